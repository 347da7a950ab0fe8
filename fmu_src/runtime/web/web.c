/* What a web page calls besides the loops, with the prefix of a model: an instance of the FMU, as fmi.h has it, and its last message. */
#include <string.h>

#define FMI_STATUS fmi3Status
#include "core.h"
#include "fmi.h"
#include "fmi3Functions.h"

#define message OWN(message)
EXPORT char message[TEXT];

/* To save, restore and release states, as couple.c calls them. */
EXPORT const void *const OWN(state_functions)[] = {(void *)fmi3GetFMUState, (void *)fmi3SetFMUState, (void *)fmi3FreeFMUState};

static void report(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text) {
    message[0] = 0;
    strncat(message, text, TEXT - 1);
}

/* Make an instance, which stops at its events or has none; false without memory. */
EXPORT bool OWN(open_fmu)(Fmi *fmi, bool has_events) {
    void *instance = fmi3InstantiateCoSimulation("", MODEL_TOKEN, "", false, true, has_events, has_events, NULL, 0, NULL, report, NULL);
    *fmi = (Fmi){
        .instance = instance, .version = 3, .reset = (int (*)(void *))fmi3Reset,
        .enter_initialization = (Function *)fmi3EnterInitializationMode, .exit_initialization = (int (*)(void *))fmi3ExitInitializationMode,
        .step = (Function *)fmi3DoStep,
        .set_real = (Function *)fmi3SetFloat64, .set_integer = (Function *)fmi3SetInt32, .set_boolean = (Function *)fmi3SetBoolean,
        .get_real = (Function *)fmi3GetFloat64, .get_integer = (Function *)fmi3GetInt32, .get_boolean = (Function *)fmi3GetBoolean,
    };
    if (has_events) {
        fmi->enter_event_mode = (int (*)(void *))fmi3EnterEventMode;
        fmi->update = (int (*)(void *, bool *, bool *, bool *, bool *, bool *, double *))fmi3UpdateDiscreteStates;
        fmi->enter_step_mode = (int (*)(void *))fmi3EnterStepMode;
    }
    return instance != NULL;
}

EXPORT void OWN(close_fmu)(Fmi *fmi) { fmi3FreeInstance(fmi->instance); }
