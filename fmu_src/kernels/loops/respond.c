/* Responses one after the other: initialise, transient, samples, how often they repeat, their peaks and impacts then.
 *
 * Its rules are ../repetition.py and ../linear_response.py, translated. response/response_loop.py has the same structures and says more of the results.
 */
#include "fmi.h"
#include "rules.h"

#define TOUCHING 0x1p-50  /* relative: a gap that is no more than the rounding of displacements */
#define END_BITS 44  /* binary digits of the state that the next response starts from */
#define MIN_EXPONENT -970  /* of two: smaller numbers are not rounded */
#define MAX_REALS 64  /* set before a start */

enum { X1, X2, V1, V2, STATES };
enum { PEAKS = 4 };  /* largest |x1|, |x2|, |a1|, |a2| */
enum { TRAITS = MUST_IMPACT + 1 };

typedef struct {  /* an FMU of the oscillator */
    Fmi fmi;
    const unsigned *reals, *booleans, *series, *peaks;  /* what is set before the start; the samples kept in a step; PEAKS */
    size_t real_count, boolean_count, start_position, series_count, capacity;  /* of the start among the reals; samples of a step */
    unsigned sample_count, x_rel_max, x_rel_max_on, peaks_on, impact_count, contact_count, in_contact;
    double *kept;  /* room for the samples of a step */
} Oscillator;

typedef struct {  /* motions that are known at the point of all responses: one that comes to one of them is not run on */
    size_t count;
    const unsigned *state;  /* x1, x2, v1, v2 */
    const double *states, *gaps;  /* at phase 0 of successive periods of all of them, and the largest gap of each */
    const size_t *periods;  /* of each, after which it repeats */
    double within;  /* over the motion's size: so near is reached */
} Known;

typedef struct {  /* what there is to do: a row a response */
    size_t count, samples, peak_periods;  /* the periods looked at for peaks, at most; 0: none */
    size_t piece;  /* periods of a transient from one step to the next */
    double tolerance, loose;  /* loose, unless 0: a wider tolerance; repetitions within both are found */
    double gap;  /* between unloaded springs, that the first start of a chain belongs to */
    bool decides, is_chain, has_gap;  /* the multiplicity is decided; each starts from the end of the one before; the gap is known */
    const uint64_t *transients;  /* periods dropped of each */
    const double *reals;
    const bool *booleans;
    const double *periods, *traits;  /* of each, traits: those of linear_response.py */
    const double *starts;  /* of each, or of the first of a chain */
    double *memory;  /* of the rule */
    double *states, *ends, *largest, *impacts, *deviations, *peaks;  /* results */
    int32_t *counts;
    const Known *known;  /* or NULL */
} Task;

typedef struct {  /* what is done */
    size_t response, period;  /* of this response the periods of its transient */
    double time, away;  /* from known motions, when they were compared last */
    bool is_begun;
} Progress;

enum { BEFORE, CONTACTS_BEFORE, TOUCHES, AFTER, CONTACTS_AFTER, PERIODS, HOW, NEARLY, REACHED, COUNTS };  /* of each response */

EXPORT const unsigned sizes_of_respond[] = {sizeof(Oscillator), sizeof(Task), sizeof(Progress)};  /* Python has to have the same */

/* -- states -- */

/* The gap x2 - x1 + offset; rounding next to an offset is 0. */
static double gap_between(const double *state, double offset) {
    double gap = state[X2] - state[X1];
    if (offset == 0.0) return gap;
    gap = gap + offset;
    return __builtin_fabs(gap) <= TOUCHING * (__builtin_fabs(state[X1]) + __builtin_fabs(state[X2]) + __builtin_fabs(offset)) ? 0.0 : gap;
}

/* Gaps of states, each with its gap between unloaded springs, or all with the same. */
EXPORT void find_gaps(const double *states, size_t count, const double *offsets, bool is_one, double *gaps) {
    for (size_t i = 0; i < count; i++) gaps[i] = gap_between(states + STATES * i, offsets[is_one ? 0 : i]);
}

