/* FMI 2.0: the order of calls, values, steps and saved states; and every hostile test in one run. */
#include "hostile2.h"

static char *image; /* the instance before a call */
static size_t image_size;

void picture(fmi2Component c) {
    free(image);
    image_size = fmu_save(c, &image);
    messages = 0;
    message[0] = 0;
}

bool unchanged(fmi2Component c) {
    char *now;
    size_t size = fmu_save(c, &now);
    bool same = size == image_size && same_state(now, image, size);
    free(now);
    return same;
}

void refused(fmi2Component c, fmi2Status status, const char *file, int line, const char *text) {
    check(status == fmi2Error || status == fmi2Discard, file, line, text);
    check(messages == 1 && message[0], file, line, "one message");
    check(unchanged(c), file, line, "nothing changed");
}

fmi2Component in_phase(int phase) {
    fmi2Component c = fmu_open("%s%n%d");
    if (phase == NEW) return c;
    IS_OK(fmi.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2True, 1000.0));
    IS_OK(fmi.EnterInitializationMode(c));
    double x;
    IS_OK(fmi.GetReal(c, reference(OUTPUT), 1, &x));
    if (phase == INITIALIZING) return c;
    IS_OK(fmi.ExitInitializationMode(c));
    fmu_step(c, 0.0, 20.0);
    if (phase == TERMINATED) IS_OK(fmi.Terminate(c));
    return c;
}

static fmi2Status setup(fmi2Component c) { return fmi.SetupExperiment(c, fmi2False, 0.0, 1.0, fmi2False, 0.0); }
static fmi2Status get_real(fmi2Component c) { double x; return fmi.GetReal(c, reference(OUTPUT), 1, &x); }
static fmi2Status get_integer(fmi2Component c) { int x; return fmi.GetInteger(c, reference(INTEGER_OUTPUT), 1, &x); }
static fmi2Status get_boolean(fmi2Component c) { int x; return fmi.GetBoolean(c, reference(BOOLEAN_OUTPUT), 1, &x); }
static fmi2Status set_input(fmi2Component c) { double x = 0.5; return fmi.SetReal(c, reference(INPUT), 1, &x); }
static fmi2Status set_fixed(fmi2Component c) { double x = 0.5; return fmi.SetReal(c, reference(FIXED), 1, &x); }
static fmi2Status set_fixed_boolean(fmi2Component c) { int x = 1; return fmi.SetBoolean(c, reference(FIXED_BOOLEAN), 1, &x); }
static fmi2Status set_tunable(fmi2Component c) { int x = 0; return fmi.SetBoolean(c, reference(TUNABLE), 1, &x); }
static fmi2Status set_integer(fmi2Component c) { int x = 3; return fmi.SetInteger(c, reference(COUNT), 1, &x); }
static fmi2Status do_step(fmi2Component c) { double t = 0.0; fmi.GetRealStatus(c, fmi2LastSuccessfulTime, &t); return fmi.DoStep(c, t, 1.0, fmi2True); }
static fmi2Status set_derivative(fmi2Component c) { int o = 1; double x = 0.1; return fmi.SetRealInputDerivatives(c, reference(SMOOTH_INPUT), 1, &o, &x); }
static fmi2Status get_derivative(fmi2Component c) { int o = 1; double x; return fmi.GetRealOutputDerivatives(c, reference(OUTPUT), 1, &o, &x); }

/* Which call is allowed when, where the model has the variable. */
static const struct { fmi2Status (*call)(fmi2Component); const char *variable; bool allowed[PHASES]; } ORDER[] = {
    {setup, "", {1, 0, 0, 0}},
    {get_real, OUTPUT, {0, 1, 1, 1}}, {get_integer, INTEGER_OUTPUT, {0, 1, 1, 1}}, {get_boolean, BOOLEAN_OUTPUT, {0, 1, 1, 1}},
    {set_input, INPUT, {1, 1, 1, 0}}, {set_fixed, FIXED, {1, 1, 0, 0}}, {set_fixed_boolean, FIXED_BOOLEAN, {1, 1, 0, 0}}, {set_tunable, TUNABLE, {1, 1, 1, 0}}, {set_integer, COUNT, {1, 1, 1, 0}},
    {do_step, "", {0, 0, 1, 0}}, {set_derivative, SMOOTH_INPUT, {1, 1, 1, 0}}, {get_derivative, OUTPUT, {0, 1, 1, 1}},
};

