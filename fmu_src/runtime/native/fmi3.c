/* FMI 3.0 for co-simulation onto core.h: arrays, event mode, and a clock that ticks at each impact; at the end the functions that have nothing to do. */
#include <math.h>
#include <string.h>

#define FMI_STATUS fmi3Status
#include "core.h"
#include "fmi3Functions.h"

#define SETTABLE (INSTANTIATED | INITIALIZING | STEPPING | EVENT)
#define CALCULATED (INITIALIZING | STEPPING | EVENT | STOPPED | TERMINATED)
#define READABLE (INSTANTIATED | CALCULATED)  /* start values, before anything is calculated */

const char *const TYPE_NAMES[] = {"Float64", "Int32", "Boolean"};

static void report(Instance *instance, Status status, const char *text) {
    if (instance->logger) ((fmi3LogMessageCallback)(size_t)instance->logger)(instance->environment, (fmi3Status)status, CATEGORY(status), text);
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                         size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    Instance *instance = instance_new("fmi3InstantiateCoSimulation", name, "instantiation token", token, report, environment, (void *)(size_t)log);
    if (!instance) return NULL;
    instance->event_mode = event_mode;
    instance->early_return = event_mode && early_return && EVENT_CLOCK;
    return instance;
}

void fmi3FreeInstance(fmi3Instance c) { instance_free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined,
                                       fmi3Float64 stop) {
    static const char *const call = "fmi3EnterInitializationMode";
    if (!c || set_experiment(c, call, start, stop_defined ? stop : INFINITY) != OK) return fmi3Error;
    return (fmi3Status)change_phase(c, call, INSTANTIATED, INITIALIZING);
}

static double impacts(const Instance *instance) { return EVENT_CLOCK ? instance->state.memory[EVENT_COUNT_SLOT] : 0.0; }

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    Instance *instance = c;
    if (!instance) return fmi3Error;
    Status status = exit_initialization(instance, "fmi3ExitInitializationMode");
    if (status == OK) instance->state.clock = impacts(instance) > 0;
    return (fmi3Status)status;
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    static const char *const call = "fmi3EnterEventMode";
    Instance *instance = c;
    if (!instance || !instance->event_mode) return (fmi3Status)refuse(instance, call, "expected an instance made with eventModeUsed");
    return (fmi3Status)change_phase(instance, call, STEPPING, EVENT);
}

fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    Instance *instance = c;
    if (change_phase(instance, "fmi3EnterStepMode", EVENT, STEPPING) != OK) return fmi3Error;
    instance->state.clock = false;
    return fmi3OK;
}

fmi3Status fmi3Reset(fmi3Instance c) {
    if (!c) return fmi3Error;
    instance_reset(c);
    return fmi3OK;
}

/* Scalars, arrays and time are stretches of the memory: first slot and length of a Float64 reference, length 0 after a refusal. */
static size_t stretch(Instance *instance, const char *call, fmi3ValueReference reference, size_t *first) {
    *first = reference;
    if (reference == TIME_SLOT) return require_phase(instance, call, CALCULATED);
    if (reference >= ARRAY_BASE && reference < ARRAY_BASE + ARRAY_COUNT) {
        *first = ARRAYS[reference - ARRAY_BASE].first;
        return require_readable(instance, call, &VARIABLES[*first]) == OK ? ARRAYS[reference - ARRAY_BASE].size : 0;
    }
    const Variable *variable = find_variable(instance, call, reference, REAL);
    if (!variable || require_readable(instance, call, variable) != OK) return 0;
    if (!variable->element) return 1;
    refuse(instance, call, "valueReference: expected that of the array, not of an element");
    return 0;
}

