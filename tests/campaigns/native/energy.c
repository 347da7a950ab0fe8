/* Momentum and energy of impacts: ``energy BINARY SEED COUNT``. The velocities before an impact come from
   the closed form of the flight, those after it from the FMU; the FMU's own sum of losses against ours. With a fourth
   argument ``wrong`` our restitution is off by a billionth, which has to be found. */
#include "flight.h"

static const double LONGEST = 64.0; /* of a run, in its fastest oscillation's radians: the clock's rounding, 7e-15 of one, is what balances are known to */

enum { MOST = 2000 }; /* impacts of a run: without losses chattering has no end */

typedef struct { double momentum, restitution, energy, ledger; } Worst;

/* A mass's velocity at the end of a flight; returns the size of the terms it is the sum of. */
static double velocity(double m, double d, double k, double x, double v, const Flight *f, double t, double *found) {
    Signal motion = {0};
    double at[3], size = fabs(motion.p[1]);
    add_mass(&motion, m, d, k, x, v, f, 1.0, 1);
    value_of(&motion, t, at);
    *found = at[1];
    for (int i = 0; i < TERMS; i++) size += cabs(motion.c[i] * motion.s[i]);
    return size;
}

/* One impact's balance, in parts of the momentum and the energy of the motion's terms. */
static double balance(const Flight *before, double t, const Flight *after, bool stuck, Worst *worst, double *met) {
    double v[2], m1 = before->m1, m2 = before->m2;
    double speed = m1 * velocity(m1, before->d1, before->k1, before->x1, before->v1, before, t, &v[0])
        + m2 * velocity(m2, before->d2, before->k2, before->x2, before->v2, before, t, &v[1]);
    double lack = fabs(m1 * v[0] + m2 * v[1] - m1 * after->v1 - m2 * after->v2) / speed;
    double closing = v[0] - v[1], opened = after->v2 - after->v1;
    double wrong = fabs(opened - (stuck ? 0.0 : before->e * closing / (1.0 + before->e_slope * closing))) * fmin(m1, m2) / speed;
    double lost = 0.5 * (m1 * (v[0] - after->v1) * (v[0] + after->v1) + m2 * (v[1] - after->v2) * (v[1] + after->v2));
    double expected = 0.5 * m1 * m2 / (m1 + m2) * (closing * closing - opened * opened);
    double whole = speed * speed / (m1 + m2);
    *met += whole;
    worst->momentum = fmax(worst->momentum, lack);
    worst->restitution = fmax(worst->restitution, wrong);
    worst->energy = fmax(worst->energy, fabs(lost - expected) / whole);
    return expected;
}

/* One run of a structure: impacts seen. */
static long run(void *it, Flight f, long wanted, Worst *worst, long *failed) {
    double rate = fmax(f.frequency, sqrt(fmax(f.k1 / f.m1, f.k2 / f.m2))), longest = LONGEST / rate;
    double time = 0.0, ours = 0.0, whole = 0.0, lost = 0.0, begun = 0.0;
    long seen = 0;
    while (seen < wanted && time < longest) {
        bool impact, known = !touching(it);
        double reached = fly(it, time, longest, &impact);
        if (reached < 0.0) { ++*failed; break; }
        if (!impact) {
            time = reached;
            break;
        }
        Flight before = f;
        double was = lost;
        go_on(it, &f, reached - time, &lost);
        seen++;
        if (known) ours += balance(&before, reached - time, &f, touching(it), worst, &whole);
        else begun += lost - was; /* after a contact whose end is not an event */
        end_event(it);
        time = reached;
    }
    if (whole > 0.0) worst->ledger = fmax(worst->ledger, fabs(lost - begun - ours) / whole);
    return seen;
}

int main(int count, char **arguments) {
    if (count < 4) return fprintf(stderr, "usage: energy BINARY SEED COUNT [wrong]\n"), 2;
    load(arguments[1]);
    uint64_t seed = strtoull(arguments[2], NULL, 10);
    long wanted = atol(arguments[3]), seen = 0, failed = 0, runs = 0;
    Worst worst = {0};
    void *it = open_with("energy", true, true);
    for (int kind = 0; seen < wanted; kind = (kind + 1) % KINDS, runs++) {
        Flight f = draw(&seed, kind == CONTACT || kind == CUBIC ? EQUAL : kind);
        f.e_slope = chance(&seed, 0.5) ? 0.0 : decades(&seed, 1e-3, 1e2);
        if (!begin(it, &f, decades(&seed, GAMMA, 1e-3))) continue;
        if (count > 4) f.e *= 1.0 - 1e-9;
        seen += run(it, f, wanted - seen < MOST ? wanted - seen : MOST, &worst, &failed);
    }
    printf("%ld %ld %ld %.3e %.3e %.3e %.3e\n", seen, runs, failed, worst.momentum, worst.restitution, worst.energy, worst.ledger);
    fmi.FreeInstance(it);
    return 0;
}
