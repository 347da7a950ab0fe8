"""Checks of section 1: beam data, response to the motor, impacts and spectra."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from ...structures import Drive, Structure
from ...weak_drive import averaged
from .claim import NO, YES, Finding, check_parts, register_claim
from .results import Results, between, impacts_in_response

if TYPE_CHECKING:
    import xarray as xr
BEAM = "beam"  # the shipped set
VOLUME = 3.07 * 0.047 * 0.05  # m3
RAMIN = (600.0, 680.0)  # kg/m3, of the dry wood: not from the paper
LINEAR = 0.1  # of the amplitude: what is seen in a printed curve
DEVICES = 2 * 1.9  # kg, exciter and counter mass


@register_claim(
    "1",
    "beam of 307 cm, 4.7/5.0 cm; unbalance 25 g; exciting device and counter mass 1900 g each",
    "25 g",
    "numbers of the shipped set",
    "density of the wood",
)
def check_beam_mass(results: Results) -> Finding:
    """Check unbalance and total mass of the set ``beam`` against the paper's beam."""
    structure, drive = Structure.from_file(BEAM), Drive.from_file(BEAM)
    low, high = (VOLUME * density + DEVICES for density in RAMIN)
    own = drive.box_mass + structure.m1 + structure.m2
    text = (
        f"our set beam: unbalance {1000 * drive.unbalance_mass:.0f} g, {own:.2f} kg in all; from "
        f"the paper's lengths and masses, ramin of {RAMIN[0]:g} to {RAMIN[1]:g} kg/m3, "
        f"{low:.2f} to {high:.2f} kg"
    )
    why = "The paper has no stiffness, frequency or motor: those of the set are estimates."
    return check_parts([drive.unbalance_mass == 0.025, low <= own <= high], text, why)


@register_claim(
    "1",
    "Figure 2(a): a break is caused by the weak drive (Sommerfeld effect)",
    "a break",
    "averaged theory of the set beam: folds of the voltage over the speed",
)
def check_sommerfeld(results: Results) -> Finding:
    """Check whether the averaged theory of the set ``beam`` has folds at its resonance."""
    structure, drive = Structure.from_file(BEAM), Drive.from_file(BEAM)
    folds = averaged.folds(structure, drive)
    resonance = averaged.resonance(structure, drive)
    text = "; ".join(
        f"fold at speed {fold.Omega:.4f} omega, "
        f"{fold.eta0 * drive.motor_constant * structure.omega:.3f} V"
        for fold in folds
    )
    value = f"resonance at {resonance:.4f} omega; {text or 'no fold: the speed does not jump'}"
    why = "Bonded masses; jumps of the delaminated beam: the command couple."
    return Finding(value, YES if len(folds) > 1 else NO, why)


def linear_curve(numbers: np.ndarray, speed: np.ndarray) -> np.ndarray:
    """Return the amplitude over speed of a linear oscillator shaken by an unbalance."""
    size, resonance, damping = numbers
    ratio = speed / resonance
    curve: np.ndarray = size * ratio**2 / np.hypot(1.0 - ratio**2, 2.0 * damping * ratio)
    return curve


def fit_linear_curve(speed: np.ndarray, amplitude: np.ndarray) -> tuple[np.ndarray, float]:
    """Fit a linear oscillator's curve to amplitudes; return its numbers and the largest error."""
    from scipy.optimize import least_squares

    top = float(amplitude.max())
    begin = [0.02 * top, float(speed[amplitude.argmax()]), 0.01]

    def relative_errors(numbers: np.ndarray) -> np.ndarray:
        """Return the curve's relative errors for an oscillator's size, resonance and damping."""
        return linear_curve(numbers, speed) / amplitude - 1.0

    fit = least_squares(relative_errors, begin, x_scale=np.abs(begin))
    return fit.x, float(np.abs(relative_errors(fit.x)).max())


