/* The communication steps of two instances together: the oscillator predicts a step, the drive does it, the oscillator repeats it.
 *
 * The structure's box_force depends on its states only, the box's acceleration on the force: there is no algebraic loop, but what each side assumes of the
 * other over a step decides everything.
 *
 * - The oscillator does the step under an extrapolated acceleration: the cubic of the last step continues from the present value.
 * - The drive does it under the force that came of it: the cubic with its ends, mean and first moment, which are exact through impacts. A drive that takes a held
 *   force gets its mean, and a share of the impulse and the first moment that the forces held until then missed (`owed`): a constant moment is made up for
 *   within two steps.
 * - The oscillator goes back and does it again. Of a drive that takes a held force the acceleration is w(t) F(t) and a rest: w, the inverse mass, is what 1 N more
 *   adds at once; F is exact; the rest is what is seen of the box less what the held force does to it.
 * - Acceleration and velocity give the ends and the mean of the rest (all of the acceleration where w is 0), the position its first moment, or it is a parabola.
 *   Otherwise it is the polynomial through the last points of acceleration, velocity or position. Where nothing is known to extrapolate, at the start, both do
 *   the step `first_passes` times, if the drive can go back.
 * - A force of the drive on a half is extrapolated as the acceleration is, and then the polynomial through its last points.
 * - With a `tolerance` a step is halved, for both, where the energy defect is a larger part of the work exchanged in it; one with less than `easy` of that is
 *   followed by one twice as long.
 * - A step that the drive discards is halved too, to the end of its interval, where the drive can go back (`halves_discarded`).
 *
 * weak_drive/master.py has the same structures.
 */
#include "fmi.h"

typedef double Cubic[4];  /* value and three time derivatives at a step's beginning */

enum {  /* places in a row; after the motion of the box the drive's other outputs, and its inputs */
    TIME, H, LEVEL, THEN, IMPACTS = THEN + 4, GIVEN,
    MOTION, FORCE = MOTION + 4, IMPULSE, MOMENT,
    POSITION = MOTION + 10, VELOCITY, ACCELERATION, WORK, ENERGY,
    ANGLE = WORK + 4, SPEED,
    PUSHES = 2,  /* halves that a force may act on */
    PAST = 4,  /* communication points that are remembered where acceleration and velocity are not both connected */
    DISCARD = 2, NOT_WHOLE = -2,  /* statuses, of FMI and our own */
    LAST_TIME = 2, TERMINATED = 3  /* kinds of fmi2GetRealStatus and fmi2GetBooleanStatus */
};
static const double WHOLE = 1e-6;  /* of a step: a rest that is rounding, its end was reached */
static const double TURN = 6.283185307179586;  /* rad */

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
    int halvings, first_passes, halves_discarded;
    Links force, motion, pushes;  /* pushes: forces on the halves, among the drive's outputs after the motion */
    int cubic;  /* place among the drive's other inputs from which on they are cubics, four of each, or -1 */
    const unsigned *recorded;
    size_t recorded_count;
    double *table;  /* of what is recorded, a row an interval */
    size_t stride;  /* of the inputs of an interval */
    double *scratch;  /* two rows of the drive's inputs */
    double points[2 * PAST];  /* times and values of the rest, or of its first or second integral */
    int point_count;
    double inverse_mass[2];  /* w at a step's beginning and end; 0 for a drive that takes the force's derivatives */
    double held, owed[2];  /* force in the last step; impulse and first moment about now, N s and N s^2, that the drive lacks */
    double push_count, push_points[PAST - 1][1 + PUSHES];  /* last times, and forces on the halves then */
} Pair;

EXPORT const unsigned sizes_of_couple[] = {sizeof(Pair), MOTION, POSITION, ANGLE};  /* Python has to have the same */

/* -- calls of the FMUs: true if the run continues -- */

static bool set_inputs(Side *s, const double *values) { return set_reals(&s->fmi, s->inputs, s->input_count, values); }

