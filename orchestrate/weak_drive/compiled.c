/* The master's communication steps between two FMI 3.0 instances, compiled.
 *
 * master.py, polynomials.py, energy_balance.py and extremes.py say what is done and why; here is the same, operation by operation, so the bits are the
 * same. compiled.py has the same structures for ctypes. No library is needed, nothing is allocated.
 */
#include <stdbool.h>
#include <stddef.h>

#include "token.h"

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#define TERMS 8  /* extremes.py: derivatives of the series */

EXPORT const char token[] = TOKEN;  /* of these sources: tells their library from others */

typedef double Cubic[4];

typedef struct { double x1, x2, v1, v2, box_force, box_impulse, box_impulse_moment, impact_energy, impact_time, x_rel; } Motion;
typedef struct {
    double box_position, box_velocity, box_acceleration, box_jerk, angle, speed, motor_energy, box_damper_energy, box_force_work, stored_energy;
} Shaking;

typedef struct {  /* as Master.get_state() returns it */
    double time, voltage, slope, force_before, h_before, acceleration_before, jerk_before, level;
    Motion motion;
    Shaking shaking;
    double lost, defect, defect_sizes, start[5];
} Memory;

typedef struct { double turn, time, impacts, x1_high, x1_low, box_high, box_low, acceleration; } Revolution;

typedef struct {
    void *instance;
    int (*set)(void *, const unsigned *references, size_t count, const double *values, size_t value_count);
    int (*get)(void *, const unsigned *references, size_t count, double *values, size_t value_count);
    int (*step)(void *, double time, double h, bool, bool *, bool *, bool *, double *);
    int (*save)(void *, void **state);
    int (*restore)(void *, void *state);
    const unsigned *inputs, *outputs;
    size_t input_count, output_count;
    void **kept;  /* its state at the step's beginning */
    const char *failed;  /* the function that did not answer OK */
    int status;
} Side;

typedef struct {
    Side oscillator, shaker;
    double m1, m2, k1, k2, d1, d2;
    double preload, rest_1, rest_2, balance;
    double tolerance, easy, converged;
    int passes, terms, iterations, matched, halvings;
    int part_count;
    const int *parts;  /* of the first step, where no algorithm goes back */
} Pair;

EXPORT const unsigned sizes[] = {sizeof(Pair), sizeof(Memory), sizeof(Revolution)};  /* compiled.py has to have the same */

typedef struct { Cubic acceleration; Motion motion; Shaking shaking; } Step;

/* -- calls of the FMUs: true where they answer OK -- */

static bool answered(Side *side, const char *function, int status) {
    if (!status) return true;
    side->failed = function;
    side->status = status;
    return false;
}

static bool put(Side *s, const double *values) {
    return answered(s, "fmi3SetFloat64", s->set(s->instance, s->inputs, s->input_count, values, s->input_count));
}

static bool get(Side *s, void *values) {
    return answered(s, "fmi3GetFloat64", s->get(s->instance, s->outputs, s->output_count, values, s->output_count));
}

static bool advance(Side *s, double time, double h) {
    bool event, terminate, early;
    double last;
    return answered(s, "fmi3DoStep", s->step(s->instance, time, h, false, &event, &terminate, &early, &last));
}

static bool save(Side *s) { return answered(s, "fmi3GetFMUState", s->save(s->instance, s->kept)); }

static bool restore(Side *s) { return answered(s, "fmi3SetFMUState", s->restore(s->instance, *s->kept)); }

