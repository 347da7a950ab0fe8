/* FMI 3.0: the order of calls, values, steps and saved states; and every hostile test in one run. */
#include "hostile3.h"

static char *image; /* the instance before a call */
static size_t image_size;

void picture(fmi3Instance c) {
    free(image);
    image_size = fmu_save(c, &image);
    messages = 0;
    message[0] = 0;
}

bool unchanged(fmi3Instance c) {
    char *now;
    size_t size = fmu_save(c, &now);
    bool same = size == image_size && same_state(now, image, size);
    free(now);
    return same;
}

void refused(fmi3Instance c, fmi3Status status, const char *file, int line, const char *text) {
    check(status == fmi3Error || status == fmi3Discard, file, line, text);
    check(messages == 1 && message[0], file, line, "one message");
    check(unchanged(c), file, line, "nothing changed");
}

fmi3Status step_to(fmi3Instance c, double time, double size) {
    fmi3Boolean event, end, early;
    double last;
    return fmi.DoStep(c, time, size, true, &event, &end, &early, &last);
}

fmi3Instance in_phase(int phase) {
    fmi3Instance c = open_with("%s%n%d", phase >= STEPPING, false);
    if (phase == NEW) return c;
    IS_OK(fmi.EnterInitializationMode(c, false, 0.0, 0.0, true, 1000.0));
    double x;
    IS_OK(fmi.GetFloat64(c, reference(OUTPUT), 1, &x, 1));
    if (phase == INITIALIZING) return c;
    IS_OK(fmi.ExitInitializationMode(c));
    if (phase != PLAIN) IS_OK(fmi.EnterStepMode(c));
    IS_OK(step_to(c, 0.0, 20.0));
    if (phase == EVENT) IS_OK(fmi.EnterEventMode(c));
    if (phase == TERMINATED) IS_OK(step_to(c, 20.0, 0.0));
    if (phase == TERMINATED) IS_OK(fmi.Terminate(c));
    return c;
}

static fmi3Status get_real(fmi3Instance c) { double x; return fmi.GetFloat64(c, reference(OUTPUT), 1, &x, 1); }
static fmi3Status get_integer(fmi3Instance c) { fmi3Int32 x; return fmi.GetInt32(c, reference(INTEGER_OUTPUT), 1, &x, 1); }
static fmi3Status get_boolean(fmi3Instance c) { fmi3Boolean x; return fmi.GetBoolean(c, reference(BOOLEAN_OUTPUT), 1, &x, 1); }
static fmi3Status get_array(fmi3Instance c) { double x[2]; return fmi.GetFloat64(c, &POSITIONS, 1, x, 2); }
static fmi3Status set_input(fmi3Instance c) { double x = 0.5; return fmi.SetFloat64(c, reference(INPUT), 1, &x, 1); }
static fmi3Status set_fixed(fmi3Instance c) { double x = 0.5; return fmi.SetFloat64(c, reference(FIXED), 1, &x, 1); }
static fmi3Status set_fixed_boolean(fmi3Instance c) { fmi3Boolean x = true; return fmi.SetBoolean(c, reference(FIXED_BOOLEAN), 1, &x, 1); }
static fmi3Status set_tunable(fmi3Instance c) { fmi3Boolean x = false; return fmi.SetBoolean(c, reference(TUNABLE), 1, &x, 1); }
static fmi3Status set_integer(fmi3Instance c) { fmi3Int32 x = 3; return fmi.SetInt32(c, reference(COUNT), 1, &x, 1); }
static fmi3Status do_step(fmi3Instance c) { return step_to(c, 20.0, 1.0); }
static fmi3Status get_derivative(fmi3Instance c) { fmi3Int32 o = 1; double x; return fmi.GetOutputDerivatives(c, reference(OUTPUT), 1, &o, &x, 1); }
static fmi3Status get_clock(fmi3Instance c) { fmi3Clock x; return fmi.GetClock(c, &CLOCK, 1, &x); }
static fmi3Status update(fmi3Instance c) { fmi3Boolean b[5]; double t; return fmi.UpdateDiscreteStates(c, b, b + 1, b + 2, b + 3, b + 4, &t); }
static fmi3Status start(fmi3Instance c) { return fmi.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0); }
static fmi3Status start_step(fmi3Instance c) { return fmi.EnterStepMode(c); }
static fmi3Status start_event(fmi3Instance c) { return fmi.EnterEventMode(c); }
static fmi3Status leave(fmi3Instance c) { return fmi.ExitInitializationMode(c); }
static fmi3Status terminate(fmi3Instance c) { return fmi.Terminate(c); }

