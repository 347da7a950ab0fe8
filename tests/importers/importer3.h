/* FMI 3.0: the functions of the binary in one table. */
#include "fmi3Functions.h"
#include "importer.h"

#define FUNCTIONS(F)                                                                                                                       \
    F(GetVersion) F(SetDebugLogging) F(InstantiateModelExchange) F(InstantiateCoSimulation) F(InstantiateScheduledExecution)               \
    F(FreeInstance) F(EnterInitializationMode) F(ExitInitializationMode) F(EnterEventMode) F(Terminate) F(Reset)                           \
    F(GetFloat32) F(GetFloat64) F(GetInt8) F(GetUInt8) F(GetInt16) F(GetUInt16) F(GetInt32) F(GetUInt32) F(GetInt64) F(GetUInt64)          \
    F(GetBoolean) F(GetString) F(GetBinary) F(GetClock)                                                                                    \
    F(SetFloat32) F(SetFloat64) F(SetInt8) F(SetUInt8) F(SetInt16) F(SetUInt16) F(SetInt32) F(SetUInt32) F(SetInt64) F(SetUInt64)          \
    F(SetBoolean) F(SetString) F(SetBinary) F(SetClock)                                                                                    \
    F(GetNumberOfVariableDependencies) F(GetVariableDependencies) F(GetFMUState) F(SetFMUState) F(FreeFMUState)                            \
    F(SerializedFMUStateSize) F(SerializeFMUState) F(DeserializeFMUState) F(GetDirectionalDerivative) F(GetAdjointDerivative)              \
    F(EnterConfigurationMode) F(ExitConfigurationMode) F(GetIntervalDecimal) F(GetIntervalFraction) F(GetShiftDecimal)                     \
    F(GetShiftFraction) F(SetIntervalDecimal) F(SetIntervalFraction) F(SetShiftDecimal) F(SetShiftFraction) F(EvaluateDiscreteStates)      \
    F(UpdateDiscreteStates) F(EnterContinuousTimeMode) F(CompletedIntegratorStep) F(SetTime) F(SetContinuousStates)                        \
    F(GetContinuousStateDerivatives) F(GetEventIndicators) F(GetContinuousStates) F(GetNominalsOfContinuousStates)                         \
    F(GetNumberOfEventIndicators) F(GetNumberOfContinuousStates) F(EnterStepMode) F(GetOutputDerivatives) F(DoStep)                        \
    F(ActivateModelPartition)
#define FMI_TYPE(NAME) fmi3##NAME##TYPE
#define FMI_SYMBOL(NAME) "fmi3" #NAME
#define REALS(VERB) VERB##Float64
#define INTEGERS(VERB) VERB##Int32
#define STATE(VERB) VERB##FMUState
#define STATE_SIZE SerializedFMUStateSize
#define DESERIALIZE DeserializeFMUState
#define VALUES(x, count) x, count
#define MEMBER(NAME) FMI_TYPE(NAME) *NAME;
typedef struct { FUNCTIONS(MEMBER) } Functions;

extern Functions fmi;

typedef fmi3Instance Instance;
typedef fmi3Status Status;
typedef fmi3Int32 Integer;
typedef fmi3Boolean Boolean;
typedef fmi3FMUState State;
static const Status FMI_OK = fmi3OK;

void take_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text);
Instance open_with(const char *name, bool event_mode, bool early_return);

/* Into initialization mode, with the experiment's times. */
static inline Status start_experiment(Instance c, double start, bool has_stop, double stop) {
    return fmi.EnterInitializationMode(c, false, 0.0, start, has_stop, stop);
}

static inline Status step_to(Instance c, double time, double size) {
    fmi3Boolean event, end, early;
    double last;
    return fmi.DoStep(c, time, size, true, &event, &end, &early, &last);
}