static bool put_force(Side *shaker, double f0, double f1, double f2, double f3, double voltage) {
    double values[] = {f0, f1, f2, f3, voltage};
    return put(shaker, values);
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

static void parabola(Cubic f, double before, double first, double last, double h_before, double h) {
    double rise = (last - first) / h;
    if (h_before == 0.0) {
        set_cubic(f, first, rise, 0.0, 0.0);
        return;
    }
    double curve = (rise - (first - before) / h_before) / (h + h_before);
    set_cubic(f, first, rise - curve * h, 2.0 * curve, 0.0);
}

static double end_value(const Cubic f, double h) { return f[0] + h * (f[1] + 0.5 * h * (f[2] + h * f[3] / 3.0)); }

static double end_slope(const Cubic f, double h) { return f[1] + h * (f[2] + 0.5 * h * f[3]); }

static void coefficients(Cubic c, const Cubic f, double h) { set_cubic(c, f[0], f[1] * h, f[2] * h * h / 2.0, f[3] * h * h * h / 6.0); }

static double product(const double *f, int f_count, const double *g, int g_count) {
    double total = 0.0;
    for (int i = 0; i < f_count; i++) for (int k = 0; k < g_count; k++) total += f[i] * g[k] / (i + k + 1.0);
    return total;
}

static double work(const Cubic force, double velocity, const Cubic a, double h) {
    double speeds[5] = {velocity, a[0] * h, a[1] * h * h / 2.0, a[2] * h * h * h / 6.0, a[3] * h * h * h * h / 24.0};
    Cubic f;
    coefficients(f, force, h);
    return h * product(f, 4, speeds, 5);
}

static void quartic(double f[5], double p0, double p1, double d0, double d1, double mean) {
    double rise = p1 - p0;
    double q = 30.0 * (mean - 0.5 * (p0 + p1) - (d0 - d1) / 12.0);
    f[0] = p0, f[1] = d0, f[2] = 3.0 * rise - 2.0 * d0 - d1 + q, f[3] = d0 + d1 - 2.0 * rise - 2.0 * q, f[4] = q;
}

/* -- energy_balance.py -- */

static double relative_energy(const Pair *p, const Motion *m) {
    double x1 = m->x1 - p->rest_1, x2 = m->x2 - p->rest_2;
    double own = 0.5 * (p->m1 * m->v1 * m->v1 + p->m2 * m->v2 * m->v2 + p->k1 * x1 * x1 + p->k2 * x2 * x2);
    return own + p->preload * m->x_rel;
}

static void enter(const Pair *p, Memory *now, const Step *done, double defect, double h) {
    const Motion *before = &now->motion, *after = &done->motion;
    double mass = p->m1 + p->m2;
    double p0 = p->m1 * before->v1 + p->m2 * before->v2, p1 = p->m1 * after->v1 + p->m2 * after->v2;
    double first = -h * (before->box_force + mass * done->acceleration[0]);
    double last = -h * (after->box_force + mass * end_value(done->acceleration, h));
    double mean = (p->m1 * (after->x1 - before->x1) + p->m2 * (after->x2 - before->x2)) / h;
    double momentum[5];
    Cubic told;
    quartic(momentum, p0, p1, first, last, mean);
    coefficients(told, done->acceleration, h);
    double given = h * product(momentum, 5, told, 4);
    now->lost += relative_energy(p, before) - relative_energy(p, after) - given;
    now->defect += defect;
    now->defect_sizes += size_of(defect);
}

/* -- extremes.py -- */

typedef struct { double low, high; } Range;

static void reach(Range *r, double position) {
    if (position < r->low) r->low = position;
    if (position > r->high) r->high = position;
}

static double value(const double *series, int count, double time, int order) {
    double total = 0.0;
    for (int power = count - 1 - order; power >= 0; power--) total = series[power + order] + total * time / (power + 1);
    return total;
}

static void taylor_coefficients(double series[TERMS + 1], const Pair *p, const Motion *m, const Cubic told) {
    double mass = p->m1, stiffness = p->k1, damping = p->d1, balance = 0.0;
    if (m->x_rel == 0.0 && m->v1 == m->v2) {
        mass = mass + p->m2, stiffness = stiffness + p->k2, damping += p->d2;
        balance = p->balance;
    }
    series[0] = m->x1 - balance, series[1] = m->v1;
    for (int order = 0; order < TERMS - 1; order++) {
        double pull = (damping * series[order + 1] + stiffness * series[order]) / mass;
        series[order + 2] = -pull - (order < 4 ? told[order] : 0.0);
    }
    series[0] = m->x1;
}

static void extrema(Range *r, const double *series, int count, double first, double last) {
    double begin = value(series, count, first, 1), end = value(series, count, last, 1);
    reach(r, value(series, count, first, 0));
    reach(r, value(series, count, last, 0));
    if (!(begin * end < 0.0)) return;
    double time = first + (last - first) * begin / (begin - end);
    for (int i = 0; i < 3; i++) {
        double slope = value(series, count, time, 2);
        time -= slope != 0.0 ? value(series, count, time, 1) / slope : 0.0;
    }
    if (first <= time && time <= last) reach(r, value(series, count, time, 0));
}

static Range range_of_mass(const Pair *p, const Memory *now, const Step *done, double h) {
    const Motion *before = &now->motion, *after = &done->motion;
    Range r = {before->x1, before->x1};
    reach(&r, after->x1);
    double hit = after->impact_time - now->time, series[TERMS + 1];
    bool impact = after->impact_time != before->impact_time && 0.0 <= hit && hit <= h;
    if (!impact && !(before->v1 * after->v1 < 0.0)) return r;
    taylor_coefficients(series, p, before, done->acceleration);
    extrema(&r, series, TERMS + 1, 0.0, impact ? hit : h);
    if (impact) {
        const double *told = done->acceleration;
        Cubic end = {end_value(told, h), end_slope(told, h), told[2] + h * told[3], told[3]};
        taylor_coefficients(series, p, after, end);
        extrema(&r, series, TERMS + 1, hit - h, 0.0);
    }
    return r;
}

static Range range_of_box(const Memory *now, const Step *done, double h) {
    const Shaking *before = &now->shaking, *after = &done->shaking;
    const double *told = done->acceleration;
    Range r = {before->box_position, before->box_position};
    reach(&r, after->box_position);
    if (before->box_velocity * after->box_velocity < 0.0) {
        double series[6] = {before->box_position, before->box_velocity, told[0], told[1], told[2], told[3]};
        extrema(&r, series, 6, 0.0, h);
    }
    return r;
}

static void look_back(const Pair *p, Revolution *r, const Memory *now, const Step *done, double h) {
    Range x = range_of_mass(p, now, done, h), y = range_of_box(now, done, h);
    double acceleration = size_of(done->shaking.box_acceleration);
    if (x.high > r->x1_high) r->x1_high = x.high;
    if (x.low < r->x1_low) r->x1_low = x.low;
    if (y.high > r->box_high) r->box_high = y.high;
    if (y.low < r->box_low) r->box_low = y.low;
    if (acceleration > r->acceleration) r->acceleration = acceleration;
}

/* -- master.py: what each side assumes of the other -- */

static void force_of(Cubic f, const Memory *now, const Motion *after, double h) {
    matched_cubic(f, now->motion.box_force, after->box_force, after->box_impulse / h, after->box_impulse_moment / (h * h), h);
}

static void told_force(Cubic f, const Pair *p, const Memory *now, const Motion *after, double h) {
    if (p->matched) force_of(f, now, after, h);
    else parabola(f, now->force_before, now->motion.box_force, after->box_force, now->h_before, h);
}

static void told_acceleration(Cubic f, const Pair *p, const Memory *memory, const Shaking *after, double h) {
    const Shaking *now = &memory->shaking;
    double first = now->box_acceleration, last = after->box_acceleration;
    if (!p->matched) {
        parabola(f, memory->acceleration_before, first, last, memory->h_before, h);
        return;
    }
    double mean = (after->box_velocity - now->box_velocity) / h;
    double moment = mean - ((after->box_position - now->box_position) / h - now->box_velocity) / h;
    matched_cubic(f, first, last, mean, moment, h);
}

static void extrapolated_acceleration(Cubic f, const Pair *p, const Memory *now) {
    double first = now->shaking.box_acceleration, jerk = now->shaking.box_jerk, h = now->h_before;
    if (p->terms == 1) {
        set_cubic(f, first, 0.0, 0.0, 0.0);
        return;
    }
    if (p->terms == 2 || h == 0.0) {
        set_cubic(f, first, jerk, 0.0, 0.0);
        return;
    }
    double bend = (now->acceleration_before - first + jerk * h) / (h * h);
    if (p->terms == 3) {
        set_cubic(f, first, jerk, 2.0 * bend, 0.0);
        return;
    }
    double twist = ((now->jerk_before - jerk) / h + 2.0 * bend) / h;
    set_cubic(f, first, jerk, 2.0 * (bend + twist * h), 6.0 * twist);
}

/* -- master.py: the schemes -- */

static bool both_at_once(Pair *p, const Memory *now, double h, Step *done) {
    double force = now->motion.box_force, h_before = now->h_before;
    double slope = p->terms > 1 && h_before != 0.0 ? (force - now->force_before) / h_before : 0.0;
    extrapolated_acceleration(done->acceleration, p, now);
    return put(&p->oscillator, done->acceleration) && advance(&p->oscillator, now->time, h)
        && put_force(&p->shaker, force, slope, 0.0, 0.0, now->voltage) && advance(&p->shaker, now->time, h)
        && get(&p->oscillator, &done->motion) && get(&p->shaker, &done->shaking);
}

static bool both_once(Pair *p, const Memory *now, double h, Step *done, Cubic force) {
    if (!put(&p->oscillator, done->acceleration) || !advance(&p->oscillator, now->time, h) || !get(&p->oscillator, &done->motion)) return false;
    told_force(force, p, now, &done->motion, h);
    return put_force(&p->shaker, force[0], force[1], force[2], force[3], now->voltage) && advance(&p->shaker, now->time, h);
}

static bool same(double a, double b, double limit) { return size_of(a - b) <= limit * (size_of(a) + size_of(b)); }

static bool settled(const Pair *p, const Motion *now, const Motion *last) {
    return same(now->box_force, last->box_force, p->converged) && same(now->box_impulse, last->box_impulse, p->converged)
        && same(now->box_impulse_moment, last->box_impulse_moment, p->converged);
}

static bool one_after_the_other(Pair *p, const Memory *now, double h, Step *done) {
    int passes = p->passes;
    Motion last;
    Cubic force;
    if (passes > 1) {
        if (!save(&p->oscillator) || !save(&p->shaker)) return false;
        if (now->h_before == 0.0) passes = p->iterations;
    }
    extrapolated_acceleration(done->acceleration, p, now);
    for (int i = 0; i < passes; i++) {
        if (i && (!restore(&p->oscillator) || !restore(&p->shaker))) return false;
        if (!both_once(p, now, h, done, force)) return false;
        if (i + 1 == passes || (i && settled(p, &done->motion, &last))) break;
        last = done->motion;
        if (!put_force(&p->shaker, last.box_force, end_slope(force, h), 0.0, 0.0, now->voltage) || !get(&p->shaker, &done->shaking)) return false;
        told_acceleration(done->acceleration, p, now, &done->shaking, h);
    }
    return get(&p->shaker, &done->shaking);
}

/* -- master.py: a step -- */

/* The shaker's outputs with the force at the present point, and its slope, as inputs. */
static bool look(Pair *p, Memory *now) {
    return put_force(&p->shaker, now->motion.box_force, now->slope, 0.0, 0.0, now->voltage) && get(&p->shaker, &now->shaking);
}

static bool go_on(Pair *p, Memory *now, Revolution *revolution, const Step *done, double h) {
    if (revolution) look_back(p, revolution, now, done, h);
    now->jerk_before = now->h_before != 0.0 ? now->shaking.box_jerk : done->acceleration[1];
    now->acceleration_before = now->shaking.box_acceleration;
    now->force_before = now->motion.box_force;
    now->h_before = h;
    now->time += h;
    now->motion = done->motion;
    return look(p, now);
}

/* A step, unless it is refused for its defect; `size` is that over the work exchanged in it. */
static bool step(Pair *p, Memory *now, Revolution *revolution, double voltage, double h, bool may_refuse, double *size) {
    if (voltage != now->voltage) {
        now->voltage = voltage;
        if (!look(p, now)) return false;
    }
    Step done;
    if (!(p->passes ? one_after_the_other : both_at_once)(p, now, h, &done)) return false;
    Cubic force;
    force_of(force, now, &done.motion, h);
    double taken = done.shaking.box_force_work - now->shaking.box_force_work;
    double defect = taken - work(force, now->shaking.box_velocity, done.acceleration, h);
    double given = done.shaking.motor_energy - now->shaking.motor_energy;
    double exchanged = size_of(taken) + size_of(given);
    *size = exchanged != 0.0 ? size_of(defect) / exchanged : 0.0;
    if (may_refuse && *size > p->tolerance) return restore(&p->oscillator) && restore(&p->shaker);
    now->slope = end_slope(force, h);
    enter(p, now, &done, defect, h);
    return go_on(p, now, revolution, &done, h);
}

static bool parts_by_defect(Pair *p, Memory *now, Revolution *revolution, double voltage, double h) {
    int most = 1 << p->halvings, done = 0, level = (int)now->level;
    while (done < most) {
        int size = most >> level;
        double last_impact = now->motion.impact_time, defect;
        bool may_refuse = level < p->halvings;
        if (!step(p, now, revolution, voltage, h / (1 << level), may_refuse, &defect)) return false;
        if (defect > p->tolerance && may_refuse) {
            now->level = ++level;
            continue;
        }
        done += size;
        if (defect < p->tolerance * p->easy && done % (2 * size) == 0 && level) now->level = --level;
        if (now->motion.impact_time != last_impact) {
            now->slope = now->h_before = 0.0;
            if (!look(p, now)) return false;
        }
    }
    return true;
}

static bool first_parts(Pair *p, Memory *now, Revolution *revolution, double voltage, double h) {
    int sum = 0;
    double size;
    for (int i = 0; i < p->part_count; i++) sum += p->parts[i];
    for (int i = 0; i < p->part_count; i++) if (!step(p, now, revolution, voltage, h * p->parts[i] / sum, false, &size)) return false;
    return true;
}

static bool interval(Pair *p, Memory *now, Revolution *revolution, double voltage, double h) {
    double begin = now->time, size;
    bool known = now->h_before != 0.0 || p->passes > 1;
    bool fine = p->tolerance != 0.0 ? parts_by_defect(p, now, revolution, voltage, h)
        : known ? step(p, now, revolution, voltage, h, false, &size)
        : first_parts(p, now, revolution, voltage, h);
    now->time = begin + h;
    return fine;
}

/* Intervals from `first` on, up to the one that completes a revolution; where the next begins, or -1 after a failure.
 * `revolution` and `kept`, the memory after each interval, may be NULL. */
EXPORT int run(Pair *p, Memory *now, Revolution *revolution, const double *voltages, int first, int count, double h, Memory *kept) {
    p->oscillator.status = p->shaker.status = 0;
    for (int i = first; i < count; i++) {
        if (!interval(p, now, revolution, voltages[i], h)) return -1;
        if (kept) kept[i] = *now;
        if (!revolution) continue;
        double angle = now->shaking.angle / 6.283185307179586;
        if (angle >= revolution->turn + 1.0 || angle <= revolution->turn - 1.0) return i + 1;
    }
    return count;
}