/* Which call is allowed when, where the model has the variable. */
static const struct { fmi3Status (*call)(fmi3Instance); const char *variable; bool allowed[PHASES]; } ORDER[] = {
    {start, "", {1, 0, 0, 0, 0, 0}}, {leave, "", {0, 1, 0, 0, 0, 0}}, {start_step, "", {0, 0, 0, 0, 1, 0}}, {start_event, "", {0, 0, 0, 1, 0, 0}},
    {terminate, "", {0, 0, 1, 1, 1, 0}}, {get_real, OUTPUT, {0, 1, 1, 1, 1, 1}}, {get_integer, INTEGER_OUTPUT, {0, 1, 1, 1, 1, 1}}, {get_boolean, BOOLEAN_OUTPUT, {0, 1, 1, 1, 1, 1}},
    {get_array, ARRAYS, {0, 1, 1, 1, 1, 1}}, {set_input, INPUT, {1, 1, 1, 1, 1, 0}}, {set_fixed, FIXED, {1, 1, 0, 0, 0, 0}}, {set_fixed_boolean, FIXED_BOOLEAN, {1, 1, 0, 0, 0, 0}},
    {set_tunable, TUNABLE, {1, 1, 1, 1, 1, 0}}, {set_integer, COUNT, {1, 1, 1, 1, 1, 0}}, {do_step, "", {0, 0, 1, 1, 0, 0}}, {get_derivative, OUTPUT, {0, 1, 1, 1, 1, 1}},
    {get_clock, TICKS, {0, 1, 0, 0, 1, 0}}, {update, "", {0, 0, 0, 0, 1, 0}},
};

static void order(void) {
    for (int phase = 0; phase < PHASES; phase++) {
        fmi3Instance c = in_phase(phase);
        for (size_t i = 0; i < sizeof ORDER / sizeof *ORDER; i++) {
            if (!ORDER[i].variable || !ORDER[i].allowed[phase]) REFUSED(c, ORDER[i].call(c));
            else {
                char *saved;
                size_t size = fmu_save(c, &saved);
                IS_OK(ORDER[i].call(c));
                CHECK(fmu_restore(c, saved, size));
                free(saved);
            }
        }
        IS_OK(fmi.Reset(c));
        fmu_initialize(c, 0.0);
        if (phase >= STEPPING) IS_OK(fmi.EnterStepMode(c));
        IS_OK(step_to(c, 0.0, 20.0));
        fmi3Instance twin = in_phase(phase >= STEPPING ? STEPPING : PLAIN);
        picture(twin);
        CHECK(unchanged(c)); /* reset forgets everything */
        fmi.FreeInstance(twin);
        fmi.FreeInstance(c);
    }
}

