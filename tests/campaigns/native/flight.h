/* Flights by a seed, their motion in closed form by Newton's law, and the FMU that flies them.
   Nothing of the motion comes from the kernel: each mass is a sum of complex exponentials and a cubic. */
#ifndef FLIGHT_H
#define FLIGHT_H

#include <complex.h>
#include <math.h>

#include "version.h"

enum { GRAZING, EQUAL, CHATTERING, FAST, CUBIC, STEEP, CONTACT, KINDS };
enum { TERMS = 5, BOX = 4 };
static const double GAMMA = 1e-9; /* the smallest there is: the longest chattering */
static const char *const KIND[KINDS] = {"near grazing", "nearly equal oscillators", "chattering", "high eta", "cubic inputs", "steep damping", "long contact"};
static const double HORIZON[KINDS] = {12.0, 12.0, 12.0, 6.0, 12.0, 3.0, 60.0}; /* s */

/* One flight or contact: parameters, inputs and the state that it begins with, from unloaded springs; ``closed`` where it has no gap. */
typedef struct {
    int kind;
    bool closed;
    double m1, m2, k1, k2, d1, d2, e, amplitude, frequency, phase, box[BOX], x1, x2, v1, v2, clearance, e_slope;
} Flight;

/* Re sum c_k e^{s_k t} + sum p_k t^k / k!; and the sizes of what c_0 and p are differences of, for these may cancel. */
typedef struct {
    double complex c[TERMS], s[TERMS];
    double p[BOX], forced, pushed[BOX];
} Signal;

