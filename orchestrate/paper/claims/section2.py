"""Checks of section 2's misprints: each printed and corrected equation, put to a test."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import TYPE_CHECKING

import numpy as np

from ...response.curves import CONTACT, FLIGHT
from .claim import NO, PARTLY, YES, Check, Finding, register_claim
from .results import Results

if TYPE_CHECKING:
    import xarray as xr
ETA, D, STIFFNESS, BEGAN = 1.3, 0.02, 1.2, 0.7  # of an oscillator (6), and its separation time
START = (0.4, -0.3)
TAUS = np.linspace(0.1, 9.0, 40)
ROUNDING = 1e-6
RATIO = 1e-6  # of successive times between impacts, against e


def register_misprint(equation: str, text: str) -> Callable[[Check], Check]:
    """Decorate a check function: add the claim of a misprinted equation."""
    how = "put into what it must fulfil"
    return register_claim("2", f"{equation}: {text}", "as printed", how, "1e-6")


def compare_residuals(what: str, printed: float, right: float, form: str) -> Finding:
    """Return the finding from the residuals of the printed and the corrected form."""
    text = f"{what}: {printed:.2g} as printed, {right:.2g} with {form}"
    verdict = YES if printed < ROUNDING else NO
    why = "" if right < ROUNDING else "The corrected form does not fulfil it either."
    return Finding(text, verdict, why)


def residual(motion: Callable[[np.ndarray], np.ndarray]) -> float:
    """Return the largest residual of equation (6) for a motion, by finite differences."""
    step = 1e-4
    here, after, before = motion(TAUS), motion(TAUS + step), motion(TAUS - step)
    rate, curvature = (after - before) / (2.0 * step), (after - 2.0 * here + before) / step**2
    left = curvature + 2.0 * D * rate + STIFFNESS * here - np.sin(ETA * (TAUS + BEGAN))
    return float(np.abs(left).max())


def solution(frequency: float, damping: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return a motion by (10) and (11), with given frequency and damping of its free part."""
    detuning, loss = STIFFNESS - ETA**2, 2.0 * D * ETA
    a, b = -loss / (detuning**2 + loss**2), detuning / (detuning**2 + loss**2)
    nu, phase = math.sqrt(STIFFNESS - D * D), ETA * BEGAN
    alpha = START[0] - (a * math.cos(phase) + b * math.sin(phase))
    rate = START[1] + D * alpha - ETA * (b * math.cos(phase) - a * math.sin(phase))

    def motion(tau: np.ndarray) -> np.ndarray:
        """Return the displacement at non-dimensional times."""
        angle = ETA * (tau + BEGAN)
        free = alpha * np.cos(frequency * tau) + rate / nu * np.sin(frequency * tau)
        return a * np.cos(angle) + b * np.sin(angle) + np.exp(-damping * tau) * free

    return motion


@register_misprint("(3)", "xi = x/a eta^2")
def check_scale(results: Results) -> Finding:
    """Check (3): whether xi is x/a eta^2 or x/(a eta^2), by the steady amplitude."""
    steady = 1.0 / math.hypot(1.0 - ETA**2, 2.0 * D * ETA)  # amplitude of (6), unit forcing
    x_over_a = ETA**2 * steady  # of m x'' + d x' + k x = m a Omega^2 sin(Omega t)
    printed, right = abs(x_over_a * ETA**2 - steady), abs(x_over_a / ETA**2 - steady)
    return compare_residuals("steady amplitude less that of (6)", printed, right, "x/(a eta^2)")


@register_misprint("(10)", "cos kappa_i tau, e^(-D tau)")
def check_free_part(results: Results) -> Finding:
    """Check whether (10) has kappa_i or nu_i of (11), by the residual of (6)."""
    nu = math.sqrt(STIFFNESS - D * D)
    printed, right = residual(solution(STIFFNESS, D)), residual(solution(nu, D))
    return compare_residuals("left of (6)", printed, right, "nu_i for kappa_i (and D_i for D)")


@register_misprint("(12)", "xi_2 - xi_1 unequal 0")
def check_one_sided(results: Results) -> Finding:
    """Check (12): whether the gap is unequal to 0 or larger than 0."""
    data = results.get("figure5")
    flying = data.kind.values == FLIGHT
    gap = (data.state.values[:, 1] - data.state.values[:, 0])[flying]
    inside = gap[np.abs(gap) > 1e-6 * np.abs(gap).max()]
    text = f"gap in flight at eta = 0.4: {inside.min():.2g} to {inside.max():.2g}"
    why = "A negative gap, which (12) as printed allows, is the masses through each other: > 0."
    return Finding(text, NO if (inside > 0.0).all() else YES, why)


@register_misprint("(15)", "(1 + e) mu/(1 + mu) in the second line")
def check_momentum(results: Results) -> Finding:
    """Check (15): the factor of its second line, by conservation of momentum."""
    e, mu, v1, v2 = 0.7, 0.5, 0.8, -0.4
    part = (1.0 + e) / (1.0 + mu) * (v1 - v2)

    def change(factor: float) -> float:
        """Return the change of total momentum with this factor."""
        return abs((v1 - mu * part) + mu * (v2 + factor * part) - (v1 + mu * v2))

    what = "momentum gained at m_2/m_1 = 0.5"
    return compare_residuals(what, change(mu), change(1.0), "(1 + e)/(1 + mu) in the second line")


