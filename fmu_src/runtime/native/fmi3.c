/* FMI 3.0 for co-simulation onto core.h: arrays, event mode, and a clock that ticks at each impact. */
#include <math.h>
#include <string.h>

#include "core.h"
#include "fmi3Functions.h"

#define SETTABLE (INSTANTIATED | INITIALIZING | STEPPING | EVENT)
#define CALCULATED (INITIALIZING | STEPPING | EVENT | STOPPED | TERMINATED)
#define READABLE (INSTANTIATED | CALCULATED)  /* start values, before anything is calculated */

const char *const TYPE_NAMES[] = {"Float64", "Int32", "Boolean"};

static void report(Instance *instance, Status status, const char *text) {
    if (instance->logger) ((fmi3LogMessageCallback)(size_t)instance->logger)(instance->environment, (fmi3Status)status, CATEGORY(status), text);
}

static fmi3Status refuse3(Instance *instance, const char *call, const char *text) {
    return instance ? (fmi3Status)refuse(instance, call, text) : fmi3Error;
}

const char *fmi3GetVersion(void) { return fmi3Version; }

fmi3Status fmi3SetDebugLogging(fmi3Instance c, fmi3Boolean on, size_t count, const fmi3String categories[]) {
    (void)on;
    return c ? (fmi3Status)require_known_categories(c, "fmi3SetDebugLogging", count, categories) : fmi3Error;
}

fmi3Instance fmi3InstantiateCoSimulation(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                         fmi3Boolean event_mode, fmi3Boolean early_return, const fmi3ValueReference intermediate[],
                                         size_t intermediate_count, fmi3InstanceEnvironment environment, fmi3LogMessageCallback log,
                                         fmi3IntermediateUpdateCallback update) {
    (void)resources, (void)visible, (void)logging, (void)intermediate, (void)intermediate_count, (void)update;
    Instance *instance = instance_new("fmi3InstantiateCoSimulation", name, "instantiation token", token, report, environment, (void *)(size_t)log);
    if (!instance) return NULL;
    instance->event_mode = event_mode;
    instance->early_return = event_mode && early_return && EVENT_CLOCK;
    return instance;
}

void fmi3FreeInstance(fmi3Instance c) { instance_free(c); }

fmi3Status fmi3EnterInitializationMode(fmi3Instance c, fmi3Boolean tolerance_defined, fmi3Float64 tolerance, fmi3Float64 start, fmi3Boolean stop_defined,
                                       fmi3Float64 stop) {
    (void)tolerance_defined, (void)tolerance;
    static const char *const call = "fmi3EnterInitializationMode";
    if (!c || set_experiment(c, call, start, stop_defined ? stop : INFINITY) != OK) return fmi3Error;
    return (fmi3Status)enter_initialization(c, call);
}

static double impacts(const Instance *instance) { return EVENT_CLOCK ? instance->state.memory[EVENT_COUNT_SLOT] : 0.0; }

fmi3Status fmi3ExitInitializationMode(fmi3Instance c) {
    Instance *instance = c;
    if (!instance) return fmi3Error;
    Status status = exit_initialization(instance, "fmi3ExitInitializationMode");
    if (status == OK) instance->state.clock = impacts(instance) > 0;
    return (fmi3Status)status;
}

static fmi3Status change(Instance *instance, const char *call, int from, int to) {
    if (!instance || !require_phase(instance, call, from)) return fmi3Error;
    instance->state.phase = to;
    return fmi3OK;
}

fmi3Status fmi3EnterEventMode(fmi3Instance c) {
    Instance *instance = c;
    if (instance && !instance->event_mode) return refuse3(instance, "fmi3EnterEventMode", "expected an instance made with eventModeUsed");
    return change(instance, "fmi3EnterEventMode", STEPPING, EVENT);
}

fmi3Status fmi3EnterStepMode(fmi3Instance c) {
    Instance *instance = c;
    fmi3Status status = change(instance, "fmi3EnterStepMode", EVENT, STEPPING);
    if (status == fmi3OK) instance->state.clock = false;
    return status;
}

fmi3Status fmi3Terminate(fmi3Instance c) { return change(c, "fmi3Terminate", STEPPING | EVENT | STOPPED, TERMINATED); }

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
    if (!instance || !require_phase(instance, call, READABLE) || refuse_missing_array(instance, call, count, refs, values) || bring_up_to_date(instance) != OK) return fmi3Error;
    size_t place = 0;
    for (size_t i = 0; i < count; i++) {
        size_t first, size = stretch(instance, call, refs[i], &first);
        if (!size) return fmi3Error;
        if (size > value_count - place) return refuse3(instance, call, "nValues: too small for the arrays among the value references");
        if (size == 1) values[place] = instance->state.memory[first];
        else memcpy(values + place, instance->state.memory + first, size * sizeof(double));
        place += size;
    }
    return place == value_count ? fmi3OK : refuse3(instance, call, "nValues: more than the value references have");
}

