/* FMI 3.0 alone: functions and arrays of its own, wrong tokens, no instance at all. */
#include "hostile.h"

/* Types no variable has, and functions modelDescription.xml does not offer. */
void absent(Instance c) {
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

void no_instance(void) {
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

void instantiation(void) {
    const char *wrong[] = {NULL, "", "{95159a6c}", "%s%n"};
    for (size_t i = 0; i < 4; i++) {
        messages = 0;
        CHECK(fmi.InstantiateCoSimulation("a", wrong[i], NULL, false, false, false, false, NULL, 0, NULL, take_message, NULL) == NULL && messages == 1);
        CHECK(fmi.InstantiateCoSimulation("a", wrong[i], NULL, false, false, false, false, NULL, 0, NULL, NULL, NULL) == NULL);
    }
    messages = 0;
    CHECK(fmi.InstantiateModelExchange("a", TOKEN, NULL, false, false, NULL, take_message) == NULL && messages == 1);
    CHECK(fmi.InstantiateScheduledExecution("a", TOKEN, NULL, false, false, NULL, take_message, NULL, NULL, NULL) == NULL && messages == 2);
    CHECK(fmi.InstantiateModelExchange("a", TOKEN, NULL, false, false, NULL, NULL) == NULL);
    CHECK(fmi.InstantiateScheduledExecution("a", TOKEN, NULL, false, false, NULL, NULL, NULL, NULL, NULL) == NULL);
    for (int i = 0; i < 2; i++) {
        Instance c = fmi.InstantiateCoSimulation(i ? "" : NULL, TOKEN, NULL, true, false, false, true, NULL, 0, NULL, i ? take_message : NULL, NULL);
        CHECK(c != NULL);
        messages = 0;
        CHECK(step_to(c, 0.0, 1.0) == fmi3Error && messages == i); /* errors are told with logging off too */
        fmu_initialize(c, 0.0);
        fmu_step(c, 0.0, 20.0); /* no early return without event mode */
        fmi.FreeInstance(c);
    }
}

void own_null_pointers(Instance c) {
    double x[4] = {0.0}, last;
    fmi3Int32 one = 1;
    fmi3Boolean b = true, event, end, early;
    const unsigned *r = reference(OUTPUT), *in = reference(SMOOTH_INPUT), *t = reference(TUNABLE), *n = reference(COUNT);
    REFUSED(c, fmi.GetOutputDerivatives(c, r, 1, &one, x, 2));
    REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, NULL, &end, &early, &last)); REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, &event, NULL, &early, &last));
    REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, &event, &end, NULL, &last)); REFUSED(c, fmi.DoStep(c, 20.0, 1.0, true, &event, &end, &early, NULL));
    /* numbers of values that do not fit the references */
    size_t wrong[] = {0, 2, 3, SIZE_MAX};
    for (int i = 0; i < 4; i++) {
        REFUSED(c, fmi.GetFloat64(c, r, 1, x, wrong[i])); REFUSED(c, fmi.SetFloat64(c, in, 1, x, wrong[i]));
        REFUSED(c, fmi.GetInt32(c, n, 1, &one, wrong[i])); REFUSED(c, fmi.SetInt32(c, n, 1, &one, wrong[i]));
        REFUSED(c, fmi.GetBoolean(c, t, 1, &b, wrong[i])); REFUSED(c, fmi.SetBoolean(c, t, 1, &b, wrong[i]));
    }
    /* arrays */
    fmi3ValueReference mixed[] = {POSITIONS, *r, POSITIONS + 1};
    double five[5], single[2] = {fmu_get(c, named(OUTPUT)), fmu_get(c, named(OUTPUT_RATE))};
    if (ARRAYS) {
        IS_OK(fmi.GetFloat64(c, mixed, 3, five, 5));
        CHECK(five[0] == single[0] && five[2] == single[0] && five[4] == single[1]);
    } else REFUSED(c, fmi.GetFloat64(c, mixed, 3, five, 5));
    REFUSED(c, fmi.GetFloat64(c, mixed, 3, five, 3)); REFUSED(c, fmi.GetFloat64(c, mixed, 3, five, 4)); REFUSED(c, fmi.GetFloat64(c, mixed, 3, five, 6));
    REFUSED(c, fmi.SetFloat64(c, &POSITIONS, 1, x, 2)); REFUSED(c, fmi.SetFloat64(c, &POSITIONS, 1, x, 1));
    REFUSED(c, fmi.GetFloat64(c, &ARRAYS_END, 1, x, 2));
}

/* In event mode: the clock alone, and null pointers for what the importer does not want to know. */
void event_mode(Instance c) {
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

/* Before initialization mode: start values, and nothing that is calculated. */
void start_values(Instance c) {
    for (size_t i = 0; i < NAME_COUNT; i++) {
        const Name *name = &NAMES[i];
        double x;
        Integer n;
        Boolean b;
        picture(c);
        Status status = name->type == 'R'   ? get_reals(c, &name->reference, 1, &x)
                        : name->type == 'I' ? get_integers(c, &name->reference, 1, &n)
                                            : get_booleans(c, &name->reference, 1, &b);
        if (name->settable) IS_OK(status);
        else { refused(c, status, __FILE__, __LINE__, name->name); SAYS(name->name); }
    }
    fmi.FreeInstance(c);
}
