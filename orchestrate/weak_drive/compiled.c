/* The master's communication steps between two native instances, compiled.
 *
 * master.py and polynomials.py say what is done and why; here is the same, operation by operation,
 * so the bits are the same. compiled.py has the same structures for ctypes. No library is needed,
 * nothing is allocated.
 */
#include <stdbool.h>
#include <stddef.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif

typedef double Cubic[4];

enum {  /* places in a row; after the motion of the box the drive's other outputs, and its inputs */
    TIME, H, LEVEL, THEN, IMPACTS = THEN + 4,
    MOTION, FORCE = MOTION + 4, IMPULSE, MOMENT,
    POSITION = MOTION + 10, VELOCITY, ACCELERATION, WORK, ENERGY,
    LARGEST = 16,  /* inputs of the drive, at most */
    WARNING = 1, DISCARD = 2, NOT_FINITE = -1, NOT_WHOLE = -2,  /* statuses, of FMI and our own */
    LAST_TIME = 2, TERMINATED = 3  /* kinds of fmi2GetRealStatus and fmi2GetBooleanStatus */
};
static const double WHOLE = 1e-6;  /* channel.py */

typedef int (*Set3)(void *, const unsigned *references, size_t count, const double *values, size_t value_count);
typedef int (*Get3)(void *, const unsigned *references, size_t count, double *values, size_t value_count);
typedef int (*Step3)(void *, double time, double h, bool, bool *, bool *, bool *, double *);
typedef int (*Set2)(void *, const unsigned *references, size_t count, const double *values);
typedef int (*Get2)(void *, const unsigned *references, size_t count, double *values);
typedef int (*Step2)(void *, double time, double h, int);
typedef int (*RealStatus2)(void *, int kind, double *value);
typedef int (*BooleanStatus2)(void *, int kind, int *value);
typedef void Function(void);

typedef struct {  /* to the last step: channel.py */
    double time, h, last;
    bool event, terminate, early;
} Answer;

typedef struct {
    void *instance;
    Function *set, *get;  /* of FMI 2.0 or 3.0 */
    int (*count)(void *, const unsigned *references, size_t count, int *values, size_t value_count);
    Function *step;
    int (*save)(void *, void **state);
    int (*restore)(void *, void *state);
    Function *real_status, *boolean_status;  /* of FMI 2.0 */
    const unsigned *inputs, *outputs, *impacts;
    size_t input_count, output_count;
    void **kept;  /* its state at the step's beginning */
    Answer *answer;
    const char *failed;  /* the function that ended the run */
    int status, is_fmi3, warned;
} Side;

typedef struct {  /* places of our variables in what is set or read of the drive, what is one in SI */
    int count, places[4];
    double scales[4];
} Links;

typedef struct {
    Side oscillator, drive;
    double tolerance, easy;
    int halvings, first_passes;
    Links force, motion;
    int cubic;  /* place among the drive's other inputs of one with its derivatives, or -1 */
    const unsigned *recorded;
    size_t recorded_count;
    double *table;  /* of what is recorded, a row an interval */
} Pair;

EXPORT const unsigned sizes[] = {sizeof(Pair), MOTION, POSITION};  /* compiled.py has to have the same */

/* -- calls of the FMUs: true where the run goes on -- */

static bool answered(Side *side, const char *function, int status) {
    if (status == WARNING) side->warned = 1;
    if (!status || status == WARNING) return true;
    side->failed = function;
    side->status = status;
    return false;
}

static bool put(Side *s, const double *values) {
    size_t n = s->input_count;
    int status = s->is_fmi3 ? ((Set3)s->set)(s->instance, s->inputs, n, values, n) : ((Set2)s->set)(s->instance, s->inputs, n, values);
    return answered(s, "setting inputs", status);
}

static bool read(Side *s, const unsigned *names, size_t n, double *values) {
    int status = s->is_fmi3 ? ((Get3)s->get)(s->instance, names, n, values, n) : ((Get2)s->get)(s->instance, names, n, values);
    return answered(s, "reading outputs", status);
}

static bool get(Side *s, double *values) {
    double sum = 0.0;
    if (!read(s, s->outputs, s->output_count, values)) return false;
    for (size_t i = 0; i < s->output_count; i++) sum += values[i];
    return answered(s, "reading outputs", sum - sum == 0.0 ? 0 : NOT_FINITE);
}

static int step2(Side *s, Answer *a) {
    int ended = 0, status = ((Step2)s->step)(s->instance, a->time, a->h, 0);
    if (status == DISCARD) {
        ((RealStatus2)s->real_status)(s->instance, LAST_TIME, &a->last);
        ((BooleanStatus2)s->boolean_status)(s->instance, TERMINATED, &ended);
        a->terminate = ended;
    }
    return a->terminate ? 0 : status;
}

static bool advance(Side *s, double time, double h) {
    Answer *a = s->answer;
    if (a->terminate) return answered(s, "the step", NOT_WHOLE);
    a->time = time, a->h = h, a->last = time;
    int status = s->is_fmi3 ? ((Step3)s->step)(s->instance, time, h, false, &a->event, &a->terminate, &a->early, &a->last) : step2(s, a);
    bool whole = a->last >= time + (1.0 - WHOLE) * h;
    return answered(s, "the step", !status && (a->terminate || a->early) && !whole ? NOT_WHOLE : status);
}

