/* The functions of FMI 3.0 that have nothing to do here: other kinds of FMU, types no variable has, what modelDescription.xml does not offer. */
#include "core.h"
#include "fmi3Functions.h"

static fmi3Status absent(fmi3Instance c, const char *call, const char *text) {
    return c ? (fmi3Status)refuse(c, call, text) : fmi3Error;
}

static fmi3Instance other_kind(fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, const char *text) {
    if (log) log(environment, fmi3Error, "logStatusError", text);
    return NULL;
}

fmi3Instance fmi3InstantiateModelExchange(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                          fmi3InstanceEnvironment environment, fmi3LogMessageCallback log) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging;
    return other_kind(environment, log, "fmi3InstantiateModelExchange: this FMU is for co-simulation only");
}

fmi3Instance fmi3InstantiateScheduledExecution(fmi3String name, fmi3String token, fmi3String resources, fmi3Boolean visible, fmi3Boolean logging,
                                               fmi3InstanceEnvironment environment, fmi3LogMessageCallback log, fmi3ClockUpdateCallback update,
                                               fmi3LockPreemptionCallback lock, fmi3UnlockPreemptionCallback unlock) {
    (void)name, (void)token, (void)resources, (void)visible, (void)logging, (void)update, (void)lock, (void)unlock;
    return other_kind(environment, log, "fmi3InstantiateScheduledExecution: this FMU is for co-simulation only");
}

/* Types no variable has. */
#define NONE(NAME, TYPE)                                                                                                                        \
    fmi3Status fmi3Get##NAME(fmi3Instance c, const fmi3ValueReference refs[], size_t count, TYPE values[], size_t value_count) {                 \
        (void)refs, (void)values, (void)value_count;                                                                                             \
        return c && count == 0 ? fmi3OK : absent(c, "fmi3Get" #NAME, "there are no variables of this type");                                    \
    }                                                                                                                                            \
    fmi3Status fmi3Set##NAME(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const TYPE values[], size_t value_count) {           \
        (void)refs, (void)values, (void)value_count;                                                                                             \
        return c && count == 0 ? fmi3OK : absent(c, "fmi3Set" #NAME, "there are no variables of this type");                                    \
    }

NONE(Float32, fmi3Float32)
NONE(Int8, fmi3Int8)
NONE(UInt8, fmi3UInt8)
NONE(Int16, fmi3Int16)
NONE(UInt16, fmi3UInt16)
NONE(UInt32, fmi3UInt32)
NONE(Int64, fmi3Int64)
NONE(UInt64, fmi3UInt64)
NONE(String, fmi3String)

fmi3Status fmi3GetBinary(fmi3Instance c, const fmi3ValueReference refs[], size_t count, size_t sizes[], fmi3Binary values[], size_t value_count) {
    (void)refs, (void)sizes, (void)values, (void)value_count;
    return c && count == 0 ? fmi3OK : absent(c, "fmi3GetBinary", "there are no variables of this type");
}

fmi3Status fmi3SetBinary(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const size_t sizes[], const fmi3Binary values[], size_t value_count) {
    (void)refs, (void)sizes, (void)values, (void)value_count;
    return c && count == 0 ? fmi3OK : absent(c, "fmi3SetBinary", "there are no variables of this type");
}

fmi3Status fmi3SetClock(fmi3Instance c, const fmi3ValueReference refs[], size_t count, const fmi3Clock values[]) {
    (void)refs, (void)values;
    return c && count == 0 ? fmi3OK : absent(c, "fmi3SetClock", "there are no input clocks");
}

/* What modelDescription.xml says is not provided. */
#define ABSENT(NAME, ...)                                                                    \
    fmi3Status NAME(fmi3Instance c, __VA_ARGS__) { return absent(c, #NAME, "not provided, as modelDescription.xml says"); }

#if defined(__GNUC__)
#pragma GCC diagnostic ignored "-Wunused-parameter"
#elif defined(_MSC_VER)
#pragma warning(disable : 4100)
#endif
ABSENT(fmi3GetNumberOfVariableDependencies, fmi3ValueReference reference, size_t *count)
ABSENT(fmi3GetVariableDependencies, fmi3ValueReference dependent, size_t elements[], fmi3ValueReference independents[], size_t others[],
       fmi3DependencyKind kinds[], size_t count)
ABSENT(fmi3GetDirectionalDerivative, const fmi3ValueReference unknowns[], size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count,
       const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)
ABSENT(fmi3GetAdjointDerivative, const fmi3ValueReference unknowns[], size_t unknown_count, const fmi3ValueReference knowns[], size_t known_count,
       const fmi3Float64 seed[], size_t seed_count, fmi3Float64 sensitivity[], size_t sensitivity_count)
ABSENT(fmi3GetIntervalDecimal, const fmi3ValueReference refs[], size_t count, fmi3Float64 intervals[], fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetIntervalFraction, const fmi3ValueReference refs[], size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[],
       fmi3IntervalQualifier qualifiers[])
ABSENT(fmi3GetShiftDecimal, const fmi3ValueReference refs[], size_t count, fmi3Float64 shifts[])
ABSENT(fmi3GetShiftFraction, const fmi3ValueReference refs[], size_t count, fmi3UInt64 counters[], fmi3UInt64 resolutions[])
ABSENT(fmi3SetIntervalDecimal, const fmi3ValueReference refs[], size_t count, const fmi3Float64 intervals[])
ABSENT(fmi3SetIntervalFraction, const fmi3ValueReference refs[], size_t count, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT(fmi3SetShiftDecimal, const fmi3ValueReference refs[], size_t count, const fmi3Float64 shifts[])
ABSENT(fmi3SetShiftFraction, const fmi3ValueReference refs[], size_t count, const fmi3UInt64 counters[], const fmi3UInt64 resolutions[])
ABSENT(fmi3CompletedIntegratorStep, fmi3Boolean no_set_state_prior, fmi3Boolean *enter_event_mode, fmi3Boolean *terminate)
ABSENT(fmi3SetTime, fmi3Float64 time)
ABSENT(fmi3SetContinuousStates, const fmi3Float64 states[], size_t count)
ABSENT(fmi3GetContinuousStateDerivatives, fmi3Float64 derivatives[], size_t count)
ABSENT(fmi3GetEventIndicators, fmi3Float64 indicators[], size_t count)
ABSENT(fmi3GetContinuousStates, fmi3Float64 states[], size_t count)
ABSENT(fmi3GetNominalsOfContinuousStates, fmi3Float64 nominals[], size_t count)
ABSENT(fmi3GetNumberOfEventIndicators, size_t *count)
ABSENT(fmi3GetNumberOfContinuousStates, size_t *count)
ABSENT(fmi3ActivateModelPartition, fmi3ValueReference clock, fmi3Float64 time)

fmi3Status fmi3EnterConfigurationMode(fmi3Instance c) { return absent(c, "fmi3EnterConfigurationMode", "there are no structural parameters"); }
fmi3Status fmi3ExitConfigurationMode(fmi3Instance c) { return absent(c, "fmi3ExitConfigurationMode", "there are no structural parameters"); }
fmi3Status fmi3EnterContinuousTimeMode(fmi3Instance c) { return absent(c, "fmi3EnterContinuousTimeMode", "this is co-simulation"); }