/* Absolute accelerations of both masses, by springs, dampers and the other mass, (6), in contact (18): a1 and a2 of each state. */
EXPORT void find_accelerations(const double *states, size_t count, const double *s, const bool *touching, double *accelerations) {
    double mass = s[M1] + s[M2], offset = s[GAP_OFFSET], stiffness = (s[K1] + s[K2]) / mass, damping = (s[D1] + s[D2]) / mass;
    for (size_t i = 0; i < count; i++, states += STATES, accelerations += 2) {
        accelerations[0] = -(s[K1] / s[M1] * states[X1] + s[D1] / s[M1] * states[V1]);
        accelerations[1] = -(s[K2] / s[M2] * states[X2] + s[D2] / s[M2] * states[V2]);
        if (!touching[i]) continue;
        for (int j = 0; j < 2; j++) accelerations[j] = -(stiffness * states[X1 + j] + damping * states[V1 + j]);
        if (offset == 0.0) continue;
        accelerations[0] += s[K2] / mass * offset;  /* each is loaded by the other one's spring where it is at 0 itself */
        accelerations[1] += -s[K1] / mass * offset;
    }
}

static bool is_any_nonzero(const double *state) {
    return state[X1] != 0.0 || state[X2] != 0.0 || state[V1] != 0.0 || state[V2] != 0.0;
}

/* A start as the FMU takes it, from the places of rest: of a preload, unless it is at rest, which all zeros are. */
EXPORT void to_rest(const double *state, const double *traits, double *start) {
    for (int i = 0; i < STATES; i++) start[i] = state[i];
    if (traits[WALL] != 0.0) {  /* mass 2 stays where it is */
        if (traits[GAP_OFFSET] < 0.0 && is_any_nonzero(state)) start[X1] = gap_between(state, traits[GAP_OFFSET]) == 0.0 ? 0.0 : state[X1] - traits[REST_1];
        return;
    }
    if (traits[GAP_OFFSET] >= 0.0 || !is_any_nonzero(state)) return;
    start[X1] = state[X1] - traits[REST_1];
    start[X2] = gap_between(state, traits[GAP_OFFSET]) == 0.0 ? start[X1] : state[X2] - traits[REST_2];
}

/* Faces at a gap: the second one is moved, but before a wall, which stays where it is, the first one. */
static void set_gap(double *state, const double *traits, double gap) {
    if (traits[WALL] != 0.0) state[X1] = traits[GAP_OFFSET] - gap;
    else state[X2] = state[X1] + gap - traits[GAP_OFFSET];
}

/* Faces beyond an end, by rounding or of another clearance or stroke, at that end. */
static void move_inside(double *state, const double *traits) {
    double apart = gap_between(state, traits[GAP_OFFSET]), inside = apart < 0.0 ? 0.0 : apart;
    if (traits[STROKE] != 0.0 && inside > traits[STROKE]) inside = traits[STROKE];
    if (inside != apart) set_gap(state, traits, inside);
}

/* A state at one point as the like one at another: displacements from rest and velocities times a factor each; faces that touch go on touching, none overlap. */
EXPORT void carry_state(const double *state, const double *from, const double *to, double length, double speed, double *like) {
    double gap = gap_between(state, from[GAP_OFFSET]);
    bool is_alike = from[GAP_OFFSET] == to[GAP_OFFSET] && from[STROKE] == to[STROKE] && from[WALL] == to[WALL];
    for (int j = 0; j < STATES; j++) like[j] = state[j];
    if (!is_any_nonzero(state) || (length == 1.0 && speed == 1.0 && is_alike)) return;
    for (int j = 0; j < 2; j++) like[X1 + j] = to[REST_1 + j] + length * (state[X1 + j] - from[REST_1 + j]), like[V1 + j] = state[V1 + j] * speed;
    if (to[WALL] != 0.0) like[X1] -= like[X2], like[V1] -= like[V2], like[X2] = like[V2] = 0.0;
    if (gap == 0.0) set_gap(like, to, 0.0);
    else if (to[STROKE] != 0.0 && __builtin_fabs(gap - from[STROKE]) <= TOUCHING * (__builtin_fabs(state[X1]) + __builtin_fabs(state[X2]) + gap)) set_gap(like, to, to[STROKE]);
    else move_inside(like, to);
}

static double power_of_two(int exponent) {
    union { uint64_t bits; double value; } number = {(uint64_t)(exponent + 1023) << 52};
    return number.value;
}

/* Two numbers to a number of binary digits of the larger one. */
static void round_to_bits(double *first, double *second) {
    double shift = 0x1.8p52, a = __builtin_fabs(*first), b = __builtin_fabs(*second);
    union { double value; uint64_t bits; } largest = {a > b ? a : b};
    int exponent = (int)(largest.bits >> 52) - 1022;
    if (exponent < MIN_EXPONENT) return;
    double digit = power_of_two(exponent - END_BITS);
    *first = __builtin_copysign((*first / digit + shift - shift) * digit, *first);
    *second = __builtin_copysign((*second / digit + shift - shift) * digit, *second);
}

