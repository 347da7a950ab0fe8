"""Section 1: the beam, its motor, impacts on the way to resonance, spectra."""

from __future__ import annotations

from typing import Any

import numpy as np
import xarray as xr

from ...model import Drive, Structure
from ...weak_drive import averaged
from ..cases import BEAM
from ..claims import Claim, Measured
from ..datasets import Datasets
from ..reading import between, strictly_decreases, successive_impact_numbers


def compare_beam_masses(data: Datasets, claim: Claim) -> Measured:
    """Measure unbalance and total mass of the set ``beam``, and those of the paper's beam."""
    structure, drive = Structure.from_file(BEAM), Drive.from_file(BEAM)
    wood, volume, devices = (600.0, 680.0), 3.07 * 0.047 * 0.05, 2 * 1.9  # kg/m3, dry; m3; kg
    low, high = (volume * density + devices for density in wood)
    own, unbalance = drive.box_mass + structure.m1 + structure.m2, 1000.0 * drive.unbalance_mass
    text = (
        f"our set beam: unbalance {unbalance:.0f} g, {own:.2f} kg in all; from the paper's lengths "
        f"and masses, ramin of {wood[0]:g} to {wood[1]:g} kg/m3, {low:.2f} to {high:.2f} kg"
    )
    return Measured(text, [abs(unbalance - 25.0) < 0.5, low <= own <= high])


def find_folds_of_the_drive(data: Datasets, claim: Claim) -> Measured:
    """Find the folds of voltage over speed of the set ``beam``, by averaged theory."""
    structure, drive = Structure.from_file(BEAM), Drive.from_file(BEAM)
    folds, volts = averaged.folds(structure, drive), drive.motor_constant * structure.omega
    text = "; ".join(f"fold at {one.Omega:.4f} omega, {one.eta0 * volts:.3f} V" for one in folds)
    text = text or "no fold: the speed does not jump"
    resonance = averaged.bonded_resonance(structure, drive)
    return Measured(f"resonance at {resonance:.4f} omega; {text}", [len(folds) > 1])


def fit_linear_curve(speed: np.ndarray, amplitude: np.ndarray) -> tuple[np.ndarray, float]:
    """Fit a linear oscillator shaken by an unbalance; return parameters, largest relative error."""
    from scipy.optimize import least_squares

    def relative_errors(parameters: np.ndarray) -> Any:
        size, resonance, damping = parameters
        ratio = speed / resonance
        curve = size * ratio**2 / np.hypot(1.0 - ratio**2, 2.0 * damping * ratio)
        return curve / amplitude - 1.0

    begin = np.array([0.02 * amplitude.max(), speed[amplitude.argmax()], 0.01])
    fit = least_squares(relative_errors, begin, x_scale=np.abs(begin))
    return fit.x, float(np.abs(relative_errors(fit.x)).max())


def ascending_speeds_and_amplitudes(run: xr.Dataset) -> tuple[np.ndarray, np.ndarray]:
    """Return speeds (over omega) and amplitudes (mm) of a ramp, up to the largest or a jump."""
    speed, amplitude = run.Omega.values, 1000.0 * run.amplitude.values
    jump = float(run.jumps.sel(jump="up"))
    kept = np.arange(len(speed)) <= int(amplitude.argmax())
    kept &= run.voltage.values > float(run.voltage[0])  # after the rest at the first voltage
    if np.isfinite(jump):
        kept &= run.voltage.values <= jump
    return speed[kept], amplitude[kept]


def fit_linear_amplitudes(data: Datasets, claim: Claim) -> Measured:
    """Fit linear oscillators' curves to both structures' amplitudes (Figure 2(a))."""
    text, worst = [], 0.0
    for kind in ("bonded", "delaminated"):
        speed, amplitude = ascending_speeds_and_amplitudes(data.ramp(kind))
        (_, resonance, damping), worst = fit_linear_curve(speed, amplitude)
        text.append(
            f"{kind} within {100 * worst:.1f} % of that of a linear oscillator with D = "
            f"{damping:.4f} at {resonance:.4f} omega, up to {amplitude.max():.2f} mm"
        )
    found = f"our set rig on a slow ramp up to the break: {'; '.join(text)}"
    return Measured(found, [worst <= 0.1])  # what is seen in a printed curve


def count_impacts_up_to_the_peak(data: Datasets, claim: Claim) -> Measured:
    """Count impacts up to the peak and irregular responses after it (Figure 2(b))."""
    up = data.up_sweep("elastic")
    steps = successive_impact_numbers(between(up, 0.43, float(up.xi_rel_max.idxmax()))) or [0]
    after = data.window_nearest("elastic", "T/1", 1.065).high
    settled = between(data.settled_responses("elastic"), after, 1.3)
    irregular = (settled.multiplicity == 0).mean().item()
    text = (
        f"the model of section 3 on the way up: {', '.join(map(str, steps))} impacts in turn, "
        f"{steps[-1]} at the peak; after it {100 * irregular:.0f} % of the responses are irregular"
    )
    falls = strictly_decreases(steps)
    return Measured(text, [falls, steps[-1] == 2, irregular > 0.0, irregular == 1.0])


def compare_spectral_lines(data: Datasets, claim: Claim) -> Measured:
    shown = data.spectra().acceleration.sel(mass=1).isel(eta=0)
    above = shown.where(shown.order > 1.5, drop=True)
    kinds = ("bonded", "delaminated")
    lines = {k: float(above.sel(kind=k).max() / shown.sel(kind=k).max()) for k in kinds}
    text = (
        f"eta = {float(shown.eta):.3f}: the largest line above the excitation's is "
        f"{lines['bonded']:.1e} of the largest of all, bonded, and {lines['delaminated']:.3f} "
        "delaminated"
    )
    return Measured(text, [lines["delaminated"] > 100.0 * lines["bonded"]])
