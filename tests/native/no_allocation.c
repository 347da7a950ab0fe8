/* Counts what is allocated before and after instantiation, over ten thousand steps of chattering; built with the sources of an FMU.
   Each allocation goes through here, those of the C library too. A refused call and its message are part of it. */
#include <stdio.h>
#include <string.h>

#include "core.h"
#include "fmi3Functions.h"

static union { double align; char bytes[1 << 20]; } room;
static size_t used;
static long count;

void *malloc(size_t size) {
    count++;
    void *place = room.bytes + used;
    used += (size + 15) / 16 * 16;
    return used <= sizeof room ? place : NULL;
}
void free(void *place) { count += place != NULL; }
void *calloc(size_t number_of, size_t size) { return malloc(number_of * size); } /* all of the room is zero at first */
void *realloc(void *place, size_t size) {
    void *other = malloc(size);
    if (place && other) memcpy(other, place, size);
    return other;
}

static unsigned reference(const char *name) {
    unsigned i = 0;
    while (i < VARIABLE_COUNT && strcmp(VARIABLES[i].name, name) != 0) i++;
    return i;
}

#define STEPS 10000
#define SIZE 0.1
#define DO(CALL) do { if (CALL) return fprintf(stderr, "%s\n", #CALL), 1; } while (0)

static void say(fmi3InstanceEnvironment c, fmi3Status status, fmi3String category, fmi3String text) {
    (void)c, (void)status, (void)category, (void)text;
}

int main(void) {
    fmi3Instance c = fmi3InstantiateCoSimulation("one", MODEL_TOKEN, "", false, false, true, true, NULL, 0, NULL, say, NULL);
    const long before = count;
    const fmi3ValueReference inputs[] = {reference("box_frequency"), reference("box_amplitude")}, gap = reference("x_rel");
    const double drive[] = {0.3, 11.0}, nonsense = -1.0;
    DO(fmi3SetFloat64(c, inputs, 2, drive, 2));
    DO(fmi3EnterInitializationMode(c, false, 0.0, 0.0, false, 0.0));
    DO(fmi3ExitInitializationMode(c));
    DO(fmi3EnterStepMode(c));
    int events = 0;
    double time = 0.0;
    for (int i = 0; i < STEPS; i++) {
        double x, rate;
        const fmi3Int32 first = 1;
        bool event, end, early;
        const double target = (i + 1) * SIZE;
        do {
            DO(fmi3DoStep(c, time, target - time, true, &event, &end, &early, &time));
            if (!event) continue;
            events++;
            DO(fmi3EnterEventMode(c));
            DO(fmi3UpdateDiscreteStates(c, &event, &end, &early, &event, &event, &x));
            DO(fmi3EnterStepMode(c));
        } while (early && time < target);
        DO(fmi3GetFloat64(c, &gap, 1, &x, 1));
        DO(fmi3GetOutputDerivatives(c, &gap, 1, &first, &rate, 1));
        if (i % 100 == 0) DO(fmi3SetFloat64(c, inputs, 1, drive, 1));
        if (i % 1000 == 0) DO(fmi3SetFloat64(c, inputs, 1, &nonsense, 1) != fmi3Error);
    }
    DO(fmi3Reset(c));
    const long after = count;
    printf("%ld %ld %d\n", before, after - before, events);
    return 0;
}
