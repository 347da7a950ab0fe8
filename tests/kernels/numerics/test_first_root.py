"""Certificates of the first root, each for thousands of cases of their worst kinds: sizes that
matter at the step, conditions just met and just not met.

The function is a quintic here, with the fifth derivative at plus or minus its bound.
"""

import math

import mpmath as mp
import numpy as np
import pytest

from fmu_src.kernels.numerics import first_root as kernel

COUNT = 8000
FACTORIALS = np.array([1.0, 1.0, 2.0, 6.0, 24.0, 120.0])
PARTS = np.unique(np.concatenate([np.linspace(0.0, 1.0, 120), 1.0 - np.geomspace(1e-6, 0.1, 40)]))


def signed(rng, low, high, shape):
    """Of sizes over decades and both signs, a tenth of them 0."""
    sizes = np.exp(rng.uniform(math.log(low), math.log(high), shape))
    return sizes * rng.choice([-1.0, 1.0], shape) * (rng.random(shape) > 0.1)


def value(h, s, order=0):
    """A derivative of the functions whose derivatives at 0 are rows of ``h``; a row of s each."""
    total = np.zeros_like(s)
    for k in range(h.shape[1] - 1, order - 1, -1):
        total = total * s + h[:, k, None] / FACTORIALS[k - order]
    return total


def starts(seed, count=COUNT):
    """Derivatives from inside or from the boundary, bounds, and the longest step."""
    rng = np.random.default_rng(seed)
    h = signed(rng, 1e-3, 30.0, (count, 6))
    h[:, 0] = np.abs(h[:, 0])
    h[:, 5] = -np.abs(h[:, 5])
    on_boundary = h[:, 0] == 0.0
    h[on_boundary, 1] = np.abs(h[on_boundary, 1])
    at_rest = on_boundary & (h[:, 1] == 0.0)
    h[at_rest, 2] = np.abs(h[at_rest, 2]) + 1e-3
    return h, np.exp(rng.uniform(-3.0, 2.0, count))


def clear_steps(h, reach):
    rows = zip(h.tolist(), reach.tolist(), strict=True)
    return np.array([kernel.clear_step(*row[:5], -row[5], far) for row, far in rows])


@pytest.mark.parametrize("seed", range(3))
def test_no_step_passes_a_root(seed):
    """A clear one, and by the whole bound that of the walk, whether or not it ends on the root."""
    h, reach = starts(seed)
    clear = clear_steps(h, reach)
    assert (clear > 0.0).all() and (clear <= reach).all()
    walked = [
        kernel.clear_step_or_root(*row[:5], -row[5], 1.0, far, 1e-15 * abs(row[0]))[0]
        for row, far in zip(h.tolist(), reach.tolist(), strict=True)
    ]
    for steps, rounding in ((clear, 4e-15), (np.array(walked), 1.5e-14)):
        at = steps[:, None] * PARTS
        assert (value(h, at) >= -rounding * value(np.abs(h), at)).all()


def test_a_clear_step_is_most_of_the_way_where_all_bends_one_way():
    """Then the parabola touches the quintic at the trial, and three trials close in on its root."""
    h, reach = starts(9)
    h[:, 2:5] = -np.abs(h[:, 2:5])
    moving = (h[:, 0] > 0.0) | (h[:, 1] > 0.0)
    h, reach = h[moving], reach[moving]
    step = clear_steps(h, reach)
    for times, share in ((1.2, 0.015), (1.45, 0.002), (2.0, 0.0)):
        far = (times * step)[:, None]
        positive = value(h, far) > 1e-9 * value(np.abs(h), far)
        assert positive[:, 0][times * step < reach].mean() <= share


def lowest_curvatures(h, s):
    rows = zip(h.tolist(), s.tolist(), strict=True)
    return np.array([kernel.lowest_parabola_curvature(*r[2:5], -r[5], far) for r, far in rows])


def test_the_parabola_touches_the_quintic_at_the_trial():
    h, s = starts(2)
    h[:, 2] = np.abs(h[:, 2])
    h[:, 3:] = -np.abs(h[:, 3:])
    expected = 2.0 * (value(h, s[:, None])[:, 0] - h[:, 0] - h[:, 1] * s) / s**2
    assert np.abs(lowest_curvatures(h, s) - expected).max() < 1e-9
    mixed, s = starts(3)
    parabola = np.column_stack([mixed[:, :2], lowest_curvatures(mixed, s)])
    at = s[:, None] * PARTS
    assert (value(parabola, at) <= value(mixed, at) + 1e-14 * value(np.abs(mixed), at)).all()


