/* Importer in C: `importer BINARY MODE ARGUMENTS`, the same modes for each FMI version. No Python anywhere near it. */
#include "fuzz.h"

#include <math.h>
#include <time.h>
#ifndef _WIN32
#include <pthread.h>
#endif

/* The sixth grows as long as something goes on: impacts, the angle of the rotor, or the amplifier's work. */
#ifdef MOTOR_SHAKER
static const char *const OUTPUTS[] = {"box_position", "box_velocity", "speed", "motor_power", "motor_energy", "angle", "box_jerk", "stored_energy"};
#elif defined(ELECTRODYNAMIC_SHAKER)
static const char *const OUTPUTS[] = {"box_position", "box_velocity", "current", "voltage", "power", "energy", "box_jerk", "stored_energy"};
#else
static const char *const OUTPUTS[] = {"x1", "x2", "v1", "v2", "phase", "impact_count", "impact_time", "impact_energy"};
#endif
#define OUTPUT_COUNT (sizeof OUTPUTS / sizeof *OUTPUTS)

static double seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }  /* of the processor: other processes do not count */

static void outputs(void *instance, double values[OUTPUT_COUNT]) {
    for (size_t i = 0; i < OUTPUT_COUNT; i++) values[i] = fmu_get(instance, named(OUTPUTS[i]));
}