/* Every parameter and input outside its range; the ends of the range are inside. */
static void values(void) {
    fmi3Instance c = in_phase(INITIALIZING);
    for (size_t i = 0; i < NAME_COUNT; i++) {
        const Name *name = &NAMES[i];
        if (!name->settable || name->type != 'R') continue;
        double bad[] = {NAN, -NAN, INFINITY, -INFINITY, nextafter(name->minimum, -INFINITY), nextafter(name->maximum, INFINITY)};
        for (size_t k = 0; k < 6; k++) {
            if (k >= 4 && isfinite(bad[k]) == 0) continue;
            unsigned pair[] = {*reference(INPUT), name->reference};
            double both[] = {0.25, bad[k]};
            REFUSED(c, fmi.SetFloat64(c, &name->reference, 1, &bad[k], 1));
            SAYS(name->name); SAYS("expected "); SAYS(k < 2 ? "nan" : k == 2 ? "inf" : " = ");
            if (name->reference != pair[0]) REFUSED(c, fmi.SetFloat64(c, pair, 2, both, 2)); /* all or none */
        }
        char *saved;
        size_t size = fmu_save(c, &saved);
        if (isfinite(name->minimum)) IS_OK(fmi.SetFloat64(c, &name->reference, 1, &name->minimum, 1));
        if (isfinite(name->maximum)) IS_OK(fmi.SetFloat64(c, &name->reference, 1, &name->maximum, 1));
        CHECK(fmu_restore(c, saved, size));
        free(saved);
    }
    fmi3Int32 count[] = {-1, 201, INT32_MAX, INT32_MIN};
    for (int i = 0; i < 4; i++) { REFUSED(c, fmi.SetInt32(c, reference(COUNT), 1, &count[i], 1)); SAYS(COUNT ? "sample_count = " : ""); }
    fmi.FreeInstance(c);
    c = in_phase(NEW);
    double starts[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) { REFUSED(c, fmi.EnterInitializationMode(c, false, 0.0, starts[i], false, 0.0)); SAYS("startTime = "); }
    double stops[] = {NAN, -INFINITY, 0.5};
    for (int i = 0; i < 3; i++) { REFUSED(c, fmi.EnterInitializationMode(c, false, 0.0, 1.0, true, stops[i])); SAYS("stopTime = "); }
    fmi.FreeInstance(c);
}

/* No step past the end of the experiment; its end, and a rounding more, is inside. */
static void stop_time(void) {
    fmi3Instance c = open_with("stop", false, false);
    IS_OK(fmi.EnterInitializationMode(c, false, 0.0, 0.0, true, 1.0));
    IS_OK(fmi.ExitInitializationMode(c));
    REFUSED(c, step_to(c, 0.0, 1.001)); SAYS("stopTime = 1.0 s");
    for (int k = 0; k < 10; k++) IS_OK(step_to(c, 0.1 * k, 0.1));
    REFUSED(c, step_to(c, 1.0, 0.1)); SAYS("stopTime = 1.0 s");
    char *saved;
    size_t size = fmu_save(c, &saved);
    IS_OK(fmi.Reset(c));
    fmu_initialize(c, 0.0);
    CHECK(fmu_restore(c, saved, size)); /* the end is the experiment's, not the state's */
    IS_OK(step_to(c, 1.0, 0.1));
    free(saved);
    fmi.FreeInstance(c);
}

/* A start that cannot be: no output can be had in initialization mode. */
static void bad_start(void) {
    fmi3Instance c = in_phase(INITIALIZING);
    double x;
    fmi3Int32 whole, order = 1;
    fmi3Boolean truth;
    IS_OK(fmi.SetFloat64(c, reference(BAD_START.name), 1, &BAD_START.bad, 1));
    messages = 0;
    CHECK(fmi.ExitInitializationMode(c) == fmi3Error && messages == 1);
    REFUSED(c, fmi.GetFloat64(c, reference(OUTPUT), 1, &x, 1)); SAYS(BAD_START.says);
    REFUSED(c, fmi.GetInt32(c, reference(INTEGER_OUTPUT), 1, &whole, 1));
    REFUSED(c, fmi.GetBoolean(c, reference(BOOLEAN_OUTPUT), 1, &truth, 1));
    REFUSED(c, fmi.GetOutputDerivatives(c, reference(OUTPUT), 1, &order, &x, 1));
    IS_OK(fmi.SetFloat64(c, reference(BAD_START.name), 1, &BAD_START.good, 1));
    IS_OK(fmi.ExitInitializationMode(c));
    unsigned time = TIME_REFERENCE, element = 50; /* an element of an array that has a reference of its own */
    REFUSED(c, fmi.GetOutputDerivatives(c, &time, 1, &order, &x, 1)); SAYS("time");
    REFUSED(c, fmi.GetFloat64(c, &element, 1, &x, 1)); SAYS(ARRAYS ? "array" : "");
    fmi.FreeInstance(c);
}

