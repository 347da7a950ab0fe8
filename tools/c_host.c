/* Time of a step of an FMI 3.0 FMU where no impact falls, from C, in ns.
   The least of many bursts. Masses far apart: nothing but the call, phasors and outputs. */
#include <time.h>

#include "version.h"

static double seconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
    return (double)now.tv_sec + 1e-9 * (double)now.tv_nsec;
}

int main(int count, char **arguments) {
    enum { BURSTS = 60, STEPS = 20000 };
    if (count < 3) return fprintf(stderr, "usage: c_host LIBRARY STEP NAME=VALUE ...\n"), 2;
    fmu_load(arguments[1]);
    Instance it = fmu_open("host");
    fmu_set_all(it, count - 3, arguments + 3);
    fmu_initialize(it, 0.0);
    fmi3DoStepTYPE *step = fmi.DoStep;
    double size = atof(arguments[2]), best = 1e9, last;
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
