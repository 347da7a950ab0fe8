/* Times of communication steps of an FMI 3.0 FMU, each one measured, as a histogram: nanoseconds, steps, one line each.

   A run is the same to the last bit each time, so it is repeated, and of each step the least time counts: what is left of a time
   that the system interrupted once. */
#include <time.h>

#include "version.h"

enum { LONGEST = UINT16_MAX };

static uint64_t now(void) {
    struct timespec time;
    clock_gettime(CLOCK_MONOTONIC, &time);
    return (uint64_t)time.tv_sec * 1000000000u + (uint64_t)time.tv_nsec;
}

int main(int count, char **arguments) {
    if (count < 5) return fprintf(stderr, "usage: steps LIBRARY STEPS SIZE RUNS NAME=VALUE ...\n"), 2;
    fmu_load(arguments[1]);
    const long steps = atol(arguments[2]), runs = atol(arguments[4]);
    const double size = atof(arguments[3]);
    Instance it = fmu_open("steps");
    fmi3DoStepTYPE *step = fmi.DoStep;
    uint16_t *times = malloc((size_t)steps * sizeof *times);
    static uint64_t histogram[LONGEST + 1];
    int32_t counted[3] = {0}, most = 0;
    const unsigned outputs[3] = {named("evaluations")->reference, named("impact_count")->reference, named("contact_count")->reference};
    if (!times) return fprintf(stderr, "no memory for the times\n"), 1;
    for (long run = 0; run < runs; run++) {
        if (fmi.Reset(it)) return 1;
        fmu_set_all(it, count - 5, arguments + 5);
        fmu_initialize(it, 0.0);
        for (long n = 0; n < steps; n++) {
            bool event, end, early;
            double last;
            const uint64_t begun = now();
            if (step(it, (double)n * size, size, true, &event, &end, &early, &last)) return fprintf(stderr, "a step failed\n"), 1;
            const uint64_t taken = now() - begun;
            const uint16_t known = taken < LONGEST ? (uint16_t)taken : LONGEST;
            if (run == 0 || known < times[n]) times[n] = known;
            if (run == 0) {
                if (get_integers(it, outputs, 3, counted)) return 1;
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
