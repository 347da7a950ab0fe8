/* The variables that hostile calls need, by what they are for, so that all models go through the same calls. NULL: the model has none. */
#ifndef ROLES_H
#define ROLES_H

#include "importer.h"

#ifdef MOTOR_SHAKER
#define OUTPUT "box_position"
#define OUTPUT_RATE "box_velocity"
#define INTEGER_OUTPUT NULL
#define BOOLEAN_OUTPUT NULL
#define INPUT "voltage"
#define SMOOTH_INPUT "box_force"
#define FIXED "motor_constant"
#define FIXED_BOOLEAN NULL
#define TUNABLE NULL
#define COUNT NULL
#define ARRAYS NULL
#define TICKS NULL
#elif defined(ELECTRODYNAMIC_SHAKER)
#define OUTPUT "box_position"
#define OUTPUT_RATE "box_velocity"
#define INTEGER_OUTPUT NULL
#define BOOLEAN_OUTPUT "limited"
#define INPUT "command"
#define SMOOTH_INPUT "box_force"
#define FIXED "force_factor"
#define FIXED_BOOLEAN "current_control"
#define TUNABLE NULL
#define COUNT NULL
#define ARRAYS NULL
#define TICKS NULL
#else
#define OUTPUT "x1"
#define OUTPUT_RATE "v2"
#define INTEGER_OUTPUT "impact_count"
#define BOOLEAN_OUTPUT "in_contact"
#define INPUT "box_amplitude"
#define SMOOTH_INPUT "box_acceleration"
#define FIXED "e"
#define FIXED_BOOLEAN "bonded"
#define TUNABLE "x_rel_max_on"
#define COUNT "sample_count"
#define ARRAYS "positions"
#define TICKS "impact"
#endif

/* A start that cannot be: with the first value the instance does not initialize and gives no output, with the second it does. */
typedef struct { const char *fixed; double value; const char *name; double bad, good; const char *says; } BadStart;

/* A step that cannot be calculated: an input's value, and one with which the motion goes on. */
typedef struct { const char *fixed; double value; const char *input; double bad, good, size; const char *says, *also; } BadStep;

#ifdef MOTOR_SHAKER
static const BadStart BAD_START = {"box_mass", 5.5, "unbalance_mass", 1e3, 0.025, "rotor_inertia"};
static const BadStep BAD_STEPS[] = {{"motor_constant", 0.06, "voltage", 1e30, 4.0, 1.0, "voltage = 1e+30 V", "expected"}};
#elif defined(ELECTRODYNAMIC_SHAKER)
static const BadStart BAD_START = {"travel_limit", 1.0, "position_start", 2.0, 0.0, "position_start"};
static const BadStep BAD_STEPS[] = {
    {"travel_limit", 0.01, "command", 1e3, 0.0, 1.0, "travel_limit = 0.01 m", "box_position = "},
    {"coil_inductance", 0.015625, "command", 1.0, 0.0, 1e9, "cannot finish", "reached 20.0 s"},
};
#else
static const BadStart BAD_START = {"m1", 1.0, "x1_start", 1.0, -1.0, "x2_start"}; /* beyond x2_start */
static const BadStep BAD_STEPS[] = {
    {"d2", 0.0, "box_frequency", 1e9, 0.5, 1.0, "cannot finish", "time = 21.0 s"}, /* some hundred million nodes */
    {"bonded", 1.0, "box_crackle", 1e100, 0.0, 1e90, "box_acceleration = 0.0 m/s2", ""},
};
#endif
#define BAD_STEP_COUNT (sizeof BAD_STEPS / sizeof *BAD_STEPS)

/* A variable's value reference; one that no variable has where the model has no such variable. */
static inline const unsigned *reference(const char *name) {
    static const unsigned nobody = 0xfffffff0u;
    return name ? &named(name)->reference : &nobody;
}

/* Whether two serialised states are equal, but for the slots that a step writes and never reads from an earlier one (and the sum of all). */
static inline bool same_state(const char *one, const char *other, size_t size) {
    if (!SCRATCH_COUNT) return memcmp(one, other, size) == 0;
    const size_t first = 64 + 8 * (3 + SCRATCH_FIRST), end = first + 8 * SCRATCH_COUNT;
    return memcmp(one, other, first) == 0 && memcmp(one + end, other + end, size - sizeof(uint64_t) - end) == 0;
}

#endif
