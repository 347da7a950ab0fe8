"""Section 2: printed equations that mislead, and the right ones, put to a test."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
import xarray as xr

from ..claims import Claim, Measured
from ..curves import CONTACT, FLIGHT
from ..datasets import Datasets

ETA, D, STIFFNESS, BEGAN = 1.3, 0.02, 1.2, 0.7  # of an oscillator (6), and its separation time
START = (0.4, -0.3)
TAUS = np.linspace(0.1, 9.0, 40)
ROUNDING = 1e-6


def judge_printed_form(
    quantity: str, printed_error: float, right_error: float, right_form: str
) -> Measured:
    """Judge a printed form by its residual and the right form's: it holds if nothing is left."""
    text = f"{quantity}: {printed_error:.2g} as printed, {right_error:.2g} with {right_form}"
    return Measured(text, [printed_error < ROUNDING] if right_error < ROUNDING else [])


def largest_residual_of_6(motion: Callable[[np.ndarray], np.ndarray]) -> float:
    """Return the largest residual of equation (6) for a motion, by finite differences."""
    step = 1e-4
    here, after, before = motion(TAUS), motion(TAUS + step), motion(TAUS - step)
    rate, curvature = (after - before) / (2.0 * step), (after - 2.0 * here + before) / step**2
    left = curvature + 2.0 * D * rate + STIFFNESS * here - np.sin(ETA * (TAUS + BEGAN))
    return float(np.abs(left).max())


def motion_by_10_and_11(frequency: float, damping: float) -> Callable[[np.ndarray], np.ndarray]:
    """Return a motion by (10) and (11), with this frequency and damping of its free part."""
    detuning, loss = STIFFNESS - ETA**2, 2.0 * D * ETA
    a, b = -loss / (detuning**2 + loss**2), detuning / (detuning**2 + loss**2)
    nu, phase = math.sqrt(STIFFNESS - D * D), ETA * BEGAN
    alpha = START[0] - (a * math.cos(phase) + b * math.sin(phase))
    rate = START[1] + D * alpha - ETA * (b * math.cos(phase) - a * math.sin(phase))

    def motion(tau: np.ndarray) -> np.ndarray:
        angle = ETA * (tau + BEGAN)
        free = alpha * np.cos(frequency * tau) + rate / nu * np.sin(frequency * tau)
        return a * np.cos(angle) + b * np.sin(angle) + np.exp(-damping * tau) * free

    return motion


def compare_printed_displacement_scale(data: Datasets, claim: Claim) -> Measured:
    """Compare x/a eta^2 and x/(a eta^2) of (3), by the steady amplitude."""
    steady = 1.0 / math.hypot(1.0 - ETA**2, 2.0 * D * ETA)  # amplitude of (6), unit forcing
    x_over_a = ETA**2 * steady  # of m x'' + d x' + k x = m a Omega^2 sin(Omega t)
    printed, right = abs(x_over_a * ETA**2 - steady), abs(x_over_a / ETA**2 - steady)
    return judge_printed_form("steady amplitude less that of (6)", printed, right, "x/(a eta^2)")


def compare_free_motions(data: Datasets, claim: Claim) -> Measured:
    """Put (10) with kappa_i, and with nu_i of (11), into (6)."""
    frequencies = STIFFNESS, math.sqrt(STIFFNESS - D * D)
    printed, right = (largest_residual_of_6(motion_by_10_and_11(one, D)) for one in frequencies)
    return judge_printed_form("left of (6)", printed, right, "nu_i for kappa_i (and D_i for D)")


def measure_gap_in_flight(data: Datasets, claim: Claim) -> Measured:
    """Measure the gap in flight: (12) as printed allows negative ones."""
    figure = data.figure_curves("5")
    flying = figure.kind.values == FLIGHT
    gap = (figure.state.values[:, 1] - figure.state.values[:, 0])[flying]
    inside = gap[np.abs(gap) > 1e-6 * np.abs(gap).max()]
    text = f"gap in flight at eta = 0.4: {inside.min():.2g} to {inside.max():.2g}"
    return Measured(text, [bool((inside < 0.0).any())])