fmi3Status fmi3SetFloat64(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const fmi3Float64 values[], size_t value_count) {
    static const char *const call = "fmi3SetFloat64";
    Instance *instance = c;
    if (!instance || !require_phase(instance, call, SETTABLE) || refuse_missing_array(instance, call, count, refs, values)) return fmi3Error;
    if (value_count != count) return refuse3(instance, call, "nValues: expected one for each value reference, arrays cannot be set");
    for (size_t i = 0; i < count; i++) {
        const Variable *variable = find_variable(instance, call, refs[i], REAL);
        if (!variable || require_settable(instance, call, variable, values[i]) != OK) return fmi3Error;
    }
    for (size_t i = 0; i < count; i++) set_value(instance, refs[i], values[i]);
    return fmi3OK;
}

#define GET_SET(NAME, TYPE, KIND, FROM_MEMORY, TO_MEMORY)                                                                                        \
    fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference refs[], size_t count, TYPE values[], size_t value_count) {                 \
        static const char *const call = "fmi3Get" #NAME;                                                                                         \
        Instance *instance = c;                                                                                                                  \
        if (!instance || !require_phase(instance, call, READABLE) || refuse_missing_array(instance, call, count, refs, values)) return fmi3Error;                   \
        if (value_count != count) return refuse3(instance, call, "nValues: expected one for each value reference");                            \
        if (bring_up_to_date(instance) != OK) return fmi3Error;                                                                                         \
        for (size_t i = 0; i < count; i++) {                                                                                                     \
            const Variable *variable = find_variable(instance, call, refs[i], KIND);                                                                      \
            if (!variable || require_readable(instance, call, variable) != OK) return fmi3Error;                                                          \
            double value = instance->state.memory[refs[i]];                                                                                      \
            values[i] = FROM_MEMORY;                                                                                                             \
        }                                                                                                                                        \
        return fmi3OK;                                                                                                                           \
    }                                                                                                                                            \
    fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const TYPE values[], size_t value_count) {           \
        static const char *const call = "fmi3Set" #NAME;                                                                                         \
        Instance *instance = c;                                                                                                                  \
        if (!instance || !require_phase(instance, call, SETTABLE) || refuse_missing_array(instance, call, count, refs, values)) return fmi3Error;                   \
        if (value_count != count) return refuse3(instance, call, "nValues: expected one for each value reference");                            \
        for (size_t i = 0; i < count; i++) {                                                                                                     \
            const Variable *variable = find_variable(instance, call, refs[i], KIND);                                                                      \
            if (!variable || require_settable(instance, call, variable, TO_MEMORY) != OK) return fmi3Error;                                               \
        }                                                                                                                                        \
        for (size_t i = 0; i < count; i++) set_value(instance, refs[i], TO_MEMORY);                                                                    \
        return fmi3OK;                                                                                                                           \
    }

GET_SET(Boolean, fmi3Boolean, BOOLEAN, value != 0, (values[i] ? 1.0 : 0.0))
GET_SET(Int32, fmi3Int32, INTEGER, (fmi3Int32)value, (double)values[i])

fmi3Status fmi3GetClock(fmi3Instance c, const fmi3ValueReference refs[], size_t count, fmi3Clock values[]) {
    static const char *const call = "fmi3GetClock";
    Instance *instance = c;
    if (!instance || !require_phase(instance, call, INITIALIZING | EVENT) || refuse_missing_array(instance, call, count, refs, values)) return fmi3Error;
    for (size_t i = 0; i < count; i++) {
        if (!EVENT_CLOCK || refs[i] != CLOCK_REFERENCE) return refuse3(instance, call, "valueReference: expected that of the clock in modelDescription.xml");
        values[i] = instance->state.clock ? fmi3ClockActive : fmi3ClockInactive;
    }
    return fmi3OK;
}