static bool read_outputs(Side *s, double *values) { return get_reals(&s->fmi, s->outputs, s->output_count, values, s->output_count); }

static int step2(Side *s, Answer *a) {
    int ended = 0, status = ((Step2)s->fmi.step)(s->fmi.instance, a->time, a->h, 0);
    if (status == DISCARD) {
        ((RealStatus2)s->real_status)(s->fmi.instance, LAST_TIME, &a->last);
        ((BooleanStatus2)s->boolean_status)(s->fmi.instance, TERMINATED, &ended);
        a->terminate = ended;
    }
    return a->terminate ? 0 : status;
}

static bool advance_side(Side *s, double time, double h) {
    Answer *a = s->answer;
    if (a->terminate) return answered(&s->fmi, "the step", NOT_WHOLE);
    a->time = time, a->h = h, a->last = time;
    int status = s->fmi.version == 2 ? step2(s, a) : ((Step3)s->fmi.step)(s->fmi.instance, time, h, false, &a->event, &a->terminate, &a->early, &a->last);
    bool whole = a->last >= time + (1.0 - WHOLE) * h;
    return answered(&s->fmi, "the step", !status && (a->terminate || a->early) && !whole ? NOT_WHOLE : status);
}

static bool save_side(Side *s) {
    if (s->keeps_anew && *s->kept && !answered(&s->fmi, "freeing the state", s->release(s->fmi.instance, s->kept))) return false;
    return answered(&s->fmi, "saving the state", s->save(s->fmi.instance, s->kept));
}

static bool restore_side(Side *s) { return answered(&s->fmi, "restoring the state", s->restore(s->fmi.instance, *s->kept)); }

static bool count_impacts(Side *s, double *impacts) {
    int32_t count = 0;
    if (!get_integer(&s->fmi, *s->impacts, &count)) return false;
    *impacts = count;
    return true;
}

/* -- polynomials -- */

static double magnitude(double value) { return __builtin_fabs(value); }

static bool is_known(double value) { return value == value; }

static void set_cubic(Cubic f, double f0, double f1, double f2, double f3) { f[0] = f0, f[1] = f1, f[2] = f2, f[3] = f3; }

static void fit_cubic(Cubic f, double first, double last, double mean, double moment, double h) {
    double a1 = last - first, a2 = mean - first, a3 = moment - 0.5 * first;
    double b = 3.0 * a1 + 36.0 * a2 - 60.0 * a3;
    double c = -12.0 * a1 - 96.0 * a2 + 180.0 * a3;
    double d = 10.0 * a1 + 60.0 * a2 - 120.0 * a3;
    set_cubic(f, first, b / h, 2.0 * c / (h * h), 6.0 * d / (h * h * h));
}

/* Cubics of rows of end values, mean, first moment and step. */
EXPORT void matched_cubics(const double (*given)[5], int count, Cubic *found) {
    for (int i = 0; i < count; i++) fit_cubic(found[i], given[i][0], given[i][1], given[i][2], given[i][3], given[i][4]);
}

static void cubic_after(Cubic end, const double *f, double h) {
    set_cubic(end, f[0] + h * (f[1] + 0.5 * h * (f[2] + h * f[3] / 3.0)), f[1] + h * (f[2] + 0.5 * h * f[3]), f[2] + h * f[3], f[3]);
}

/* Cubics of rows of another one and the time after which they continue it. */
EXPORT void continued_cubics(const double (*given)[5], int count, Cubic *found) {
    for (int i = 0; i < count; i++) cubic_after(found[i], given[i], given[i][4]);
}

static double work_of_force(const Cubic force, double velocity, const Cubic a, double h) {
    double f[4] = {force[0], force[1] * h, force[2] * h * h / 2.0, force[3] * h * h * h / 6.0};
    double v[5] = {velocity, a[0] * h, a[1] * h * h / 2.0, a[2] * h * h * h / 6.0, a[3] * h * h * h * h / 24.0};
    double total = 0.0;
    for (int i = 0; i < 4; i++) for (int k = 0; k < 5; k++) total += f[i] * v[k] / (i + k + 1.0);
    return h * total;
}