static bool save(Side *s) { return answered(s, "saving the state", s->save(s->instance, s->kept)); }

static bool restore(Side *s) { return answered(s, "restoring the state", s->restore(s->instance, *s->kept)); }

static bool count_impacts(Side *s, double *impacts) {
    int count = 0;
    if (!answered(s, "counting impacts", s->count(s->instance, s->impacts, 1, &count, 1))) return false;
    *impacts = count;
    return true;
}

/* -- polynomials.py -- */

static double size_of(double value) { return __builtin_fabs(value); }

static void set_cubic(Cubic f, double f0, double f1, double f2, double f3) { f[0] = f0, f[1] = f1, f[2] = f2, f[3] = f3; }

static void matched_cubic(Cubic f, double first, double last, double mean, double moment, double h) {
    double a1 = last - first, a2 = mean - first, a3 = moment - 0.5 * first;
    double b = 3.0 * a1 + 36.0 * a2 - 60.0 * a3;
    double c = -12.0 * a1 - 96.0 * a2 + 180.0 * a3;
    double d = 10.0 * a1 + 60.0 * a2 - 120.0 * a3;
    set_cubic(f, first, b / h, 2.0 * c / (h * h), 6.0 * d / (h * h * h));
}

static double work(const Cubic force, double velocity, const Cubic a, double h) {
    double f[4] = {force[0], force[1] * h, force[2] * h * h / 2.0, force[3] * h * h * h / 6.0};
    double v[5] = {velocity, a[0] * h, a[1] * h * h / 2.0, a[2] * h * h * h / 6.0, a[3] * h * h * h * h / 24.0};
    double total = 0.0;
    for (int i = 0; i < 4; i++) for (int k = 0; k < 5; k++) total += f[i] * v[k] / (i + k + 1.0);
    return h * total;
}

/* -- master.py: what each side assumes of the other -- */

static void force_over(const Pair *p, Cubic f, const double *now, const double *next, double h) {
    if (p->force.count == 4) matched_cubic(f, now[FORCE], next[FORCE], next[IMPULSE] / h, next[MOMENT] / (h * h), h);
    else set_cubic(f, next[IMPULSE] / h, 0.0, 0.0, 0.0);
}

static void acceleration_over(Cubic f, const double *now, const double *next, double h) {
    double first = now[ACCELERATION], last = next[ACCELERATION];
    bool knows_velocity = now[VELOCITY] == now[VELOCITY];
    double mean = knows_velocity ? (next[VELOCITY] - now[VELOCITY]) / h : 0.5 * (first + last);
    if (!knows_velocity || now[POSITION] != now[POSITION]) {
        double bend = 3.0 * (first + last) - 6.0 * mean;
        set_cubic(f, first, (last - first - bend) / h, 2.0 * bend / (h * h), 0.0);
    } else {
        double moment = mean - ((next[POSITION] - now[POSITION]) / h - now[VELOCITY]) / h;
        matched_cubic(f, first, last, mean, moment, h);
    }
}

static void end_derivatives(Cubic end, const double *f, double h) {
    set_cubic(end, f[0] + h * (f[1] + 0.5 * h * (f[2] + h * f[3] / 3.0)), f[1] + h * (f[2] + 0.5 * h * f[3]), f[2] + h * f[3], f[3]);
}

static void run_on(Cubic f, const double *now) {
    const double *then = now + THEN, h = now[H];
    set_cubic(f, now[ACCELERATION], 0.0, 0.0, 0.0);
    if (h != 0.0) set_cubic(f, f[0], then[1] + h * (then[2] + 0.5 * h * then[3]), then[2] + h * then[3], then[3]);
}

/* -- master.py: a step -- */

/* A force, and the drive's other inputs. */
static bool put_force(Pair *p, const double *inputs, const Cubic force) {
    double values[LARGEST];
    int n = p->force.count;
    for (int i = 0; i < n; i++) values[i] = force[p->force.places[i]] / p->force.scales[i];
    for (size_t i = n; i < p->drive.input_count; i++) values[i] = inputs[i - n];
    return put(&p->drive, values);
}

/* The drive's outputs under the force at a row's end, a time h after its inputs were set. */
static bool look(Pair *p, double *row, const double *inputs, double h) {
    int known = p->motion.count;
    double force[4] = {row[FORCE]}, box[3], later[LARGEST], *read = row + POSITION + 3 - known;
    if (p->cubic >= 0 && h != 0.0) {
        for (size_t i = 0; i < p->drive.input_count - p->force.count; i++) later[i] = inputs[i];
        end_derivatives(later + p->cubic, inputs + p->cubic, h);
        inputs = later;
    }
    if (!put_force(p, inputs, force) || !get(&p->drive, read)) return false;
    for (int i = 0; i < known; i++) box[i] = read[i];
    for (int i = 0; i < 3; i++) row[POSITION + i] = __builtin_nan("");
    for (int i = 0; i < known; i++) row[POSITION + p->motion.places[i]] = p->motion.scales[i] * box[i];
    return true;
}

