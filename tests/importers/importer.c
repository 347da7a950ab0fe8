/* The importer of either FMI version, see importer.h. */
#include "version.h"

int checks, failures;
_Thread_local int messages;
_Thread_local char message[4096];
Functions fmi;
static void *library;

#if FMI_VERSION == 2
static void take_message(fmi2ComponentEnvironment environment, fmi2String instance, fmi2Status status, fmi2String category, fmi2String format, ...) {
    (void)environment, (void)instance, (void)category;
    va_list rest;
    va_start(rest, format);
    vsnprintf(message, sizeof message, format, rest);
    va_end(rest);
    if (status != fmi2OK) messages++;
}

const fmi2CallbackFunctions callbacks = {.logger = take_message, .allocateMemory = calloc, .freeMemory = free};

static Instance instantiate(const char *name) {
    return fmi.Instantiate(name, fmi2CoSimulation, TOKEN, "file:///nowhere", &callbacks, fmi2False, fmi2True);
}
#else
void take_message(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text) {
    (void)environment, (void)category;
    snprintf(message, sizeof message, "%s", text);
    if (status != fmi3OK) messages++;
}

Instance open_with(const char *name, bool event_mode, bool early_return) {
    return fmi.InstantiateCoSimulation(name, TOKEN, "/nowhere/", false, true, event_mode, early_return, NULL, 0, NULL, take_message, NULL);
}

static Instance instantiate(const char *name) { return open_with(name, false, false); }
#endif

void fmu_load(const char *path) {
    library = load_library(path);
    if (!library) { fprintf(stderr, "%s cannot be loaded\n", path); exit(2); }
#define FIND(NAME) fmi.NAME = (FMI_TYPE(NAME) *)must_find(library, FMI_SYMBOL(NAME));
    FUNCTIONS(FIND)
}

void fmu_unload(void) { close_library(library); }

static void must(Status status) {
    if (status == FMI_OK) return;
    fprintf(stderr, "status %d: %s\n", status, message);
    exit(2);
}

void *fmu_open(const char *name) {
    void *made = instantiate(name);
    if (!made) { fprintf(stderr, "no instance: %s\n", message); exit(2); }
    return made;
}

void fmu_set(void *instance, const char *name, double value) {
    const Name *variable = named(name);
    Integer whole = (Integer)value;
    Boolean truth = value != 0.0;
    if (variable->type == 'R') must(set_reals(instance, &variable->reference, 1, &value));
    else if (variable->type == 'I') must(set_integers(instance, &variable->reference, 1, &whole));
    else must(set_booleans(instance, &variable->reference, 1, &truth));
}

void fmu_set_all(void *instance, int count, char **arguments) {
    for (int i = 0; i < count; i++) {
        char *equals = strchr(arguments[i], '=');
        if (!equals) continue;
        *equals = 0;
        fmu_set(instance, arguments[i], strtod(equals + 1, NULL));
        *equals = '=';
    }
}

double fmu_get(void *instance, const Name *variable) {
    double value = 0.0;
    Integer whole = 0;
    Boolean truth = false;
    if (variable->type == 'R') must(get_reals(instance, &variable->reference, 1, &value));
    else if (variable->type == 'I') must(get_integers(instance, &variable->reference, 1, &whole));
    else must(get_booleans(instance, &variable->reference, 1, &truth));
    return variable->type == 'R' ? value : variable->type == 'I' ? whole : truth;
}

void fmu_initialize(void *instance, double start) {
    must(start_experiment(instance, start, false, 0.0));
    must(fmi.ExitInitializationMode(instance));
}


void fmu_step(void *instance, double time, double size) {
#if FMI_VERSION == 2
    must(step_to(instance, time, size));
#else
    fmi3Boolean event, end, early;
    double last;
    must(fmi.DoStep(instance, time, size, true, &event, &end, &early, &last));
    if (event || end || early || last != time + size) { fprintf(stderr, "a plain step ends elsewhere\n"); exit(2); }
#endif
}

size_t fmu_save(void *instance, char **bytes) {
    State state = NULL;
    size_t size = 0;
    must(get_state(instance, &state));
    must(serialized_size(instance, state, &size));
    *bytes = malloc(size);
    must(serialize(instance, state, *bytes, size));
    must(free_state(instance, &state));
    return size;
}

void fmu_close(void *instance) {
    fmi.Terminate(instance); /* refused before initialisation, which is no matter here */
    fmi.FreeInstance(instance);
}