/* splitmix64: every seed is a good one. */
static inline uint64_t next(uint64_t *seed) {
    uint64_t z = (*seed += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

static inline double uniform(uint64_t *seed, double low, double high) { return low + (high - low) * (double)(next(seed) >> 11) * 0x1p-53; }
static inline double decades(uint64_t *seed, double low, double high) { return low * exp(uniform(seed, 0.0, 1.0) * log(high / low)); }
static inline bool chance(uint64_t *seed, double share) { return uniform(seed, 0.0, 1.0) < share; }
static inline double either(uint64_t *seed) { return next(seed) & 1u ? 1.0 : -1.0; }

/* Add one mass's motion to a signal: two free terms at ``place``, the forced one in term 0. */
static void add_mass(Signal *to, double m, double d, double k, double x, double v, const Flight *f, double sign, int place) {
    double w = f->frequency;
    double complex forced = -I * f->amplitude * w * w * cexp(I * f->phase) / CMPLX(k / m - w * w, w * d / m);
    double q[BOX + 2] = {0.0};
    for (int i = BOX - 1; i >= 0; i--) q[i] = (-m * f->box[i] - d * q[i + 1] - m * q[i + 2]) / k;
    double complex split = csqrt(CMPLX(0.25 * d * d / (m * m) - k / m, 0.0));
    double complex slow = -0.5 * d / m + split, fast = -0.5 * d / m - split;
    double left = x - creal(forced) - q[0], speed = v - creal(I * w * forced) - q[1];
    to->c[0] += sign * forced;
    to->s[0] = CMPLX(0.0, w);
    to->c[place] = sign * (speed - fast * left) / (slow - fast), to->s[place] = slow;
    to->c[place + 1] = sign * (slow * left - speed) / (slow - fast), to->s[place + 1] = fast;
    to->forced += cabs(forced);
    for (int i = 0; i < BOX; i++) to->p[i] += sign * q[i], to->pushed[i] += fabs(q[i]);
}

static Signal gap_of(const Flight *f) {
    Signal gap = {0};
    add_mass(&gap, f->m1, f->d1, f->k1, f->x1, f->v1, f, -1.0, 1);
    add_mass(&gap, f->m2, f->d2, f->k2, f->x2, f->v2, f, 1.0, 3);
    gap.p[0] += f->clearance, gap.pushed[0] += fabs(f->clearance);
    return gap;
}

/* Where the springs balance with both masses together, from unloaded ones: of mass 1 and of mass 2. */
static double rest_1(const Flight *f) { return f->clearance * f->k2 / (f->k1 + f->k2); }
static double rest_2(const Flight *f) { return -f->clearance * f->k1 / (f->k1 + f->k2); }

/* The force that keeps both together, over m1 m2/(m1 + m2): positive in contact. Both masses move as one. */
static Signal push_of(const Flight *f) {
    Signal push = {0};
    add_mass(&push, f->m1 + f->m2, f->d1 + f->d2, f->k1 + f->k2, f->x1 - rest_1(f), f->v1, f, 1.0, 1);
    double by_speed = f->d2 / f->m2 - f->d1 / f->m1, by_place = f->k2 / f->m2 - f->k1 / f->m1;
    push.forced *= fabs(by_speed) * f->frequency + fabs(by_place);
    for (int i = 0; i < TERMS; i++) push.c[i] *= by_speed * push.s[i] + by_place;
    for (int i = 0; i < BOX; i++) push.pushed[i] = fabs(by_place) * push.pushed[i] + (i + 1 < BOX ? fabs(by_speed) * push.pushed[i + 1] : 0.0);
    for (int i = 0; i < BOX; i++) push.p[i] = by_place * push.p[i] + (i + 1 < BOX ? by_speed * push.p[i + 1] : 0.0);
    double held = f->k2 * rest_2(f) / f->m2 - f->k1 * rest_1(f) / f->m1;
    push.p[0] += held, push.pushed[0] += fabs(held);
    return push;
}

/* Value and two derivatives. */
static void value_of(const Signal *f, double t, double out[3]) {
    out[0] = f->p[0] + t * (f->p[1] + 0.5 * t * (f->p[2] + t * f->p[3] / 3.0));
    out[1] = f->p[1] + t * (f->p[2] + 0.5 * t * f->p[3]);
    out[2] = f->p[2] + t * f->p[3];
    for (int i = 0; i < TERMS; i++) {
        double complex term = f->c[i] * cexp(f->s[i] * t);
        out[0] += creal(term);
        out[1] += creal(f->s[i] * term);
        out[2] += creal(f->s[i] * f->s[i] * term);
    }
}

/* Sizes that rounding is measured by: of the terms, and of the rates. */
static double size_of(const Signal *f, double stop) {
    double size = f->forced, power = 1.0;
    for (int i = 1; i < TERMS; i++) size += cabs(f->c[i]);
    for (int i = 0; i < BOX; i++, power *= stop) size += f->pushed[i] * power;
    return size;
}

static double fastest_of(const Signal *f) {
    double fastest = 0.0;
    for (int i = 0; i < TERMS; i++) fastest = fmax(fastest, cabs(f->s[i]));
    return fastest;
}

static double bottom_of(const Signal *f, double t) {
    double at[3];
    for (int i = 0; i < 4; i++) {
        value_of(f, t, at);
        if (at[2] > 0.0) t -= at[1] / at[2];
    }
    return t;
}

/* Move mass 2 so that the gap's first minimum is ``depth``, where it has one. */
static void graze(Flight *f, double depth) {
    enum { POINTS = 240 };
    for (int round = 0; round < 4; round++) {
        Signal gap = gap_of(f);
        double at[3], before = -1.0, low = -1.0;
        for (int i = 1; i <= POINTS && low < 0.0; i++) {
            value_of(&gap, HORIZON[GRAZING] * i / POINTS, at);
            if (i > 1 && before < 0.0 && at[1] >= 0.0) low = bottom_of(&gap, HORIZON[GRAZING] * (i - 1) / POINTS);
            before = at[1];
        }
        if (low <= 0.0) return;
        double half = 0.5 * f->d2 / f->m2, nu = sqrt(fabs(f->k2 / f->m2 - half * half));
        double lift = exp(-half * low) * (cos(nu * low) + half * sin(nu * low) / nu);
        if (fabs(lift) < 0.1) return;
        value_of(&gap, low, at);
        double moved = f->x2 + (depth - at[0]) / lift;
        if (!(moved + f->clearance > f->x1 && moved < 10.0)) return;
        f->x2 = moved;
    }
}

/* Near critical damping the two exponentials cancel, and this closed form, not the FMU's, loses digits. */
static void apart_from_critical(double *d, double m, double k) {
    if (fabs(*d * *d / (4.0 * m * k) - 1.0) < 0.1) *d *= 0.8;
}

/* From start positions, which count from rest, to positions from unloaded springs. */
static void place(Flight *f) {
    f->closed = f->x2 == f->x1;
    if (f->clearance < 0.0) f->x1 += rest_1(f), f->x2 += rest_2(f);
    else f->x2 -= f->clearance;
}

/* Any flight, then what makes it one of its kind. Half of them have a clearance, one way or the other. */
static Flight draw(uint64_t *seed, int kind) {
    bool unit = chance(seed, 0.5);
    Flight f = {.kind = kind, .m1 = unit ? 1.0 : decades(seed, 0.1, 10.0), .k1 = unit ? 1.0 : decades(seed, 0.1, 10.0)};
    f.m2 = f.m1 * decades(seed, 0.2, 5.0), f.k2 = f.k1 * decades(seed, 0.2, 5.0);
    double critical = sqrt(f.m1 * f.k1);
    f.d1 = chance(seed, 0.2) ? 0.0 : critical * decades(seed, 1e-3, 1.0);
    f.d2 = chance(seed, 0.2) ? 0.0 : critical * decades(seed, 1e-3, 1.0);
    f.e = chance(seed, 0.1) ? 1.0 : uniform(seed, 0.0, 1.0);
    double omega = sqrt(f.k1 / f.m1);
    f.amplitude = 1.0, f.frequency = omega * decades(seed, 0.15, 4.0), f.phase = uniform(seed, 0.0, 6.283);
    f.x1 = uniform(seed, -1.0, 0.0), f.v1 = omega * uniform(seed, -1.0, 1.0);
    f.x2 = uniform(seed, 0.01, 1.0), f.v2 = omega * uniform(seed, -1.0, 1.0);
    f.clearance = chance(seed, 0.5) ? 0.0 : either(seed) * decades(seed, 1e-6, 3.0);
    if (kind == GRAZING) {
        place(&f);
        graze(&f, either(seed) * decades(seed, 1e-11, 1e-3));
        apart_from_critical(&f.d1, f.m1, f.k1), apart_from_critical(&f.d2, f.m2, f.k2);
        return f;
    }
    if (kind == EQUAL) {
        f.k2 = f.k1 * f.m2 / f.m1 * (1.0 + either(seed) * decades(seed, 1e-9, 1e-2));
        f.d2 = f.d1 * f.m2 / f.m1;
    }
    if (kind == CHATTERING || (kind == EQUAL && chance(seed, 0.5))) f.x2 = f.x1, f.v2 = f.v1 + omega * decades(seed, 1e-9, 1.0);
    if (kind == FAST) {
        double eta = decades(seed, 4.0, 40.0);
        f.frequency = omega * eta, f.amplitude = 0.3 / eta;
    }
    if (kind == CUBIC)
        for (int i = 0; i < BOX; i++) f.box[i] = uniform(seed, -0.2, 0.2) * pow(omega, 2.0 + i);
    if (kind == STEEP) {
        if (chance(seed, 0.7)) f.d1 = critical * decades(seed, 3.0, 40.0);
        if (chance(seed, 0.7)) f.d2 = sqrt(f.m2 * f.k2) * decades(seed, 3.0, 40.0);
    }
    apart_from_critical(&f.d1, f.m1, f.k1), apart_from_critical(&f.d2, f.m2, f.k2);
    if (kind == CONTACT) {
        f.x2 = f.x1, f.v2 = f.v1;
        f.frequency = omega * decades(seed, 0.02, 1.0);
        f.box[0] = uniform(seed, -2.0, 2.0) * omega * omega;
        f.box[1] = chance(seed, 0.3) ? uniform(seed, -0.02, 0.02) * omega * omega * omega : 0.0;
    }
    place(&f);
    return f;
}

/* -- the FMU ---------------------------------------------------------------------------------- */

/* Value references, in the order of their names below. */
enum { PARAMETERS = 21, STATE = 6 };
static const char *const SET[PARAMETERS] = {"m1", "m2", "k1", "k2", "d1", "d2", "e", "gamma", "box_amplitude", "box_frequency", "phase_start",
    "box_acceleration", "box_jerk", "box_snap", "box_crackle", "x1_start", "x2_start", "v1_start", "v2_start", "clearance", "e_slope"};
static const char *const GET[STATE] = {"x1", "x2", "v1", "v2", "phase", "impact_energy"};
static unsigned set_references[PARAMETERS], get_references[STATE], in_contact_reference, watched_reference;

static void load(const char *path) {
    fmu_load(path);
    for (int i = 0; i < PARAMETERS; i++) set_references[i] = named(SET[i])->reference;
    for (int i = 0; i < STATE; i++) get_references[i] = named(GET[i])->reference;
    in_contact_reference = named("in_contact")->reference, watched_reference = named("x_rel_max_on")->reference;
}

static void end_event(void *it) {
    fmi3Boolean told[5];
    double when;
    fmi.UpdateDiscreteStates(it, told, told + 1, told + 2, told + 3, told + 4, &when);
    fmi.EnterStepMode(it);
}

/* Begin a flight; false where the FMU refuses it. */
static bool begin(void *it, const Flight *f, double gamma) {
    fmi.Reset(it);
    bool pressed = f->clearance < 0.0;
    double x1 = pressed ? f->x1 - rest_1(f) : f->x1, x2 = pressed ? f->x2 - rest_2(f) : f->x2;
    if (pressed && f->closed) x2 = x1;
    double values[PARAMETERS] = {f->m1, f->m2, f->k1, f->k2, f->d1, f->d2, f->e, gamma, f->amplitude, f->frequency, f->phase,
        f->box[0], f->box[1], f->box[2], f->box[3], x1, x2, f->v1, f->v2, f->clearance, f->e_slope};
    fmi3Boolean off = false;
    bool taken = fmi.SetFloat64(it, set_references, PARAMETERS, values, PARAMETERS) == fmi3OK
        && fmi.SetBoolean(it, &watched_reference, 1, &off, 1) == fmi3OK
        && fmi.EnterInitializationMode(it, false, 0.0, 0.0, false, 0.0) == fmi3OK && fmi.ExitInitializationMode(it) == fmi3OK;
    if (taken) end_event(it);
    return taken;
}

static bool touching(void *it) {
    fmi3Boolean value = false;
    fmi.GetBoolean(it, &in_contact_reference, 1, &value, 1);
    return value;
}

/* Go on to ``target`` or to the first impact: the time reached, and whether it is an impact; less than 0 where the FMU fails. */
static double fly(void *it, double time, double target, bool *impact) {
    fmi3Boolean end, early;
    double reached;
    *impact = false;
    if (fmi.DoStep(it, time, target - time, true, impact, &end, &early, &reached) != fmi3OK) return -1.0;
    if (*impact) fmi.EnterEventMode(it);
    return reached;
}

/* The cubic a time later: it runs on where nobody sets it. */
static void run_on(double box[BOX], double t) {
    for (int i = 0; i < BOX; i++) {
        double value = 0.0;
        for (int k = BOX - 1; k >= i; k--) value = box[k] + value * t / (k - i + 1);
        box[i] = value;
    }
}

/* The state after an impact as the beginning of the next flight, which comes ``elapsed`` after that of the present one. */
static void go_on(void *it, Flight *f, double elapsed, double *lost) {
    run_on(f->box, elapsed);
    double state[STATE];
    fmi.GetFloat64(it, get_references, STATE, state, STATE);
    f->x1 = state[0], f->x2 = state[1], f->v1 = state[2], f->v2 = state[3], f->phase = state[4], f->closed = true;
    *lost = state[5];
}

#endif
