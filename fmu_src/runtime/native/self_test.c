/* Whether this library computes its model's bits, whatever compiler and options made it. */
#include <string.h>

#include "core.h"

/* The bits of all variables as one number; each of them counts, and its place. */
static unsigned long long fingerprint(unsigned long long sum, const double *memory) {
    for (unsigned i = 0; i < VARIABLE_COUNT; i++) {
        unsigned long long bits;
        memcpy(&bits, &memory[i], sizeof bits);
        sum = ((sum << 7) | (sum >> 57)) ^ bits;
    }
    return sum;
}

/* A short run from the start values; for its second half all real inputs are moved. */
bool has_right_bits(double *memory) {
    unsigned long long sum = 0;
    if (kernel_initialize(memory, 0.0)) return false;
    for (int step = 1; step <= SELF_TEST_STEPS; step++) {
        for (unsigned i = 0; step == SELF_TEST_STEPS / 2 && i < VARIABLE_COUNT; i++) {
            const Variable *variable = &VARIABLES[i];
            if (variable->type == REAL && !variable->calculated && !variable->fixed) memory[i] += SELF_TEST_CHANGE;
            if (variable->set_flag) memory[variable->set_flag] = 1.0;
        }
        if (kernel_advance(memory, step * SELF_TEST_STEP)) return false;
        sum = fingerprint(sum, memory);
    }
    return sum == SELF_TEST_SUM;
}
