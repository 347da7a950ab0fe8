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
#define MEMBER(NAME) fmi2##NAME##TYPE *NAME;
typedef struct { FUNCTIONS(MEMBER) } Fmi2;

extern Fmi2 fmi;
extern const fmi2CallbackFunctions callbacks;
