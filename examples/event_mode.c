/* Every impact at its time: an FMI 3.0 importer in C, with event mode and early return.
 *
 *   mkdir fmu && cd fmu && unzip -q ../build/fmi3/TwoMassImpactOscillator.fmu && cd ..
 *   cc -I HEADERS examples/event_mode.c -ldl -lm -o event_mode && ./event_mode fmu
 *
 * HEADERS has fmi3Functions.h of the FMI standard; FMPy brings it in its folder c-code. */
#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include "fmi3Functions.h"

#define BINARY "binaries/x86_64-linux/TwoMassImpactOscillator.so"
static void *library;
static char xml[1 << 20];

/* A function of the FMU, as in FIND(DoStep)(instance, ...). */
#define FIND(NAME) ((fmi3##NAME##TYPE *)dlsym(library, "fmi3" #NAME))

static void message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text) {
    (void)environment, (void)category;
    fprintf(stderr, "status %d: %s\n", status, text);
}

static void must(fmi3Status status) {
    if (status != fmi3OK) exit(1);
}

/* The value reference of a variable, from the model description. */
static fmi3ValueReference reference(const char *name) {
    char text[80];
    snprintf(text, sizeof text, " name=\"%s\" valueReference=\"", name);
    return (fmi3ValueReference)atoi(strstr(xml, text) + strlen(text));
}

static void set(fmi3Instance instance, const char *name, double value) {
    fmi3ValueReference number = reference(name);
    must(FIND(SetFloat64)(instance, &number, 1, &value, 1));
}

static double get(fmi3Instance instance, const char *name) {
    fmi3ValueReference number = reference(name);
    double value;
    must(FIND(GetFloat64)(instance, &number, 1, &value, 1));
    return value;
}

static void end_event(fmi3Instance instance) {
    fmi3Boolean again, terminate, nominals, values, defined;
    fmi3Float64 next;
    must(FIND(UpdateDiscreteStates)(instance, &again, &terminate, &nominals, &values, &defined, &next));
    must(FIND(EnterStepMode)(instance));
}

int main(int count, char **arguments) {
    char path[4096], token[80];
    const char *folder = count > 1 ? arguments[1] : "fmu";
    snprintf(path, sizeof path, "%s/modelDescription.xml", folder);
    FILE *file = fopen(path, "r");
    if (!file || !fread(xml, 1, sizeof xml - 1, file)) return fprintf(stderr, "no %s\n", path), 1;
    sscanf(strstr(xml, "instantiationToken=\""), "instantiationToken=\"%79[^\"]", token);
    snprintf(path, sizeof path, "%s/" BINARY, folder);
    if (!(library = dlopen(path, RTLD_NOW))) return fprintf(stderr, "%s\n", dlerror()), 1;

    fmi3Instance instance =
        FIND(InstantiateCoSimulation)("oscillator", token, NULL, false, false, true, true, NULL, 0, NULL, message, NULL);
    set(instance, "box_amplitude", 1.0 / (0.8 * 0.8));
    set(instance, "box_frequency", 0.8);
    must(FIND(EnterInitializationMode)(instance, false, 0.0, 0.0, false, 0.0));
    must(FIND(ExitInitializationMode)(instance));
    end_event(instance);

    double time = 0.0, end = 20.0;
    while (time < end) {
        fmi3Boolean event, terminate, early;
        must(FIND(DoStep)(instance, time, end - time, true, &event, &terminate, &early, &time));
        if (!event) continue;
        must(FIND(EnterEventMode)(instance)); /* an impact, and time is its time */
        printf("impact at %.6f s, closing at %.6f m/s\n", time, get(instance, "impact_velocity"));
        end_event(instance);
    }
    must(FIND(Terminate)(instance));
    FIND(FreeInstance)(instance);
    return 0;
}
