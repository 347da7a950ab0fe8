"""Draw branches of orbits, or over responses, once both are known to belong together."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes

from ..errors import InputError
from ..flags import flag_words
from ..model.ranges import OF_LENGTH, STRUCTURE
from ..units import omega_of, unit_of_xi
from .colours import BIFURCATION_MARKS, BLUE, RED
from .kinds import kind_of
from .labels import frequency_scale
from .scales import ETA, acceleration_scale, axis_values, parameter_scale_and_label
from .style import draw_line

SAME = 1e-9  # relative: numbers that are nearer than this are one
SI = (*STRUCTURE, "bonded")
MOVED = {  # by a parameter that is not in SI
    **{"mu": {"m2", "d2"}, "kappa": {"k2"}, "omega": {"k1", "k2", "d1", "d2"}},
    **{"D": {"d1", "d2"}, "D1": {"d1"}, "D2": {"d2"}, "zeta1": {"d1"}, "zeta2": {"d2"}},
    **{"f1": {"k1", "d1"}, "f2": {"k2", "d2"}},
}
ALIKE = ({"eta", "frequency"}, {"level", "amplitude"})  # names of what is one axis


def explain_branch_mismatch(branch: xr.Dataset, over: str, parameters: Mapping[str, Any]) -> str:
    """Return a text on why a dataset is no branch of this structure and parameter; else ""."""
    question = kind_of(branch) or "nothing"
    if question != "branch":
        return f"an answer of {question}; expected one of branch"
    name = str(branch.attrs["over"])
    if name != over and not any({name, over} <= alike for alike in ALIKE):
        return f"a branch along {name}; expected one along {over}"
    if branch.attrs.get("box_acceleration", 0.0) or "box_acceleration" in branch.coords:
        return "a branch with a constant acceleration of the box; expected one without"
    return explain_structure_mismatch(branch, {name}, parameters)


def explain_border_mismatch(
    curve: xr.Dataset, over: set[str], parameters: Mapping[str, Any]
) -> str:
    """Return a text on why a dataset is no border of a map over two parameters; else ""."""
    question = kind_of(curve) or "nothing"
    if question != "border":
        return f"an answer of {question}; expected one of border"
    names = set(map(str, curve.attrs["over"]))
    if names != over or not over & ALIKE[0]:
        return (
            f"a border over {' and '.join(names)}; expected {' and '.join(over)}, one a frequency"
        )
    return explain_structure_mismatch(curve, names, parameters)


def explain_structure_mismatch(
    branch: xr.Dataset, varied: set[str], parameters: Mapping[str, Any]
) -> str:
    """Return a text on how a result's structure differs in what does not vary; else ""."""
    moved = set().union(*(MOVED.get(name, {name}) for name in varied))
    for key in SI:
        if key in moved or key not in parameters:
            continue
        own, other = float(branch.attrs.get(key, 0.0)), float(parameters[key])
        if not math.isclose(own, other, rel_tol=SAME):
            return f"a branch of another structure, {key} = {own:g}; expected {key} = {other:g}"
    return ""


def explain_excitation_mismatch(branch: xr.Dataset, data: xr.Dataset, over: str) -> str:
    """Return a text on why a branch has another excitation than the responses; else ""."""
    at = branch.frequency.values
    if over not in ALIKE[0]:
        pairs = ((branch[key].values, data[key].values) for key in ("eta", "frequency"))
        if not any(np.allclose(np.append(a, b), a[0], rtol=SAME, atol=0.0) for a, b in pairs):
            eta = [float(each.eta.values[0]) for each in (branch, data)]
            return f"a branch at eta = {eta[0]:g}; expected eta = {eta[1]:g}"
    has_scale = any(branch.attrs.get(name) for name in OF_LENGTH)
    if has_scale and over not in ALIKE[1]:
        own, other = branch.amplitude.values, amplitude_at(data, at)
        if not np.allclose(own, other, rtol=SAME, atol=0.0):
            return (
                f"a branch at an amplitude of {own[0]:g} m, where the responses have "
                f"{other[0]:g} m; expected the same, as the structure has a scale of length"
            )
    return ""