static void order(void) {
    for (int phase = 0; phase < PHASES; phase++) {
        fmi2Component c = in_phase(phase);
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
        if (phase != NEW) REFUSED(c, fmi.EnterInitializationMode(c));
        if (phase != INITIALIZING) REFUSED(c, fmi.ExitInitializationMode(c));
        if (phase != STEPPING) REFUSED(c, fmi.Terminate(c));
        IS_OK(fmi.Reset(c));
        fmu_initialize(c, 0.0);
        fmu_step(c, 0.0, 20.0);
        fmi2Component twin = in_phase(STEPPING);
        picture(twin);
        CHECK(unchanged(c)); /* reset forgets everything */
        fmi.FreeInstance(twin);
        fmi.FreeInstance(c);
    }
}

/* Every parameter and input outside its range; the ends of the range are inside. */
static void values(void) {
    fmi2Component c = in_phase(INITIALIZING);
    for (size_t i = 0; i < NAME_COUNT; i++) {
        const Name *name = &NAMES[i];
        if (!name->settable || name->type != 'R') continue;
        double bad[] = {NAN, -NAN, INFINITY, -INFINITY, nextafter(name->minimum, -INFINITY), nextafter(name->maximum, INFINITY)};
        for (size_t k = 0; k < 6; k++) {
            if (k >= 4 && isfinite(bad[k]) == 0) continue;
            unsigned pair[] = {*reference(INPUT), name->reference};
            double both[] = {0.25, bad[k]};
            REFUSED(c, fmi.SetReal(c, &name->reference, 1, &bad[k]));
            SAYS(name->name); SAYS("expected "); SAYS(k < 2 ? "nan" : k == 2 ? "inf" : " = ");
            if (name->reference != pair[0]) REFUSED(c, fmi.SetReal(c, pair, 2, both)); /* all or none */
        }
        char *saved;
        size_t size = fmu_save(c, &saved);
        if (isfinite(name->minimum)) IS_OK(fmi.SetReal(c, &name->reference, 1, &name->minimum));
        if (isfinite(name->maximum)) IS_OK(fmi.SetReal(c, &name->reference, 1, &name->maximum));
        CHECK(fmu_restore(c, saved, size));
        free(saved);
    }
    int count[] = {-1, 201, INT32_MAX, INT32_MIN};
    for (int i = 0; i < 4; i++) { REFUSED(c, fmi.SetInteger(c, reference(COUNT), 1, &count[i])); SAYS(COUNT ? "sample_count = " : ""); }
    double read;
    IS_OK(fmi.SetReal(c, reference(BAD_START.name), 1, &BAD_START.bad));
    messages = 0;
    CHECK(fmi.ExitInitializationMode(c) == fmi2Error && messages == 1);
    SAYS(BAD_START.says);
    int order = 1, whole; /* outputs cannot be had either */
    REFUSED(c, fmi.GetReal(c, reference(OUTPUT), 1, &read)); SAYS(BAD_START.says);
    REFUSED(c, fmi.GetInteger(c, reference(INTEGER_OUTPUT), 1, &whole));
    REFUSED(c, fmi.GetBoolean(c, reference(BOOLEAN_OUTPUT), 1, &whole));
    REFUSED(c, fmi.GetRealOutputDerivatives(c, reference(OUTPUT), 1, &order, &read));
    IS_OK(fmi.SetReal(c, reference(BAD_START.name), 1, &BAD_START.good));
    IS_OK(fmi.ExitInitializationMode(c));
    fmu_step(c, 0.0, 1.0);
    fmi.FreeInstance(c);
    c = in_phase(NEW);
    double starts[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) { REFUSED(c, fmi.SetupExperiment(c, fmi2False, 0.0, starts[i], fmi2False, 0.0)); SAYS("startTime = "); }
    double stops[] = {NAN, -INFINITY, 0.5};
    for (int i = 0; i < 3; i++) { REFUSED(c, fmi.SetupExperiment(c, fmi2False, 0.0, 1.0, fmi2True, stops[i])); SAYS("stopTime = "); }
    IS_OK(fmi.SetupExperiment(c, fmi2False, 0.0, 1.0, fmi2False, 0.5)); /* not defined: not looked at */
    IS_OK(fmi.SetupExperiment(c, fmi2False, 0.0, 1.0, fmi2True, INFINITY));
    fmi.FreeInstance(c);
}