def measure_momentum_gain(data: Datasets, claim: Claim) -> Measured:
    """Measure the momentum that (15) gains with the factor of its second line."""
    e, mu, v1, v2 = 0.7, 0.5, 0.8, -0.4
    part = (1.0 + e) / (1.0 + mu) * (v1 - v2)
    printed, right = (
        abs((v1 - mu * part) + mu * (v2 + factor * part) - (v1 + mu * v2)) for factor in (mu, 1.0)
    )
    form = "(1 + e)/(1 + mu) in the second line"
    return judge_printed_form("momentum gained at m_2/m_1 = 0.5", printed, right, form)


def count_chattering_impacts(data: Datasets, claim: Claim) -> Measured:
    """Find of which e impacts come in a geometric sequence of times, down to any gamma (16)."""
    rows = data.chattering_by_restitution()
    every = rows.e.values.tolist()
    holding = [e for e in every if has_endless_sequence(rows.sel(e=e), e)]
    failing = [e for e in every if e not in holding]
    gammas = sorted(rows.gamma.values.tolist(), reverse=True)
    away = rows.ratio_error.sel(gamma=gammas[-1], e=holding).max().item() if holding else math.nan
    counts = [
        f"{rows.impacts.sel(e=e, gamma=gammas).values.astype(int).tolist()} at e = {e:g}"
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
    return Measured(text, [bool(holding), not failing])


def has_endless_sequence(rows: xr.Dataset, e: float) -> bool:
    """Return whether impacts come at times in a geometric sequence, down to each gamma."""
    rows = rows.sortby("gamma", ascending=False)
    with np.errstate(divide="ignore"):  # at e = 1 more impacts than any number
        expected = np.diff(np.log(rows.gamma.values)) / np.log(e)
    grows = np.abs(np.diff(rows.impacts.values) - expected) <= 1.0 + 1e-9
    near = float(rows.ratio_error[-1]) < 1e-6
    return bool(grows.all() and near and rows.sticks.values.all())


def count_pulled_impacts(data: Datasets, claim: Claim) -> Measured:
    """Count slow impacts that would stick by (17) although the contact force pulls."""
    rows = data.slow_impact_counts()
    slow, pulled, sticking = (int(rows[name].sum()) for name in ("slow", "pulled", "sticking"))
    text = (
        f"of {slow} impacts slower than gamma at {rows.sizes['motion']} frequencies and structures "
        f"{pulled} would stick although the contact force would pull; the FMU lets {sticking} stick"
    )
    return Measured(text, [pulled == 0] if slow else [])


def measure_velocity_after_contact(data: Datasets, claim: Claim) -> Measured:
    """Measure the gap velocity with which the states after contact begin (20)."""
    figure = data.figure_curves("5")
    kind, state = figure.kind.values, figure.state.values
    ends = np.flatnonzero((kind[:-1] == CONTACT) & (kind[1:] != CONTACT))
    if not len(ends):
        return Measured("no contact ends", [])
    rate, after = state[:, 3] - state[:, 2], int(ends[0]) + 1
    jumps = np.flatnonzero(np.diff(figure.tau.values)[after:] == 0.0)
    later = float(rate[after + jumps[0] + 1]) if len(jumps) else math.nan
    first, later = abs(float(rate[after])), abs(later)
    largest = float(np.abs(rate).max())
    text = (
        f"gap velocity after contact at eta = 0.4, over the largest: {first / largest:.1e} in the "
        f"(k+1)th state, {later / largest:.2g} at the beginning of the (k+2)th"
    )
    return Measured(text, [] if math.isnan(later) else [later < first])


def compare_periods(data: Datasets, claim: Claim) -> Measured:
    """Compare eta/2 pi and 2 pi/eta as periods of sin(eta tau)."""
    spans, here = (ETA / (2.0 * np.pi), 2.0 * np.pi / ETA), np.sin(ETA * TAUS)
    printed, right = (float(np.abs(np.sin(ETA * (TAUS + span)) - here).max()) for span in spans)
    return judge_printed_form("change of sin(eta tau) after T", printed, right, "2 pi/eta")
