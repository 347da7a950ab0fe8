/* FMI 3.0 with hostile arguments: each call is refused with one message and changes nothing, and the instance works on. */
#include <math.h>

#include "importer3.h"

static char *image; /* the instance before a call */
static size_t image_size;

static void picture(fmi3Instance c) {
    free(image);
    image_size = fmu_save(c, &image);
    messages = 0;
    message[0] = 0;
}

static bool unchanged(fmi3Instance c) {
    char *now;
    size_t size = fmu_save(c, &now);
    bool same = size == image_size && memcmp(now, image, size) == 0;
    free(now);
    return same;
}

static void refused(fmi3Instance c, fmi3Status status, const char *file, int line, const char *text) {
    check(status == fmi3Error || status == fmi3Discard, file, line, text);
    check(messages == 1 && message[0], file, line, "one message");
    check(unchanged(c), file, line, "nothing changed");
}
#define REFUSED(c, call) (picture(c), refused(c, call, __FILE__, __LINE__, #call))
#define SAYS(text) CHECK(strstr(message, text) != NULL)
#define IS_OK(call) CHECK((call) == fmi3OK)
#define VR(name) (&named(name)->reference)

static const fmi3ValueReference POSITIONS = 1000, ARRAYS_END = 1006, CLOCK = 2000;

/* PLAIN is step mode of an importer without event mode, STEPPING that of one with it. */
enum { NEW, INITIALIZING, PLAIN, STEPPING, EVENT, TERMINATED, PHASES };

static fmi3Status step_to(fmi3Instance c, double time, double size) {
    fmi3Boolean event, end, early;
    double last;
    return fmi.DoStep(c, time, size, true, &event, &end, &early, &last);
}

static fmi3Instance in_phase(int phase) {
    fmi3Instance c = open_with("%s%n%d", phase >= STEPPING, false);
    if (phase == NEW) return c;
    IS_OK(fmi.EnterInitializationMode(c, false, 0.0, 0.0, true, 10.0));
    double x;
    IS_OK(fmi.GetFloat64(c, VR("x1"), 1, &x, 1));
    if (phase == INITIALIZING) return c;
    IS_OK(fmi.ExitInitializationMode(c));
    if (phase != PLAIN) IS_OK(fmi.EnterStepMode(c));
    IS_OK(step_to(c, 0.0, 20.0));
    if (phase == EVENT) IS_OK(fmi.EnterEventMode(c));
    if (phase == TERMINATED) IS_OK(step_to(c, 20.0, 0.0));
    if (phase == TERMINATED) IS_OK(fmi.Terminate(c));
    return c;
}

static fmi3Status get_real(fmi3Instance c) { double x; return fmi.GetFloat64(c, VR("x1"), 1, &x, 1); }
static fmi3Status get_integer(fmi3Instance c) { fmi3Int32 x; return fmi.GetInt32(c, VR("impact_count"), 1, &x, 1); }
static fmi3Status get_boolean(fmi3Instance c) { fmi3Boolean x; return fmi.GetBoolean(c, VR("in_contact"), 1, &x, 1); }
static fmi3Status get_array(fmi3Instance c) { double x[2]; return fmi.GetFloat64(c, &POSITIONS, 1, x, 2); }
static fmi3Status set_input(fmi3Instance c) { double x = 0.5; return fmi.SetFloat64(c, VR("box_amplitude"), 1, &x, 1); }
static fmi3Status set_fixed(fmi3Instance c) { double x = 0.5; return fmi.SetFloat64(c, VR("e"), 1, &x, 1); }
static fmi3Status set_fixed_boolean(fmi3Instance c) { fmi3Boolean x = true; return fmi.SetBoolean(c, VR("bonded"), 1, &x, 1); }
static fmi3Status set_tunable(fmi3Instance c) { fmi3Boolean x = false; return fmi.SetBoolean(c, VR("x_rel_max_on"), 1, &x, 1); }
static fmi3Status set_integer(fmi3Instance c) { fmi3Int32 x = 3; return fmi.SetInt32(c, VR("sample_count"), 1, &x, 1); }
static fmi3Status do_step(fmi3Instance c) { return step_to(c, 20.0, 1.0); }
static fmi3Status get_derivative(fmi3Instance c) { fmi3Int32 o = 1; double x; return fmi.GetOutputDerivatives(c, VR("x1"), 1, &o, &x, 1); }
static fmi3Status get_clock(fmi3Instance c) { fmi3Clock x; return fmi.GetClock(c, &CLOCK, 1, &x); }
static fmi3Status update(fmi3Instance c) { fmi3Boolean b[5]; double t; return fmi.UpdateDiscreteStates(c, b, b + 1, b + 2, b + 3, b + 4, &t); }
static fmi3Status start(fmi3Instance c) { return fmi.EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0); }
static fmi3Status start_step(fmi3Instance c) { return fmi.EnterStepMode(c); }
static fmi3Status start_event(fmi3Instance c) { return fmi.EnterEventMode(c); }
static fmi3Status leave(fmi3Instance c) { return fmi.ExitInitializationMode(c); }
static fmi3Status terminate(fmi3Instance c) { return fmi.Terminate(c); }