fmi3Status fmi3GetFloat64(fmi3Instance c, const fmi3ValueReference refs[], size_t count, fmi3Float64 values[], size_t value_count) {
    static const char *const call = "fmi3GetFloat64";
    Instance *instance = c;
    if (!require_phase(instance, call, READABLE) || refuse_missing_array(instance, call, count, refs, values) || bring_up_to_date(instance) != OK) return fmi3Error;
    size_t place = 0;
    for (size_t i = 0; i < count; i++) {
        size_t first, size = stretch(instance, call, refs[i], &first);
        if (!size) return fmi3Error;
        if (size > value_count - place) return (fmi3Status)refuse(instance, call, "nValues: too small for the arrays among the value references");
        if (size == 1) values[place] = instance->state.memory[first];
        else memcpy(values + place, instance->state.memory + first, size * sizeof(double));
        place += size;
    }
    return place == value_count ? fmi3OK : (fmi3Status)refuse(instance, call, "nValues: more than the value references have");
}

#define GETTER(NAME, TYPE, KIND, EXPRESSION)                                                                                                                         \
    fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference refs[], size_t count, TYPE values[], size_t value_count) {                                     \
        static const char *const call = "fmi3Get" #NAME;                                                                                                             \
        Instance *instance = c;                                                                                                                                      \
        if (!require_phase(instance, call, READABLE) || refuse_missing_array(instance, call, count, refs, values)) return fmi3Error;                                 \
        if (value_count != count) return (fmi3Status)refuse(instance, call, "nValues: expected one for each value reference");                                       \
        if (bring_up_to_date(instance) != OK) return fmi3Error;                                                                                                      \
        for (size_t i = 0; i < count; i++) {                                                                                                                         \
            const Variable *variable = find_variable(instance, call, refs[i], KIND);                                                                                 \
            if (!variable || require_readable(instance, call, variable) != OK) return fmi3Error;                                                                     \
            double value = instance->state.memory[refs[i]];                                                                                                          \
            values[i] = EXPRESSION;                                                                                                                                  \
        }                                                                                                                                                            \
        return fmi3OK;                                                                                                                                               \
    }

GETTER(Boolean, fmi3Boolean, BOOLEAN, value != 0)
GETTER(Int32, fmi3Int32, INTEGER, (fmi3Int32)value)

#define SETTER(NAME, TYPE, KIND, HINT, EXPRESSION)                                                                                                                   \
    fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const TYPE values[], size_t value_count) {                               \
        static const char *const call = "fmi3Set" #NAME;                                                                                                             \
        Instance *instance = c;                                                                                                                                      \
        if (!require_phase(instance, call, SETTABLE) || refuse_missing_array(instance, call, count, refs, values)) return fmi3Error;                                 \
        if (value_count != count) return (fmi3Status)refuse(instance, call, "nValues: expected one for each value reference" HINT);                                  \
        for (size_t i = 0; i < count; i++) {  /* all or none */                                                                                                      \
            const Variable *variable = find_variable(instance, call, refs[i], KIND);                                                                                 \
            if (!variable || require_settable(instance, call, variable, EXPRESSION) != OK) return fmi3Error;                                                         \
        }                                                                                                                                                            \
        for (size_t i = 0; i < count; i++) set_value(instance, refs[i], EXPRESSION);                                                                                 \
        return fmi3OK;                                                                                                                                               \
    }

SETTER(Float64, fmi3Float64, REAL, ", arrays cannot be set", values[i])
SETTER(Boolean, fmi3Boolean, BOOLEAN, "", (values[i] ? 1.0 : 0.0))
SETTER(Int32, fmi3Int32, INTEGER, "", (double)values[i])

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference refs[], size_t count, fmi3Clock values[]) {
    static const char *const call = "fmi3GetClock";
    Instance *instance = c;
    if (!require_phase(instance, call, INITIALIZING | EVENT) || refuse_missing_array(instance, call, count, refs, values)) return fmi3Error;
    for (size_t i = 0; i < count; i++) {
        if (!EVENT_CLOCK || refs[i] != CLOCK_REFERENCE) return (fmi3Status)refuse(instance, call, "valueReference: expected that of the clock in modelDescription.xml");
        values[i] = instance->state.clock ? fmi3ClockActive : fmi3ClockInactive;
    }
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals, fmi3Boolean *values,
                                    fmi3Boolean *next_defined, fmi3Float64 *next) {
    Instance *instance = c;
    if (!require_phase(instance, "fmi3UpdateDiscreteStates", EVENT)) return fmi3Error;
    if (again) *again = fmi3False;
    if (terminate) *terminate = fmi3False;
    if (nominals) *nominals = fmi3False;
    if (values) *values = fmi3False;
    if (next_defined) *next_defined = fmi3False;
    if (next) *next = 0.0;
    instance->state.clock = false;
    return fmi3OK;
}

