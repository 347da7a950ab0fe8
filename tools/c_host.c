/* Time of a step of a FMI 3.0 FMU where no impact falls, from C, in ns.
   The least of many bursts. Masses far apart: nothing but the call, phasors and outputs. */
#include <dlfcn.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <time.h>

typedef void *Instance;
typedef Instance Instantiate(const char *, const char *, const char *, bool, bool, bool, bool, const uint32_t *, size_t, void *, void *, void *);
typedef int Enter(Instance, bool, double, double, bool, double);
typedef int Exit(Instance);
typedef int Set(Instance, const uint32_t *, size_t, const double *, size_t);
typedef int Switch(Instance, const uint32_t *, size_t, const bool *, size_t);
typedef int Step(Instance, double, double, bool, bool *, bool *, bool *, double *);

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int count, char **arguments) {
    enum { BURSTS = 60, STEPS = 20000 };
    void *library = count > 5 ? dlopen(arguments[1], RTLD_NOW) : NULL;
    if (!library) return fprintf(stderr, "usage: c_host LIBRARY TOKEN SWITCH ON STEP REFERENCE VALUE ...\n"), 2;
    Instance it = ((Instantiate *)dlsym(library, "fmi3InstantiateCoSimulation"))(
        "host", arguments[2], "", false, false, false, false, NULL, 0, NULL, NULL, NULL);
    Set *set = (Set *)dlsym(library, "fmi3SetFloat64");
    uint32_t place = (uint32_t)atoi(arguments[3]);
    bool on = atoi(arguments[4]) != 0;
    if (((Switch *)dlsym(library, "fmi3SetBoolean"))(it, &place, 1, &on, 1)) return 1;
    for (int i = 6; i + 1 < count; i += 2) {
        uint32_t reference = (uint32_t)atoi(arguments[i]);
        double value = atof(arguments[i + 1]);
        if (set(it, &reference, 1, &value, 1)) return 1;
    }
    if (((Enter *)dlsym(library, "fmi3EnterInitializationMode"))(it, false, 0.0, 0.0, false, 0.0)) return 1;
    if (((Exit *)dlsym(library, "fmi3ExitInitializationMode"))(it)) return 1;
    Step *step = (Step *)dlsym(library, "fmi3DoStep");
    double size = atof(arguments[5]), best = 1e9, last;
    long n = 0;
    bool event, end, early;
    for (int burst = 0; burst < BURSTS; burst++) {
        double begun = seconds();
        for (int i = 0; i < STEPS; i++, n++)
            if (step(it, (double)n * size, size, true, &event, &end, &early, &last)) return 1;
        double taken = seconds() - begun;
        if (taken < best) best = taken;
    }
    printf("%.1f\n", 1e9 * best / STEPS);
    return 0;
}