/* Which call is allowed when. */
static const struct { fmi3Status (*call)(fmi3Instance); bool allowed[PHASES]; } ORDER[] = {
    {start, {1, 0, 0, 0, 0, 0}}, {leave, {0, 1, 0, 0, 0, 0}}, {start_step, {0, 0, 0, 0, 1, 0}}, {start_event, {0, 0, 0, 1, 0, 0}},
    {terminate, {0, 0, 1, 1, 1, 0}}, {get_real, {0, 1, 1, 1, 1, 1}}, {get_integer, {0, 1, 1, 1, 1, 1}}, {get_boolean, {0, 1, 1, 1, 1, 1}},
    {get_array, {0, 1, 1, 1, 1, 1}}, {set_input, {1, 1, 1, 1, 1, 0}}, {set_fixed, {1, 1, 0, 0, 0, 0}}, {set_fixed_boolean, {1, 1, 0, 0, 0, 0}},
    {set_tunable, {1, 1, 1, 1, 1, 0}}, {set_integer, {1, 1, 1, 1, 1, 0}}, {do_step, {0, 0, 1, 1, 0, 0}}, {get_derivative, {0, 1, 1, 1, 1, 1}},
    {get_clock, {0, 0, 0, 0, 1, 0}}, {update, {0, 0, 0, 0, 1, 0}},
};