fmi3Status fmi3UpdateDiscreteStates(fmi3Instance c, fmi3Boolean *again, fmi3Boolean *terminate, fmi3Boolean *nominals, fmi3Boolean *values,
                                    fmi3Boolean *next_defined, fmi3Float64 *next) {
    Instance *instance = c;
    if (!instance || !require_phase(instance, "fmi3UpdateDiscreteStates", EVENT)) return fmi3Error;
    if (again) *again = fmi3False;
    if (terminate) *terminate = fmi3False;
    if (nominals) *nominals = fmi3False;
    if (values) *values = fmi3False;
    if (next_defined) *next_defined = fmi3False;
    if (next) *next = 0.0;
    instance->state.clock = false;
    return fmi3OK;
}

fmi3Status fmi3EvaluateDiscreteStates(fmi3Instance c) {
    return c && require_phase(c, "fmi3EvaluateDiscreteStates", INITIALIZING | EVENT) ? fmi3OK : fmi3Error;
}

fmi3Status fmi3GetFMUState(fmi3Instance c, fmi3FMUState *to) {
    return c ? (fmi3Status)save_state(c, "fmi3GetFMUState", to) : fmi3Error;
}

fmi3Status fmi3SetFMUState(fmi3Instance c, fmi3FMUState from) {
    return c ? (fmi3Status)restore_state(c, "fmi3SetFMUState", from) : fmi3Error;
}

fmi3Status fmi3FreeFMUState(fmi3Instance c, fmi3FMUState *state) {
    if (!c) return fmi3Error;
    free_state(state);
    return fmi3OK;
}

fmi3Status fmi3SerializedFMUStateSize(fmi3Instance c, fmi3FMUState state, size_t *size) {
    return c ? (fmi3Status)state_size(c, "fmi3SerializedFMUStateSize", state, size) : fmi3Error;
}

fmi3Status fmi3SerializeFMUState(fmi3Instance c, fmi3FMUState state, fmi3Byte bytes[], size_t size) {
    return c ? (fmi3Status)serialize_state(c, "fmi3SerializeFMUState", state, bytes, size) : fmi3Error;
}

fmi3Status fmi3DeserializeFMUState(fmi3Instance c, const fmi3Byte bytes[], size_t size, fmi3FMUState *to) {
    return c ? (fmi3Status)deserialize_state(c, "fmi3DeserializeFMUState", bytes, size, to) : fmi3Error;
}

/* An order for each reference; the derivatives of an array's elements follow one another. */
fmi3Status fmi3GetOutputDerivatives(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const fmi3Int32 orders[], fmi3Float64 values[],
                                    size_t value_count) {
    static const char *const call = "fmi3GetOutputDerivatives";
    Instance *instance = c;
    if (!instance || !require_phase(instance, call, CALCULATED) || refuse_missing_array(instance, call, count, refs, values) || refuse_missing_array(instance, call, count, orders, values))
        return fmi3Error;
    if (bring_up_to_date(instance) != OK) return fmi3Error;
    double memory[MEMORY_SIZE];
    for (int write = 0; write < 2; write++) {
        size_t place = 0;
        for (size_t i = 0; i < count; i++) {
            size_t first, size = stretch(instance, call, refs[i], &first);
            if (!size) return fmi3Error;
            for (size_t k = first; k < first + size; k++, place++) {
                if (k == TIME_SLOT) return refuse3(instance, call, "time: expected order 1 of a continuous output");
                if (write && !isfinite(memory[VARIABLES[k].rate])) return refuse3(instance, call, "a rate of change leaves the range of floating-point numbers");
                if (write) values[place] = memory[VARIABLES[k].rate];
                else if (!require_rate(instance, call, &VARIABLES[k], orders[i])) return fmi3Error;
            }
        }
        if (place != value_count) return refuse3(instance, call, "nValues: expected as many as the value references have");
        if (!write) copy_with_rates(instance, memory);
    }
    return fmi3OK;
}

fmi3Status fmi3DoStep(fmi3Instance c, fmi3Float64 current, fmi3Float64 size, fmi3Boolean no_set_state_prior, fmi3Boolean *event_needed,
                      fmi3Boolean *terminate, fmi3Boolean *early, fmi3Float64 *last) {
    (void)no_set_state_prior;
    Instance *instance = c;
    if (!instance || !event_needed || !terminate || !early || !last) return refuse3(instance, "fmi3DoStep", "a null pointer");
    double before = impacts(instance);
    Status status = step_to_point(instance, "fmi3DoStep", current, size);
    *event_needed = *terminate = *early = fmi3False;
    *last = instance->state.memory[TIME_SLOT];
    if (status != OK && status != WARNING) return (fmi3Status)status;
    *early = *last < current + size;
    *event_needed = instance->state.clock = instance->event_mode && impacts(instance) > before;
    return (fmi3Status)status;
}