/* -- what each side assumes of the other -- */

static bool is_force_held(const Pair *p) { return p->force.count < 4; }

/* The first moment of the force about the middle of a step, which a held force lacks. */
static double moment_about_middle(const double *next, double h) { return next[MOMENT] - 0.5 * h * next[IMPULSE]; }

static void fit_force(Cubic f, const double *now, const double *next, double h) {
    fit_cubic(f, now[FORCE], next[FORCE], next[IMPULSE] / h, next[MOMENT] / (h * h), h);
}

static void force_for_drive(Pair *p, Cubic f, const double *now, const double *next, double h) {
    if (!is_force_held(p)) {
        fit_force(f, now, next, h);
        return;
    }
    p->held = next[IMPULSE] / h + (p->owed[1] / h + 1.5 * (p->owed[0] - moment_about_middle(next, h) / h)) / h;
    set_cubic(f, p->held, 0.0, 0.0, 0.0);
}

/* What the drive is owed after a step, of the force that it was given. */
static void note_owed_momentum(Pair *p, const double *next, double h) {
    double lacks = next[IMPULSE] - p->held * h;
    p->owed[1] += h * (p->owed[0] + 0.5 * lacks) - moment_about_middle(next, h);
    p->owed[0] += lacks;
}

/* Derivatives at time 0, from an order on, of the polynomial through points. */
static void derivatives_through_points(const double *times, double *values, int count, int order, Cubic found) {
    double polynomial[PAST + 5] = {0.0}, factorial = order > 1 ? 2.0 : 1.0;  /* coefficients, by Horner's scheme in Newton's form */
    for (int level = 1; level < count; level++)
        for (int i = count - 1; i >= level; i--) values[i] = (values[i] - values[i - 1]) / (times[i] - times[i - level]);
    for (int i = count - 1; i >= 0; i--) {
        for (int k = count; k > 0; k--) polynomial[k] = polynomial[k - 1] - times[i] * polynomial[k];
        polynomial[0] = values[i] - times[i] * polynomial[0];
    }
    for (int k = order; k < order + 4; factorial *= ++k) found[k - order] = k < count ? factorial * polynomial[k] : 0.0;
}

static bool knows_ends_and_mean(const double *row) { return is_known(row[ACCELERATION]) && is_known(row[VELOCITY]); }

/* Which derivative the points are: 0 of the rest, -1 and -2 for its integrals. */
static int point_order(const double *row) { return is_known(row[ACCELERATION]) ? 0 : is_known(row[VELOCITY]) ? 1 : 2; }

/* What the points are of at a row: the acceleration less w times the force, or the velocity or position. */
static double point_value(const double *row, double w) {
    int order = point_order(row);
    return order ? row[order == 1 ? VELOCITY : POSITION] : row[ACCELERATION] - w * row[FORCE];
}

/* What a held force did over a step to a point that is `age` from the step's end: nothing after it. */
static double motion_by_held_force(double held, int order, double h, double age) { return order == 0 ? 0.0 : order == 1 ? held * h : held * h * (0.5 * h + age); }

/* The rest over a step through the points of velocity, position or acceleration only. */
static void rest_through_points(const Pair *p, Cubic f, const double *now, const double *next, double h) {
    int order = point_order(now), most = 2 + order, known = p->point_count < most ? p->point_count : most, first = p->point_count - known;
    double ages[PAST + 1], values[PAST + 1];
    for (int i = 0; i < known; i++) {
        ages[i] = p->points[2 * (first + i)] - now[TIME];
        values[i] = p->points[2 * (first + i) + 1];
    }
    ages[known] = h;
    values[known] = point_value(next, p->inverse_mass[1]) - p->inverse_mass[1] * motion_by_held_force(p->held, order, h, 0.0);
    derivatives_through_points(ages, values, known + 1, order, f);
}

