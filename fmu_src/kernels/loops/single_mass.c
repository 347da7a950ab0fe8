/* A single mass on a spring that is not linear, on a shaken base: classical Runge-Kutta steps. diagnosis/single_mass.py has the equation. */
#include <math.h>

#include "fmi.h"

/* w^2, 2 zeta w, q and c; friction and the speed below which it is viscous; the stop's stiffness r over
   the spring's, its distance p, and on which side (1, -1) it is: the numbers of `coefficients`. */
typedef struct { double stiffness, damping, square, cube, friction, slow, stop, position, side; } Mass;

static double acceleration(const Mass *p, double base, double x, double v) {
    double beyond = p->side * x - p->position;
    double spring = x + p->square * x * x + p->cube * x * x * x;
    if (beyond > 0.0) spring = spring + p->side * p->stop * beyond;
    double force = p->stiffness * spring + p->damping * v;
    if (p->friction != 0.0) force = force + p->friction * (v / sqrt(v * v + p->slow * p->slow));
    return -base - force;
}

/* Integrate from rest under `count` cubics of the base's acceleration (value and three derivatives, a row
   for each `step`), in `parts` of a step. Writes the displacement at the beginning of each cubic and at the
   end of the last one, and stops where it reaches `bound`. */
EXPORT void displace(const Mass *p, const double *cubics, size_t count, double step, int parts, double bound, double *displacement) {
    double x = 0.0, v = 0.0, h = step / parts;
    displacement[0] = x;
    for (size_t i = 0; i < count; i++) {
        const double *c = cubics + 4 * i;
        double right = c[0];
        for (int part = 0; part < parts; part++) {
            double t = part * h + 0.5 * h, u = part * h + h;
            double left = right;
            double middle = c[0] + t * (c[1] + t * (0.5 * c[2] + t * c[3] / 6.0));
            right = c[0] + u * (c[1] + u * (0.5 * c[2] + u * c[3] / 6.0));
            double a1 = acceleration(p, left, x, v);
            double v2 = v + 0.5 * h * a1, a2 = acceleration(p, middle, x + 0.5 * h * v, v2);
            double v3 = v + 0.5 * h * a2, a3 = acceleration(p, middle, x + 0.5 * h * v2, v3);
            double v4 = v + h * a3, a4 = acceleration(p, right, x + h * v3, v4);
            x = x + h / 6.0 * (v + 2.0 * v2 + 2.0 * v3 + v4);
            v = v + h / 6.0 * (a1 + 2.0 * a2 + 2.0 * a3 + a4);
        }
        if (!(fabs(x) < bound)) return;
        displacement[i + 1] = x;
    }
}
