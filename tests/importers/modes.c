/* Importer in C: `importer BINARY MODE ARGUMENTS`, the same modes for each FMI version. No Python anywhere near it. */
#include "fuzz.h"

#ifndef _WIN32
#include <pthread.h>
#include <unistd.h>
#endif

/* The sixth grows as long as something goes on: impacts, the angle of the rotor, or the amplifier's work. */
#ifdef MODEL_MotorShaker
static const char *const OUTPUTS[] = {"box_position", "box_velocity", "speed", "motor_power", "motor_energy", "angle", "box_jerk", "stored_energy"};
#elif defined(MODEL_ElectrodynamicShaker)
static const char *const OUTPUTS[] = {"box_position", "box_velocity", "current", "voltage", "power", "energy", "box_jerk", "stored_energy"};
#else
static const char *const OUTPUTS[] = {"x1", "x2", "v1", "v2", "phase", "impact_count", "impact_time", "impact_energy"};
#endif
#define OUTPUT_COUNT (sizeof OUTPUTS / sizeof *OUTPUTS)

static void outputs(void *instance, double values[OUTPUT_COUNT]) {
    for (size_t i = 0; i < OUTPUT_COUNT; i++) values[i] = fmu_get(instance, named(OUTPUTS[i]));
}

/* Harmonic drive of the paper: box_amplitude = 1/eta^2. Chaotic motion for eta around 1.1. Or a motor or an amplifier, at a voltage that differs too. */
static void *driven(double eta) {
    void *instance = fmu_open("driven");
#ifdef MODEL_MotorShaker
    fmu_set(instance, "voltage", 4.0 * eta);
    return instance;
#elif defined(MODEL_ElectrodynamicShaker)
    fmu_set(instance, "command", 4.0 * eta);
    return instance;
#endif
    fmu_set(instance, "box_amplitude", 1.0 / (eta * eta));
    fmu_set(instance, "box_frequency", eta);
    return instance;
}

/* Outputs "x1,x2,..." at the times of the standard input, the first one being the start; numbers to the last bit. */
static void simulate(char *wanted, int count, char **arguments) {
    const Name *variables[256];
    int width = 0;
    for (char *name = strtok(wanted, ","); name && width < 256; name = strtok(NULL, ",")) variables[width++] = named(name);
    void *instance = fmu_open("simulate");
    fmu_set_all(instance, count, arguments);
    char line[128];
    double time = 0.0;
    for (int row = 0; fgets(line, sizeof line, stdin); row++) {
        double next = strtod(line, NULL);
        if (row == 0) fmu_initialize(instance, next);
        else fmu_step(instance, time, next - time);
        time = next;
        for (int i = 0; i < width; i++) printf("%a ", fmu_get(instance, variables[i]));
        printf("\n");
    }
    fmu_close(instance);
}

static double eta_of(int i) { return 0.3 + 0.0061 * (i % 487); }

static void alone(double eta, int steps, double size, double values[OUTPUT_COUNT]) {
    void *instance = driven(eta);
    fmu_initialize(instance, 0.0);
    for (int k = 0; k < steps; k++) fmu_step(instance, size * k, size);
    outputs(instance, values);
    fmu_close(instance);
}

#ifndef _WIN32
typedef struct { double eta; int steps; double values[OUTPUT_COUNT]; } Job;

static void *job(void *argument) {
    Job *own = argument;
    alone(own->eta, own->steps, 0.25, own->values);
    return NULL;
}

static void in_threads(int steps) {
    enum { THREADS = 4 };
    Job jobs[THREADS];
    pthread_t threads[THREADS];
    for (int i = 0; i < THREADS; i++) {
        jobs[i] = (Job){.eta = 1.1 + 0.01 * (i / 2), .steps = steps};
        CHECK(pthread_create(&threads[i], NULL, job, &jobs[i]) == 0);
    }
    for (int i = 0; i < THREADS; i++) pthread_join(threads[i], NULL);
    for (int i = 0; i < THREADS; i++) {
        double values[OUTPUT_COUNT];
        alone(jobs[i].eta, steps, 0.25, values);
        CHECK(values[5] > 0.05 * steps);
        CHECK(memcmp(values, jobs[i].values, sizeof values) == 0);
    }
}
#endif