/* Where a row has the forces on the halves, in SI, */
static double *forces_on_halves(double *row) { return row + ACCELERATION + 1; }

/* and their cubics over the step that ends there. */
static double *force_cubics(const Pair *p, double *row) { return forces_on_halves(row) + p->drive.output_count - p->motion.count; }

/* The forces over the coming step: extrapolated, */
static void extrapolate_forces(const Pair *p, double *now, double *next) {
    for (int k = 0; k < p->pushes.count; k++) {
        double *cubic = force_cubics(p, next) + 4 * k;
        set_cubic(cubic, 0.0, 0.0, 0.0, 0.0);
        if (now[H] != 0.0) cubic_after(cubic, force_cubics(p, now) + 4 * k, now[H]);
        cubic[0] = forces_on_halves(now)[k];
    }
}

/* and then the polynomials through their last points and the one at its end. */
static void fit_forces(const Pair *p, const double *now, double *next, double h) {
    int known = (int)p->push_count;
    for (int k = 0; k < p->pushes.count; k++) {
        double ages[PAST], values[PAST];
        for (int i = 0; i < known; i++) ages[i] = p->push_points[i][0] - now[TIME], values[i] = p->push_points[i][1 + k];
        ages[known] = h, values[known] = forces_on_halves(next)[k];
        derivatives_through_points(ages, values, known + 1, 0, force_cubics(p, next) + 4 * k);
    }
}

static void keep_force_points(Pair *p, double *row) {
    int count = (int)p->push_count;
    if (!p->pushes.count) return;
    for (; count == PAST - 1; count--)
        for (int i = 0; i + 1 < count; i++) for (int k = 0; k <= PUSHES; k++) p->push_points[i][k] = p->push_points[i + 1][k];
    p->push_points[count][0] = row[TIME];
    for (int k = 0; k < p->pushes.count; k++) p->push_points[count][1 + k] = forces_on_halves(row)[k];
    p->push_count = count + 1;
}

/* Keep the last points, as though w times the forces held since then had not acted. */
static void keep_motion_point(Pair *p, const double *row) {
    if (knows_ends_and_mean(row) || !p->motion.count) return;
    for (int i = 0; i < p->point_count && row[H] != 0.0; i++)
        p->points[2 * i + 1] += p->inverse_mass[1] * motion_by_held_force(p->held, point_order(row), row[H], p->points[2 * i] - row[TIME]);
    if (p->point_count == PAST) {
        for (int i = 0; i < 2 * PAST - 2; i++) p->points[i] = p->points[i + 2];
        p->point_count--;
    }
    double *point = p->points + 2 * p->point_count++;
    point[0] = row[TIME], point[1] = point_value(row, p->inverse_mass[1]);
}

/* The rest over a step from its ends, its mean, and its first moment. */
static void rest_from_ends(const Pair *p, Cubic f, const double *now, const double *next, double h) {
    double w0 = p->inverse_mass[0], w1 = p->inverse_mass[1];
    double first = now[ACCELERATION] - w0 * now[FORCE], last = next[ACCELERATION] - w1 * next[FORCE];
    double mean = (next[VELOCITY] - now[VELOCITY]) / h - 0.5 * (w0 + w1) * p->held;
    double moment = 0.5 * mean + (last - first) / 12.0;
    if (is_known(now[POSITION])) moment = mean - ((next[POSITION] - now[POSITION]) / h - now[VELOCITY]) / h + (w0 + 0.5 * w1) / 3.0 * p->held;
    fit_cubic(f, first, last, mean, moment, h);
}

static void fit_box_acceleration(const Pair *p, Cubic f, const double *now, const double *next, double h) {
    double w = p->inverse_mass[0], rise = (p->inverse_mass[1] - w) / h;
    Cubic force;
    set_cubic(f, 0.0, 0.0, 0.0, 0.0);
    if (!p->motion.count) return;
    if (knows_ends_and_mean(now)) rest_from_ends(p, f, now, next, h);
    else rest_through_points(p, f, now, next, h);
    if (w == 0.0 && rise == 0.0) return;
    fit_force(force, now, next, h);
    for (int i = 0; i < 4; i++) f[i] += w * force[i] + (i ? i * rise * force[i - 1] : 0.0);
}

