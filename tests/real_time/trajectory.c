/* A chaotic trajectory through an FMI 3.0 FMU's sources, and its bits: the same program on a desktop, under an emulator and on bare metal.

   Compiled with the FMU's sources/ as one program. Prints impacts, a hash of all outputs over all steps, the last state, bytes of an instance and,
   on bare metal, bytes of stack. With COUNT_ALLOCATIONS it counts what is allocated, too, before and after instantiation; inputs, rates,
   refused calls and a reset are part of it then. */
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#include "core.h"
#include "fmi3Functions.h"

#if !defined(STEPS)
#define STEPS 80000
#endif
#if !defined(FREQUENCY)
#define FREQUENCY 1.13
#endif
#define SIZE 0.25 /* s: a sum of them is exact */

static unsigned reference(const char *name) {
    unsigned i = 0;
    while (i < VARIABLE_COUNT && strcmp(VARIABLES[i].name, name) != 0) i++;
    return i;
}

static void set_real(fmi3Instance c, const char *name, double value) {
    const fmi3ValueReference at = reference(name);
    if (fmi3SetFloat64(c, &at, 1, &value, 1) != fmi3OK) printf("%s: refused\n", name);
}

static double real(fmi3Instance c, const char *name) {
    const fmi3ValueReference at = reference(name);
    double value = 0.0;
    if (fmi3GetFloat64(c, &at, 1, &value, 1) != fmi3OK) printf("%s: refused\n", name);
    return value;
}

static void print_bits(const char *name, uint64_t bits) {
    printf("%s %08lx%08lx\n", name, (unsigned long)(bits >> 32), (unsigned long)(bits & 0xffffffffu));
}

#if defined(COUNT_ALLOCATIONS) /* each allocation goes through here, those of the C library too */
static union { double align; char bytes[1 << 20]; } room; /* zeros at first, and never used twice */
static size_t used;
static long allocations;

void *malloc(size_t size) {
    allocations++;
    void *place = room.bytes + used;
    used += (size + 15) / 16 * 16;
    return used <= sizeof room ? place : NULL;
}
void free(void *place) { allocations += place != NULL; }
void *calloc(size_t number_of, size_t size) { return malloc(number_of * size); }
void *realloc(void *place, size_t size) {
    void *other = malloc(size);
    if (place && other) memcpy(other, place, size);
    return other;
}

static bool make_more_calls(fmi3Instance c, long step) {
    const fmi3ValueReference input = reference("box_frequency"), gap = reference("x_rel");
    const fmi3Int32 first = 1;
    const double drive = FREQUENCY, nonsense = -1.0;
    double rate;
    if (fmi3GetOutputDerivatives(c, &gap, 1, &first, &rate, 1) != fmi3OK || fmi3SetFloat64(c, &input, 1, &drive, 1) != fmi3OK) return false;
    return step % 1000 || fmi3SetFloat64(c, &input, 1, &nonsense, 1) == fmi3Error;
}
#else
static const long allocations = 0;
static bool make_more_calls(fmi3Instance c, long step) { (void)c, (void)step; return true; }
#endif

static void say(fmi3InstanceEnvironment environment, fmi3Status status, fmi3String category, fmi3String text) {
    (void)environment, (void)status, (void)category;
    if (!allocations) puts(text);
}

#if defined(STACK_PAINTED) /* by startup.c: how much of it was written to */
unsigned long stack_used(void);
#else
static unsigned long stack_used(void) { return 0; }
#endif

int main(void) {
    static const char *const hashed[] = {"x1", "x2", "v1", "v2", "contact_force", "box_impulse", "phase", "impact_energy", "x_rel_max"};
    enum { HASHED = sizeof hashed / sizeof *hashed };
    fmi3ValueReference at[HASHED];
    for (int i = 0; i < HASHED; i++) at[i] = reference(hashed[i]);
    fmi3Instance c = fmi3InstantiateCoSimulation("trajectory", MODEL_TOKEN, "", false, false, true, true, NULL, 0, NULL, say, NULL);
    if (!c) return 1;
    const long before = allocations;
    set_real(c, "box_frequency", FREQUENCY);
    set_real(c, "box_amplitude", 1.0 / (FREQUENCY * FREQUENCY));
    if (fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0) != fmi3OK || fmi3ExitInitializationMode(c) != fmi3OK) return 1;
    if (fmi3EnterStepMode(c) != fmi3OK) return 1;
    uint64_t hash = 0xcbf29ce484222325u; /* FNV-1a, eight bytes at a time */
    double time = 0.0;
    for (long i = 1; i <= STEPS; i++)
        while (time < (double)i * SIZE) {
            bool event, end, early;
            if (fmi3DoStep(c, time, (double)i * SIZE - time, true, &event, &end, &early, &time) != fmi3OK) return 1;
            double values[HASHED];
            if (fmi3GetFloat64(c, at, HASHED, values, HASHED) != fmi3OK) return 1;
            for (int k = 0; k < HASHED; k++) {
                uint64_t bits;
                memcpy(&bits, &values[k], sizeof bits);
                hash = (hash ^ bits) * 0x100000001b3u;
            }
            if (event) {
                bool again, nominals, changed, next_defined;
                double next;
                if (fmi3EnterEventMode(c) != fmi3OK) return 1;
                if (fmi3UpdateDiscreteStates(c, &again, &end, &nominals, &changed, &next_defined, &next) != fmi3OK) return 1;
                if (fmi3EnterStepMode(c) != fmi3OK) return 1;
            }
            if (!make_more_calls(c, i)) return 1;
        }
    long later = allocations - before;
    const unsigned long stack = stack_used(); /* before any printf but those of errors */
    fmi3Int32 impacts = 0;
    const fmi3ValueReference count = reference("impact_count");
    if (fmi3GetInt32(c, &count, 1, &impacts, 1) != fmi3OK) return 1;
    printf("impacts %ld\n", (long)impacts);
    print_bits("hash", hash);
    for (int k = 0; k < 4; k++) {
        double value = real(c, hashed[k]);
        uint64_t bits;
        memcpy(&bits, &value, sizeof bits);
        print_bits(hashed[k], bits);
    }
#if defined(COUNT_ALLOCATIONS)
    later -= allocations; /* not what printing took */
    if (fmi3Reset(c) != fmi3OK) return 1;
    later += allocations;
#endif
    printf("instance %lu\nstack %lu\nallocated %ld\nlater %ld\n", (unsigned long)sizeof(Instance), stack, before, later);
    fmi3FreeInstance(c);
    return 0;
}