@register_claim(
    "2",
    "(16): for all non-vanishing restitution coefficients a sequence of infinitely many "
    "impacts, with time intervals tending to zero",
    "all e > 0",
    "the FMU's impacts after one kick, for e from 0.01 to 1 and gamma from 1e-3 to 1e-9",
    "ratios of times 1e-6; counts one impact",
)
def check_chattering(results: Results) -> Finding:
    """Check (16): whether impacts are infinitely many with intervals that tend to zero."""
    data = results.get("chattering")
    every = data.e.values.tolist()
    holding = [e for e in every if is_endless(data.sel(e=e), e)]
    failing = [e for e in every if e not in holding]
    gammas = sorted(data.gamma.values.tolist(), reverse=True)
    away = data.ratio_error.sel(gamma=gammas[-1], e=holding).max().item() if holding else math.nan
    counts = [
        f"{data.impacts.sel(e=e, gamma=gammas).values.astype(int).tolist()} at e = {e:g}"
        for e in (holding[:1] + holding[-1:])
    ]
    text = (
        f"after one kick times between impacts shrink by e each, to {away:.0e}, for "
        f"{len(holding)} of {len(every)} values of e: {', '.join(f'{e:g}' for e in holding)}; "
        f"impacts before the masses stick, gamma = {', '.join(f'{g:g}' for g in gammas)}: "
        f"{' and '.join(counts)}"
    )
    if failing:
        text += f"; not for e = {', '.join(f'{e:g}' for e in failing)}"
    why = (
        "Counts grow as the logarithm of gamma over that of e, so without bound as gamma goes to "
        "0. At e = 1, which does not vanish either, no velocity is lost: times do not tend to zero."
    )
    return Finding(text, PARTLY if holding and failing else YES if holding else NO, why)


def is_endless(rows: xr.Dataset, e: float) -> bool:
    """Return whether impacts form a geometric sequence in time, down to gamma."""
    order = np.argsort(-rows.gamma.values)
    gammas, counts = rows.gamma.values[order], rows.impacts.values[order]
    with np.errstate(divide="ignore"):  # at e = 1 more impacts than any number
        expected = np.diff(np.log(gammas)) / np.log(e)
    grows = np.abs(np.diff(counts) - expected) <= 1.0 + 1e-9
    near = float(rows.ratio_error.values[order][-1]) < RATIO
    return bool(grows.all() and near and rows.sticks.values.all())


@register_misprint("(17)", "contact follows by the velocity alone")
def check_pulling(results: Results) -> Finding:
    """Check (17): whether slow impacts would stick although the contact force pulls."""
    data = results.get("low_speed")
    slow, pulled, sticking = (int(data[name].sum()) for name in ("slow", "pulled", "sticking"))
    text = (
        f"of {slow} impacts slower than gamma at {data.sizes['motion']} frequencies and structures "
        f"{pulled} would stick although the contact force would pull; the FMU lets {sticking} stick"
    )
    why = "(17) needs f < 0 as well: masses that are pulled apart do not stay together."
    return Finding(text, NO if pulled else YES, why)


@register_misprint("(20)", "initial conditions of the (k+i)th state")
def check_next_state(results: Results) -> Finding:
    """Check (20): the gap velocity with which the state after contact begins."""
    data = results.get("figure5")
    kind, state = data.kind.values, data.state.values
    ends = np.flatnonzero((kind[:-1] == CONTACT) & (kind[1:] != CONTACT))
    rate = state[:, 3] - state[:, 2]
    after = int(ends[0]) + 1
    jumps = np.flatnonzero(np.diff(data.tau.values)[after:] == 0.0)
    later = float(rate[after + jumps[0] + 1]) if len(jumps) else math.nan
    largest = float(np.abs(rate).max())
    first = abs(float(rate[after])) / largest
    text = (
        f"gap velocity after contact at eta = 0.4, over the largest: {first:.1e} in the (k+1)th "
        f"state, {later / largest:.2g} at the beginning of the (k+2)th"
    )
    why = "With i = 2 (20) would be an impact's beginning: (k+1)."
    return Finding(text, YES if abs(later) < first * largest else NO, why)


@register_misprint("(22)", "T = eta/2 pi")
def check_period(results: Results) -> Finding:
    """Check (22): whether the excitation's period is eta/2 pi or 2 pi/eta."""

    def change(span: float) -> float:
        """Return the largest change of sin(eta tau) after a time span."""
        return float(np.abs(np.sin(ETA * (TAUS + span)) - np.sin(ETA * TAUS)).max())

    what = "change of sin(eta tau) after T"
    return compare_residuals(
        what, change(ETA / (2.0 * np.pi)), change(2.0 * np.pi / ETA), "2 pi/eta"
    )
