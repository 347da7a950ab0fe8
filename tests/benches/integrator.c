/* Modes of a structure on a shaken base, with springs, friction and unilateral contacts on top: the
 * classical Runge-Kutta method of fourth order with equal steps. No event is looked for: contacts are
 * compliant, so the motion is smooth enough for small steps, and how small is tested.
 *
 * Equations, mass-normalised modes q:
 *   q_i'' = -w_i^2 q_i - 2 zeta_i w_i q_i' - participation_i base(t) + sum over forces row_i F
 * integrator.py has the same structure for ctypes.
 */
#include <math.h>

#ifdef _WIN32
#define EXPORT __declspec(dllexport)
#else
#define EXPORT __attribute__((visibility("default")))
#endif
#define MOST_MODES 64
#define MOST_CONTACTS 256
#define FAR 1e3  /* mass-normalised displacement that nothing here reaches: the motion has escaped */

enum { LINEAR, HUNT_CROSSLEY, HERTZ };

typedef struct {
    int modes, contacts, springs, frictions, outputs, law;
    const double *stiffness, *damping, *participation;  /* of each mode: w^2, 2 zeta w */
    const double *contact_rows, *clearance, *contact_stiffness, *contact_damping;
    const double *spring_rows, *cubic, *offset;
    const double *friction_rows, *friction_force, *friction_coefficient, *friction_speed;
    const double *output_rows;
} System;

typedef struct { double gap, force; } Largest;  /* of a contact */

static double along(const double *row, const double *q, int n) {
    double sum = 0.0;
    for (int i = 0; i < n; i++) sum += row[i] * q[i];
    return sum;
}

static void push(const double *row, double force, double *a, int n) {
    for (int i = 0; i < n; i++) a[i] += row[i] * force;
}

/* Never pulls: the faces are not glued. */
static double contact_force(const System *s, int c, double depth, double speed) {
    double force;
    if (depth <= 0.0) return 0.0;
    if (s->law == LINEAR) force = s->contact_stiffness[c] * depth + s->contact_damping[c] * speed;
    else {
        force = s->contact_stiffness[c] * depth * (1.0 + s->contact_damping[c] * speed);
        if (s->law == HERTZ) force *= sqrt(depth);
    }
    return force > 0.0 ? force : 0.0;
}

static double accelerate(const System *s, const double *q, const double *v, double base, double *a) {
    int n = s->modes;
    double pressed = 0.0;
    for (int i = 0; i < n; i++) a[i] = -s->stiffness[i] * q[i] - s->damping[i] * v[i] - s->participation[i] * base;
    for (int c = 0; c < s->contacts; c++) {
        const double *row = s->contact_rows + c * n;
        double depth = -along(row, q, n) - s->clearance[c];
        if (depth <= 0.0) continue;
        double force = contact_force(s, c, depth, -along(row, v, n));
        push(row, force, a, n);
        pressed += force;
    }
    for (int k = 0; k < s->springs; k++) {
        const double *row = s->spring_rows + k * n;
        double o = s->offset[k], x = along(row, q, n) + o;
        push(row, -s->cubic[k] * (x * x * x - o * o * o), a, n);
    }
    for (int k = 0; k < s->frictions; k++) {
        const double *row = s->friction_rows + k * n;
        double speed = along(row, v, n), slow = s->friction_speed[k];
        double level = s->friction_force[k] + s->friction_coefficient[k] * pressed;
        push(row, -level * speed / sqrt(speed * speed + slow * slow), a, n);
    }
    return pressed;
}

static void observe(const System *s, const double *q, const double *v, Largest *largest) {
    int n = s->modes;
    for (int c = 0; c < s->contacts; c++) {
        const double *row = s->contact_rows + c * n;
        double gap = along(row, q, n) + s->clearance[c], force = contact_force(s, c, -gap, -along(row, v, n));
        if (gap > largest[c].gap) largest[c].gap = gap;
        if (force > largest[c].force) largest[c].force = force;
    }
}

/* `base`: acceleration at the ends and the middle of all steps, 2 steps + 1 numbers; `out`: relative accelerations of the outputs at the
 * steps' ends, (steps + 1) x outputs, or NULL. Returns the steps done: fewer where the motion escapes. */
EXPORT long run(const System *s, long steps, double h, const double *base, double *q, double *v, double *out, Largest *largest) {
    int n = s->modes;
    double x[MOST_MODES], y[MOST_MODES], a1[MOST_MODES], a2[MOST_MODES], a3[MOST_MODES], a4[MOST_MODES], u2[MOST_MODES], u3[MOST_MODES];
    if (n > MOST_MODES || s->contacts > MOST_CONTACTS) return -1;
    for (long step = 0; ; step++) {
        const double *b = base + 2 * step;
        observe(s, q, v, largest);
        accelerate(s, q, v, b[0], a1);
        if (out) for (int k = 0; k < s->outputs; k++) out[step * s->outputs + k] = along(s->output_rows + k * n, a1, n);
        if (step == steps) return steps;
        for (int i = 0; i < n; i++) { x[i] = q[i] + 0.5 * h * v[i]; u2[i] = v[i] + 0.5 * h * a1[i]; }
        accelerate(s, x, u2, b[1], a2);
        for (int i = 0; i < n; i++) { x[i] = q[i] + 0.5 * h * u2[i]; u3[i] = v[i] + 0.5 * h * a2[i]; }
        accelerate(s, x, u3, b[1], a3);
        for (int i = 0; i < n; i++) { x[i] = q[i] + h * u3[i]; y[i] = v[i] + h * a3[i]; }
        accelerate(s, x, y, b[2], a4);
        for (int i = 0; i < n; i++) {
            q[i] += h / 6.0 * (v[i] + 2.0 * u2[i] + 2.0 * u3[i] + y[i]);
            v[i] += h / 6.0 * (a1[i] + 2.0 * a2[i] + 2.0 * a3[i] + a4[i]);
            if (!(fabs(q[i]) < FAR)) return step;
        }
    }
}
