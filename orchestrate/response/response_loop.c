/* Responses one after the other, compiled: initialise, transient, samples, how often they repeat, peaks.
 *
 * respond.py and begin.py of Python say what is done and why; here are the same calls of the FMU in the same order, so the bits are the same. The
 * rule of repetition is fmu_src/kernels/repetition.py, translated. Structures are those of response_loop.py. No library is needed, nothing is allocated.
 */
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#include "repetition.h"
#include "token.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#define TOUCHING 0x1p-50  /* begin.py: a gap that is no more than the rounding of displacements */
#define END_BITS 44  /* respond.py: binary digits of the state that the next response starts from */

EXPORT const char token[] = TOKEN;  /* of these sources: tells their library from others */

enum { DONE, FAILED };
enum { NOT_FINITE = -1 };  /* a status that FMI does not have */
enum { X1, X2, V1, V2, STATES };
enum { PEAKS = 4 };  /* largest |x1|, |x2|, |a1|, |a2| */

typedef struct {
    void *instance;
    int (*reset)(void *);
    int (*enter_initialization)(void *, bool, double, double, bool, double);
    int (*exit_initialization)(void *);
    int (*step)(void *, double time, double h, bool, bool *event, bool *terminate, bool *early, double *last);
    int (*set)(void *, const unsigned *references, size_t count, const double *values, size_t value_count);
    int (*set_boolean)(void *, const unsigned *references, size_t count, const bool *values, size_t value_count);
    int (*set_integer)(void *, const unsigned *references, size_t count, const int32_t *values, size_t value_count);
    int (*get)(void *, const unsigned *references, size_t count, double *values, size_t value_count);
    int (*get_boolean)(void *, const unsigned *references, size_t count, bool *values, size_t value_count);
    int (*get_integer)(void *, const unsigned *references, size_t count, int32_t *values, size_t value_count);
    const unsigned *reals, *booleans, *series, *peaks;  /* what is set before the start; the samples kept in a step; PEAKS */
    size_t real_count, boolean_count, start_position, capacity;  /* of the start among the reals; samples of a step */
    unsigned sample_count, x_rel_max, x_rel_max_on, peaks_on, impact_count, contact_count, in_contact;
    const char *failed;  /* the function that did not answer OK */
    int status;
} Calls;

typedef struct {  /* what there is to do: a row a response */
    size_t count, samples, peak_periods;  /* the periods looked at for peaks, at most */
    double tolerance, loose;  /* loose, unless 0: a wider tolerance; repetitions within both are found */
    bool decides, is_chain, has_gap;  /* the multiplicity is decided; each starts from the end of the one before; the gap that the first start belongs to is known */
    double gap;
    const uint64_t *transients;  /* periods dropped of each */
    const double *reals;
    const bool *booleans;
    const double *periods, *frequencies, *rests;  /* of each, rests: gap between unloaded springs, places of rest */
    const double *starts;  /* of each, or of the first of a chain */
    double *memory;  /* of the rule */
    double *states, *ends, *largest, *deviations, *peaks;  /* results */
    int32_t *counts;
    double *series;  /* the samples of a step */
} Task;

enum { BEFORE, CONTACTS_BEFORE, TOUCHES, AFTER, CONTACTS_AFTER, PERIODS, HOW, LATER_IMPACTS, NEARLY, COUNTS };  /* of each response */

EXPORT const unsigned sizes[] = {sizeof(Calls), sizeof(Task)};  /* response_loop.py has to have the same */

static bool answered(Calls *calls, const char *function, int status) {
    if (!status) return true;
    calls->failed = function;
    calls->status = status;
    return false;
}

static bool step(Calls *calls, double time, double target) {
    bool event, terminate, early;
    double last;
    return answered(calls, "fmi3DoStep", calls->step(calls->instance, time, target - time, true, &event, &terminate, &early, &last));
}

static bool set_flag(Calls *calls, unsigned reference, bool value) {
    return answered(calls, "fmi3SetBoolean", calls->set_boolean(calls->instance, &reference, 1, &value, 1));
}

static bool set_sample_count(Calls *calls, int32_t count) {
    return answered(calls, "fmi3SetInt32", calls->set_integer(calls->instance, &calls->sample_count, 1, &count, 1));
}

static bool get_integer(Calls *calls, unsigned reference, int32_t *value) {
    return answered(calls, "fmi3GetInt32", calls->get_integer(calls->instance, &reference, 1, value, 1));
}