/* Flags of a saved state: outputs are stale, the clock ticks. */
static void other_heads(void) {
    for (int flag = 0; flag < 4; flag++) {
        fmi3Instance c = in_phase(PLAIN);
        double head = flag;
        char *bytes;
        size_t size = fmu_save(c, &bytes);
        memcpy(bytes + 80, &head, sizeof head);
        seal(bytes, size);
        CHECK(fmu_restore(c, bytes, size));
        IS_OK(step_to(c, 20.0 - 1e-12, 0.0)); /* the importer's clock a rounding behind */
        IS_OK(step_to(c, 20.0, 1.0));
        free(bytes);
        fmi.FreeInstance(c);
    }
}

/* Before initialization mode: start values, and nothing that is calculated. */
static void start_values(void) {
    fmi3Instance c = in_phase(NEW);
    for (size_t i = 0; i < NAME_COUNT; i++) {
        const Name *name = &NAMES[i];
        double x;
        fmi3Int32 n;
        fmi3Boolean b;
        fmi3Status status = name->type == 'R'   ? (picture(c), fmi.GetFloat64(c, &name->reference, 1, &x, 1))
                            : name->type == 'I' ? (picture(c), fmi.GetInt32(c, &name->reference, 1, &n, 1))
                                                : (picture(c), fmi.GetBoolean(c, &name->reference, 1, &b, 1));
        if (name->settable) IS_OK(status);
        else { refused(c, status, __FILE__, __LINE__, name->name); SAYS(name->name); }
    }
    fmi.FreeInstance(c);
}

static void steps(fmi3Instance c) {
    double sizes[] = {-1.0, -5e-324, NAN, -NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 6; i++) { REFUSED(c, step_to(c, 20.0, sizes[i])); SAYS("communicationStepSize = "); }
    double points[] = {-20.0, 0.0, 19.0, 21.0, NAN, INFINITY, -INFINITY, 1e300};
    for (int i = 0; i < 8; i++) { REFUSED(c, step_to(c, points[i], 1.0)); SAYS("currentCommunicationPoint = "); }
    fmi3Boolean event = true, end = true, early = true;
    double last = 0.0;
    CHECK(fmi.DoStep(c, 20.0, -1.0, true, &event, &end, &early, &last) == fmi3Error);
    CHECK(!event && !end && !early && last == 20.0); /* nothing happened */
    IS_OK(step_to(c, 20.0, 0.0));
    IS_OK(step_to(c, 20.0, 5e-324));
}

/* In event mode: the clock alone, and null pointers for what the importer does not want to know. */
static void event_mode(void) {
    fmi3Instance c = in_phase(EVENT);
    fmi3Clock tick = false;
    unsigned other[] = {1999, 2001, 0, *reference(INTEGER_OUTPUT), 0xffffffffu};
    for (int i = 0; i < 5; i++) REFUSED(c, fmi.GetClock(c, &other[i], 1, &tick));
    REFUSED(c, fmi.GetClock(c, NULL, 1, &tick)); REFUSED(c, fmi.GetClock(c, &CLOCK, 1, NULL)); REFUSED(c, fmi.SetClock(c, &CLOCK, 1, &tick));
    IS_OK(fmi.GetClock(c, NULL, 0, NULL));
    if (TICKS) IS_OK(fmi.GetClock(c, &CLOCK, 1, &tick));
    else REFUSED(c, fmi.GetClock(c, &CLOCK, 1, &tick));
    CHECK(tick == (TICKS != NULL));
    IS_OK(fmi.EvaluateDiscreteStates(c));
    IS_OK(fmi.UpdateDiscreteStates(c, NULL, NULL, NULL, NULL, NULL, NULL));
    if (TICKS) IS_OK(fmi.GetClock(c, &CLOCK, 1, &tick));
    CHECK(!tick);
    IS_OK(fmi.EnterStepMode(c));
    IS_OK(step_to(c, 20.0, 1.0));
    fmi.FreeInstance(c);
}