def ascending_branch(run: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return speeds (over omega) and amplitudes (mm) of a ramp, up to the largest or a jump."""
    speed, amplitude = run.Omega.values, 1000.0 * run.amplitude.values
    jump = float(run.jumps.sel(jump="up"))
    on_branch = np.arange(len(speed)) <= int(amplitude.argmax())
    if np.isfinite(jump):
        on_branch &= run.voltage.values <= jump
    on_branch &= run.voltage.values > float(run.voltage[0])  # after the rest at the first voltage
    return speed[on_branch], amplitude[on_branch]


@register_claim(
    "1",
    "Figure 2(a): no extraordinary phenomenon compared to amplitudes of linear systems",
    "none",
    "the set rig coupled with its motor, voltage slowly up: a linear oscillator's curve fitted",
    "10 % of the amplitude, at every speed up to the break",
    full=True,
)
def check_linear_amplitudes(results: Results) -> Finding:
    """Check how well linear oscillators fit both structures' amplitudes (Figure 2(a))."""
    text, worst, tops = [], {}, {}
    for kind in ("bonded", "delaminated"):
        speed, amplitude = ascending_branch(results.get(f"ramp_{kind}"))
        (_, resonance, damping), worst[kind] = fit_linear_curve(speed, amplitude)
        tops[kind] = float(amplitude.max())
        text.append(
            f"{kind} within {100 * worst[kind]:.1f} % of that of a linear oscillator with D = "
            f"{damping:.4f} at {resonance:.4f} omega, up to {tops[kind]:.2f} mm"
        )
    value = f"our set rig on a slow ramp up to the break: {'; '.join(text)}"
    why = (
        "The curve of the delaminated structure has the shape of a linear one's with more damping. "
        f"Only beside the bonded one does it differ: its peak is {tops['delaminated']:.2f} mm in "
        f"place of {tops['bonded']:.2f} mm. Stiffnesses, damping and motor of the set are ours."
    )
    return Finding(value, YES if worst["delaminated"] <= LINEAR else NO, why)


@register_claim(
    "1",
    "Figure 2(b): impacts change step by step, two near resonance, irregular after the break",
    "two",
    "up-sweep, multiplicity and impacts; settled responses",
    full=True,
)
def check_impacts_by_steps(results: Results) -> Finding:
    """Check how impacts per period change up to resonance and after it (Figure 2(b))."""
    up = results.up("elastic")
    peak = float(up.xi_rel_max.idxmax())
    before = between(up, 0.43, peak)
    counts = impacts_in_response(before)[before.multiplicity.values == 1]
    steps = list(dict.fromkeys(counts[counts > 0].tolist()))
    after = between(
        results.settled("elastic"), results.upper_limit("elastic", "T/1", 1.065).value, 1.3
    )
    irregular = float(np.mean(after.multiplicity.values == 0))
    text = (
        f"the model of section 3 on the way up: {', '.join(map(str, steps))} impacts in turn, "
        f"{steps[-1]} at the peak; after it {100 * irregular:.0f} % of the responses are irregular"
    )
    falls = all(a > b for a, b in zip(steps, steps[1:], strict=False))
    why = "The model is not the beam: a harmonic box and one mass on each side."
    return check_parts([falls, steps[-1] == 2, irregular > 0.0, irregular == 1.0], text, why)


@register_claim(
    "1",
    "Figure 3: impacts change the acceleration's spectrum at resonance significantly",
    "significant",
    "spectra of bonded and delaminated structure",
    "a factor of 100",
)
def check_spectra_change(results: Results) -> Finding:
    """Check spectral lines above the excitation at resonance (Figure 3)."""
    shown = results.get("spectra").acceleration.sel(mass=1).isel(eta=0)
    above = shown.where(shown.order > 1.5, drop=True)
    bonded, delaminated = (
        float(above.sel(kind=kind).max()) / float(shown.sel(kind=kind).max())
        for kind in ("bonded", "delaminated")
    )
    text = (
        f"eta = {float(shown.eta):.3f}: the largest line above the excitation's is {bonded:.1e} of "
        f"the largest of all, bonded, and {delaminated:.3f} delaminated"
    )
    return Finding(text, YES if delaminated > 100.0 * bonded else NO)