def amplitude_at(data: xr.Dataset, frequency: np.ndarray) -> np.ndarray:
    """Return the box's amplitude, m, interpolated to frequencies between the responses'."""
    order = np.argsort(data.frequency.values, kind="stable")
    own = data.frequency.values[order]
    amplitude = np.broadcast_to(data.amplitude.values, own.shape)[order]
    level = amplitude * own**2
    if np.allclose(level, level[0], rtol=SAME, atol=0.0):
        return np.asarray(level[0] / frequency**2)
    return np.interp(frequency, own, amplitude)


def place_over_responses(branch: xr.Dataset, data: xr.Dataset, parameter: str) -> DrawnBranch:
    """Return a branch in the units of responses along a parameter, over which it is drawn."""
    parameters = {key: data.attrs[key] for key in SI if key in data.attrs}
    if "structure" in data.dims:  # of both
        parameters.pop("bonded", None)
    why = explain_branch_mismatch(branch, parameter, parameters)
    why = why or explain_excitation_mismatch(branch, data, parameter)
    if why:
        raise InputError(f"overlay: {why}")
    name, omega = str(branch.attrs["over"]), omega_of(branch)
    if name in ALIKE[0]:
        on_ratios = axis_values(data, parameter).label == ETA
        unit = omega if on_ratios else frequency_scale(data)[0]
        unit /= omega if name == "eta" else 1.0
    elif parameter == "level":
        unit = acceleration_scale(data, "g")[0] / float(branch.frequency[0]) ** 2
    else:
        unit = parameter_scale_and_label(data, parameter)[0]
    own = parameter in ALIKE[1]
    amplitude = None if own else amplitude_at(data, branch.frequency.values)
    return DrawnBranch(branch, unit, amplitude)


@dataclass(frozen=True)
class DrawnBranch:
    """A branch of orbits in the units of a picture's axes."""

    branch: xr.Dataset
    x_unit: float  # what is one on the axis of its parameter
    amplitude: np.ndarray | None = None  # of the box at its points, m, if it is not its own

    def length_factors(self, unit: float) -> np.ndarray:
        """Return each point's factor from lengths over a eta^2 to a unit, m; 1 for unit 0."""
        count = self.branch.sizes["point"]
        if not unit:
            return np.ones(count)
        if self.amplitude is None or not self.amplitude.any():
            return np.broadcast_to(np.asarray(unit_of_xi(self.branch)), count) / unit
        return np.asarray(self.amplitude * self.branch.eta.values**2 / unit)

    def gaps_at_phase_0(self, unit: float) -> np.ndarray:
        samples = self.branch.xi_rel.transpose("sample", "point").values
        return np.asarray(samples * self.length_factors(unit))

    def draw_orbits(
        self, plane: Axes, name: str, unit: float, colours: tuple[str, str] = (BLUE, RED)
    ) -> None:
        """Draw a length of the orbits, such as ``xi_rel``: solid if stable, dashed if unstable."""
        x = self.branch[str(self.branch.attrs["over"])].values / self.x_unit
        stable = self.branch.stable.values == 1
        # a step of which one end is unstable is drawn as unstable
        both = stable & np.append(stable[1:], True) & np.append(True, stable[:-1])
        lengths = self.branch[name].transpose(..., "point").values * self.length_factors(unit)
        for row in np.atleast_2d(lengths):
            for label, shown, style, colour, width in (
                ("stable", stable, "-", colours[0], 1.2),
                ("unstable", ~both, "--", colours[1], 0.9),
            ):
                values = np.where(shown, row, np.nan)
                draw_line(plane, x, values, style, colour, width, label if shown.any() else None)

    def draw_bifurcations(self, plane: Axes, name: str, unit: float) -> None:
        branch, scale = self.branch, self.length_factors(unit)
        if not branch.sizes.get("bifurcation"):
            return
        names = flag_words(branch.bifurcation_kind.attrs)
        there = np.interp(branch.bifurcation_place.values, np.arange(len(scale)), scale)
        values = branch[f"bifurcation_{name}"].transpose("bifurcation", ...).values
        rows = values.reshape(len(there), -1) * there[:, np.newaxis]
        places = branch.bifurcation_value.values / self.x_unit
        style: Any = {"color": "black", "markerfacecolor": "white", "markersize": 5, "zorder": 3}
        for at, row, kind in zip(places, rows, branch.bifurcation_kind.values, strict=True):
            word = names[int(kind)].replace("Neimark Sacker", "Neimark-Sacker")
            x = np.full(len(row), at)
            plane.plot(x, row, BIFURCATION_MARKS[word], linestyle="none", label=word, **style)
