/* ``leaks BINARY INSTANCES STEPS``: instances made, run and freed, and steps of one that stays; the bytes
   that the heap has grown by after the first tenth of each. */
#include <malloc.h>

#include "flight.h"

static long held(void) { return (long)mallinfo2().uordblks; }

static void live(int number) {
    uint64_t seed = (uint64_t)number;
    Flight f = draw(&seed, number % KINDS);
    void *it = open_with("leaks", number % 2, number % 2);
    bool event, end, early;
    double reached = 0.0;
    char *bytes;
    if (begin(it, &f, 1e-6)) {
        fmi.DoStep(it, 0.0, 1.0, true, &event, &end, &early, &reached);
        size_t size = fmu_save(it, &bytes);
        fmu_restore(it, bytes, size);
        free(bytes);
    }
    fmi.FreeInstance(it);
}

int main(int count, char **arguments) {
    if (count < 4) return fprintf(stderr, "usage: leaks BINARY INSTANCES STEPS\n"), 2;
    load(arguments[1]);
    long instances = atol(arguments[2]), steps = atol(arguments[3]), before = 0, grown = 0, more = 0, failed = 0;
    for (long i = 0; i < instances; i++) {
        if (i == instances / 10) before = held();
        live((int)i);
    }
    grown = held() - before;
    uint64_t seed = 1;
    Flight f = draw(&seed, EQUAL);
    void *it = open_with("leaks", false, false);
    if (!begin(it, &f, 1e-6)) return 1;
    bool event, end, early;
    double reached, size = 0x1p-5;
    for (long i = 0; i < steps; i++) {
        if (i == steps / 10) before = held();
        failed += fmi.DoStep(it, (double)i * size, size, true, &event, &end, &early, &reached) != fmi3OK;
    }
    more = held() - before;
    fmi.FreeInstance(it);
    printf("%ld %ld %ld\n", grown, more, failed);
    return 0;
}
