"""Polynomials over one communication step: fitted to what two models exchange, and integrated.

A cubic is kept as the FMUs take it: value and three time derivatives at the step's beginning.
"""


def matched_cubic(first, last, mean, moment, h):
    """The cubic with given ends, mean and first moment.

    Parameters
    ----------
    first, last : float
        Values at the step's beginning and end.
    mean, moment : float
        Integrals of f ds and of s f ds over s = t/h in [0, 1].
    h : float
        Length of the step.

    Returns
    -------
    tuple of float
        Value and first to third derivative at the beginning.
    """
    a1, a2, a3 = last - first, mean - first, moment - 0.5 * first
    b = 3.0 * a1 + 36.0 * a2 - 60.0 * a3
    c = -12.0 * a1 - 96.0 * a2 + 180.0 * a3
    d = 10.0 * a1 + 60.0 * a2 - 120.0 * a3
    return first, b / h, 2.0 * c / (h * h), 6.0 * d / (h * h * h)


def parabola(before, first, last, h_before, h):
    """The quadratic through three communication points, as :func:`matched_cubic`; a line where ``h_before`` is 0."""
    rise = (last - first) / h
    if h_before == 0.0:
        return first, rise, 0.0, 0.0
    curve = (rise - (first - before) / h_before) / (h + h_before)
    return first, rise - curve * h, 2.0 * curve, 0.0


def end_slope(cubic, h):
    """First derivative of a cubic at the step's end."""
    _, f1, f2, f3 = cubic
    return f1 + h * (f2 + 0.5 * h * f3)


def work(force, velocity, acceleration, h):
    """Integral over the step of a cubic force times the velocity that begins at ``velocity`` and has a cubic acceleration."""
    f = (force[0], force[1] * h, force[2] * h * h / 2.0, force[3] * h * h * h / 6.0)
    a = acceleration
    v = (velocity, a[0] * h, a[1] * h * h / 2.0, a[2] * h * h * h / 6.0, a[3] * h * h * h * h / 24.0)
    return h * product(f, v)


def product(f, g):
    """Integral over [0, 1] of the product of two polynomials in s, each as its coefficients."""
    total = 0.0
    for i, a in enumerate(f):
        for k, b in enumerate(g):
            total += a * b / (i + k + 1)
    return total


def quartic(ends, slopes, mean):
    """Coefficients in s of the quartic with given ends, slopes (by s) there, and mean."""
    p0, p1 = ends
    d0, d1 = slopes
    rise = p1 - p0
    q = 30.0 * (mean - 0.5 * (p0 + p1) - (d0 - d1) / 12.0)
    return p0, d0, 3.0 * rise - 2.0 * d0 - d1 + q, d0 + d1 - 2.0 * rise - 2.0 * q, q
