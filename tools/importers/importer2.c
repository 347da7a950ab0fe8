/* The FMI 2.0 importer, see importer.h. */
#include "importer2.h"

Fmi2 fmi;
static void *library;

static void take_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category, fmi2String format, ...) {
    (void)environment, (void)instance, (void)category;
    va_list rest;
    va_start(rest, format);
    vsnprintf(message, sizeof message, format, rest);
    va_end(rest);
    if (status != fmi2OK) messages++;
}

const fmi2CallbackFunctions callbacks = {.logger = take_message, .allocateMemory = calloc, .freeMemory = free};

void fmu_load(const char *path) {
    library = load_library(path);
    if (!library) { fprintf(stderr, "%s cannot be loaded\n", path); exit(2); }
#define FIND(NAME) fmi.NAME = (fmi2##NAME##TYPE *)must_find(library, "fmi2" #NAME);
    FUNCTIONS(FIND)
}

void fmu_unload(void) { close_library(library); }

static void must(fmi2Status status) {
    if (status == fmi2OK) return;
    fprintf(stderr, "status %d: %s\n", status, message);
    exit(2);
}

void *fmu_open(const char *name) {
    void *made = fmi.Instantiate(name, fmi2CoSimulation, TOKEN, "file:///nowhere", &callbacks, fmi2False, fmi2True);
    if (!made) { fprintf(stderr, "no instance: %s\n", message); exit(2); }
    return made;
}

void fmu_set(void *instance, const char *name, double value) {
    const Name *variable = named(name);
    fmi2Integer whole = (fmi2Integer)value;
    if (variable->type == 'R') must(fmi.SetReal(instance, &variable->reference, 1, &value));
    else if (variable->type == 'I') must(fmi.SetInteger(instance, &variable->reference, 1, &whole));
    else must(fmi.SetBoolean(instance, &variable->reference, 1, &whole));
}

double fmu_get(void *instance, const Name *variable) {
    double value = 0.0;
    fmi2Integer whole = 0;
    if (variable->type == 'R') must(fmi.GetReal(instance, &variable->reference, 1, &value));
    else if (variable->type == 'I') must(fmi.GetInteger(instance, &variable->reference, 1, &whole));
    else must(fmi.GetBoolean(instance, &variable->reference, 1, &whole));
    return variable->type == 'R' ? value : whole;
}

void fmu_initialize(void *instance, double start) {
    must(fmi.SetupExperiment(instance, fmi2False, 0.0, start, fmi2False, 0.0));
    must(fmi.EnterInitializationMode(instance));
    must(fmi.ExitInitializationMode(instance));
}

bool fmu_try_step(void *instance, double time, double size) { return fmi.DoStep(instance, time, size, fmi2True) == fmi2OK; }

void fmu_step(void *instance, double time, double size) { must(fmi.DoStep(instance, time, size, fmi2True)); }

size_t fmu_save(void *instance, char **bytes) {
    fmi2FMUstate state = NULL;
    size_t size = 0;
    must(fmi.GetFMUstate(instance, &state));
    must(fmi.SerializedFMUstateSize(instance, state, &size));
    *bytes = malloc(size);
    must(fmi.SerializeFMUstate(instance, state, *bytes, size));
    must(fmi.FreeFMUstate(instance, &state));
    return size;
}

bool fmu_restore(void *instance, const char *bytes, size_t size) {
    fmi2FMUstate state = NULL;
    bool taken = fmi.DeSerializeFMUstate(instance, bytes, size, &state) == fmi2OK && fmi.SetFMUstate(instance, state) == fmi2OK;
    must(fmi.FreeFMUstate(instance, &state));
    return taken;
}

void fmu_close(void *instance) {
    fmi.Terminate(instance);  /* refused before initialisation, which is no matter here */
    fmi.FreeInstance(instance);
}