static bool get_finite(Calls *calls, const unsigned *references, size_t count, double *values, size_t value_count) {
    if (!answered(calls, "fmi3GetFloat64", calls->get(calls->instance, references, count, values, value_count))) return false;
    for (size_t i = 0; i < value_count; i++) if (!__builtin_isfinite(values[i])) return answered(calls, "fmi3GetFloat64", NOT_FINITE);
    return true;
}

/* begin.py: gap_between. */
static double gap_between(const double *state, double offset) {
    double gap = state[X2] - state[X1];
    if (offset == 0.0) return gap;
    gap = gap + offset;
    return __builtin_fabs(gap) <= TOUCHING * (__builtin_fabs(state[X1]) + __builtin_fabs(state[X2]) + __builtin_fabs(offset)) ? 0.0 : gap;
}

static bool is_any(const double *state) {
    return state[X1] != 0.0 || state[X2] != 0.0 || state[V1] != 0.0 || state[V2] != 0.0;
}

/* begin.py: to_rest, of a state that counts from unloaded springs. */
static void to_rest(const double *state, const double *rest, double *start) {
    for (int i = 0; i < STATES; i++) start[i] = state[i];
    if (rest[0] >= 0.0 || !is_any(state)) return;
    start[X1] = state[X1] - rest[1];
    start[X2] = gap_between(state, rest[0]) == 0.0 ? state[X1] - rest[1] : state[X2] - rest[2];
}

static double power_of_two(int exponent) {
    union { uint64_t bits; double value; } number = {(uint64_t)(exponent + 1023) << 52};
    return number.value;
}

/* respond.py: round_to_bits; the numbers below 2^-970 m are kept as they are, as there. */
static void round_to_bits(double *first, double *second) {
    double shift = 0x1.8p52, a = __builtin_fabs(*first), b = __builtin_fabs(*second);
    union { double value; uint64_t bits; } largest = {a > b ? a : b};
    int exponent = (int)(largest.bits >> 52) - 1022;
    if (exponent < -970) return;
    double digit = power_of_two(exponent - END_BITS);
    *first = __builtin_copysign((*first / digit + shift - shift) * digit, *first);
    *second = __builtin_copysign((*second / digit + shift - shift) * digit, *second);
}

/* respond.py: round_state. */
static void round_state(const double *state, double offset, double *end) {
    for (int i = 0; i < STATES; i++) end[i] = state[i];
    round_to_bits(&end[V1], &end[V2]);
    if (offset != 0.0) end[X2] = state[X1] + gap_between(state, offset);
    round_to_bits(&end[X1], &end[X2]);
    if (offset != 0.0) end[X2] -= offset;
}

static bool initialize(Calls *calls, const Task *task, size_t i, const double *start) {
    double reals[64];
    for (size_t k = 0; k < calls->real_count; k++) reals[k] = task->reals[i * calls->real_count + k];
    to_rest(start, task->rests + 3 * i, reals + calls->start_position);
    return answered(calls, "fmi3Reset", calls->reset(calls->instance))
        && answered(calls, "fmi3SetFloat64", calls->set(calls->instance, calls->reals, calls->real_count, reals, calls->real_count))
        && answered(calls, "fmi3SetBoolean", calls->set_boolean(calls->instance, calls->booleans, calls->boolean_count, task->booleans + i * calls->boolean_count, calls->boolean_count))
        && answered(calls, "fmi3EnterInitializationMode", calls->enter_initialization(calls->instance, false, 0.0, 0.0, false, 0.0))
        && answered(calls, "fmi3ExitInitializationMode", calls->exit_initialization(calls->instance));
}

/* begin.py: last_samples of a step of its own. */
static bool sample(Calls *calls, const Task *task, double time, double target, size_t count, double *states) {
    if (!set_sample_count(calls, (int32_t)count) || !step(calls, time, target)) return false;
    if (!get_finite(calls, calls->series, STATES, task->series, STATES * calls->capacity)) return false;
    for (size_t k = 0; k < count; k++) for (int j = 0; j < STATES; j++) states[STATES * k + j] = task->series[j * calls->capacity + k];
    return true;
}

/* respond.py: stroboscopic_samples. */
static bool sample_periods(Calls *calls, const Task *task, double period, size_t transient, double *states, double *largest) {
    *largest = 0.0;
    for (size_t done = 0; done < task->samples; done += calls->capacity) {
        size_t count = task->samples - done < calls->capacity ? task->samples - done : calls->capacity, first = transient + done;
        double peak;
        if (!set_flag(calls, calls->x_rel_max_on, true)) return false;
        if (!sample(calls, task, (double)first * period, (double)(first + count) * period, count, states + STATES * done)) return false;
        if (!get_finite(calls, &calls->x_rel_max, 1, &peak, 1)) return false;
        if (peak > *largest) *largest = peak;
    }
    return true;
}