/* No step past the end of the experiment; its end, and a rounding more, is inside. */
static void stop_time(void) {
    fmi2Component c = fmu_open("stop");
    IS_OK(fmi.SetupExperiment(c, fmi2False, 0.0, 0.0, fmi2True, 1.0));
    IS_OK(fmi.EnterInitializationMode(c));
    IS_OK(fmi.ExitInitializationMode(c));
    REFUSED(c, fmi.DoStep(c, 0.0, 1.001, fmi2True)); SAYS("stopTime = 1.0 s");
    for (int k = 0; k < 10; k++) IS_OK(fmi.DoStep(c, 0.1 * k, 0.1, fmi2True));
    REFUSED(c, fmi.DoStep(c, 1.0, 0.1, fmi2True)); SAYS("stopTime = 1.0 s");
    char *saved;
    size_t size = fmu_save(c, &saved);
    IS_OK(fmi.Reset(c));
    fmu_initialize(c, 0.0);
    CHECK(fmu_restore(c, saved, size)); /* the end is the experiment's, not the state's */
    IS_OK(fmi.DoStep(c, 1.0, 0.1, fmi2True));
    free(saved);
    fmi.FreeInstance(c);
}

static void steps(fmi2Component c) {
    double t = 20.0, none = 0.0;
    double sizes[] = {-1.0, -5e-324, NAN, -NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 6; i++) { REFUSED(c, fmi.DoStep(c, t, sizes[i], fmi2True)); SAYS("communicationStepSize = "); }
    double points[] = {-20.0, 0.0, 19.0, 21.0, NAN, INFINITY, -INFINITY, 1e300};
    for (int i = 0; i < 8; i++) { REFUSED(c, fmi.DoStep(c, points[i], 1.0, fmi2True)); SAYS("currentCommunicationPoint = "); SAYS("20.0 s"); }
    IS_OK(fmi.DoStep(c, t, 0.0, fmi2True));
    IS_OK(fmi.DoStep(c, t, 5e-324, fmi2True));
    IS_OK(fmi.GetRealStatus(c, fmi2LastSuccessfulTime, &none));
    CHECK(none == t);
}

