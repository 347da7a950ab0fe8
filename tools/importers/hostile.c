/* The order of calls, values, steps and saved states; and every hostile test in one run. */
#include "hostile.h"

static char *image; /* the instance before a call */
static size_t image_size;

void picture(Instance c) {
    free(image);
    image_size = fmu_save(c, &image);
    messages = 0;
    message[0] = 0;
}

bool unchanged(Instance c) {
    char *now;
    size_t size = fmu_save(c, &now);
    bool same = size == image_size && same_state(now, image, size);
    free(now);
    return same;
}

void refused(Instance c, Status status, const char *file, int line, const char *text) {
    check(status == FMI_ERROR || status == FMI_DISCARD, file, line, text);
    check(messages == 1 && message[0], file, line, "one message");
    check(unchanged(c), file, line, "nothing changed");
}

#if FMI_VERSION == 2
enum { NEW, INITIALIZING, STEPPING, TERMINATED, PHASES };

static Instance in_phase(int phase) {
    Instance c = fmu_open("%s%n%d");
#else
/* STEPPING is step mode of an importer without event mode, the last two are modes of one with it. */
enum { NEW, INITIALIZING, STEPPING, TERMINATED, BETWEEN_EVENTS, AT_EVENT, PHASES };

static Instance in_phase(int phase) {
    Instance c = open_with("%s%n%d", phase >= TERMINATED, false);
#endif
    if (phase == NEW) return c;
    IS_OK(start_experiment(c, 0.0, true, 1000.0));
    double x;
    IS_OK(get_reals(c, reference(OUTPUT), 1, &x));
    if (phase == INITIALIZING) return c;
    IS_OK(fmi.ExitInitializationMode(c));
#if FMI_VERSION == 3
    if (phase != STEPPING) IS_OK(fmi.EnterStepMode(c));
#endif
    IS_OK(step_to(c, 0.0, 20.0));
#if FMI_VERSION == 3
    if (phase == AT_EVENT) IS_OK(fmi.EnterEventMode(c));
#endif
    if (phase == TERMINATED) IS_OK(fmi.Terminate(c));
    return c;
}

static Status start(Instance c) { return start_experiment(c, 0.0, false, 0.0); }
static Status leave(Instance c) { return fmi.ExitInitializationMode(c); }
static Status terminate(Instance c) { return fmi.Terminate(c); }
static Status get_real(Instance c) { double x; return get_reals(c, reference(OUTPUT), 1, &x); }
static Status get_integer(Instance c) { Integer x; return get_integers(c, reference(INTEGER_OUTPUT), 1, &x); }
static Status get_boolean(Instance c) { Boolean x; return get_booleans(c, reference(BOOLEAN_OUTPUT), 1, &x); }
static Status set_input(Instance c) { double x = 0.5; return set_reals(c, reference(INPUT), 1, &x); }
static Status set_fixed(Instance c) { double x = 0.5; return set_reals(c, reference(FIXED), 1, &x); }
static Status set_fixed_boolean(Instance c) { Boolean x = true; return set_booleans(c, reference(FIXED_BOOLEAN), 1, &x); }
static Status set_tunable(Instance c) { Boolean x = false; return set_booleans(c, reference(TUNABLE), 1, &x); }
static Status set_integer(Instance c) { Integer x = 3; return set_integers(c, reference(COUNT), 1, &x); }
static Status do_step(Instance c) { return step_to(c, 20.0, 1.0); }
static Status get_derivative(Instance c) { Integer o = 1; double x; return get_derivatives(c, reference(OUTPUT), 1, &o, &x); }
#if FMI_VERSION == 2
static Status setup(Instance c) { return fmi.SetupExperiment(c, fmi2False, 0.0, 1.0, fmi2False, 0.0); }
static Status enter(Instance c) { return fmi.EnterInitializationMode(c); }
static Status set_derivative(Instance c) { int o = 1; double x = 0.1; return fmi.SetRealInputDerivatives(c, reference(SMOOTH_INPUT), 1, &o, &x); }
#else
static Status get_array(Instance c) { double x[2]; return fmi.GetFloat64(c, &POSITIONS, 1, x, 2); }
static Status get_clock(Instance c) { fmi3Clock x; return fmi.GetClock(c, &CLOCK, 1, &x); }
static Status update(Instance c) { fmi3Boolean b[5]; double t; return fmi.UpdateDiscreteStates(c, b, b + 1, b + 2, b + 3, b + 4, &t); }
static Status start_step(Instance c) { return fmi.EnterStepMode(c); }
static Status start_event(Instance c) { return fmi.EnterEventMode(c); }
#endif

/* Which call is allowed when, where the model has the variable; the last two phases are FMI 3.0's. */
static const struct { Status (*call)(Instance); const char *variable; bool allowed[6]; } ORDER[] = {
    {start, "", {1, 0, 0, 0, 0, 0}}, {leave, "", {0, 1, 0, 0, 0, 0}}, {terminate, "", {0, 0, 1, 0, 1, 1}},
    {get_real, OUTPUT, {0, 1, 1, 1, 1, 1}}, {get_integer, INTEGER_OUTPUT, {0, 1, 1, 1, 1, 1}}, {get_boolean, BOOLEAN_OUTPUT, {0, 1, 1, 1, 1, 1}},
    {set_input, INPUT, {1, 1, 1, 0, 1, 1}}, {set_fixed, FIXED, {1, 1, 0, 0, 0, 0}}, {set_fixed_boolean, FIXED_BOOLEAN, {1, 1, 0, 0, 0, 0}},
    {set_tunable, TUNABLE, {1, 1, 1, 0, 1, 1}}, {set_integer, COUNT, {1, 1, 1, 0, 1, 1}},
    {do_step, "", {0, 0, 1, 0, 1, 0}}, {get_derivative, OUTPUT, {0, 1, 1, 1, 1, 1}},
#if FMI_VERSION == 2
    {setup, "", {1, 0, 0, 0}}, {enter, "", {1, 0, 0, 0}}, {set_derivative, SMOOTH_INPUT, {1, 1, 1, 0}},
#else
    {get_array, ARRAYS, {0, 1, 1, 1, 1, 1}}, {get_clock, TICKS, {0, 1, 0, 0, 0, 1}}, {update, "", {0, 0, 0, 0, 0, 1}},
    {start_step, "", {0, 0, 0, 0, 0, 1}}, {start_event, "", {0, 0, 0, 0, 1, 0}},
#endif
};

static void order(void) {
    for (int phase = 0; phase < PHASES; phase++) {
        Instance c = in_phase(phase);
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
        int stepping = STEPPING;
#if FMI_VERSION == 3
        if (phase >= TERMINATED) {
            IS_OK(fmi.EnterStepMode(c));
            stepping = BETWEEN_EVENTS;
        }
#endif
        IS_OK(step_to(c, 0.0, 20.0));
        Instance twin = in_phase(stepping);
        picture(twin);
        CHECK(unchanged(c)); /* reset forgets everything */
        fmi.FreeInstance(twin);
        fmi.FreeInstance(c);
    }
}

/* Every parameter and input outside its range; the ends of the range are inside. */
static void values(void) {
    Instance c = in_phase(INITIALIZING);
    for (size_t i = 0; i < NAME_COUNT; i++) {
        const Name *name = &NAMES[i];
        if (!name->settable || name->type != 'R') continue;
        double bad[] = {NAN, -NAN, INFINITY, -INFINITY, nextafter(name->minimum, -INFINITY), nextafter(name->maximum, INFINITY)};
        for (size_t k = 0; k < 6; k++) {
            if (k >= 4 && isfinite(bad[k]) == 0) continue;
            unsigned pair[] = {*reference(INPUT), name->reference};
            double both[] = {0.25, bad[k]};
            REFUSED(c, set_reals(c, &name->reference, 1, &bad[k]));
            SAYS(name->name); SAYS("expected "); SAYS(k < 2 ? "nan" : k == 2 ? "inf" : " = ");
            if (name->reference != pair[0]) REFUSED(c, set_reals(c, pair, 2, both)); /* all or none */
        }
        char *saved;
        size_t size = fmu_save(c, &saved);
        if (isfinite(name->minimum)) IS_OK(set_reals(c, &name->reference, 1, &name->minimum));
        if (isfinite(name->maximum)) IS_OK(set_reals(c, &name->reference, 1, &name->maximum));
        CHECK(fmu_restore(c, saved, size));
        free(saved);
    }
    Integer count[] = {-1, 201, INT32_MAX, INT32_MIN};
    for (int i = 0; i < 4; i++) { REFUSED(c, set_integers(c, reference(COUNT), 1, &count[i])); SAYS(COUNT ? "sample_count = " : ""); }
    fmi.FreeInstance(c);
    c = in_phase(NEW);
    double starts[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) { REFUSED(c, start_experiment(c, starts[i], false, 0.0)); SAYS("startTime = "); }
    double stops[] = {NAN, -INFINITY, 0.5};
    for (int i = 0; i < 3; i++) { REFUSED(c, start_experiment(c, 1.0, true, stops[i])); SAYS("stopTime = "); }
#if FMI_VERSION == 2
    IS_OK(fmi.SetupExperiment(c, fmi2False, 0.0, 1.0, fmi2False, 0.5)); /* not defined: not looked at */
    IS_OK(fmi.SetupExperiment(c, fmi2False, 0.0, 1.0, fmi2True, INFINITY));
#endif
    fmi.FreeInstance(c);
}

/* A start that cannot be: no output can be had in initialization mode. */
static void bad_start(void) {
    Instance c = in_phase(INITIALIZING);
    double x;
    Integer whole, order = 1;
    Boolean truth;
    IS_OK(set_reals(c, reference(BAD_START.fixed), 1, &BAD_START.value));
    IS_OK(set_reals(c, reference(BAD_START.name), 1, &BAD_START.bad));
    messages = 0;
    CHECK(fmi.ExitInitializationMode(c) == FMI_ERROR && messages == 1); SAYS(BAD_START.says);
    REFUSED(c, get_reals(c, reference(OUTPUT), 1, &x)); SAYS(BAD_START.says);
    REFUSED(c, get_integers(c, reference(INTEGER_OUTPUT), 1, &whole));
    REFUSED(c, get_booleans(c, reference(BOOLEAN_OUTPUT), 1, &truth));
    REFUSED(c, get_derivatives(c, reference(OUTPUT), 1, &order, &x));
    IS_OK(set_reals(c, reference(BAD_START.name), 1, &BAD_START.good));
    IS_OK(fmi.ExitInitializationMode(c));
#if FMI_VERSION == 3
    unsigned time = TIME_REFERENCE, element = 50; /* an element of an array that has a reference of its own */
    REFUSED(c, get_derivatives(c, &time, 1, &order, &x)); SAYS("time");
    REFUSED(c, get_reals(c, &element, 1, &x)); SAYS(ARRAYS ? "array" : "");
#endif
    IS_OK(step_to(c, 0.0, 1.0));
    fmi.FreeInstance(c);
}

/* No step past the end of the experiment; its end, and a rounding more, is inside. */
static void stop_time(void) {
    Instance c = fmu_open("stop");
    IS_OK(start_experiment(c, 0.0, true, 1.0));
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

static void steps(Instance c) {
    double sizes[] = {-1.0, -5e-324, NAN, -NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 6; i++) { REFUSED(c, step_to(c, 20.0, sizes[i])); SAYS("communicationStepSize = "); }
    double points[] = {-20.0, 0.0, 19.0, 21.0, NAN, INFINITY, -INFINITY, 1e300};
    for (int i = 0; i < 8; i++) { REFUSED(c, step_to(c, points[i], 1.0)); SAYS("currentCommunicationPoint = "); SAYS("20.0 s"); }
    double last = 0.0;
#if FMI_VERSION == 3
    fmi3Boolean event = true, end = true, early = true;
    CHECK(fmi.DoStep(c, 20.0, -1.0, true, &event, &end, &early, &last) == fmi3Error);
    CHECK(!event && !end && !early && last == 20.0); /* nothing happened */
#endif
    IS_OK(step_to(c, 20.0, 0.0));
    CHECK(step_to(c, 20.0, 5e-324) == FMI_WARNING); SAYS("too short to change the time, 20.0 s");
    IS_OK(step_to(c, 20.0, 5e-324)); /* said once */
#if FMI_VERSION == 2
    IS_OK(fmi.GetRealStatus(c, fmi2LastSuccessfulTime, &last));
    CHECK(last == 20.0);
#endif
}

/* A step that fails inside leaves the instance where it was, and the next one goes on from there. */
static void failing_steps(void) {
    for (size_t i = 0; i < BAD_STEP_COUNT; i++) {
        const BadStep *bad = &BAD_STEPS[i];
        Instance c = fmu_open("failing"), twin = fmu_open("twin");
        fmu_set(c, bad->fixed, bad->value);
        fmu_set(twin, bad->fixed, bad->value);
        fmu_initialize(c, 0.0);
        fmu_initialize(twin, 0.0);
        fmu_step(c, 0.0, 20.0);
        fmu_step(twin, 0.0, 20.0);
        IS_OK(set_reals(c, reference(bad->input), 1, &bad->bad));
        REFUSED(c, step_to(c, 20.0, bad->size));
        SAYS(bad->says); SAYS(bad->also);
        fmu_set(c, bad->input, bad->good);
        fmu_set(twin, bad->input, bad->good);
        fmu_step(c, 20.0, 100.0);
        fmu_step(twin, 20.0, 100.0);
        picture(twin);
        CHECK(unchanged(c));
        fmi.FreeInstance(twin);
        fmi.FreeInstance(c);
    }
}

/* Phase and flags of a saved state: outputs are stale, the clock ticks; FMI 3.0's event mode is step mode in FMI 2.0. */
static void other_heads(void) {
#if FMI_VERSION == 2
    static const double heads[][2] = {{4.0, 0.0}, {4.0, 1.0}, {4.0, 2.0}, {4.0, 3.0}, {8.0, 0.0}, {8.0, 2.0}};
#else
    static const double heads[][2] = {{4.0, 0.0}, {4.0, 1.0}, {4.0, 2.0}, {4.0, 3.0}};
#endif
    for (size_t i = 0; i < sizeof heads / sizeof *heads; i++) {
        Instance c = in_phase(STEPPING);
        char *bytes;
        size_t size = fmu_save(c, &bytes);
        memcpy(bytes + 64, &heads[i][0], sizeof(double));
        memcpy(bytes + 80, &heads[i][1], sizeof(double));
        seal(bytes, size);
        CHECK(fmu_restore(c, bytes, size));
        IS_OK(step_to(c, 20.0 - 1e-12, 0.0)); /* the importer's clock a rounding behind */
        IS_OK(step_to(c, 20.0, 1.0));
        free(bytes);
        fmi.FreeInstance(c);
    }
}

static void saved_states(Instance c) {
    char *bytes, *bad;
    size_t size = fmu_save(c, &bytes), told;
    State state = NULL, other = NULL;
    double broken[] = {NAN, 0.0, -1.0, 3.0, 4.5, 64.0, 1e300, INFINITY};
    CHECK((bad = malloc(size + 1)) != NULL);
    size_t sizes[] = {0, 1, 63, 64, size - 1, size + 1};
    memcpy(bad, bytes, size);
    bad[size] = 0;
    for (int i = 0; i < 6; i++) { REFUSED(c, deserialize(c, bad, sizes[i], &state)); CHECK(state == NULL); }
    for (size_t i = 0; i < 64; i++) { /* what says whose state this is */
        bad[i] ^= 4;
        REFUSED(c, deserialize(c, bad, size, &state));
        bad[i] ^= 4;
    }
    for (size_t i = 64; i < size; i += 61) { /* its numbers, and the checksum */
        bad[i] ^= 1;
        REFUSED(c, deserialize(c, bad, size, &state));
        bad[i] ^= 1;
    }
    for (int i = 0; i < 8; i++) { /* the phase */
        memcpy(bad + 64, &broken[i], sizeof broken[i]);
        seal(bad, size);
        REFUSED(c, deserialize(c, bad, size, &state));
    }
    CHECK(state == NULL);
    IS_OK(get_state(c, &state));
    REFUSED(c, serialized_size(c, state, NULL)); REFUSED(c, serialized_size(c, NULL, &told));
    REFUSED(c, serialize(c, NULL, bad, size)); REFUSED(c, serialize(c, state, NULL, size));
    REFUSED(c, serialize(c, state, bad, size - 1)); REFUSED(c, serialize(c, state, bad, 0));
    REFUSED(c, deserialize(c, NULL, size, &other)); REFUSED(c, deserialize(c, bytes, size, NULL));
    State same = state;
    IS_OK(get_state(c, &state));
    CHECK(state == same); /* the memory handed in is used again */
    IS_OK(deserialize(c, bytes, size, &state));
    CHECK(state == same);
    IS_OK(free_state(c, &state));
    CHECK(state == NULL);
    IS_OK(free_state(c, &state)); /* once more, as the standard has it */
    free(bad);
    free(bytes);
}

void hostile(void) {
    no_instance();
    instantiation();
    order();
    values();
    bad_start();
    stop_time();
    other_heads();
    failing_steps();
#if FMI_VERSION == 3
    start_values(in_phase(NEW));
    event_mode(in_phase(AT_EVENT));
#endif
    Instance c = in_phase(STEPPING), twin = in_phase(STEPPING);
    absent(c);
    null_pointers(c);
    own_null_pointers(c);
    references(c);
    steps(c);
    saved_states(c);
    IS_OK(set_reals(twin, NULL, 0, NULL)); /* what c was told and accepted: nothing, and three steps of no length */
    fmu_step(twin, 20.0, 0.0);
    CHECK(step_to(twin, 20.0, 5e-324) == FMI_WARNING);
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