/* Extrapolate the box acceleration over the coming step. */
static void extrapolate_box_acceleration(Cubic f, const double *now) {
    set_cubic(f, 0.0, 0.0, 0.0, 0.0);
    if (now[H] != 0.0) cubic_after(f, now + THEN, now[H]);
    if (is_known(now[ACCELERATION])) f[0] = now[ACCELERATION];
}

/* -- a step -- */

/* A force, and the drive's other inputs. */
static bool set_force_and_inputs(Pair *p, const double *inputs, const Cubic force) {
    double *values = p->scratch;
    int n = p->force.count;
    for (int i = 0; i < n; i++) values[i] = force[p->force.places[i]] / p->force.scales[i];
    for (size_t i = n; i < p->drive.input_count; i++) values[i] = inputs[i - n];
    return set_inputs(&p->drive, values);
}

/* Reads the drive's outputs under the force at a row's end, a time h after its inputs were set. */
static bool read_drive(Pair *p, double *row, const double *inputs, double h) {
    int known = p->motion.count;
    double force[4] = {row[FORCE]}, box[3], *later = p->scratch + p->drive.input_count, *read = row + POSITION + 3 - known;
    if (p->cubic >= 0 && h != 0.0) {
        size_t own = p->drive.input_count - p->force.count;
        for (size_t i = 0; i < own; i++) later[i] = inputs[i];
        for (size_t i = p->cubic; i < own; i += 4) cubic_after(later + i, inputs + i, h);
        inputs = later;
    }
    if (!set_force_and_inputs(p, inputs, force) || !read_outputs(&p->drive, read)) return false;
    for (int i = 0; i < known; i++) box[i] = read[i];
    for (int i = 0; i < 3; i++) row[POSITION + i] = __builtin_nan("");
    for (int i = 0; i < known; i++) row[POSITION + p->motion.places[i]] = p->motion.scales[i] * box[i];
    for (int k = 0; k < p->pushes.count; k++) forces_on_halves(row)[k] *= p->pushes.scales[k];
    return true;
}

/* Reads the drive, and w, its acceleration with 1 N more less that without. */
static bool read_drive_and_mass(Pair *p, double *row, const double *inputs, double h, double *w) {
    double force = row[FORCE], more = 0.0;
    bool tries = is_force_held(p) && p->motion.count && p->motion.places[p->motion.count - 1] == ACCELERATION - POSITION;
    if (tries) {
        row[FORCE] = force + 1.0;
        if (!read_drive(p, row, inputs, h)) return false;
        row[FORCE] = force, more = row[ACCELERATION];
    }
    if (!read_drive(p, row, inputs, h)) return false;
    if (tries) *w = more - row[ACCELERATION];
    return true;
}

static size_t first_input_column(const Pair *p) { return ACCELERATION + 1 + p->drive.output_count - p->motion.count + 4 * p->pushes.count; }

static bool advance_oscillator(Pair *p, const double *now, double *next, const Cubic acceleration, double h) {
    double values[4 * (1 + PUSHES)];
    for (int i = 0; i < 4; i++) values[i] = acceleration[i];
    for (int i = 0; i < 4 * p->pushes.count; i++) values[4 + i] = force_cubics(p, next)[i];
    return set_inputs(&p->oscillator, values) && advance_side(&p->oscillator, now[TIME], h) && read_outputs(&p->oscillator, next + MOTION);
}

static bool restore_both(Pair *p) { return restore_side(&p->oscillator) && restore_side(&p->drive); }

/* Go back behind a step that the drive did not do. */
static bool go_back_after_discard(Pair *p) {
    p->drive.fmi.status = 0;
    return restore_both(p);
}