/* A state to 44 bits (13 digits) of the larger face and velocity: what converged from two sides differs in its last digits for good; rounded, it is the same,
   and parts of a sweep that are begun elsewhere join it. */
static void round_state(const double *state, const double *traits, double *end) {
    double offset = traits[GAP_OFFSET];
    for (int i = 0; i < STATES; i++) end[i] = state[i];
    if (traits[WALL] != 0.0 || traits[STROKE] != 0.0) return;  /* rounded, a face might be beyond the other one */
    round_to_bits(&end[V1], &end[V2]);
    if (offset != 0.0) end[X2] = state[X1] + gap_between(state, offset);
    round_to_bits(&end[X1], &end[X2]);
    if (offset != 0.0) end[X2] -= offset;
}

/* -- steps -- */

static bool step_to(Fmi *fmi, double time, double target, double *reached) {
    bool event;
    return do_step(fmi, time, target, &event, reached);
}

/* States at equal parts of a step, the last at its end. */
static bool sample_step(Oscillator *o, double time, double target, size_t count, double *states) {
    double reached;
    if (!set_integer(&o->fmi, o->sample_count, (int32_t)count) || !step_to(&o->fmi, time, target, &reached)) return false;
    if (!get_reals(&o->fmi, o->series, o->series_count, o->kept, STATES * o->capacity)) return false;
    for (size_t k = 0; k < count; k++) for (int j = 0; j < STATES; j++) states[STATES * k + j] = o->kept[j * o->capacity + k];
    return true;
}

/* States at equal parts of a span of any length. */
EXPORT bool sample_evenly(Oscillator *o, double time, double target, size_t points, double *states) {
    double width = (target - time) / (double)points;
    for (size_t done = 0; done < points; done += o->capacity) {
        size_t count = points - done < o->capacity ? points - done : o->capacity;
        if (!sample_step(o, time + (double)done * width, time + (double)(done + count) * width, count, states + STATES * done)) return false;
    }
    return true;
}

/* States at the excitation's phase 0 of successive periods after a transient, and the largest gap over them. */
EXPORT bool sample_periods(Oscillator *o, double period, size_t transient, size_t samples, double *states, double *largest) {
    *largest = 0.0;
    for (size_t done = 0; done < samples; done += o->capacity) {
        size_t count = samples - done < o->capacity ? samples - done : o->capacity, first = transient + done;
        double peak;
        if (!set_boolean(&o->fmi, o->x_rel_max_on, true)) return false;
        if (!sample_step(o, (double)first * period, (double)(first + count) * period, count, states + STATES * done)) return false;
        if (!get_reals(&o->fmi, &o->x_rel_max, 1, &peak, 1)) return false;
        if (peak > *largest) *largest = peak;
    }
    return true;
}

/* The largest displacements and accelerations over a step. */
static bool find_peaks(Oscillator *o, double time, double target, double *peaks) {
    double reached;
    return set_boolean(&o->fmi, o->peaks_on, true) && step_to(&o->fmi, time, target, &reached)
        && get_reals(&o->fmi, o->peaks, PEAKS, peaks, PEAKS) && set_boolean(&o->fmi, o->peaks_on, false);
}

/* Begin response number i, or any motion, at its start. */
static bool begin_motion(Oscillator *o, const Task *task, size_t i, const double *start) {
    Fmi *fmi = &o->fmi;
    double reals[MAX_REALS];
    for (size_t k = 0; k < o->real_count; k++) reals[k] = task->reals[i * o->real_count + k];
    to_rest(start, task->traits + TRAITS * i, reals + o->start_position);
    if (!answered(fmi, "Reset", fmi->reset(fmi->instance)) || !set_reals(fmi, o->reals, o->real_count, reals)) return false;
    for (size_t k = 0; k < o->boolean_count; k++) if (!set_boolean(fmi, o->booleans[k], task->booleans[i * o->boolean_count + k])) return false;
    return initialize(fmi);
}