static size_t inputs_at(const Pair *p) { return ACCELERATION + 1 + p->drive.output_count - p->motion.count; }

static bool oscillate(Pair *p, const double *now, double *next, const Cubic acceleration, double h) {
    return put(&p->oscillator, acceleration) && advance(&p->oscillator, now[TIME], h) && get(&p->oscillator, next + MOTION);
}

static bool restore_both(Pair *p) { return restore(&p->oscillator) && restore(&p->drive); }

static double relative_defect(const Pair *p, const double *now, const double *next, const Cubic acceleration, double h) {
    Cubic force;
    force_over(p, force, now, next, h);
    double taken = next[WORK] - now[WORK], given = next[ENERGY] - now[ENERGY];
    double exchanged = size_of(taken) + size_of(given);
    return exchanged != 0.0 ? size_of(taken - work(force, now[VELOCITY], acceleration, h)) / exchanged : 0.0;
}

/* A step from `now` to `next`; where it is refused for its defect, both sides have gone back. */
static bool attempt(Pair *p, const double *now, double *next, double h, bool may_refuse, double *defect, bool *refused) {
    int passes = now[H] == 0.0 ? p->first_passes : 1;
    const double *inputs = now + inputs_at(p);
    Cubic acceleration, force;
    if (!save(&p->oscillator) || ((may_refuse || passes > 1) && !save(&p->drive))) return false;
    run_on(acceleration, now);
    for (int i = 0; i < passes; i++) {
        if (i && !restore_both(p)) return false;
        if (!oscillate(p, now, next, acceleration, h)) return false;
        force_over(p, force, now, next, h);
        if (!put_force(p, inputs, force) || !advance(&p->drive, now[TIME], h) || !look(p, next, inputs, h)) return false;
        acceleration_over(acceleration, now, next, h);
    }
    if (!restore(&p->oscillator) || !oscillate(p, now, next, acceleration, h) || !look(p, next, inputs, h)) return false;
    *defect = p->tolerance != 0.0 ? relative_defect(p, now, next, acceleration, h) : 0.0;
    *refused = may_refuse && *defect > p->tolerance;
    if (*refused) return restore_both(p);
    next[TIME] = now[TIME] + h, next[H] = h, next[LEVEL] = now[LEVEL];
    for (int i = 0; i < 4; i++) next[THEN + i] = acceleration[i];
    return count_impacts(&p->oscillator, next + IMPACTS);
}

/* An interval in steps, the row after each of them: `*at` is the last that there is. */
static bool interval(Pair *p, double *now, double **at, size_t width, const double *inputs, double h) {
    size_t first = inputs_at(p);
    int halvings = p->tolerance != 0.0 ? p->halvings : 0, level = (int)now[LEVEL], done = 0;
    double end = now[TIME] + h, defect;
    bool known = p->cubic < 0, refused;
    for (size_t i = first; i < width; i++) known = known && now[i] == inputs[i - first];
    for (size_t i = first; i < width; i++) now[i] = inputs[i - first];
    if (!known && !look(p, now, inputs, 0.0)) return false;
    while (done < 1 << halvings) {
        int size = (1 << halvings) >> level;
        double *next = *at + width;
        for (size_t i = first; i < width; i++) next[i] = now[i];
        if (!attempt(p, now, next, h / (1 << level), level < halvings, &defect, &refused)) return false;
        if (refused) {
            level++;
        } else {
            done += size;
            *at = next;
            for (size_t i = 0; i < width; i++) now[i] = next[i];
            if (defect < p->tolerance * p->easy && done % (2 * size) == 0 && level) level--;
        }
        now[LEVEL] = level;
    }
    (*at)[TIME] = now[TIME] = end;
    return true;
}

/* What is recorded of the drive at a row's end, under the force and the inputs there. */
static bool record(Pair *p, const double *row, const double *inputs) {
    double force[4] = {row[FORCE]};
    if (!put_force(p, inputs, force) || !read(&p->drive, p->recorded, p->recorded_count, p->table)) return false;
    p->table += p->recorded_count;
    return true;
}

/* Intervals from the state `now` on, which becomes that at the end: a row for each step after the
 * first row, and the row at which each interval ends. Returns how many there are: all, unless a call
 * failed or an FMU ended the simulation. The inputs of an interval are followed by those at its end,
 * where something is recorded. */
EXPORT int run(Pair *p, double *now, double *rows, int *ends, const double *inputs, int count, double h) {
    size_t own = p->drive.input_count - p->force.count, width = inputs_at(p) + own;
    double *at = rows;
    p->oscillator.status = p->drive.status = 0;
    for (int i = 0; i < count; i++) {
        if (p->oscillator.answer->terminate || p->drive.answer->terminate) return i;
        if (!interval(p, now, &at, width, inputs, h)) return i;
        inputs += own;
        if (p->recorded_count) {
            if (!record(p, now, inputs)) return i;
            inputs += own;
        }
        ends[i] = (int)((size_t)(at - rows) / width);
    }
    return count;
}
