/* Does the FMU miss a root, and do its impacts balance? ``roots BINARY SEED COUNT``: adversarial flights by the seed, each one's end
   as the FMU says against a dense search of the closed form, which has the velocities before an impact too; those after it are the
   FMU's. With a fourth argument ``show`` every flight is printed; with ``wrong`` the search's stiffness and our restitution are off
   by a billionth, which has to be found. */
#include <float.h>

#include "flight.h"

enum { BLOCK = 64, FOLLOWED = 4 };
enum { OK, MISSED, NOT_A_ROOT, UNFINISHED, REFUSED, VERDICTS };
static long impacts;
static double momentum, restitution, energy; /* largest errors, in parts of the momentum and the energy of the motion's terms */

typedef struct { double re[TERMS][BLOCK], im[TERMS][BLOCK]; } Turns;

/* e^{s j h} for j = 1 ... BLOCK, by doubling: few roundings. */
static void set_turns(Turns *turns, const Signal *f, double h) {
    for (int i = 0; i < TERMS; i++) {
        double complex power = cexp(f->s[i] * h);
        turns->re[i][0] = creal(power), turns->im[i][0] = cimag(power);
        for (int have = 1; have < BLOCK; have *= 2) {
            double a = turns->re[i][have - 1], b = turns->im[i][have - 1];
            for (int j = 0; j < have; j++) {
                turns->re[i][have + j] = turns->re[i][j] * a - turns->im[i][j] * b;
                turns->im[i][have + j] = turns->re[i][j] * b + turns->im[i][j] * a;
            }
        }
    }
}

/* Values and slopes at the BLOCK points after ``t``. */
static void sample(const Signal *f, const Turns *turns, double t, double h, double value[BLOCK], double slope[BLOCK]) {
    for (int j = 0; j < BLOCK; j++) {
        double at = t + (j + 1) * h;
        value[j] = f->p[0] + at * (f->p[1] + 0.5 * at * (f->p[2] + at * f->p[3] * (1.0 / 3.0)));
        slope[j] = f->p[1] + at * (f->p[2] + 0.5 * at * f->p[3]);
    }
    for (int i = 0; i < TERMS; i++) {
        double complex term = f->c[i] * cexp(f->s[i] * t), rate = f->s[i] * term;
        double a = creal(term), b = cimag(term), c = creal(rate), d = cimag(rate);
        for (int j = 0; j < BLOCK; j++) {
            value[j] += a * turns->re[i][j] - b * turns->im[i][j];
            slope[j] += c * turns->re[i][j] - d * turns->im[i][j];
        }
    }
}

/* Where the signal is seen to be below ``-allowed`` before ``stop``, or more than ``stop``; ``*above`` is the point before. */
static double first_below(const Signal *f, double stop, double allowed, double *above) {
    static Turns turns;
    double value[BLOCK], slope[BLOCK], at[3], before = 0.0;
    int count = (int)ceil(stop * fastest_of(f) / 0.04) + 2;
    double h = stop / count;
    set_turns(&turns, f, h);
    value_of(f, 0.0, at);
    before = at[1];
    for (int first = 0; first < count - 1; first += BLOCK) {
        int here = count - 1 - first < BLOCK ? count - 1 - first : BLOCK;
        sample(f, &turns, first * h, h, value, slope);
        for (int j = 0; j < here; j++) {
            double t = (first + j + 1) * h;
            *above = t - h;
            if (value[j] < -allowed) return t;
            if (before < 0.0 && slope[j] >= 0.0) {
                double low = bottom_of(f, t);
                value_of(f, low, at);
                if (low > t - h && low < t && at[0] < -allowed) return low;
            }
            before = slope[j];
        }
    }
    return INFINITY;
}

static double allowed_for(const Signal *f, double stop) { return 1e-14 * size_of(f, stop) * (1.0 + fastest_of(f) * stop); }

/* Whether no root lies before ``stop``, and one there if it is said to be one. */
static int judge(const Signal *f, double stop, bool is_root) {
    double allowed = allowed_for(f, stop), at[3], above;
    if (first_below(f, stop, allowed, &above) < stop) return MISSED;
    value_of(f, stop, at);
    if (at[0] < (is_root ? -10.0 : -1.0) * allowed) return is_root ? NOT_A_ROOT : MISSED;
    if (is_root && fabs(at[0]) > 10.0 * allowed + 1e-15 * stop * fabs(at[1])) return NOT_A_ROOT;
    return OK;
}

static void show(const Flight *f, double end, bool root, int verdict) {
    printf("FLIGHT %d %d %d %a", f->kind, verdict, root, end);
    const double row[] = {f->m1, f->m2, f->k1, f->k2, f->d1, f->d2, f->e, f->amplitude, f->frequency, f->phase, f->box[0], f->box[1], f->box[2], f->box[3], f->x1, f->x2, f->v1, f->v2, f->clearance};
    for (size_t i = 0; i < sizeof row / sizeof *row; i++) printf(" %a", row[i]);
    printf("\n");
}

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

