/* The communication steps of two instances together: in an ordinary step the oscillator alone goes back.
 *
 * The structure's box_force depends on its states only, the box's acceleration on the force: there is no algebraic loop, but what each side assumes of the
 * other over a step decides everything.
 *
 * - The oscillator does the step under an extrapolated acceleration: the cubic of the last step goes on from the present value.
 * - The drive does it under the force that came of it: the cubic with its ends, mean and first moment, which are exact through impacts. A drive that takes the
 *   force alone is given its mean.
 * - The oscillator goes back and does it again, under the acceleration between both ends: the cubic with the changes of the box's velocity and position, or
 *   what is known of it.
 * - Where nothing is known to extrapolate, at the start, both do the step `first_passes` times, if the drive can go back.
 * - With a `tolerance` a step is halved, for both, where the energy defect is a larger part of the work exchanged in it; one with less than `easy` of that is
 *   followed by one twice as long.
 *
 * weak_drive/master.py has the same structures.
 */
#include "fmi.h"

typedef double Cubic[4];  /* value and three time derivatives at a step's beginning */

enum {  /* places in a row; after the motion of the box the drive's other outputs, and its inputs */
    TIME, H, LEVEL, THEN, IMPACTS = THEN + 4,
    MOTION, FORCE = MOTION + 4, IMPULSE, MOMENT,
    POSITION = MOTION + 10, VELOCITY, ACCELERATION, WORK, ENERGY,
    PAST = 3,  /* communication points that are remembered where no acceleration is connected */
    DISCARD = 2, NOT_WHOLE = -2,  /* statuses, of FMI and our own */
    LAST_TIME = 2, TERMINATED = 3  /* kinds of fmi2GetRealStatus and fmi2GetBooleanStatus */
};
static const double WHOLE = 1e-6;  /* fmu/channel.py */

typedef int (*RealStatus2)(void *, int kind, double *value);
typedef int (*BooleanStatus2)(void *, int kind, int *value);

typedef struct {  /* to the last step: fmu/channel.py */
    double time, h, last;
    bool event, terminate, early;
} Answer;

typedef struct {
    Fmi fmi;
    int (*save)(void *, void **state);
    int (*restore)(void *, void *state);
    int (*release)(void *, void **state);
    Function *real_status, *boolean_status;  /* of FMI 2.0 */
    const unsigned *inputs, *outputs, *impacts;
    size_t input_count, output_count;
    void **kept;  /* its state at the step's beginning */
    Answer *answer;
    int keeps_anew;  /* pythonfmu makes a new state each time */
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
    size_t stride;  /* of the inputs of an interval */
    double *scratch;  /* two rows of the drive's inputs */
    double points[2 * PAST];  /* times and values of velocity or position, where no acceleration is connected */
    int point_count;
} Pair;

EXPORT const unsigned sizes_of_couple[] = {sizeof(Pair), MOTION, POSITION};  /* Python has to have the same */

/* -- calls of the FMUs: true where the run goes on -- */

static bool put(Side *s, const double *values) { return set_reals(&s->fmi, s->inputs, s->input_count, values); }

static bool get(Side *s, double *values) { return get_reals(&s->fmi, s->outputs, s->output_count, values, s->output_count); }

static int step2(Side *s, Answer *a) {
    int ended = 0, status = ((Step2)s->fmi.step)(s->fmi.instance, a->time, a->h, 0);
    if (status == DISCARD) {
        ((RealStatus2)s->real_status)(s->fmi.instance, LAST_TIME, &a->last);
        ((BooleanStatus2)s->boolean_status)(s->fmi.instance, TERMINATED, &ended);
        a->terminate = ended;
    }
    return a->terminate ? 0 : status;
}

static bool advance(Side *s, double time, double h) {
    Answer *a = s->answer;
    if (a->terminate) return answered(&s->fmi, "the step", NOT_WHOLE);
    a->time = time, a->h = h, a->last = time;
    int status = s->fmi.version == 2 ? step2(s, a) : ((Step3)s->fmi.step)(s->fmi.instance, time, h, false, &a->event, &a->terminate, &a->early, &a->last);
    bool whole = a->last >= time + (1.0 - WHOLE) * h;
    return answered(&s->fmi, "the step", !status && (a->terminate || a->early) && !whole ? NOT_WHOLE : status);
}

static bool save(Side *s) {
    if (s->keeps_anew && *s->kept && !answered(&s->fmi, "freeing the state", s->release(s->fmi.instance, s->kept))) return false;
    return answered(&s->fmi, "saving the state", s->save(s->fmi.instance, s->kept));
}

static bool restore(Side *s) { return answered(&s->fmi, "restoring the state", s->restore(s->fmi.instance, *s->kept)); }

static bool count_impacts(Side *s, double *impacts) {
    int32_t count = 0;
    if (!get_integer(&s->fmi, *s->impacts, &count)) return false;
    *impacts = count;
    return true;
}

/* -- polynomials -- */

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

/* -- what each side assumes of the other -- */

static void force_over(const Pair *p, Cubic f, const double *now, const double *next, double h) {
    if (p->force.count == 4) matched_cubic(f, now[FORCE], next[FORCE], next[IMPULSE] / h, next[MOMENT] / (h * h), h);
    else set_cubic(f, next[IMPULSE] / h, 0.0, 0.0, 0.0);
}

static void end_derivatives(Cubic end, const double *f, double h) {
    set_cubic(end, f[0] + h * (f[1] + 0.5 * h * (f[2] + h * f[3] / 3.0)), f[1] + h * (f[2] + 0.5 * h * f[3]), f[2] + h * f[3], f[3]);
}