static void order(void) {
    for (int phase = 0; phase < PHASES; phase++) {
        fmi3Instance c = in_phase(phase);
        for (size_t i = 0; i < sizeof ORDER / sizeof *ORDER; i++) {
            if (!ORDER[i].allowed[phase]) REFUSED(c, ORDER[i].call(c));
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

/* Types no variable has, and functions modelDescription.xml does not offer. */
static void absent(fmi3Instance c) {
    fmi3ValueReference r = 0;
    size_t size = 0;
    double x = 0.0;
    fmi3UInt64 u = 0;
    fmi3IntervalQualifier q;
    fmi3Boolean b;
    fmi3Binary data = NULL;
    fmi3Clock tick = false;
#define NO_TYPE(NAME)                                                                                                    \
    { fmi3##NAME value = 0;                                                                                              \
      REFUSED(c, fmi.Get##NAME(c, &r, 1, &value, 1)); REFUSED(c, fmi.Set##NAME(c, &r, 1, &value, 1));                     \
      REFUSED(c, fmi.Get##NAME(c, NULL, 1, NULL, 1)); REFUSED(c, fmi.Set##NAME(c, NULL, 1, NULL, 1));                     \
      IS_OK(fmi.Get##NAME(c, NULL, 0, NULL, 0)); IS_OK(fmi.Set##NAME(c, NULL, 0, NULL, 0));                               \
      CHECK(fmi.Get##NAME(NULL, &r, 1, &value, 1) == fmi3Error && fmi.Set##NAME(NULL, &r, 1, &value, 1) == fmi3Error); }
    NO_TYPE(Float32) NO_TYPE(Int8) NO_TYPE(UInt8) NO_TYPE(Int16) NO_TYPE(UInt16) NO_TYPE(UInt32) NO_TYPE(Int64) NO_TYPE(UInt64) NO_TYPE(String)
    REFUSED(c, fmi.GetBinary(c, &r, 1, &size, &data, 1)); REFUSED(c, fmi.SetBinary(c, &r, 1, &size, &data, 1));
    REFUSED(c, fmi.SetClock(c, &CLOCK, 1, &tick)); REFUSED(c, fmi.SetClock(c, NULL, 1, NULL));
#define ABSENT(NAME, ...) REFUSED(c, fmi.NAME(c, __VA_ARGS__)); CHECK(fmi.NAME(NULL, __VA_ARGS__) == fmi3Error)
    ABSENT(GetNumberOfVariableDependencies, r, &size); ABSENT(GetVariableDependencies, r, NULL, NULL, NULL, NULL, 0);
    ABSENT(GetDirectionalDerivative, &r, 1, &r, 1, &x, 1, &x, 1); ABSENT(GetAdjointDerivative, &r, 1, &r, 1, &x, 1, &x, 1);
    ABSENT(GetIntervalDecimal, &CLOCK, 1, &x, &q); ABSENT(GetIntervalFraction, &CLOCK, 1, &u, &u, &q);
    ABSENT(GetShiftDecimal, &CLOCK, 1, &x); ABSENT(GetShiftFraction, &CLOCK, 1, &u, &u);
    ABSENT(SetIntervalDecimal, &CLOCK, 1, &x); ABSENT(SetIntervalFraction, &CLOCK, 1, &u, &u);
    ABSENT(SetShiftDecimal, &CLOCK, 1, &x); ABSENT(SetShiftFraction, &CLOCK, 1, &u, &u);
    ABSENT(CompletedIntegratorStep, true, &b, &b); ABSENT(SetTime, 1.0); ABSENT(SetContinuousStates, &x, 1);
    ABSENT(GetContinuousStateDerivatives, &x, 1); ABSENT(GetEventIndicators, &x, 1); ABSENT(GetContinuousStates, &x, 1);
    ABSENT(GetNominalsOfContinuousStates, &x, 1); ABSENT(GetNumberOfEventIndicators, &size); ABSENT(GetNumberOfContinuousStates, &size);
    ABSENT(ActivateModelPartition, CLOCK, 0.0);
    REFUSED(c, fmi.EnterConfigurationMode(c)); REFUSED(c, fmi.ExitConfigurationMode(c)); REFUSED(c, fmi.EnterContinuousTimeMode(c));
    REFUSED(c, fmi.EnterEventMode(c)); /* instantiated without it */
}

static void no_instance(void) {
    fmi3ValueReference r = 0;
    double x = 0.0;
    fmi3Int32 n = 1;
    fmi3Boolean b = false;
    fmi3Byte byte = 0;
    size_t size = 0;
    fmi3FMUState state = NULL;
    fmi3Binary data = NULL;
    fmi3Status all[] = {
        fmi.SetDebugLogging(NULL, true, 0, NULL), fmi.EnterInitializationMode(NULL, false, 0.0, 0.0, false, 0.0), fmi.ExitInitializationMode(NULL),
        fmi.EnterEventMode(NULL), fmi.EnterStepMode(NULL), fmi.Terminate(NULL), fmi.Reset(NULL), fmi.GetFloat64(NULL, &r, 1, &x, 1),
        fmi.SetFloat64(NULL, &r, 1, &x, 1), fmi.GetInt32(NULL, &r, 1, &n, 1), fmi.SetInt32(NULL, &r, 1, &n, 1), fmi.GetBoolean(NULL, &r, 1, &b, 1),
        fmi.SetBoolean(NULL, &r, 1, &b, 1), fmi.GetBinary(NULL, &r, 1, &size, &data, 1), fmi.SetBinary(NULL, &r, 1, &size, &data, 1),
        fmi.GetClock(NULL, &CLOCK, 1, &b), fmi.SetClock(NULL, &CLOCK, 1, &b), fmi.UpdateDiscreteStates(NULL, &b, &b, &b, &b, &b, &x),
        fmi.EvaluateDiscreteStates(NULL), fmi.GetFMUState(NULL, &state), fmi.SetFMUState(NULL, state), fmi.FreeFMUState(NULL, &state),
        fmi.SerializedFMUStateSize(NULL, state, &size), fmi.SerializeFMUState(NULL, state, &byte, 1), fmi.DeserializeFMUState(NULL, &byte, 1, &state),
        fmi.GetOutputDerivatives(NULL, &r, 1, &n, &x, 1), fmi.DoStep(NULL, 0.0, 1.0, true, &b, &b, &b, &x), fmi.EnterConfigurationMode(NULL),
        fmi.ExitConfigurationMode(NULL), fmi.EnterContinuousTimeMode(NULL),
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) CHECK(all[i] == fmi3Error);
    fmi.FreeInstance(NULL);
    CHECK(strcmp(fmi.GetVersion(), "3.0") == 0);
}

static void instantiation(void) {
    const char *wrong[] = {NULL, "", "{95159a6c}", "%s%n"};
    for (size_t i = 0; i < 4; i++) {
        messages = 0;
        CHECK(fmi.InstantiateCoSimulation("a", wrong[i], NULL, false, false, false, false, NULL, 0, NULL, take_message, NULL) == NULL && messages == 1);
        CHECK(fmi.InstantiateCoSimulation("a", wrong[i], NULL, false, false, false, false, NULL, 0, NULL, NULL, NULL) == NULL);
    }
    CHECK(fmi.InstantiateModelExchange("a", TOKEN, NULL, false, false, NULL, take_message) == NULL);
    CHECK(fmi.InstantiateScheduledExecution("a", TOKEN, NULL, false, false, NULL, take_message, NULL, NULL, NULL) == NULL);
    for (int i = 0; i < 2; i++) {
        fmi3Instance c = fmi.InstantiateCoSimulation(i ? "" : NULL, TOKEN, NULL, true, false, false, true, NULL, 0, NULL, i ? take_message : NULL, NULL);
        CHECK(c != NULL);
        messages = 0;
        CHECK(step_to(c, 0.0, 1.0) == fmi3Error && messages == i); /* errors are told with logging off too */
        fmu_initialize(c, 0.0);
        fmu_step(c, 0.0, 20.0); /* no early return without event mode */
        fmi.FreeInstance(c);
    }
}

static void null_pointers(fmi3Instance c) {
    double x[4] = {0.0}, last;
    fmi3Int32 one = 1;
    fmi3Boolean b = true, event, end, early;
    const unsigned *r = VR("x1"), *in = VR("box_acceleration"), *t = VR("x_rel_max_on"), *n = VR("sample_count");
    REFUSED(c, fmi.GetFloat64(c, NULL, 1, x, 1)); REFUSED(c, fmi.GetFloat64(c, r, 1, NULL, 1));
    REFUSED(c, fmi.SetFloat64(c, NULL, 1, x, 1)); REFUSED(c, fmi.SetFloat64(c, in, 1, NULL, 1));
    REFUSED(c, fmi.GetInt32(c, NULL, 1, &one, 1)); REFUSED(c, fmi.GetInt32(c, n, 1, NULL, 1));
    REFUSED(c, fmi.SetInt32(c, NULL, 1, &one, 1)); REFUSED(c, fmi.SetInt32(c, n, 1, NULL, 1));
    REFUSED(c, fmi.GetBoolean(c, NULL, 1, &b, 1)); REFUSED(c, fmi.GetBoolean(c, t, 1, NULL, 1));
    REFUSED(c, fmi.SetBoolean(c, NULL, 1, &b, 1)); REFUSED(c, fmi.SetBoolean(c, t, 1, NULL, 1));
    REFUSED(c, fmi.GetOutputDerivatives(c, NULL, 1, &one, x, 1)); REFUSED(c, fmi.GetOutputDerivatives(c, r, 1, NULL, x, 1));
    REFUSED(c, fmi.GetOutputDerivatives(c, r, 1, &one, NULL, 1)); REFUSED(c, fmi.GetOutputDerivatives(c, r, 1, &one, x, 2));
    REFUSED(c, fmi.GetFMUState(c, NULL)); REFUSED(c, fmi.SetFMUState(c, NULL));
    REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, NULL, &end, &early, &last)); REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, &event, NULL, &early, &last));
    REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, &event, &end, NULL, &last)); REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, &event, &end, &early, NULL));
    IS_OK(fmi.GetFloat64(c, NULL, 0, NULL, 0)); IS_OK(fmi.SetFloat64(c, NULL, 0, NULL, 0)); IS_OK(fmi.GetInt32(c, NULL, 0, NULL, 0));
    IS_OK(fmi.SetInt32(c, NULL, 0, NULL, 0)); IS_OK(fmi.GetBoolean(c, NULL, 0, NULL, 0)); IS_OK(fmi.SetBoolean(c, NULL, 0, NULL, 0));
    IS_OK(fmi.FreeFMUState(c, NULL)); IS_OK(fmi.SetDebugLogging(c, true, 0, NULL));
    IS_OK(fmi.GetOutputDerivatives(c, NULL, 0, NULL, NULL, 0));
    /* numbers of values that do not fit the references */
    size_t wrong[] = {0, 2, 3, SIZE_MAX};
    for (int i = 0; i < 4; i++) {
        REFUSED(c, fmi.GetFloat64(c, r, 1, x, wrong[i])); REFUSED(c, fmi.SetFloat64(c, in, 1, x, wrong[i]));
        REFUSED(c, fmi.GetInt32(c, n, 1, &one, wrong[i])); REFUSED(c, fmi.SetInt32(c, n, 1, &one, wrong[i]));
        REFUSED(c, fmi.GetBoolean(c, t, 1, &b, wrong[i])); REFUSED(c, fmi.SetBoolean(c, t, 1, &b, wrong[i]));
    }
    /* arrays */
    fmi3ValueReference mixed[] = {POSITIONS, *r, POSITIONS + 1};
    double five[5], single[2] = {fmu_get(c, named("x1")), fmu_get(c, named("v2"))};
    IS_OK(fmi.GetFloat64(c, mixed, 3, five, 5));
    CHECK(five[0] == single[0] && five[2] == single[0] && five[4] == single[1]);
    REFUSED(c, fmi.GetFloat64(c, mixed, 3, five, 3)); REFUSED(c, fmi.GetFloat64(c, mixed, 3, five, 4)); REFUSED(c, fmi.GetFloat64(c, mixed, 3, five, 6));
    REFUSED(c, fmi.SetFloat64(c, &POSITIONS, 1, x, 2)); REFUSED(c, fmi.SetFloat64(c, &POSITIONS, 1, x, 1));
    REFUSED(c, fmi.GetFloat64(c, &ARRAYS_END, 1, x, 2));
}