static double relative_defect(const double *now, const double *next) {
    double taken = next[WORK] - now[WORK], given = next[ENERGY] - now[ENERGY];
    double exchanged = magnitude(taken) + magnitude(given);
    return exchanged != 0.0 ? magnitude(taken - next[GIVEN]) / exchanged : 0.0;
}

/* A step from `now` to `next`; where it is refused for its defect, both sides have gone back. */
static bool try_step(Pair *p, double *now, double *next, double h, bool may_refuse, double *defect, bool *refused) {
    int passes = now[H] == 0.0 ? p->first_passes : 1;
    const double *inputs = now + first_input_column(p);
    double *w = p->inverse_mass, given;
    Cubic acceleration, force;
    if (!save_side(&p->oscillator) || ((may_refuse || passes > 1) && !save_side(&p->drive))) return false;
    extrapolate_box_acceleration(acceleration, now);
    extrapolate_forces(p, now, next);
    for (int i = 0; i < passes; i++) {
        if (i && !restore_both(p)) return false;
        if (!advance_oscillator(p, now, next, acceleration, h)) return false;
        force_for_drive(p, force, now, next, h);
        if (!set_force_and_inputs(p, inputs, force)) return false;
        if (!advance_side(&p->drive, now[TIME], h)) {
            *refused = may_refuse && p->halves_discarded && p->drive.fmi.status == DISCARD;
            return *refused && go_back_after_discard(p);
        }
        if (!read_drive_and_mass(p, next, inputs, h, w + 1)) return false;
        fit_box_acceleration(p, acceleration, now, next, h);
        fit_forces(p, now, next, h);
    }
    given = next[FORCE];
    if (w[0] != 0.0 || w[1] != 0.0) {  /* w times the force of the motion that is nearly the last one */
        if (!restore_side(&p->oscillator) || !advance_oscillator(p, now, next, acceleration, h)) return false;
        next[ACCELERATION] += w[1] * (next[FORCE] - given);
        fit_box_acceleration(p, acceleration, now, next, h);
    }
    if (!restore_side(&p->oscillator) || !advance_oscillator(p, now, next, acceleration, h) || !read_drive(p, next, inputs, h)) return false;
    fit_force(force, now, next, h);
    next[GIVEN] = work_of_force(force, now[VELOCITY], acceleration, h);
    *defect = p->tolerance != 0.0 ? relative_defect(now, next) : 0.0;
    *refused = may_refuse && p->tolerance != 0.0 && *defect > p->tolerance;
    if (*refused) return restore_both(p);
    next[TIME] = now[TIME] + h, next[H] = h, next[LEVEL] = now[LEVEL];
    for (int i = 0; i < 4; i++) next[THEN + i] = acceleration[i];
    if (is_force_held(p)) note_owed_momentum(p, next, h);
    keep_motion_point(p, next);
    keep_force_points(p, next);
    w[0] = w[1];
    return count_impacts(&p->oscillator, next + IMPACTS);
}