/* response_loop.py: peaks_of_step. */
static bool step_with_peaks(Calls *calls, double time, double target, double *peaks) {
    return set_flag(calls, calls->x_rel_max_on, false) && set_sample_count(calls, 0) && set_flag(calls, calls->peaks_on, true)
        && step(calls, time, target) && get_finite(calls, calls->peaks, PEAKS, peaks, PEAKS) && set_flag(calls, calls->peaks_on, false);
}

/* multiplicity.py: apply_rule. */
static int32_t apply_rule(const Task *task, size_t i, double tolerance, int (*rule)(double *, double)) {
    double *memory = task->memory;
    memory[COUNT] = (double)task->samples;
    memory[FREQUENCY] = task->frequencies[i];
    memory[GAP] = task->largest[i];
    memory[TOLERANCE] = tolerance;
    for (size_t k = 0; k < STATES * task->samples; k++) memory[HEAD + k] = task->states[STATES * task->samples * i + k];
    rule(memory, 0.0);
    return (int32_t)memory[MULTIPLICITY];
}

/* The peaks, and the impacts of a response that has repeated. */
static bool look_at_periods(Calls *calls, const Task *task, double period, size_t first, double *peaks, int32_t *counts) {
    size_t most = task->peak_periods, n = (size_t)counts[PERIODS], span = n < most ? n : most;
    if (!span) span = (most + 1) / 2;
    double done = (double)(first + span) * period, end = (double)(first + n) * period;
    if (!step_with_peaks(calls, (double)first * period, done, peaks)) return false;
    if (counts[HOW] != REPEATED) return true;
    if (end > done && !step(calls, done, end)) return false;
    return get_integer(calls, calls->impact_count, &counts[LATER_IMPACTS]);
}

static bool respond(Calls *calls, const Task *task, size_t i, const double *start) {
    size_t transient = (size_t)task->transients[i];
    double period = task->periods[i], *states = task->states + STATES * task->samples * i, *last = states + STATES * (task->samples - 1);
    int32_t *counts = task->counts + COUNTS * i;
    bool touches;
    if (!initialize(calls, task, i, start) || (transient && !step(calls, 0.0, (double)transient * period))) return false;
    if (!get_integer(calls, calls->impact_count, &counts[BEFORE]) || !get_integer(calls, calls->contact_count, &counts[CONTACTS_BEFORE])) return false;
    if (!answered(calls, "fmi3GetBoolean", calls->get_boolean(calls->instance, &calls->in_contact, 1, &touches, 1))) return false;
    counts[TOUCHES] = touches;
    if (!sample_periods(calls, task, period, transient, states, task->largest + i)) return false;
    if (!get_integer(calls, calls->impact_count, &counts[AFTER]) || !get_integer(calls, calls->contact_count, &counts[CONTACTS_AFTER])) return false;
    round_state(last, task->rests[3 * i], task->ends + STATES * i);
    if (task->loose != 0.0) {
        counts[NEARLY] = apply_rule(task, i, task->loose, kernel_repeat);
        task->deviations[i] = task->memory[DEVIATION];
        counts[PERIODS] = apply_rule(task, i, task->tolerance, kernel_repeat);
    }
    if (!task->decides) return true;
    counts[PERIODS] = apply_rule(task, i, task->tolerance, kernel_decide);
    counts[HOW] = (int32_t)task->memory[DECIDED];
    return look_at_periods(calls, task, period, transient + task->samples, task->peaks + PEAKS * i, counts);
}

/* Compute the responses from number first up to, not including, last; returns DONE, or FAILED. */
EXPORT int run(Calls *calls, const Task *task, size_t first, size_t last) {
    for (size_t i = first; i < last; i++) {
        const double *given = task->is_chain && i ? task->ends + STATES * (i - 1) : task->starts + (task->is_chain ? 0 : STATES * i);
        double start[STATES], offset = task->rests[3 * i], gap = i ? task->rests[3 * (i - 1)] : task->gap;
        bool has_gap = i || task->has_gap;
        for (int j = 0; j < STATES; j++) start[j] = given[j];
        if (task->is_chain && has_gap && gap != offset && is_any(start)) for (int j = 0; j < STATES; j++) start[j] += j == X2 ? gap - offset : 0.0;
        if (!respond(calls, task, i, start)) return FAILED;
    }
    return DONE;
}

EXPORT int decide_multiplicity(double *memory) { return kernel_decide(memory, 0.0); }

EXPORT int find_repetition(double *memory) { return kernel_repeat(memory, 0.0); }
