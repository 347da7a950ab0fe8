/* Times of communication steps of an FMI 3.0 FMU, each one measured, as a histogram: nanoseconds, steps, one line each.

   A run is the same to the last bit each time, so it is repeated, and of each step the least time counts: what is left of a time
   that the system interrupted once. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef void *Instance;
typedef Instance Instantiate(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t, void *, void *, void *);
typedef int Reset(Instance);
typedef int Enter(Instance, bool, double, double, bool, double);
typedef int Set(Instance, const uint32_t *, size_t, const double *, size_t);
typedef int GetInt(Instance, const uint32_t *, size_t, int32_t *, size_t);
typedef int Step(Instance, double, double, bool, bool *, bool *, bool *, double *);
enum { LONGEST = UINT16_MAX };

static uint64_t now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

int main(int count, char **arguments) {
    void *library = count > 8 ? dlopen(arguments[1], RTLD_NOW) : NULL;
    if (!library) return fprintf(stderr, "usage: steps LIBRARY TOKEN STEPS SIZE RUNS EVALUATIONS IMPACTS CONTACTS REFERENCE VALUE ...\n"), 2;
    const long steps = atol(arguments[3]), runs = atol(arguments[5]);
    const double size = atof(arguments[4]);
    Instance it = ((Instantiate *)dlsym(library, "fmi3InstantiateCoSimulation"))(
        "steps", arguments[2], "", false, false, false, false, NULL, 0, NULL, NULL, NULL);
    Step *step = (Step *)dlsym(library, "fmi3DoStep");
    GetInt *get = (GetInt *)dlsym(library, "fmi3GetInt32");
    uint16_t *times = malloc((size_t)steps * sizeof *times);
    static uint64_t histogram[LONGEST + 1];
    int32_t counted[3] = {0}, most = 0;
    uint32_t outputs[3];
    for (int i = 0; i < 3; i++) outputs[i] = (uint32_t)atoi(arguments[6 + i]);
    if (!it || !times) return fprintf(stderr, "no instance, or no memory for the times\n"), 1;
    for (long run = 0; run < runs; run++) {
        if (((Reset *)dlsym(library, "fmi3Reset"))(it)) return 1;
        for (int i = 9; i + 1 < count; i += 2) {
            uint32_t reference = (uint32_t)atoi(arguments[i]);
            double value = atof(arguments[i + 1]);
            if (((Set *)dlsym(library, "fmi3SetFloat64"))(it, &reference, 1, &value, 1)) return 1;
        }
        if (((Enter *)dlsym(library, "fmi3EnterInitializationMode"))(it, false, 0.0, 0.0, false, 0.0)) return 1;
        if (((Reset *)dlsym(library, "fmi3ExitInitializationMode"))(it)) return 1;
        for (long n = 0; n < steps; n++) {
            bool event, end, early;
            double last;
            const uint64_t begun = now();
            if (step(it, (double)n * size, size, true, &event, &end, &early, &last)) return fprintf(stderr, "a step failed\n"), 1;
            const uint64_t taken = now() - begun;
            const uint16_t known = taken < LONGEST ? (uint16_t)taken : LONGEST;
            if (run == 0 || known < times[n]) times[n] = known;
            if (run == 0) {
                if (get(it, outputs, 3, counted, 3)) return 1;
                if (counted[0] > most) most = counted[0];
            }
        }
    }
    for (long n = 0; n < steps; n++) histogram[times[n]]++;
    printf("evaluations %ld\nimpacts %ld\ncontacts %ld\n", (long)most, (long)counted[1], (long)counted[2]);
    for (int i = 0; i <= LONGEST; i++)
        if (histogram[i]) printf("%d %llu\n", i, (unsigned long long)histogram[i]);
    return 0;
}