/* Instances at once, stepped in turn, have the bits they have alone; so have instances in threads. */
static void many(int count, int steps, int thread_steps) {
    void **instances = malloc((size_t)count * sizeof *instances);
    double *times = calloc((size_t)count, sizeof *times);
    for (int i = 0; i < count; i++) {
        instances[i] = driven(eta_of(i));
        fmu_initialize(instances[i], 0.0);
    }
    for (int k = 0; k < steps; k++)
        for (int i = 0; i < count; i++) fmu_step(instances[i], 0.5 * k, 0.5);
    double impacts = 0.0;
    for (int i = 0; i < count; i++) {
        double together[OUTPUT_COUNT], single[OUTPUT_COUNT];
        outputs(instances[i], together);
        fmu_close(instances[i]);
        alone(eta_of(i), steps, 0.5, single);
        CHECK(memcmp(together, single, sizeof single) == 0);
        impacts += single[5];
    }
    CHECK(impacts > count);
    free(times);
    free(instances);
#ifndef _WIN32
    in_threads(thread_steps);
#else
    (void)thread_steps;
#endif
}

enum { SLOWEST = 60 }; /* s of a sequence: longer, and something goes on for ever */

/* Write a sequence to a file, for `replay` where it ends the process. */
static void keep_sequence(const char *path, const uint8_t *data, size_t size) {
    FILE *file = fopen(path, "w");
    for (size_t k = 0; file && k < size; k++) fprintf(file, "%02x", data[k]);
    if (file) fclose(file);
}

/* Calls drawn at random: `count` sequences of up to 256 bytes, or `longest`. */
static void random_calls(unsigned seed, int count, size_t longest, const char *path) {
    uint64_t state = seed * 0x9e3779b97f4a7c15u + 1u;
    for (int i = 0; i < count && !failures; i++) {
        uint8_t data[1024];
        for (size_t k = 0; k < longest; k++) {
            state ^= state << 13, state ^= state >> 7, state ^= state << 17; /* Marsaglia's xorshift */
            data[k] = (uint8_t)(state >> 32);
        }
        size_t size = 32 + (longest > 256 ? data[0] + 256u * data[1] : data[0]) % (longest - 32);
        if (path) keep_sequence(path, data, size);
        fuzz(data, size);
    }
}

/* The same over the declared ranges; no sequence may take long. */
static void declared_calls(unsigned seed, int count, const char *path) {
    declared = true;
    for (int i = 0; i < count && !failures; i++) {
#ifndef _WIN32
        alarm(SLOWEST);
#endif
        random_calls(seed + (unsigned)i * 2654435761u, 1, 1024, path);
    }
}

/* Inputs of the standard input, one a line in hexadecimal digits. */
static void replay(void) {
    char line[2050];
    int played = 0;
    while (scanf("%2049s", line) == 1) {
        uint8_t data[1024];
        size_t size = strlen(line) / 2;
        for (size_t i = 0; i < size; i++) data[i] = (uint8_t)strtoul((char[]){line[2 * i], line[2 * i + 1], 0}, NULL, 16);
        fuzz(data, size);
        played++;
    }
    printf("PLAYED %d\n", played);
}

int main(int count, char **arguments) {
    if (count < 3) return 2;
    const char *mode = arguments[2];
#define NUMBER(i) (count > (i) ? atoi(arguments[i]) : 0)
    fmu_load(arguments[1]);
    if (strcmp(mode, "simulate") == 0 && count > 3) simulate(arguments[3], count - 4, arguments + 4);
    else if (strcmp(mode, "random") == 0 && count > 4) random_calls((unsigned)NUMBER(3), NUMBER(4), 256, NULL);
    else if (strcmp(mode, "declared") == 0 && count > 5) declared_calls((unsigned)NUMBER(3), NUMBER(4), arguments[5]);
    else if (strcmp(mode, "many") == 0 && count > 5) many(NUMBER(3), NUMBER(4), NUMBER(5));
    else if (strcmp(mode, "replay") == 0) {
        declared = count > 3;
        replay();
    }
    else return 2;
    fmu_unload();
    printf("CHECKS %d FAILURES %d\n", checks, failures);
    return failures ? 1 : 0;
}
