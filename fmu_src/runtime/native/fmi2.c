/* FMI 2.0 for co-simulation onto core.h. */
#include <math.h>

#define FMI_STATUS fmi2Status
#include "core.h"
#include "fmi2Functions.h"

#define SETTABLE (INSTANTIATED | INITIALIZING | STEPPING)
#define READABLE (INITIALIZING | STEPPING | STOPPED | TERMINATED)

const char *const TYPE_NAMES[] = {"Real", "Integer", "Boolean"};

static void report(Instance *instance, Status status, const char *text) {
    const fmi2CallbackFunctions *callbacks = instance->logger;
    if (!callbacks || !callbacks->logger) return;
    /* Some importers show the format as it is: finished text, its percent signs doubled for those that do not. */
    char format[2 * TEXT], *to = format;
    for (const char *from = text; *from; from++) {
        if (*from == '%') *to++ = '%';
        *to++ = *from;
    }
    *to = 0;
    /* errors are logged whether debug logging is on or not */
    callbacks->logger(instance->environment, instance->name, (fmi2Status)status, CATEGORY(status), format);
}

const char *fmi2GetTypesPlatform(void) { return fmi2TypesPlatform; }
const char *fmi2GetVersion(void) { return fmi2Version; }

fmi2Component fmi2Instantiate(fmi2String name, fmi2Type type, fmi2String guid, fmi2String resources, const fmi2CallbackFunctions *callbacks,
                              fmi2Boolean visible, fmi2Boolean logging) {
    static const char *const call = "fmi2Instantiate";
    Instance *instance = instance_new(call, name, "GUID", guid, report, callbacks ? callbacks->componentEnvironment : NULL, (void *)callbacks);
    if (!instance || type == fmi2CoSimulation) return instance;
    refuse(instance, call, "fmuType: expected fmi2CoSimulation, this FMU is for co-simulation only");
    instance_free(instance);
    return NULL;
}

void fmi2FreeInstance(fmi2Component c) { instance_free(c); }

PASS_ON(fmi2SetDebugLogging, (fmi2Component c, fmi2Boolean on, size_t count, const fmi2String categories[]),
        require_known_categories(c, call, count, categories))
PASS_ON(fmi2SetupExperiment,
        (fmi2Component c, fmi2Boolean tolerance_defined, fmi2Real tolerance, fmi2Real start, fmi2Boolean stop_defined, fmi2Real stop),
        set_experiment(c, call, start, stop_defined ? stop : INFINITY))
PASS_ON(fmi2EnterInitializationMode, (fmi2Component c), change_phase(c, call, INSTANTIATED, INITIALIZING))
PASS_ON(fmi2ExitInitializationMode, (fmi2Component c), exit_initialization(c, call))
PASS_ON(fmi2Terminate, (fmi2Component c), change_phase(c, call, STEPPING | STOPPED, TERMINATED))

fmi2Status fmi2Reset(fmi2Component c) {
    if (!c) return fmi2Error;
    instance_reset(c);
    return fmi2OK;
}