def test_the_root_of_a_parabola():
    rng = np.random.default_rng(4)
    h = signed(rng, 1e-3, 1e3, (COUNT // 4, 3))
    h[:, 0] = np.abs(h[:, 0])
    found = np.array([kernel.parabola_root(*row) for row in h.tolist()])
    for row, root in zip(h.tolist(), found.tolist(), strict=True):
        roots = np.roots(np.trim_zeros([row[2] / 2.0, row[1], row[0]], "f"))
        later = [float(r.real) for r in roots if r.imag == 0.0 and r.real > 0.0]
        near = row[1] ** 2 - 2.0 * row[0] * row[2]
        if row[0] == 0.0 and row[1] < 0.0:
            assert root == 0.0
        elif abs(near) > 1e-6 * row[1] ** 2:
            assert root == pytest.approx(min(later, default=math.inf), rel=1e-6)


def falling(seed, sizes):
    """Quintics whose quartic has a root at 1 and falls there; slopes there."""
    rng = np.random.default_rng(seed)
    h = signed(rng, *sizes, (COUNT, 6))
    h[:, 0] = -(h[:, 1:5] / FACTORIALS[1:5]).sum(axis=1)
    slope = (h[:, 1:5] / FACTORIALS[:4]).sum(axis=1)
    chosen = (h[:, 0] > 1e-3) & (slope < 0.0)
    return rng, h[chosen], slope[chosen]


def exact_root(row, near=1.0):
    """The quintic's root by Newton's method in 30 digits."""
    with mp.workdps(30):
        terms = [mp.mpf(one) / math.factorial(k) for k, one in enumerate(row)]
        s = mp.mpf(near)
        for _ in range(60):
            slope = mp.polyval([k * c for k, c in enumerate(terms)][1:], s, asc=True)
            change = mp.polyval(terms, s, asc=True) / slope
            s -= change
            if abs(change) < mp.mpf(10) ** -25 * abs(s):
                break
        return float(s)


@pytest.mark.parametrize("sign", [1.0, -1.0])
def test_a_root_by_taylor_is_as_accurate_as_asked_and_the_only_one(sign):
    """The accuracy is about that which the bound allows; the step lies up to a third before."""
    rng, h, slope = falling(5, (1e-2, 3.0))
    h[:, 5] = sign * np.exp(rng.uniform(-12.0, -1.0, len(h)))
    step = rng.uniform(0.68, 1.0, len(h))
    accuracy = np.abs(h[:, 5]) / 120.0 / -slope * np.exp(rng.uniform(-0.5, 1.0, len(h)))
    taken = 0
    for row, clear, wanted in zip(h.tolist(), step.tolist(), accuracy.tolist(), strict=True):
        root = kernel.taylor_root(*row[:5], abs(row[5]), clear, wanted)
        if not root:
            continue
        taken += 1
        if taken % 4 == 0:
            exact = exact_root(row)
            assert abs(root - exact) <= 1.1 * wanted + 1e-13
        between = clear + (root - clear) * PARTS[None, :]
        rise = np.array([[*row[:5], abs(row[5])]])
        assert clear <= root and (value(rise, between, 1) < 1e-13).all()
    assert taken > 200


def test_a_root_by_taylor_is_found_where_all_bends_down_a_little():
    """But with a bound too large for the accuracy, or too far from the clear step."""
    rng = np.random.default_rng(6)
    h = -np.abs(signed(rng, 1e-4, 3e-3, (1000, 6)))
    h[:, 1] = -1.0
    h[:, 0] = -(h[:, 1:5] / FACTORIALS[1:5]).sum(axis=1)
    slope = -(h[:, 1:5] / FACTORIALS[:4]).sum(axis=1)
    for row, steep in zip(h.tolist(), slope.tolist(), strict=True):
        wanted = 1e-10
        limit = 120.0 * steep * wanted
        for step in (0.68, 0.9, 0.99):
            found = kernel.taylor_root(*row[:5], 0.99 * limit, step, wanted)
            assert found == pytest.approx(1.0, abs=1e-13)
            assert kernel.taylor_root(*row[:5], 1.01 * limit, step, wanted) == 0.0
        assert kernel.taylor_root(*row[:5], 0.0, 0.66, wanted) == 0.0
        assert kernel.taylor_root(*row[:5], 0.0, 1.01, wanted) == 0.0
    for h3, h4, root in ((1.9, -6.0, 1.0), (2.1, -6.0, 0.0), (-1.0, 5.9, 1.0), (-1.0, 6.1, 0.0)):
        row = 1.0 - h3 / 6.0 - h4 / 24.0, -1.0, 0.0, h3, h4  # what rises may turn the slope
        assert kernel.taylor_root(*row, 0.0, 0.999, 0.3) == pytest.approx(root)
    for bound, root in ((23.0, 1.0), (25.0, 0.0)):  # 24 may turn the slope before the root
        assert kernel.taylor_root(1.0, -1.0, 0.0, 0.0, 0.0, bound, 0.9, 0.3) == root


def test_a_close_root_is_exact_and_the_only_one():
    """The slope changes by up to 1/256 up to it, all terms taking their parts."""
    rng = np.random.default_rng(7)
    h = signed(rng, 1e-4, 1.0, (COUNT, 6))
    h[:, :2] = 1.0, -1.0
    scale = rng.uniform(0.2, 1.3, COUNT) / 256.0
    weight = np.abs(h[:, 2:]) / FACTORIALS[1:5] * 1.125 ** np.arange(1, 5)
    h[:, 2:] *= (scale / weight.sum(axis=1))[:, None]
    h[:, 5] *= rng.choice([1e-12, 1e-3, 1.0], COUNT)  # what the quartic misses
    change = (np.abs(h[:, 2:]) / FACTORIALS[1:5] * 1.125 ** np.arange(1, 5)).sum(axis=1)
    missed = np.abs(h[:, 5]) / 120.0
    accuracy = np.maximum(missed * rng.uniform(1.0, 3.0, COUNT), 1e-16)
    taken = refused = 0
    for row, wanted, turn in zip(h.tolist(), accuracy.tolist(), change.tolist(), strict=True):
        root = kernel.close_root(*row[:5], abs(row[5]), wanted)
        allowed = abs(row[5]) * 1.125**5 / 120.0 <= 0.999 * wanted
        if root:
            taken += 1
            assert turn < 1.0 / 255.9
            assert abs(row[5]) * 1.125**5 / 120.0 <= 1.001 * wanted
            if taken % 8 == 0:
                assert abs(root - exact_root(row)) <= 1.1 * wanted + 4e-16
        else:
            refused += 1
            assert turn > 1.0 / 256.1 or not allowed
    assert taken > 1000 and refused > 1000


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_two_steps_find_the_furthest_close_root(sign):
    """From a slope that changes by 1/256 up to it two steps of Newton's method are exact."""
    for row in ([1.0, -1.0, sign * 0.0034722, 0.0, 0.0], [1.0, -1.0, 0.0, sign * 0.006172, 0.0]):
        root = kernel.close_root(*row, 0.0, 1e-16)
        assert abs(root - exact_root(row)) <= 3e-16


def test_one_step_of_the_walk():
    """Scaled amplitudes take the same steps; at the root, or as near as digits are, it ends."""
    h, reach = starts(11, 1500)
    ended = 0
    for row, far in zip(h.tolist(), reach.tolist(), strict=True):
        found = kernel.next_step_or_root(*row[:5], -row[5], 3.0, far, 1e-12)
        if row[5]:
            for scale in (2.0**40, 2.0**-40):
                scaled = [scale * one for one in row]
                assert kernel.next_step_or_root(*scaled[:5], -scaled[5], 3.0, far, 1e-12) == found
        ended += found[1]
        assert found[1] or found[0] > 0.0
    assert 100 < ended < 1400
    assert kernel.next_step_or_root(-1e-9, -1.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1e-12) == (0.0, True)
    assert math.isnan(kernel.NO_NUMBER)
    for h0, ends in ((2.0e-16, True), (2.4e-16, False)):  # a last digit of where the walk stands
        assert kernel.clear_step_or_root(h0, -1.0, 1.0, 1e3, 1e3, 1e20, 2.0, 1.0, 0.0)[1] == ends


def test_a_start_on_the_boundary_leaves_it_as_far_as_is_certain():
    """At rest, pulled apart less and less: exactly until the bound turns it back."""
    rng = np.random.default_rng(12)
    for _ in range(1000):
        far = float(np.exp(rng.uniform(-1.0, 1.0)))
        h3, h4 = -rng.uniform(0.1, 1.0, 2) * (rng.random(2) > 0.2)
        rest = float(rng.uniform(0.05, 1.0))
        h2 = rest - far * h3 / 3.0 - far**2 * h4 / 12.0
        bound = 60.0 * rest / far**3  # brings it back at `far`
        assert kernel.clear_step(0.0, 0.0, h2, h3, h4, 0.99 * bound, far) == far
        back = kernel.clear_step(0.0, 0.0, h2, h3, h4, 1.01 * bound, far)
        row = np.array([[0.0, 0.0, h2, h3, h4, -1.01 * bound]])
        assert 0.98 * far < back < far
        assert value(row, np.array([[back]]))[0, 0] > -1e-14
        free = kernel.clear_step(0.0, 0.0, h2 - rest, h3, h4, 0.0, 1.2 * far)
        assert h2 == rest or free == pytest.approx(far, rel=1e-12)
