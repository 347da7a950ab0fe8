/* What the importers share: names of variables, checks that count and say where they failed, and an FMI version behind a few functions. */
#ifndef IMPORTER_H
#define IMPORTER_H

#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef _WIN32
#include <windows.h>
#define load_library(path) ((void *)LoadLibraryA(path))
#define find_symbol(library, name) ((void *)GetProcAddress((HMODULE)(library), name))
#define close_library(library) FreeLibrary((HMODULE)(library))
#else
#include <dlfcn.h>
#define load_library(path) dlopen(path, RTLD_NOW | RTLD_LOCAL)
#define find_symbol(library, name) dlsym(library, name)
#define close_library(library) dlclose(library)
#endif

/* One scalar variable, as modelDescription.xml has it; type is 'R', 'I' or 'B'. */
typedef struct {
    const char *name;
    unsigned reference;
    char type;
    bool settable, fixed;
    double minimum, maximum;
} Name;

#include "names.h" /* generated from modelDescription.xml: NAMES, TOKEN, FMI_VERSION */
#define NAME_COUNT (sizeof NAMES / sizeof *NAMES)

static const Name *named(const char *name) {
    for (size_t i = 0; i < NAME_COUNT; i++)
        if (strcmp(NAMES[i].name, name) == 0) return &NAMES[i];
    fprintf(stderr, "no variable %s\n", name);
    exit(2);
}

/* A function of the FMU's binary. */
static inline void *must_find(void *library, const char *name) {
    void *found = find_symbol(library, name);
    if (found) return found;
    fprintf(stderr, "no function %s\n", name);
    exit(2);
}

/* The last message of the FMU, and how many came since somebody set the counter to 0; threads have their own. */
extern _Thread_local int messages;
extern _Thread_local char message[4096];

extern int checks, failures;

static inline void check(bool held, const char *file, int line, const char *text) {
    checks++;
    if (held) return;
    failures++;
    printf("%s:%d: %s (last message: %s)\n", file, line, text, message);
    fflush(stdout);
}
#define CHECK(condition) check(condition, __FILE__, __LINE__, #condition)

/* The checksum at the end of a serialised state made right again, for states that nothing but their contents gives away. */
static inline void seal(char *bytes, size_t size) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (size_t i = 0; i + sizeof hash < size; i++) hash = (hash ^ (unsigned char)bytes[i]) * 0x100000001b3u;
    memcpy(bytes + size - sizeof hash, &hash, sizeof hash);
}

/* An FMI version; every status but OK ends the process. */
void fmu_load(const char *path);
void fmu_unload(void);
void *fmu_open(const char *name);
void fmu_set(void *instance, const char *name, double value);
void fmu_set_all(void *instance, int count, char **arguments);         /* name=value each */
double fmu_get(void *instance, const Name *variable);
void fmu_initialize(void *instance, double start);
void fmu_step(void *instance, double time, double size);
size_t fmu_save(void *instance, char **bytes);                        /* to be freed */
void fmu_close(void *instance);

#endif
