/* The FMI 3.0 importer, see importer.h. */
#include "importer3.h"

Fmi3 fmi;
static void *library;

void take_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text) {
    (void)environment, (void)category;
    snprintf(message, sizeof message, "%s", text);
    if (status != fmi3OK) messages++;
}

void fmu_load(const char *path) {
    library = load_library(path);
    if (!library) { fprintf(stderr, "%s cannot be loaded\n", path); exit(2); }
#define FIND(NAME) fmi.NAME = (fmi3##NAME##TYPE *)must_find(library, "fmi3" #NAME);
    FUNCTIONS(FIND)
}

void fmu_unload(void) { close_library(library); }

static void must(fmi3Status status) {
    if (status == fmi3OK) return;
    fprintf(stderr, "status %d: %s\n", status, message);
    exit(2);
}

fmi3Instance open_with(const char *name, bool event_mode, bool early_return) {
    return fmi.InstantiateCoSimulation(name, TOKEN, "/nowhere/", false, true, event_mode, early_return, NULL, 0, NULL, take_message, NULL);
}

void *fmu_open(const char *name) {
    void *made = open_with(name, false, false);
    if (!made) { fprintf(stderr, "no instance: %s\n", message); exit(2); }
    return made;
}

void fmu_set(void *instance, const char *name, double value) {
    const Name *variable = named(name);
    fmi3Int32 whole = (fmi3Int32)value;
    fmi3Boolean truth = value != 0.0;
    if (variable->type == 'R') must(fmi.SetFloat64(instance, &variable->reference, 1, &value, 1));
    else if (variable->type == 'I') must(fmi.SetInt32(instance, &variable->reference, 1, &whole, 1));
    else must(fmi.SetBoolean(instance, &variable->reference, 1, &truth, 1));
}

double fmu_get(void *instance, const Name *variable) {
    double value = 0.0;
    fmi3Int32 whole = 0;
    fmi3Boolean truth = false;
    if (variable->type == 'R') must(fmi.GetFloat64(instance, &variable->reference, 1, &value, 1));
    else if (variable->type == 'I') must(fmi.GetInt32(instance, &variable->reference, 1, &whole, 1));
    else must(fmi.GetBoolean(instance, &variable->reference, 1, &truth, 1));
    return variable->type == 'R' ? value : variable->type == 'I' ? whole : truth;
}

void fmu_initialize(void *instance, double start) {
    must(fmi.EnterInitializationMode(instance, false, 0.0, start, false, 0.0));
    must(fmi.ExitInitializationMode(instance));
}

bool fmu_try_step(void *instance, double time, double size) {
    fmi3Boolean event, end, early;
    fmi3Float64 last;
    return fmi.DoStep(instance, time, size, true, &event, &end, &early, &last) == fmi3OK;
}

void fmu_step(void *instance, double time, double size) {
    fmi3Boolean event, end, early;
    fmi3Float64 last;
    must(fmi.DoStep(instance, time, size, true, &event, &end, &early, &last));
    if (event || end || early || last != time + size) { fprintf(stderr, "a plain step ends elsewhere\n"); exit(2); }
}

size_t fmu_save(void *instance, char **bytes) {
    fmi3FMUState state = NULL;
    size_t size = 0;
    must(fmi.GetFMUState(instance, &state));
    must(fmi.SerializedFMUStateSize(instance, state, &size));
    *bytes = malloc(size);
    must(fmi.SerializeFMUState(instance, state, (fmi3Byte *)*bytes, size));
    must(fmi.FreeFMUState(instance, &state));
    return size;
}

bool fmu_restore(void *instance, const char *bytes, size_t size) {
    fmi3FMUState state = NULL;
    bool taken = fmi.DeserializeFMUState(instance, (const fmi3Byte *)bytes, size, &state) == fmi3OK && fmi.SetFMUState(instance, state) == fmi3OK;
    must(fmi.FreeFMUState(instance, &state));
    return taken;
}

void fmu_close(void *instance) {
    fmi.Terminate(instance); /* refused before initialisation, which is no matter here */
    fmi.FreeInstance(instance);
}