/* Harmonic drive of the paper: box_amplitude = 1/eta^2. Chaotic motion for eta around 1.1. Or a motor or an amplifier, at a voltage that differs too. */
static void *driven(double eta) {
    void *instance = fmu_open("driven");
#ifdef MOTOR_SHAKER
    fmu_set(instance, "voltage", 4.0 * eta);
    return instance;
#elif defined(ELECTRODYNAMIC_SHAKER)
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

/* The files mapped into this process once the FMU has run. */
static void maps(void) {
    void *instance = fmu_open("maps");
    fmu_initialize(instance, 0.0);
    fmu_step(instance, 0.0, 10.0);
    char line[1024];
    FILE *file = fopen("/proc/self/maps", "r");
    while (file && fgets(line, sizeof line, file)) {
        char *path = strchr(line, '/');
        if (path) fputs(path, stdout);
    }
    if (file) fclose(file);
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

/* Resident memory, kB; 0 where the system does not tell. */
static long resident(void) {
    long pages = 0;
    FILE *file = fopen("/proc/self/statm", "r");
    if (file && fscanf(file, "%*d %ld", &pages) != 1) pages = 0;
    if (file) fclose(file);
    return pages * 4;
}

/* Small steps reach what one step reaches, to the last bit, and take no memory, if that is to be looked at: valgrind grows by itself.
 * Dyadic times are exact. */
static void million(int count, bool look) {
    double small[OUTPUT_COUNT], one[OUTPUT_COUNT];
    double size = 0x1p-10;
    void *instance = driven(1.13);
    fmu_initialize(instance, 0.0);
    for (int k = 0; k < 1000; k++) fmu_step(instance, size * k, size);
    long before = resident();
    for (int k = 1000; k < count; k++) fmu_step(instance, size * k, size);
    CHECK(!look || resident() - before < 256); /* kB */
    outputs(instance, small);
    fmu_close(instance);
#ifdef MOTOR_SHAKER /* integrated from one communication point to the next: the same steps again */
    alone(1.13, count, size, one);
#else
    alone(1.13, 1, size * count, one);
#endif
    CHECK(memcmp(small, one, sizeof one) == 0);
    printf("IMPACTS %.0f\n", one[5]);
}

static void timed(const char *label, int count, double size, int values, char **arguments) {
    double best = 1e300;
    for (int round = 0; round < 5; round++) {
        void *instance = fmu_open("timed");
        fmu_set_all(instance, values, arguments);
        fmu_initialize(instance, 0.0);
        double begin = seconds();
        for (int k = 0; k < count; k++) fmu_step(instance, size * k, size);
        double each = (seconds() - begin) / count;
        if (each < best) best = each;
        CHECK(fmu_get(instance, named(OUTPUTS[5])) == 0.0);
        fmu_close(instance);
    }
    printf("SPEED %s %.1f ns\n", label, 1e9 * best);
}

/* Time of a step where no impact falls. */
static void speed(int count) {
    static char bonded[] = "bonded=1", apart[] = "x2_start=100", unwatched[] = "x_rel_max_on=0", sampled[] = "sample_count=32", undriven[] = "box_amplitude=0";
    double flight = 0x1p-20;  /* a flight from 100 m apart ends after 1.5 s */
    timed("bonded", count, 0x1p-7, 1, (char *[]){bonded});
    timed("flight", count, flight, 1, (char *[]){apart});
    timed("flight, x_rel_max off", count, flight, 2, (char *[]){apart, unwatched});
    timed("flight, x_rel_max off, 32 samples", count / 10, flight, 3, (char *[]){apart, unwatched, sampled});
    timed("flight, x_rel_max off, undriven", count, flight, 3, (char *[]){apart, unwatched, undriven});
}

/* A state saved in motion, with one of its numbers overwritten: refused, or else what comes of it. */
static void corrupt(size_t offset, double value, bool sealed) {
    void *instance = driven(1.13);
    fmu_initialize(instance, 0.0);
    fmu_step(instance, 0.0, 20.0);
    char *bytes;
    size_t size = fmu_save(instance, &bytes);
    if (offset + sizeof value > size) exit(2);
    memcpy(bytes + offset, &value, sizeof value);
    if (sealed) seal(bytes, size);
    messages = 0;
    if (!fmu_restore(instance, bytes, size)) {
        CHECK(messages == 1);
        printf("REFUSED %s\n", message);
    } else {
        bool stepped = fmu_try_step(instance, 20.0, 1.0);
        printf("TAKEN step %s, %s = %g\n", stepped ? "OK" : message, OUTPUTS[0], fmu_get(instance, named(OUTPUTS[0])));
    }
    free(bytes);
    fmu_close(instance);
}

/* Each number of a saved state replaced in turn and the checksum made right: whatever comes of it, the process lives. */
static void forge(void) {
    static const double values[] = {NAN, -INFINITY, -1.0, 77.0};
    void *instance = driven(1.13);
    fmu_initialize(instance, 0.0);
    fmu_step(instance, 0.0, 20.0);
    char *bytes;
    size_t size = fmu_save(instance, &bytes), taken = 0;
    for (size_t offset = 64; offset + 16 <= size; offset += 8)
        for (size_t i = 0; i < sizeof values / sizeof *values; i++) {
            double right;
            memcpy(&right, bytes + offset, sizeof right);
            memcpy(bytes + offset, &values[i], sizeof right);
            seal(bytes, size);
            if (fmu_restore(instance, bytes, size)) {
                fmu_try_step(instance, 20.0, 1.0);
                taken++;
            }
            memcpy(bytes + offset, &right, sizeof right);
        }
    seal(bytes, size);
    CHECK(fmu_restore(instance, bytes, size));
    double after[OUTPUT_COUNT], expected[OUTPUT_COUNT];
    fmu_step(instance, 20.0, 20.0);
    outputs(instance, after);
    fmu_close(instance);
    alone(1.13, 2, 20.0, expected);
    CHECK(memcmp(after, expected, sizeof after) == 0); /* nothing stays behind in the instance */
    free(bytes);
    printf("TAKEN %zu\n", taken);
}

/* Calls drawn at random: `count` sequences of up to 256 bytes. */
static void random_calls(unsigned seed, int count) {
    uint64_t state = seed * 0x9e3779b97f4a7c15u + 1u;
    for (int i = 0; i < count; i++) {
        uint8_t data[256];
        for (size_t k = 0; k < sizeof data; k++) {
            state ^= state << 13, state ^= state >> 7, state ^= state << 17; /* Marsaglia's xorshift */
            data[k] = (uint8_t)(state >> 32);
        }
        fuzz(data, 32 + data[0] % 224u);
    }
}

/* Inputs of the standard input, one a line in hexadecimal digits. */
static void replay(void) {
    char line[2048];
    int played = 0;
    while (scanf("%2047s", line) == 1) {
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
    else if (strcmp(mode, "maps") == 0) maps();
    else if (strcmp(mode, "hostile") == 0) hostile();
    else if (strcmp(mode, "random") == 0 && count > 4) random_calls((unsigned)NUMBER(3), NUMBER(4));
    else if (strcmp(mode, "many") == 0 && count > 5) many(NUMBER(3), NUMBER(4), NUMBER(5));
    else if (strcmp(mode, "million") == 0 && count > 3) million(NUMBER(3), count < 5);
    else if (strcmp(mode, "speed") == 0 && count > 3) speed(NUMBER(3));
    else if (strcmp(mode, "replay") == 0) replay();
    else if (strcmp(mode, "forge") == 0) forge();
    else if (strcmp(mode, "corrupt") == 0 && count > 4) corrupt((size_t)NUMBER(3), strtod(arguments[4], NULL), count > 5);
    else return 2;
    fmu_unload();
    printf("CHECKS %d FAILURES %d\n", checks, failures);
    return failures ? 1 : 0;
}