static void saved_states(fmi3Instance c) {
    char *bytes, *bad;
    size_t size = fmu_save(c, &bytes), told;
    fmi3FMUState state = NULL, other = NULL;
    CHECK((bad = malloc(size + 1)) != NULL);
    fmi3Byte *data = (fmi3Byte *)bad;
    memcpy(bad, bytes, size);
    bad[size] = 0;
    size_t sizes[] = {0, 1, 63, 64, size - 1, size + 1};
    for (int i = 0; i < 6; i++) { REFUSED(c, fmi.DeserializeFMUState(c, data, sizes[i], &state)); CHECK(state == NULL); }
    for (size_t i = 0; i < 64; i++) { /* what says whose state this is */
        bad[i] ^= 4;
        REFUSED(c, fmi.DeserializeFMUState(c, data, size, &state));
        bad[i] ^= 4;
    }
    double broken[] = {NAN, 0.0, -1.0, 3.0, 4.5, 64.0, 1e300, INFINITY};
    for (size_t i = 64; i < size; i += 61) { /* its numbers, and the checksum */
        bad[i] ^= 1;
        REFUSED(c, fmi.DeserializeFMUState(c, data, size, &state));
        bad[i] ^= 1;
    }
    for (int i = 0; i < 8; i++) { /* the phase */
        memcpy(bad + 64, &broken[i], sizeof broken[i]);
        seal(bad, size);
        REFUSED(c, fmi.DeserializeFMUState(c, data, size, &state));
    }
    IS_OK(fmi.GetFMUState(c, &state));
    REFUSED(c, fmi.SerializedFMUStateSize(c, state, NULL)); REFUSED(c, fmi.SerializedFMUStateSize(c, NULL, &told));
    REFUSED(c, fmi.SerializeFMUState(c, NULL, data, size)); REFUSED(c, fmi.SerializeFMUState(c, state, NULL, size));
    REFUSED(c, fmi.SerializeFMUState(c, state, data, size - 1)); REFUSED(c, fmi.SerializeFMUState(c, state, data, 0));
    REFUSED(c, fmi.DeserializeFMUState(c, NULL, size, &other)); REFUSED(c, fmi.DeserializeFMUState(c, (fmi3Byte *)bytes, size, NULL));
    fmi3FMUState same = state;
    IS_OK(fmi.GetFMUState(c, &state));
    IS_OK(fmi.DeserializeFMUState(c, (fmi3Byte *)bytes, size, &state));
    CHECK(state == same); /* the memory handed in is used again */
    IS_OK(fmi.FreeFMUState(c, &state));
    CHECK(state == NULL);
    IS_OK(fmi.FreeFMUState(c, &state)); /* once more, as the standard has it */
    free(bad);
    free(bytes);
}

void hostile(void) {
    no_instance();
    instantiation();
    order();
    values();
    stop_time();
    start_values();
    bad_start();
    other_heads();
    event_mode();
    fmi3Instance c = in_phase(PLAIN), twin = in_phase(PLAIN);
    absent(c);
    null_pointers(c);
    references(c);
    steps(c);
    saved_states(c);
    IS_OK(fmi.SetFloat64(twin, NULL, 0, NULL, 0)); /* what c was told and accepted: nothing, and two steps of no length */
    fmu_step(twin, 20.0, 0.0);
    fmu_step(twin, 20.0, 5e-324);
    fmu_step(c, 20.0, 100.0);
    fmu_step(twin, 20.0, 100.0);
    CHECK(fmu_get(c, named(OUTPUT)) == fmu_get(twin, named(OUTPUT))); /* outputs are calculated when asked for */
    picture(twin);
    CHECK(unchanged(c));
    fmi.FreeInstance(c);
    fmi.FreeInstance(twin);
    free(image);
}