/* Two derivatives at time 0, from an order on, of the polynomial through points. */
static void derivatives(const double *times, double *values, int count, int order, double *found) {
    double polynomial[PAST + 4] = {0.0};  /* coefficients, by Horner's scheme in Newton's form */
    for (int level = 1; level < count; level++)
        for (int i = count - 1; i >= level; i--) values[i] = (values[i] - values[i - 1]) / (times[i] - times[i - level]);
    for (int i = count - 1; i >= 0; i--) {
        for (int k = count + 2; k > 0; k--) polynomial[k] = polynomial[k - 1] - times[i] * polynomial[k];
        polynomial[0] = values[i] - times[i] * polynomial[0];
    }
    found[0] = order * polynomial[order];  /* its factorial: order is 1 or 2 */
    found[1] = (order == 1 ? 2.0 : 6.0) * polynomial[order + 1];
}

/* The acceleration over a step from velocities or positions alone, as a line. */
static void line_of_points(const Pair *p, Cubic f, const double *now, const double *next, double h) {
    bool from_position = next[VELOCITY] != next[VELOCITY];
    int known = p->point_count < 2 + from_position ? p->point_count : 2 + from_position, first = p->point_count - known;
    double ages[PAST + 1], values[PAST + 1], found[2];
    for (int i = 0; i < known; i++) {
        ages[i] = p->points[2 * (first + i)] - now[TIME];
        values[i] = p->points[2 * (first + i) + 1];
    }
    ages[known] = now[TIME] + h - now[TIME];
    values[known] = next[from_position ? POSITION : VELOCITY];
    derivatives(ages, values, known + 1, 1 + from_position, found);
    set_cubic(f, found[0], found[1], 0.0, 0.0);
}

/* Keep the last points of velocity or position where no acceleration is connected. */
static void remember(Pair *p, const double *row) {
    if (row[ACCELERATION] == row[ACCELERATION]) return;
    if (p->point_count == PAST) {
        for (int i = 0; i < 2 * PAST - 2; i++) p->points[i] = p->points[i + 2];
        p->point_count--;
    }
    double *point = p->points + 2 * p->point_count++;
    point[0] = row[TIME], point[1] = row[VELOCITY] == row[VELOCITY] ? row[VELOCITY] : row[POSITION];
}

static void acceleration_over(const Pair *p, Cubic f, const double *now, const double *next, double h) {
    if (now[ACCELERATION] != now[ACCELERATION]) {
        line_of_points(p, f, now, next, h);
        return;
    }
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

/* Extrapolate the box acceleration over the coming step. */
static void run_on(Cubic f, const double *now) {
    set_cubic(f, 0.0, 0.0, 0.0, 0.0);
    if (now[H] != 0.0) end_derivatives(f, now + THEN, now[H]);
    if (now[ACCELERATION] == now[ACCELERATION]) f[0] = now[ACCELERATION];
}

/* -- a step -- */

/* A force, and the drive's other inputs. */
static bool put_force(Pair *p, const double *inputs, const Cubic force) {
    double *values = p->scratch;
    int n = p->force.count;
    for (int i = 0; i < n; i++) values[i] = force[p->force.places[i]] / p->force.scales[i];
    for (size_t i = n; i < p->drive.input_count; i++) values[i] = inputs[i - n];
    return put(&p->drive, values);
}

/* The drive's outputs under the force at a row's end, a time h after its inputs were set. */
static bool look(Pair *p, double *row, const double *inputs, double h) {
    int known = p->motion.count;
    double force[4] = {row[FORCE]}, box[3], *later = p->scratch + p->drive.input_count, *read = row + POSITION + 3 - known;
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
        acceleration_over(p, acceleration, now, next, h);
    }
    if (!restore(&p->oscillator) || !oscillate(p, now, next, acceleration, h) || !look(p, next, inputs, h)) return false;
    *defect = p->tolerance != 0.0 ? relative_defect(p, now, next, acceleration, h) : 0.0;
    *refused = may_refuse && *defect > p->tolerance;
    if (*refused) return restore_both(p);
    next[TIME] = now[TIME] + h, next[H] = h, next[LEVEL] = now[LEVEL];
    for (int i = 0; i < 4; i++) next[THEN + i] = acceleration[i];
    remember(p, next);
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
    if (!put_force(p, inputs, force) || !get_reals(&p->drive.fmi, p->recorded, p->recorded_count, p->table, p->recorded_count)) return false;
    p->table += p->recorded_count;
    return true;
}

/* Intervals from the state `now` on, which becomes that at the end: a row for each step after the
 * first row, and the row at which each interval ends. Returns how many there are: all, unless a call
 * failed or an FMU ended the simulation. The inputs of an interval are followed by those at its end,
 * where something is recorded. */
EXPORT int couple(Pair *p, double *now, double *rows, int *ends, const double *inputs, int count, double h) {
    size_t own = p->drive.input_count - p->force.count, width = inputs_at(p) + own;
    double *at = rows;
    p->oscillator.fmi.status = p->drive.fmi.status = 0;
    for (int i = 0; i < count; i++, inputs += p->stride) {
        if (p->oscillator.answer->terminate || p->drive.answer->terminate) return i;
        if (!interval(p, now, &at, width, inputs, h)) return i;
        if (p->recorded_count && !record(p, now, inputs + own)) return i;
        ends[i] = (int)((size_t)(at - rows) / width);
    }
    return count;
}
