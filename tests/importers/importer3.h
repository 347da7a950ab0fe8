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
#define MEMBER(NAME) FMI_TYPE(NAME) *NAME;
typedef struct { FUNCTIONS(MEMBER) } Functions;

extern Functions fmi;

typedef fmi3Instance Instance;
typedef fmi3Status Status;
typedef fmi3Int32 Integer;
typedef fmi3Boolean Boolean;
typedef fmi3FMUState State;
static const Status FMI_OK = fmi3OK, FMI_WARNING = fmi3Warning, FMI_ERROR = fmi3Error, FMI_DISCARD = fmi3Discard;

void take_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text);
Instance open_with(const char *name, bool event_mode, bool early_return);

/* Of scalar variables: as many values as references. */
static inline Status get_reals(Instance c, const unsigned *r, size_t count, double *x) { return fmi.GetFloat64(c, r, count, x, count); }
static inline Status set_reals(Instance c, const unsigned *r, size_t count, const double *x) { return fmi.SetFloat64(c, r, count, x, count); }
static inline Status get_integers(Instance c, const unsigned *r, size_t count, Integer *x) { return fmi.GetInt32(c, r, count, x, count); }
static inline Status set_integers(Instance c, const unsigned *r, size_t count, const Integer *x) { return fmi.SetInt32(c, r, count, x, count); }
static inline Status get_booleans(Instance c, const unsigned *r, size_t count, Boolean *x) { return fmi.GetBoolean(c, r, count, x, count); }
static inline Status set_booleans(Instance c, const unsigned *r, size_t count, const Boolean *x) { return fmi.SetBoolean(c, r, count, x, count); }

static inline Status get_state(Instance c, State *state) { return fmi.GetFMUState(c, state); }
static inline Status set_state(Instance c, State state) { return fmi.SetFMUState(c, state); }
static inline Status free_state(Instance c, State *state) { return fmi.FreeFMUState(c, state); }
static inline Status serialized_size(Instance c, State state, size_t *size) { return fmi.SerializedFMUStateSize(c, state, size); }
static inline Status serialize(Instance c, State state, char *bytes, size_t size) { return fmi.SerializeFMUState(c, state, (fmi3Byte *)bytes, size); }
static inline Status deserialize(Instance c, const char *bytes, size_t size, State *state) {
    return fmi.DeserializeFMUState(c, (const fmi3Byte *)bytes, size, state);
}

/* Into initialization mode, with the experiment's times. */
static inline Status start_experiment(Instance c, double start, bool has_stop, double stop) {
    return fmi.EnterInitializationMode(c, false, 0.0, start, has_stop, stop);
}

static inline Status step_to(Instance c, double time, double size) {
    fmi3Boolean event, end, early;
    double last;
    return fmi.DoStep(c, time, size, true, &event, &end, &early, &last);
}