/* The start of a response: its own, or the end of the one before, with the same faces where the gap between unloaded springs is another one. */
static void find_start(const Task *task, size_t i, double *start) {
    const double *given = task->is_chain && i ? task->ends + STATES * (i - 1) : task->starts + (task->is_chain ? 0 : STATES * i);
    double offset = task->traits[TRAITS * i + GAP_OFFSET], gap = i ? task->traits[TRAITS * (i - 1) + GAP_OFFSET] : task->gap;
    for (int j = 0; j < STATES; j++) start[j] = given[j];
    const double *traits = task->traits + TRAITS * i;
    if (task->is_chain && (i || task->has_gap) && gap != offset && is_any_nonzero(start)) for (int j = 0; j < STATES; j++) start[j] += j == X2 ? gap - offset : 0.0;
    if (traits[WALL] != 0.0) start[X1] -= start[X2], start[X2] = 0.0;
    if (!task->is_chain || !is_any_nonzero(start)) return;
    move_inside(start, traits);
}

/* Some periods of the transient, with the work that they are. The last step, which begins after half of it, ends where one over all would, to the last bit. */
static bool run_transient(Oscillator *o, const Task *task, Progress *progress, int32_t *impacts, size_t *work) {
    size_t i = progress->response, left = (size_t)task->transients[i] - progress->period, count = left < task->piece ? left : task->piece;
    int32_t before = *impacts;
    progress->period += count;
    if (!step_to(&o->fmi, progress->time, (double)progress->period * task->periods[i], &progress->time)) return false;
    if (!get_integer(&o->fmi, o->impact_count, impacts)) return false;
    *work += count + (size_t)(*impacts - before);
    return true;
}

/* -- decisions -- */

static int32_t apply_rule(const Task *task, size_t i, double tolerance, int (*rule)(double *, double)) {
    double *memory = task->memory;
    memory[COUNT] = (double)task->samples;
    memory[FREQUENCY] = task->traits[TRAITS * i + BOX_FREQUENCY];
    memory[GAP] = task->largest[i];
    memory[TOLERANCE] = tolerance;
    for (size_t k = 0; k < STATES * task->samples; k++) memory[HEAD + k] = task->states[STATES * task->samples * i + k];
    rule(memory, 0.0);
    return (int32_t)memory[MULTIPLICITY];
}

/* Run on and decide: peaks over the periods after which the response repeats, or some, and the impacts of one that has repeated, over its own period. */
static bool run_on_and_confirm(Oscillator *o, const Task *task, size_t i) {
    double period = task->periods[i], *memory = task->memory;
    int32_t *counts = task->counts + COUNTS * i, later;
    size_t first = (size_t)task->transients[i] + task->samples, n = (size_t)counts[PERIODS], span = n < task->peak_periods ? n : task->peak_periods;
    if (!span) span = (task->peak_periods + 1) / 2;
    double done = (double)first * period, end = (double)(first + n) * period;
    if (!set_boolean(&o->fmi, o->x_rel_max_on, false) || !set_integer(&o->fmi, o->sample_count, 0)) return false;
    if (span && !find_peaks(o, done, (double)(first + span) * period, task->peaks + PEAKS * i)) return false;
    if (span) done = (double)(first + span) * period;
    if (counts[HOW] == REPEATED) {
        if (end > done && !step_to(&o->fmi, done, end, &done)) return false;
        if (!get_integer(&o->fmi, o->impact_count, &later)) return false;
        memory[OWN_IMPACTS] = (double)(later - counts[AFTER]);
        task->impacts[i] = memory[OWN_IMPACTS] / (double)n;
    }
    memory[IMPACTS] = (double)(counts[AFTER] - counts[BEFORE]);
    memory[MUST] = task->traits[TRAITS * i + MUST_IMPACT];
    kernel_confirm_by_impacts(memory, 0.0);
    counts[PERIODS] = (int32_t)memory[MULTIPLICITY];
    counts[HOW] = (int32_t)memory[DECIDED];
    return true;
}

/* How near states of a motion come to a state, over the motion's size; the memory has the number of that state. */
EXPORT double nearest_state(const double *states, size_t count, double frequency, double gap, const double *state, double *memory) {
    memory[COUNT] = (double)count;
    memory[FREQUENCY] = frequency;
    memory[GAP] = gap;
    for (size_t k = 0; k < STATES; k++) memory[GIVEN + k] = state[k];
    for (size_t k = 0; k < STATES * count; k++) memory[HEAD + k] = states[k];
    kernel_write_nearest_state(memory, 0.0);
    return memory[DISTANCE];
}

