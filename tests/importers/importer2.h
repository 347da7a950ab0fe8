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
#define MEMBER(NAME) FMI_TYPE(NAME) *NAME;
typedef struct { FUNCTIONS(MEMBER) } Functions;

extern Functions fmi;
extern const fmi2CallbackFunctions callbacks;

typedef fmi2Component Instance;
typedef fmi2Status Status;
typedef fmi2Integer Integer;
typedef fmi2Boolean Boolean;
typedef fmi2FMUstate State;
static const Status FMI_OK = fmi2OK, FMI_WARNING = fmi2Warning, FMI_ERROR = fmi2Error, FMI_DISCARD = fmi2Discard;

static inline Status get_reals(Instance c, const unsigned *r, size_t count, double *x) { return fmi.GetReal(c, r, count, x); }
static inline Status set_reals(Instance c, const unsigned *r, size_t count, const double *x) { return fmi.SetReal(c, r, count, x); }
static inline Status get_integers(Instance c, const unsigned *r, size_t count, Integer *x) { return fmi.GetInteger(c, r, count, x); }
static inline Status set_integers(Instance c, const unsigned *r, size_t count, const Integer *x) { return fmi.SetInteger(c, r, count, x); }
static inline Status get_booleans(Instance c, const unsigned *r, size_t count, Boolean *x) { return fmi.GetBoolean(c, r, count, x); }
static inline Status set_booleans(Instance c, const unsigned *r, size_t count, const Boolean *x) { return fmi.SetBoolean(c, r, count, x); }

static inline Status get_state(Instance c, State *state) { return fmi.GetFMUstate(c, state); }
static inline Status set_state(Instance c, State state) { return fmi.SetFMUstate(c, state); }
static inline Status free_state(Instance c, State *state) { return fmi.FreeFMUstate(c, state); }
static inline Status serialized_size(Instance c, State state, size_t *size) { return fmi.SerializedFMUstateSize(c, state, size); }
static inline Status serialize(Instance c, State state, char *bytes, size_t size) { return fmi.SerializeFMUstate(c, state, bytes, size); }
static inline Status deserialize(Instance c, const char *bytes, size_t size, State *state) { return fmi.DeSerializeFMUstate(c, bytes, size, state); }

/* Into initialization mode, with the experiment's times. */
static inline Status start_experiment(Instance c, double start, bool has_stop, double stop) {
    Status status = fmi.SetupExperiment(c, fmi2False, 0.0, start, has_stop, stop);
    return status == fmi2OK ? fmi.EnterInitializationMode(c) : status;
}

static inline Status step_to(Instance c, double time, double size) { return fmi.DoStep(c, time, size, fmi2True); }