PASS_ON(fmi3SetDebugLogging, (fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]),
        require_known_categories(c, call, count, categories))
PASS_ON(fmi3Terminate, (fmi3Instance c), change_phase(c, call, STEPPING | EVENT | STOPPED, TERMINATED))
PASS_ON(fmi3EvaluateDiscreteStates, (fmi3Instance c), require_phase(c, call, INITIALIZING | EVENT) ? OK : FAILED)
PASS_ON(fmi3GetFMUState, (fmi3Instance c, fmi3FMUState *to), save_state(c, call, to))
PASS_ON(fmi3SetFMUState, (fmi3Instance c, fmi3FMUState from), restore_state(c, call, from))
PASS_ON(fmi3SerializedFMUStateSize, (fmi3Instance c, fmi3FMUState state, size_t *size), state_size(c, call, state, size))
PASS_ON(fmi3SerializeFMUState, (fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size), serialize_state(c, call, state, bytes, size))
PASS_ON(fmi3DeserializeFMUState, (fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *to), deserialize_state(c, call, bytes, size, to))

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    if (!c) return fmi3Error;
    free_state(state);
    return fmi3OK;
}

/* An order for each reference; the derivatives of an array's elements follow one another. */
fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const fmi3Int32 orders[], fmi3Float64 values[],
                                    size_t value_count) {
    static const char *const call = "fmi3GetOutputDerivatives";
    Instance *instance = c;
    if (!require_phase(instance, call, CALCULATED) || refuse_missing_array(instance, call, count, refs, values) || refuse_missing_array(instance, call, count, orders, values))
        return fmi3Error;
    if (bring_up_to_date(instance) != OK) return fmi3Error;
    double memory[MEMORY_SIZE];
    for (int write = 0; write < 2; write++) {
        size_t place = 0;
        for (size_t i = 0; i < count; i++) {
            size_t first, size = stretch(instance, call, refs[i], &first);
            if (!size) return fmi3Error;
            for (size_t k = first; k < first + size; k++, place++) {
                if (k == TIME_SLOT) return (fmi3Status)refuse(instance, call, "time: expected order 1 of a continuous output");
                if (write && !isfinite(memory[VARIABLES[k].rate])) return (fmi3Status)refuse(instance, call, "a rate of change leaves the range of floating-point numbers");
                if (write) values[place] = memory[VARIABLES[k].rate];
                else if (!require_rate(instance, call, &VARIABLES[k], orders[i])) return fmi3Error;
            }
        }
        if (place != value_count) return (fmi3Status)refuse(instance, call, "nValues: expected as many as the value references have");
        if (!write) copy_with_rates(instance, memory);
    }
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 current, fmi3Float64 size, fmi3Boolean no_set_state_prior, fmi3Boolean *event_needed,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    Instance *instance = c;
    if (!instance || !event_needed || !terminate || !early || !last) return (fmi3Status)refuse(instance, "fmi3DoStep", "a null pointer");
    double before = impacts(instance);
    Status status = step_to_point(instance, "fmi3DoStep", current, size);
    *event_needed = *terminate = *early = fmi3False;
    *last = instance->state.memory[TIME_SLOT];
    if (status != OK && status != WARNING) return (fmi3Status)status;
    *early = *last < current + size;
    *event_needed = instance->state.clock = instance->event_mode && impacts(instance) > before;
    return (fmi3Status)status;
}

/* -- functions that have nothing to do: other kinds of FMU, types no variable has, what modelDescription.xml does not offer -- */

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    if (log) log(environment, fmi3Error, "logStatusError", "fmi3InstantiateModelExchange: this FMU is for co-simulation only");
    return NULL;
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
                                               fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    if (log) log(environment, fmi3Error, "logStatusError", "fmi3InstantiateScheduledExecution: this FMU is for co-simulation only");
    return NULL;
}