/* An interval in steps, the row after each of them: `*at` is the last that there is. */
static bool run_interval(Pair *p, double *now, double **at, size_t width, const double *inputs, double h) {
    size_t first = first_input_column(p);
    int halvings = p->tolerance != 0.0 || p->halves_discarded ? p->halvings : 0, level = p->tolerance != 0.0 ? (int)now[LEVEL] : 0, done = 0;
    double end = now[TIME] + h, defect;
    bool known = p->cubic < 0, refused;
    for (size_t i = first; i < width; i++) known = known && now[i] == inputs[i - first];
    for (size_t i = first; i < width; i++) now[i] = inputs[i - first];
    double before = now[ACCELERATION], pushed[PUSHES] = {0.0};
    for (int k = 0; k < p->pushes.count; k++) pushed[k] = forces_on_halves(now)[k];
    if (!known && !read_drive(p, now, inputs, 0.0)) return false;
    for (int i = 0; i < p->point_count && is_known(before); i++) p->points[2 * i + 1] += now[ACCELERATION] - before;  /* a jump of the inputs is none of the motion */
    for (int i = 0; i < (int)p->push_count; i++) for (int k = 0; k < p->pushes.count; k++) p->push_points[i][1 + k] += forces_on_halves(now)[k] - pushed[k];
    if (now[H] == 0.0 && p->point_count == 0) {
        if (!read_drive_and_mass(p, now, inputs, 0.0, p->inverse_mass + 1)) return false;
        p->inverse_mass[0] = p->inverse_mass[1];
        keep_motion_point(p, now);
        p->push_count = 0.0;
        keep_force_points(p, now);
    }
    while (done < 1 << halvings) {
        int size = (1 << halvings) >> level;
        double *next = *at + width;
        for (size_t i = first; i < width; i++) next[i] = now[i];
        if (!try_step(p, now, next, h / (1 << level), level < halvings, &defect, &refused)) return false;
        if (refused) {
            level++;
        } else {
            done += size;
            *at = next;
            for (size_t i = 0; i < width; i++) now[i] = next[i];
            for (size_t i = first + p->cubic; p->cubic >= 0 && level && i < width; i += 4) cubic_after(now + i, now + i, h / (1 << level));
            if (defect < p->tolerance * p->easy && done % (2 * size) == 0 && level) level--;
        }
        now[LEVEL] = level;
    }
    (*at)[TIME] = now[TIME] = end;
    return true;
}

/* What is recorded of the drive at a row's end, under the force and the inputs there. */
static bool record_drive(Pair *p, const double *row, const double *inputs) {
    double force[4] = {row[FORCE]};
    if (!set_force_and_inputs(p, inputs, force) || !get_reals(&p->drive.fmi, p->recorded, p->recorded_count, p->table, p->recorded_count)) return false;
    p->table += p->recorded_count;
    return true;
}

/* Intervals from the state `now` on, which becomes that at the end: a row for each step after the
 * first row, and the row at which each interval ends. Returns how many there are: all, unless a call
 * failed or an FMU ended the simulation. The inputs of an interval are followed by those at its end,
 * where something is recorded. */
EXPORT int couple(Pair *p, double *now, double *rows, int *ends, const double *inputs, int count, double h) {
    size_t own = p->drive.input_count - p->force.count, width = first_input_column(p) + own;
    double *at = rows;
    p->oscillator.fmi.status = p->drive.fmi.status = 0;
    for (int i = 0; i < count; i++, inputs += p->stride) {
        if (p->oscillator.answer->terminate || p->drive.answer->terminate) return i;
        if (!run_interval(p, now, &at, width, inputs, h)) return i;
        if (p->recorded_count && !record_drive(p, now, inputs + own)) return i;
        ends[i] = (int)((size_t)(at - rows) / width);
    }
    return count;
}

/* Revolutions of the motor that are complete at the ends of intervals: of each the row, time, mean speed, and impacts. Rows are `along` values apart, columns
 * `across`. `last` has the full turns, time and impacts at the beginning of the present one. Returns how many there are. */
EXPORT int find_revolutions(const double *values, size_t along, size_t across, const int *ends, int count, double *last, double (*found)[4]) {
    int done = 0;
    for (int i = 0; i < count; i++) {
        const double *row = values + (size_t)ends[i] * along;
        double angle = row[ANGLE * across], turns = angle / TURN, turn = (double)(int64_t)turns, impacts = row[IMPACTS * across];
        if (magnitude(turns - last[0]) < 1.0) continue;
        if (turns > last[0] ? turn > turns : turn < turns) turn += turns > last[0] ? -1.0 : 1.0;
        double time = row[TIME * across] - (angle - turn * TURN) / row[SPEED * across];
        double *now = found[done++];
        now[0] = ends[i], now[1] = time, now[2] = (turn - last[0]) * TURN / (time - last[1]), now[3] = impacts - last[2];
        last[0] = turn, last[1] = time, last[2] = impacts;
    }
    return done;
}
