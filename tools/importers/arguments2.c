/* FMI 2.0 alone: functions of its own, wrong tokens, no instance at all. */
#include "hostile.h"

void no_instance(void) {
    unsigned r = 0;
    double x = 0.0;
    int n = 1;
    char byte = 0;
    size_t size;
    fmi2FMUstate state = NULL;
    fmi2String text = "";
    fmi2Status status;
    fmi2Status all[] = {
        fmi.SetDebugLogging(NULL, 1, 0, NULL), fmi.SetupExperiment(NULL, 0, 0.0, 0.0, 0, 0.0), fmi.EnterInitializationMode(NULL),
        fmi.ExitInitializationMode(NULL), fmi.Terminate(NULL), fmi.Reset(NULL), fmi.GetReal(NULL, &r, 1, &x), fmi.GetInteger(NULL, &r, 1, &n),
        fmi.GetBoolean(NULL, &r, 1, &n), fmi.GetString(NULL, &r, 1, &text), fmi.SetReal(NULL, &r, 1, &x), fmi.SetInteger(NULL, &r, 1, &n),
        fmi.SetBoolean(NULL, &r, 1, &n), fmi.SetString(NULL, &r, 1, &text), fmi.GetFMUstate(NULL, &state), fmi.SetFMUstate(NULL, state),
        fmi.FreeFMUstate(NULL, &state), fmi.SerializedFMUstateSize(NULL, state, &size), fmi.SerializeFMUstate(NULL, state, &byte, 1),
        fmi.DeSerializeFMUstate(NULL, &byte, 1, &state), fmi.GetDirectionalDerivative(NULL, &r, 1, &r, 1, &x, &x),
        fmi.SetRealInputDerivatives(NULL, &r, 1, &n, &x), fmi.GetRealOutputDerivatives(NULL, &r, 1, &n, &x), fmi.DoStep(NULL, 0.0, 1.0, 1),
        fmi.CancelStep(NULL), fmi.GetStatus(NULL, fmi2DoStepStatus, &status), fmi.GetRealStatus(NULL, fmi2LastSuccessfulTime, &x),
        fmi.GetIntegerStatus(NULL, fmi2DoStepStatus, &n), fmi.GetBooleanStatus(NULL, fmi2Terminated, &n), fmi.GetStringStatus(NULL, fmi2PendingStatus, &text),
    };
    for (size_t i = 0; i < sizeof all / sizeof *all; i++) CHECK(all[i] == fmi2Error);
    fmi.FreeInstance(NULL);
    CHECK(strcmp(fmi.GetVersion(), "2.0") == 0 && strcmp(fmi.GetTypesPlatform(), "default") == 0);
}

/* Functions of model exchange, which some importers look for. */
void absent(Instance c) {
    double x = 0.0;
    fmi2Boolean b;
    fmi2EventInfo info;
#define ABSENT(NAME, ...) REFUSED(c, fmi.NAME(c, __VA_ARGS__)); SAYS("co-simulation"); CHECK(fmi.NAME(NULL, __VA_ARGS__) == fmi2Error)
    ABSENT(NewDiscreteStates, &info); ABSENT(CompletedIntegratorStep, fmi2True, &b, &b); ABSENT(SetTime, 1.0); ABSENT(SetContinuousStates, &x, 1);
    ABSENT(GetDerivatives, &x, 1); ABSENT(GetEventIndicators, &x, 1); ABSENT(GetContinuousStates, &x, 1); ABSENT(GetNominalsOfContinuousStates, &x, 1);
    REFUSED(c, fmi.EnterEventMode(c)); CHECK(fmi.EnterEventMode(NULL) == fmi2Error);
    REFUSED(c, fmi.EnterContinuousTimeMode(c)); CHECK(fmi.EnterContinuousTimeMode(NULL) == fmi2Error);
}

void instantiation(void) {
    const char *wrong[] = {NULL, "", "{95159a6c}", "%s%n"};
    for (size_t i = 0; i < 4; i++) {
        messages = 0;
        CHECK(fmi.Instantiate("a", fmi2CoSimulation, wrong[i], NULL, &callbacks, fmi2False, fmi2False) == NULL && messages == 1);
        SAYS("GUID");
        CHECK(fmi.Instantiate("a", fmi2CoSimulation, wrong[i], NULL, NULL, fmi2False, fmi2False) == NULL);
    }
    messages = 0;
    CHECK(fmi.Instantiate("a", fmi2ModelExchange, TOKEN, NULL, &callbacks, fmi2False, fmi2False) == NULL && messages == 1);
    SAYS("co-simulation only");
    fmi2CallbackFunctions bare = {0}; /* no logger, no memory functions: the FMU needs none */
    const fmi2CallbackFunctions *given[] = {NULL, &bare, &callbacks};
    for (int i = 0; i < 3; i++) {
        Instance c = fmi.Instantiate(i ? "" : NULL, fmi2CoSimulation, TOKEN, NULL, given[i], fmi2True, fmi2False);
        CHECK(c != NULL);
        messages = 0;
        CHECK(fmi.DoStep(c, 0.0, 1.0, fmi2True) == fmi2Error && messages == (i == 2)); /* errors are told with logging off too */
        fmu_initialize(c, 0.0);
        fmu_step(c, 0.0, 1.0);
        fmi.FreeInstance(c);
    }
}

void own_null_pointers(Instance c) {
    const unsigned *r = reference(OUTPUT), *in = reference(SMOOTH_INPUT);
    double x = 0.0;
    int one = 1;
    fmi2String text = "";
    REFUSED(c, fmi.GetString(c, r, 1, &text)); REFUSED(c, fmi.SetString(c, r, 1, &text));
    REFUSED(c, fmi.GetString(c, NULL, 1, NULL)); REFUSED(c, fmi.SetString(c, NULL, 1, NULL));
    REFUSED(c, fmi.SetRealInputDerivatives(c, NULL, 1, &one, &x)); REFUSED(c, fmi.SetRealInputDerivatives(c, in, 1, NULL, &x));
    REFUSED(c, fmi.SetRealInputDerivatives(c, in, 1, &one, NULL));
    REFUSED(c, fmi.GetRealStatus(c, fmi2LastSuccessfulTime, NULL)); REFUSED(c, fmi.GetBooleanStatus(c, fmi2Terminated, NULL));
    REFUSED(c, fmi.GetStatus(c, fmi2DoStepStatus, NULL)); REFUSED(c, fmi.GetIntegerStatus(c, fmi2DoStepStatus, NULL));
    REFUSED(c, fmi.GetStringStatus(c, fmi2PendingStatus, NULL)); REFUSED(c, fmi.CancelStep(c));
    REFUSED(c, fmi.GetDirectionalDerivative(c, NULL, 1, NULL, 1, NULL, NULL));
    IS_OK(fmi.GetString(c, NULL, 0, NULL)); IS_OK(fmi.SetString(c, NULL, 0, NULL));
    IS_OK(fmi.SetRealInputDerivatives(c, NULL, 0, NULL, NULL));
}