/* An impact's momentum, restitution and loss of energy; the ledger of all losses is rounded. */
static void balance(const Flight *before, double t, const Flight *after, bool stuck, double lost, double ledger) {
    double v[2], m1 = before->m1, m2 = before->m2;
    double size = m1 * velocity(m1, before->d1, before->k1, before->x1, before->v1, before, t, &v[0])
        + m2 * velocity(m2, before->d2, before->k2, before->x2, before->v2, before, t, &v[1]);
    double closing = v[0] - v[1], opened = after->v2 - after->v1;
    double expected = stuck ? 0.0 : before->e * closing / (1.0 + before->e_slope * closing);
    double loss = 0.5 * m1 * m2 / (m1 + m2) * (closing * closing - opened * opened);
    momentum = fmax(momentum, fabs(m1 * v[0] + m2 * v[1] - m1 * after->v1 - m2 * after->v2) / size);
    restitution = fmax(restitution, fabs(opened - expected) * fmin(m1, m2) / size);
    energy = fmax(energy, (fabs(lost - loss) - DBL_EPSILON * ledger) * (m1 + m2) / (size * size));
    impacts++;
}

/* A flight, and those that follow it. */
static void follow(void *it, Flight f, long verdicts[VERDICTS], bool shown) {
    double time = 0.0, lost = 0.0;
    for (int i = 0; i < FOLLOWED; i++) {
        bool impact;
        double reached = fly(it, time, time + HORIZON[f.kind], &impact);
        int verdict = UNFINISHED;
        if (reached >= 0.0) {
            Signal gap = gap_of(&f);
            verdict = judge(&gap, reached - time, impact);
        }
        verdicts[verdict]++;
        if (shown || verdict == MISSED || verdict == NOT_A_ROOT) show(&f, reached - time, impact, verdict);
        if (reached < 0.0 || !impact) return;
        Flight before = f;
        double already = lost;
        go_on(it, &f, reached - time, &lost);
        bool stuck = touching(it);
        if (f.kind != CUBIC) balance(&before, reached - time, &f, stuck, lost - already, lost); /* cubics cancel */
        end_event(it);
        if (stuck) return;
        time = reached;
    }
}

static double root_between(const Signal *f, double above, double below) {
    double at[3];
    for (int i = 0; i < 60 && below - above > 1e-16 * below; i++) {
        double middle = 0.5 * (above + below);
        value_of(f, middle, at);
        *(at[0] > 0.0 ? &above : &below) = middle;
    }
    return below;
}

/* The FMU must be in contact just before the push ends, and not just after. */
static void release(void *it, const Flight *f, long verdicts[VERDICTS], bool shown) {
    Signal push = push_of(f);
    double stop = HORIZON[CONTACT], allowed = allowed_for(&push, stop), at[3], above, root = stop, margin = 0.0;
    double below = first_below(&push, stop, allowed, &above);
    bool ends = below < stop;
    if (ends) {
        root = root_between(&push, above, below);
        value_of(&push, root, at);
        margin = 1e-9 * (1.0 + root) + 100.0 * allowed / fmax(fabs(at[1]), 1e-300);
        if (root <= margin || margin > 1e-4) { verdicts[REFUSED]++; return; } /* it ends at once, or grazes */
    } else {
        value_of(&push, stop, at);
        if (at[0] < 100.0 * allowed) { verdicts[REFUSED]++; return; } /* about to end */
    }
    bool impact, before, after = false;
    double reached = fly(it, 0.0, root - margin, &impact);
    before = reached >= 0.0 && touching(it) && !impact;
    if (before && ends && begin(it, f, GAMMA)) {
        reached = fly(it, 0.0, root + margin, &impact);
        after = touching(it);
    }
    int verdict = reached < 0.0 ? UNFINISHED : !before || (ends && after) ? MISSED : OK;
    verdicts[verdict]++;
    if (shown || verdict == MISSED) show(f, root, ends, verdict);
}

int main(int count, char **arguments) {
    if (count < 4) return fprintf(stderr, "usage: roots BINARY SEED COUNT [show|wrong]\n"), 2;
    load(arguments[1]);
    uint64_t seed = strtoull(arguments[2], NULL, 10);
    long wanted = atol(arguments[3]), verdicts[KINDS][VERDICTS] = {{0}}, done = 0;
    bool shown = count > 4 && arguments[4][0] == 's', wrong = count > 4 && arguments[4][0] == 'w';
    void *it = open_with("roots", true, true);
    for (int kind = 0; done < wanted; kind = (kind + 1) % KINDS) {
        Flight f = draw(&seed, kind);
        f.e_slope = chance(&seed, 0.5) ? 0.0 : decades(&seed, 1e-3, 1e2);
        bool begun = begin(it, &f, GAMMA);
        if (wrong) f.k2 *= 1.0 + 1e-9, f.e *= 1.0 - 1e-9;
        long *here = verdicts[kind], before = here[OK] + here[MISSED] + here[NOT_A_ROOT] + here[UNFINISHED];
        if (!begun) here[REFUSED]++;
        else if (kind == CONTACT ? !touching(it) : touching(it)) here[REFUSED]++;
        else if (kind == CONTACT) release(it, &f, here, shown);
        else follow(it, f, here, shown);
        done += here[OK] + here[MISSED] + here[NOT_A_ROOT] + here[UNFINISHED] - before;
    }
    for (int kind = 0; kind < KINDS; kind++) {
        for (int i = 0; i < VERDICTS; i++) printf("%ld ", verdicts[kind][i]);
        printf("%s\n", KIND[kind]);
    }
    printf("%ld %.3e %.3e %.3e\n", impacts, momentum, restitution, energy);
    fmi.FreeInstance(it);
    return 0;
}
