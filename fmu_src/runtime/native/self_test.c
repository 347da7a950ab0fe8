/* Whether this library computes its model's bits, whatever compiler and options made it. */
#include <string.h>

#include "core.h"

/* A short run from the start values; for its second half all real inputs are moved. The bits of all variables are one number: each counts, and its place. */
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
        for (unsigned i = 0; i < VARIABLE_COUNT; i++) {
            unsigned long long bits;
            memcpy(&bits, &memory[i], sizeof bits);
            sum = ((sum << 7) | (sum >> 57)) ^ bits;
        }
    }
    return sum == SELF_TEST_SUM;
}