/* Note the state of known motions that a response has reached, from one: so near when it was compared before, and nearer now; the end is its own. */
static bool note_reached_state(Oscillator *o, const Task *task, Progress *progress) {
    size_t i = progress->response;
    const Known *known = task->known;
    const double *states = known->states;
    double *state = task->ends + STATES * i, nearest = 0.0;
    int32_t reached = 0, first = 1;
    if (!get_reals(&o->fmi, known->state, STATES, state, STATES)) return false;
    for (size_t k = 0; k < known->count; first += (int32_t)known->periods[k], states += STATES * known->periods[k++]) {
        double away = nearest_state(states, known->periods[k], task->traits[TRAITS * i + BOX_FREQUENCY], known->gaps[k], state, task->memory);
        if (!k || away < nearest) nearest = away, reached = first + (int32_t)task->memory[NEAREST];
    }
    task->counts[COUNTS * i + REACHED] = progress->away < known->within && nearest < progress->away ? reached : 0;
    progress->away = nearest;
    return true;
}

/* Sample a response whose transient is over, and decide. */
static bool sample_and_decide(Oscillator *o, const Task *task, size_t i) {
    Fmi *fmi = &o->fmi;
    double *states = task->states + STATES * task->samples * i, *last = states + STATES * (task->samples - 1);
    int32_t *counts = task->counts + COUNTS * i;
    bool touches;
    if (!get_integer(fmi, o->impact_count, &counts[BEFORE]) || !get_integer(fmi, o->contact_count, &counts[CONTACTS_BEFORE])) return false;
    if (!get_boolean(fmi, o->in_contact, &touches)) return false;
    counts[TOUCHES] = touches;
    if (!sample_periods(o, task->periods[i], (size_t)task->transients[i], task->samples, states, task->largest + i)) return false;
    if (!get_integer(fmi, o->impact_count, &counts[AFTER]) || !get_integer(fmi, o->contact_count, &counts[CONTACTS_AFTER])) return false;
    task->impacts[i] = (double)(counts[AFTER] - counts[BEFORE]) / (double)task->samples;
    round_state(last, task->traits + TRAITS * i, task->ends + STATES * i);
    if (task->loose != 0.0) {
        counts[NEARLY] = apply_rule(task, i, task->loose, kernel_write_least_multiplicity);
        task->deviations[i] = task->memory[DEVIATION];
        counts[PERIODS] = apply_rule(task, i, task->tolerance, kernel_write_least_multiplicity);
    }
    if (!task->decides) return true;
    counts[PERIODS] = apply_rule(task, i, task->tolerance, kernel_write_decided_multiplicity);
    counts[HOW] = (int32_t)task->memory[DECIDED];
    return run_on_and_confirm(o, task, i);
}

/* Begin the motion of a row at its start. */
EXPORT bool begin(Oscillator *o, const Task *task, size_t i) {
    double start[STATES];
    find_start(task, i, start);
    return begin_motion(o, task, i, start);
}

/* Compute responses from where the progress stands: DONE, PAUSED after some work (periods and impacts), or BROKEN. */
EXPORT int respond(Oscillator *o, const Task *task, Progress *progress, size_t budget) {
    size_t work = 0;
    for (; progress->response < task->count; progress->response++, progress->is_begun = false) {
        size_t i = progress->response;
        int32_t impacts = 0, *counts = task->counts + COUNTS * i;
        if (!progress->is_begun && !begin(o, task, i)) return BROKEN;
        if (!progress->is_begun) progress->period = 0, progress->time = progress->away = 0.0;
        else if (!get_integer(&o->fmi, o->impact_count, &impacts)) return BROKEN;
        progress->is_begun = true;
        while (progress->period < task->transients[i] && !counts[REACHED]) {
            if (work >= budget) return PAUSED;
            if (!run_transient(o, task, progress, &impacts, &work)) return BROKEN;
            if (task->known && !note_reached_state(o, task, progress)) return BROKEN;
        }
        if (counts[REACHED]) continue;
        if (work >= budget) return PAUSED;
        if (!sample_and_decide(o, task, i)) return BROKEN;
        work += task->samples + (size_t)(counts[AFTER] - counts[BEFORE]);
    }
    return DONE;
}

EXPORT size_t memory_size(size_t samples) { return HEAD + (STATE + COLUMNS + 1) * samples; }

EXPORT int decide_multiplicity(double *memory) { return kernel_write_decided_multiplicity(memory, 0.0); }

EXPORT int find_repetition(double *memory) { return kernel_write_least_multiplicity(memory, 0.0); }

EXPORT int rest_and_threshold(double *memory) { return kernel_write_rest_and_threshold(memory, 0.0); }