#define GETTER(NAME, TYPE, KIND, EXPRESSION)                                                                                                                        \
    fmi2Status NAME(fmi2Component c, const fmi2ValueReference refs[], size_t count, TYPE values[]) {                                                                \
        Instance *instance = c;                                                                                                                                     \
        if (!require_phase(instance, #NAME, READABLE) || refuse_missing_array(instance, #NAME, count, refs, values)) return fmi2Error;                              \
        if (bring_up_to_date(instance) != OK) return fmi2Error;                                                                                                     \
        for (size_t i = 0; i < count; i++) {                                                                                                                        \
            if (!find_variable(instance, #NAME, refs[i], KIND)) return fmi2Error;                                                                                   \
            double value = instance->state.memory[refs[i]];                                                                                                         \
            values[i] = EXPRESSION;                                                                                                                                 \
        }                                                                                                                                                           \
        return fmi2OK;                                                                                                                                              \
    }

GETTER(fmi2GetReal, fmi2Real, REAL, value)
GETTER(fmi2GetInteger, fmi2Integer, INTEGER, (fmi2Integer)value)
GETTER(fmi2GetBoolean, fmi2Boolean, BOOLEAN, value != 0 ? fmi2True : fmi2False)

#define SETTER(NAME, TYPE, KIND, EXPRESSION)                                                                                                                        \
    fmi2Status NAME(fmi2Component c, const fmi2ValueReference refs[], size_t count, const TYPE values[]) {                                                          \
        Instance *instance = c;                                                                                                                                     \
        if (!require_phase(instance, #NAME, SETTABLE) || refuse_missing_array(instance, #NAME, count, refs, values)) return fmi2Error;                              \
        for (size_t i = 0; i < count; i++) {  /* all or none */                                                                                                     \
            const Variable *variable = find_variable(instance, #NAME, refs[i], KIND);                                                                               \
            if (!variable || require_settable(instance, #NAME, variable, EXPRESSION) != OK) return fmi2Error;                                                       \
        }                                                                                                                                                           \
        for (size_t i = 0; i < count; i++) set_value(instance, refs[i], EXPRESSION);                                                                                \
        return fmi2OK;                                                                                                                                              \
    }

SETTER(fmi2SetReal, fmi2Real, REAL, (double)values[i])
SETTER(fmi2SetInteger, fmi2Integer, INTEGER, (double)values[i])
SETTER(fmi2SetBoolean, fmi2Boolean, BOOLEAN, (values[i] != fmi2False ? 1.0 : 0.0))

PASS_ON(fmi2GetString, (fmi2Component c, const fmi2ValueReference refs[], size_t count, fmi2String values[]), count ? refuse(c, call, "there are no String variables") : OK)
PASS_ON(fmi2SetString, (fmi2Component c, const fmi2ValueReference refs[], size_t count, const fmi2String values[]), count ? refuse(c, call, "there are no String variables") : OK)

PASS_ON(fmi2GetFMUstate, (fmi2Component c, fmi2FMUstate *to), save_state(c, call, to))
PASS_ON(fmi2SetFMUstate, (fmi2Component c, fmi2FMUstate from), restore_state(c, call, from))
PASS_ON(fmi2SerializedFMUstateSize, (fmi2Component c, fmi2FMUstate state, size_t *size), state_size(c, call, state, size))
PASS_ON(fmi2SerializeFMUstate, (fmi2Component c, fmi2FMUstate state, fmi2Byte bytes[], size_t size), serialize_state(c, call, state, bytes, size))
PASS_ON(fmi2DeSerializeFMUstate, (fmi2Component c, const fmi2Byte bytes[], size_t size, fmi2FMUstate *to), deserialize_state(c, call, bytes, size, to))

fmi2Status fmi2FreeFMUstate(fmi2Component c, fmi2FMUstate *state) {
    if (!c) return fmi2Error;
    free_state(state);
    return fmi2OK;
}

fmi2Status fmi2SetRealInputDerivatives(fmi2Component c, const fmi2ValueReference refs[], size_t count, const fmi2Integer orders[], const fmi2Real values[]) {
    static const char *const call = "fmi2SetRealInputDerivatives";
    Instance *instance = c;
    if (!require_phase(instance, call, SETTABLE) || refuse_missing_array(instance, call, count, refs, values) || refuse_missing_array(instance, call, count, orders, values))
        return fmi2Error;
    for (int write = 0; write < 2; write++)
        for (size_t i = 0; i < count; i++) {
            const Variable *input = find_variable(instance, call, refs[i], REAL);
            if (!input) return fmi2Error;
            if (!input->input_derivatives || orders[i] < 1 || orders[i] > input->input_derivatives)
                return (fmi2Status)refuse(instance, call, "expected " INPUT_DERIVATIVES);
            const Variable *derivative = input + orders[i];  /* the derivatives of an input follow it in the table */
            if (write) set_value(instance, refs[i] + (unsigned)orders[i], values[i]);
            else if (require_settable(instance, call, derivative, values[i]) != OK) return fmi2Error;
        }
    return fmi2OK;
}

fmi2Status fmi2GetRealOutputDerivatives(fmi2Component c, const fmi2ValueReference refs[], size_t count, const fmi2Integer orders[], fmi2Real values[]) {
    static const char *const call = "fmi2GetRealOutputDerivatives";
    Instance *instance = c;
    if (!require_phase(instance, call, READABLE) || refuse_missing_array(instance, call, count, refs, values) || refuse_missing_array(instance, call, count, orders, values))
        return fmi2Error;
    if (bring_up_to_date(instance) != OK) return fmi2Error;
    for (size_t i = 0; i < count; i++) {
        const Variable *output = find_variable(instance, call, refs[i], REAL);
        if (!output || !require_rate(instance, call, output, orders[i])) return fmi2Error;
    }
    double memory[MEMORY_SIZE];
    copy_with_rates(instance, memory);
    for (size_t i = 0; i < count; i++) {
        values[i] = memory[VARIABLES[refs[i]].rate];
        if (!isfinite(values[i])) return (fmi2Status)refuse(instance, call, "a rate of change leaves the range of floating-point numbers");
    }
    return fmi2OK;
}

PASS_ON(fmi2DoStep, (fmi2Component c, fmi2Real current, fmi2Real size, fmi2Boolean no_set_state_prior), step_to_point(c, call, current, size))

fmi2Status fmi2GetRealStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Real *value) {
    Instance *instance = c;
    if (!c || kind != fmi2LastSuccessfulTime || !value) return (fmi2Status)refuse(c, "fmi2GetRealStatus", "expected fmi2LastSuccessfulTime");
    *value = instance->state.memory[TIME_SLOT];
    return fmi2OK;
}

fmi2Status fmi2GetBooleanStatus(fmi2Component c, const fmi2StatusKind kind, fmi2Boolean *value) {
    if (!c || kind != fmi2Terminated || !value) return (fmi2Status)refuse(c, "fmi2GetBooleanStatus", "expected fmi2Terminated");
    *value = fmi2False;
    return fmi2OK;
}

/* Functions that have nothing to do here: some importers look for all that the header has. */
#define NOT_HERE "this is co-simulation"
#define NEVER_PENDING "steps are never pending"
PASS_ON(fmi2EnterEventMode, (fmi2Component c), refuse(c, call, NOT_HERE))
PASS_ON(fmi2NewDiscreteStates, (fmi2Component c, fmi2EventInfo *info), refuse(c, call, NOT_HERE))
PASS_ON(fmi2EnterContinuousTimeMode, (fmi2Component c), refuse(c, call, NOT_HERE))
PASS_ON(fmi2CompletedIntegratorStep, (fmi2Component c, fmi2Boolean no_set_state_prior, fmi2Boolean *enter_event_mode, fmi2Boolean *terminate),
        refuse(c, call, NOT_HERE))
PASS_ON(fmi2SetTime, (fmi2Component c, fmi2Real time), refuse(c, call, NOT_HERE))
PASS_ON(fmi2SetContinuousStates, (fmi2Component c, const fmi2Real states[], size_t count), refuse(c, call, NOT_HERE))
PASS_ON(fmi2GetDerivatives, (fmi2Component c, fmi2Real derivatives[], size_t count), refuse(c, call, NOT_HERE))
PASS_ON(fmi2GetEventIndicators, (fmi2Component c, fmi2Real indicators[], size_t count), refuse(c, call, NOT_HERE))
PASS_ON(fmi2GetContinuousStates, (fmi2Component c, fmi2Real states[], size_t count), refuse(c, call, NOT_HERE))
PASS_ON(fmi2GetNominalsOfContinuousStates, (fmi2Component c, fmi2Real nominals[], size_t count), refuse(c, call, NOT_HERE))
PASS_ON(fmi2CancelStep, (fmi2Component c), refuse(c, call, NEVER_PENDING))
PASS_ON(fmi2GetStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Status *value), refuse(c, call, NEVER_PENDING))
PASS_ON(fmi2GetStringStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2String *value), refuse(c, call, NEVER_PENDING))
PASS_ON(fmi2GetIntegerStatus, (fmi2Component c, const fmi2StatusKind kind, fmi2Integer *value), refuse(c, call, "there is no such status"))
PASS_ON(fmi2GetDirectionalDerivative,
        (fmi2Component c, const fmi2ValueReference unknowns[], size_t unknown_count, const fmi2ValueReference knowns[], size_t known_count,
         const fmi2Real seed[], fmi2Real sensitivity[]), refuse(c, call, "not provided, as modelDescription.xml says"))
