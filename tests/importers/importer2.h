/* FMI 2.0: the functions of the binary in one table. */
#include <stdarg.h>

#include "fmi2Functions.h"
#include "importer.h"

#define FUNCTIONS(F)                                                                                                                       \
    F(GetTypesPlatform) F(GetVersion) F(SetDebugLogging) F(Instantiate) F(FreeInstance) F(SetupExperiment) F(EnterInitializationMode)      \
    F(ExitInitializationMode) F(Terminate) F(Reset) F(GetReal) F(GetInteger) F(GetBoolean) F(GetString) F(SetReal) F(SetInteger)           \
    F(SetBoolean) F(SetString) F(GetFMUstate) F(SetFMUstate) F(FreeFMUstate) F(SerializedFMUstateSize) F(SerializeFMUstate)                \
    F(DeSerializeFMUstate) F(GetDirectionalDerivative) F(SetRealInputDerivatives) F(GetRealOutputDerivatives) F(DoStep) F(CancelStep)      \
    F(GetStatus) F(GetRealStatus) F(GetIntegerStatus) F(GetBooleanStatus) F(GetStringStatus)                                               \
    F(EnterEventMode) F(NewDiscreteStates) F(EnterContinuousTimeMode) F(CompletedIntegratorStep) F(SetTime) F(SetContinuousStates)         \
    F(GetDerivatives) F(GetEventIndicators) F(GetContinuousStates) F(GetNominalsOfContinuousStates)
#define FMI_TYPE(NAME) fmi2##NAME##TYPE
#define FMI_SYMBOL(NAME) "fmi2" #NAME
#define REALS(VERB) VERB##Real
#define INTEGERS(VERB) VERB##Integer
#define STATE(VERB) VERB##FMUstate
#define STATE_SIZE SerializedFMUstateSize
#define DESERIALIZE DeSerializeFMUstate
#define VALUES(x, count) x
#define MEMBER(NAME) FMI_TYPE(NAME) *NAME;
typedef struct { FUNCTIONS(MEMBER) } Functions;

extern Functions fmi;
extern const fmi2CallbackFunctions callbacks;

typedef fmi2Component Instance;
typedef fmi2Status Status;
typedef fmi2Integer Integer;
typedef fmi2Boolean Boolean;
typedef fmi2FMUstate State;
static const Status FMI_OK = fmi2OK;

/* Into initialization mode, with the experiment's times. */
static inline Status start_experiment(Instance c, double start, bool has_stop, double stop) {
    Status status = fmi.SetupExperiment(c, fmi2False, 0.0, start, has_stop, stop);
    return status == fmi2OK ? fmi.EnterInitializationMode(c) : status;
}

static inline Status step_to(Instance c, double time, double size) { return fmi.DoStep(c, time, size, fmi2True); }