/* A step that fails inside leaves the instance where it was, and the next one goes on from there. */
static void failing_steps(void) {
    for (size_t i = 0; i < BAD_STEP_COUNT; i++) {
        const BadStep *bad = &BAD_STEPS[i];
        fmi2Component c = fmu_open("failing"), twin = fmu_open("twin");
        fmu_set(c, bad->fixed, bad->value);
        fmu_set(twin, bad->fixed, bad->value);
        fmu_initialize(c, 0.0);
        fmu_initialize(twin, 0.0);
        fmu_step(c, 0.0, 20.0);
        fmu_step(twin, 0.0, 20.0);
        IS_OK(fmi.SetReal(c, reference(bad->input), 1, &bad->bad));
        REFUSED(c, fmi.DoStep(c, 20.0, bad->size, fmi2True));
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

/* What an FMI 3.0 FMU may have saved: its clock ticks, outputs are stale, it is in event mode, which is step mode here. */
static void other_heads(void) {
    static const double heads[][2] = {{4.0, 1.0}, {4.0, 2.0}, {4.0, 3.0}, {8.0, 0.0}, {8.0, 2.0}};
    for (int i = 0; i < 5; i++) {
        fmi2Component c = in_phase(STEPPING);
        char *bytes;
        size_t size = fmu_save(c, &bytes);
        memcpy(bytes + 64, &heads[i][0], sizeof(double));
        memcpy(bytes + 80, &heads[i][1], sizeof(double));
        seal(bytes, size);
        CHECK(fmu_restore(c, bytes, size));
        fmu_step(c, 20.0 - 1e-12, 0.0); /* the importer's clock a rounding behind */
        fmu_step(c, 20.0, 1.0);
        free(bytes);
        fmi.FreeInstance(c);
    }
}

static void saved_states(fmi2Component c) {
    char *bytes, *bad;
    size_t size = fmu_save(c, &bytes), told;
    fmi2FMUstate state = NULL, other = NULL;
    double broken[] = {NAN, 0.0, -1.0, 3.0, 4.5, 64.0, 1e300, INFINITY};
    CHECK((bad = malloc(size + 1)) != NULL);
    size_t sizes[] = {0, 1, 63, 64, size - 1, size + 1};
    memcpy(bad, bytes, size);
    bad[size] = 0;
    for (int i = 0; i < 6; i++) { REFUSED(c, fmi.DeSerializeFMUstate(c, bad, sizes[i], &state)); CHECK(state == NULL); }
    for (size_t i = 0; i < 64; i++) { /* what says whose state this is */
        bad[i] ^= 4;
        REFUSED(c, fmi.DeSerializeFMUstate(c, bad, size, &state));
        bad[i] ^= 4;
    }
    for (size_t i = 64; i < size; i += 61) { /* its numbers, and the checksum */
        bad[i] ^= 1;
        REFUSED(c, fmi.DeSerializeFMUstate(c, bad, size, &state));
        bad[i] ^= 1;
    }
    for (int i = 0; i < 8; i++) { /* the phase */
        memcpy(bad + 64, &broken[i], sizeof broken[i]);
        seal(bad, size);
        REFUSED(c, fmi.DeSerializeFMUstate(c, bad, size, &state));
    }
    CHECK(state == NULL);
    IS_OK(fmi.GetFMUstate(c, &state));
    REFUSED(c, fmi.SerializedFMUstateSize(c, state, NULL)); REFUSED(c, fmi.SerializedFMUstateSize(c, NULL, &told));
    REFUSED(c, fmi.SerializeFMUstate(c, NULL, bad, size)); REFUSED(c, fmi.SerializeFMUstate(c, state, NULL, size));
    REFUSED(c, fmi.SerializeFMUstate(c, state, bad, size - 1)); REFUSED(c, fmi.SerializeFMUstate(c, state, bad, 0));
    REFUSED(c, fmi.DeSerializeFMUstate(c, NULL, size, &other)); REFUSED(c, fmi.DeSerializeFMUstate(c, bytes, size, NULL));
    fmi2FMUstate same = state;
    IS_OK(fmi.GetFMUstate(c, &state));
    CHECK(state == same); /* the memory handed in is used again */
    IS_OK(fmi.DeSerializeFMUstate(c, bytes, size, &state));
    CHECK(state == same);
    IS_OK(fmi.FreeFMUstate(c, &state));
    CHECK(state == NULL);
    IS_OK(fmi.FreeFMUstate(c, &state)); /* once more, as the standard has it */
    free(bad);
    free(bytes);
}

void hostile(void) {
    no_instance();
    instantiation();
    order();
    values();
    stop_time();
    other_heads();
    failing_steps();
    fmi2Component c = in_phase(STEPPING), twin = in_phase(STEPPING);
    absent(c);
    null_pointers(c);
    references(c);
    steps(c);
    saved_states(c);
    IS_OK(fmi.SetReal(twin, NULL, 0, NULL)); /* what c was told and accepted: nothing, and two steps of no length */
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