/* Every reference with every type: only those of modelDescription.xml; those of arrays' elements are another test's. */
static void references(fmi3Instance c) {
    for (unsigned i = 0; i < 2200; i++) {
        unsigned r = i < 2100 ? i : i < 2150 ? 0x7fffffc0u + i - 2100 : 0xffffffffu - (i - 2150);
        const Name *name = NULL;
        for (size_t k = 0; k < NAME_COUNT; k++) if (NAMES[k].reference == r) name = &NAMES[k];
        char type = name ? name->type : 0;
        double x = 0.0;
        fmi3Int32 n = 0;
        fmi3Boolean b = false;
        if (type != 'R' || !name->settable) REFUSED(c, fmi.SetFloat64(c, &r, 1, &x, 1));
        if (type != 'I' || !name->settable) REFUSED(c, fmi.SetInt32(c, &r, 1, &n, 1));
        if (type != 'B' || !name->settable) REFUSED(c, fmi.SetBoolean(c, &r, 1, &b, 1));
        if (type != 'I') REFUSED(c, fmi.GetInt32(c, &r, 1, &n, 1));
        if (type != 'B') REFUSED(c, fmi.GetBoolean(c, &r, 1, &b, 1));
        if (type == 'I') IS_OK(fmi.GetInt32(c, &r, 1, &n, 1));
        if (type == 'B') IS_OK(fmi.GetBoolean(c, &r, 1, &b, 1));
        if (type == 'R') IS_OK(fmi.GetFloat64(c, &r, 1, &x, 1));
        else if (r == TIME_REFERENCE) { IS_OK(fmi.GetFloat64(c, &r, 1, &x, 1)); CHECK(x == 20.0); }
        else if ((r >= TIME_REFERENCE && r < POSITIONS) || r >= ARRAYS_END) REFUSED(c, fmi.GetFloat64(c, &r, 1, &x, 1));
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
            unsigned pair[] = {*VR("box_amplitude"), name->reference};
            double both[] = {0.25, bad[k]};
            REFUSED(c, fmi.SetFloat64(c, &name->reference, 1, &bad[k], 1));
            SAYS(name->name); SAYS("allowed is"); SAYS(k < 2 ? "nan" : k == 2 ? "inf" : " = ");
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
    for (int i = 0; i < 4; i++) { REFUSED(c, fmi.SetInt32(c, VR("sample_count"), 1, &count[i], 1)); SAYS("sample_count = "); }
    fmi.FreeInstance(c);
    c = in_phase(NEW);
    double starts[] = {NAN, INFINITY, -INFINITY};
    for (int i = 0; i < 3; i++) { REFUSED(c, fmi.EnterInitializationMode(c, false, 0.0, starts[i], false, 0.0)); SAYS("startTime = "); }
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
    unsigned other[] = {1999, 2001, 0, *VR("impact_count"), 0xffffffffu};
    for (int i = 0; i < 5; i++) REFUSED(c, fmi.GetClock(c, &other[i], 1, &tick));
    REFUSED(c, fmi.GetClock(c, NULL, 1, &tick)); REFUSED(c, fmi.GetClock(c, &CLOCK, 1, NULL)); REFUSED(c, fmi.SetClock(c, &CLOCK, 1, &tick));
    IS_OK(fmi.GetClock(c, NULL, 0, NULL));
    IS_OK(fmi.GetClock(c, &CLOCK, 1, &tick));
    CHECK(tick);
    IS_OK(fmi.EvaluateDiscreteStates(c));
    IS_OK(fmi.UpdateDiscreteStates(c, NULL, NULL, NULL, NULL, NULL, NULL));
    IS_OK(fmi.GetClock(c, &CLOCK, 1, &tick));
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
    picture(twin);
    CHECK(unchanged(c));
    fmi.FreeInstance(c);
    fmi.FreeInstance(twin);
    free(image);
}