#define NO_VARIABLES (count ? refuse(c, call, "there are no variables of this type") : OK)
#define NONE(NAME, TYPE)                                                                                                                                             \
    PASS_ON(fmi3Get##NAME, (fmi3Instance c, const fmi3ValueReference refs[], size_t count, TYPE values[], size_t value_count), NO_VARIABLES)                         \
    PASS_ON(fmi3Set##NAME, (fmi3Instance c, const fmi3ValueReference refs[], size_t count, const TYPE values[], size_t value_count), NO_VARIABLES)
NONE(Float32, fmi3Float32)
NONE(Int8, fmi3Int8)
NONE(UInt8, fmi3UInt8)
NONE(Int16, fmi3Int16)
NONE(UInt16, fmi3UInt16)
NONE(UInt32, fmi3UInt32)
NONE(Int64, fmi3Int64)
NONE(UInt64, fmi3UInt64)
NONE(String, fmi3String)
PASS_ON(fmi3GetBinary, (fmi3Instance c, const fmi3ValueReference refs[], size_t count, size_t sizes[], fmi3Binary values[], size_t value_count), NO_VARIABLES)
PASS_ON(fmi3SetBinary,
        (fmi3Instance c, const fmi3ValueReference refs[], size_t count, const size_t sizes[], const fmi3Binary values[], size_t value_count), NO_VARIABLES)
PASS_ON(fmi3SetClock, (fmi3Instance c, const fmi3ValueReference refs[], size_t count, const fmi3Clock values[]),
        count ? refuse(c, call, "there are no input clocks") : OK)

#define NO_PARAMETERS "there are no structural parameters"
PASS_ON(fmi3EnterConfigurationMode, (fmi3Instance c), refuse(c, call, NO_PARAMETERS))
PASS_ON(fmi3ExitConfigurationMode, (fmi3Instance c), refuse(c, call, NO_PARAMETERS))
PASS_ON(fmi3EnterContinuousTimeMode, (fmi3Instance c), refuse(c, call, "this is co-simulation"))

#define ABSENT(NAME, ...) PASS_ON(fmi3##NAME, (fmi3Instance c, __VA_ARGS__), refuse(c, call, "not provided, as modelDescription.xml says"))
ABSENT(GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *count)
ABSENT(GetVariableDependencies, fmi3ValueReference dependent, size_t elements[], fmi3ValueReference independents[], size_t others[],
       fmi3DependencyKind kinds[], size_t count)
ABSENT(GetDirectionalDerivative, const fmi3ValueReference unknowns[], size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count,
       const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)
ABSENT(GetAdjointDerivative, const fmi3ValueReference unknowns[], size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count,
       const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)
ABSENT(GetIntervalDecimal, const fmi3ValueReference refs[], size_t count, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
ABSENT(GetIntervalFraction, const fmi3ValueReference refs[], size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
       fmi3IntervalQualifier qualifiers[])
ABSENT(GetShiftDecimal, const fmi3ValueReference refs[], size_t count, fmi3Float64 shifts[])
ABSENT(GetShiftFraction, const fmi3ValueReference refs[], size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
ABSENT(SetIntervalDecimal, const fmi3ValueReference refs[], size_t count, const fmi3Float64 intervals[])
ABSENT(SetIntervalFraction, const fmi3ValueReference refs[], size_t count, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT(SetShiftDecimal, const fmi3ValueReference refs[], size_t count, const fmi3Float64 shifts[])
ABSENT(SetShiftFraction, const fmi3ValueReference refs[], size_t count, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT(CompletedIntegratorStep, fmi3Boolean no_set_state_prior, fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
ABSENT(SetTime, fmi3Float64 time)
ABSENT(SetContinuousStates, const fmi3Float64 states[], size_t count)
ABSENT(GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t count)
ABSENT(GetEventIndicators, fmi3Float64 indicators[], size_t count)
ABSENT(GetContinuousStates, fmi3Float64 states[], size_t count)
ABSENT(GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t count)
ABSENT(GetNumberOfEventIndicators, size_t *count)
ABSENT(GetNumberOfContinuousStates, size_t *count)
ABSENT(ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)
