"""Made-up results of every kind, as questions give them, and where a drawn figure has its texts."""

import numpy as np
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg

from orchestrate.model.structure import Structure

BEAM = {"m1": 1.5, "m2": 1.4, "k1": 8437.5, "k2": 9450.0, "d1": 1.125, "d2": 1.95}
PAPER = {"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.2, "d1": 0.01, "d2": 0.01}
RANDOM = np.random.default_rng(1)
BOTH = ["delaminated", "bonded"]


def rendered(figure):
    """A figure that knows where everything is."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return figure, canvas.get_renderer()


def legend_texts(place) -> list[str]:
    """Texts of the legend of a panel, or of a figure."""
    legends = place.legends if hasattr(place, "legends") else [place.get_legend()]
    return [text.get_text() for legend in legends if legend for text in legend.get_texts()]


def drawn(axes) -> list[np.ndarray]:
    """Points of all lines of a panel."""
    return [line.get_xydata() for line in axes.lines if len(line.get_xydata())]


def known(si: bool) -> dict:
    """Attributes of a dataset."""
    gamma = 2e-4 if si else 1e-4
    return {**(BEAM if si else PAPER), "e": 0.7, "gamma": gamma, "bonded": 0}


def along(count: int, si: bool) -> dict:
    """A frequency axis, as questions give it."""
    eta = np.linspace(0.9, 1.3, count)
    name, omega = ("frequency", 75.0) if si else ("eta", 1.0)
    amplitude = np.full(count, 1e-3) if si else 1.0 / eta**2
    values = {"eta": eta, "frequency": omega * eta, "amplitude": amplitude}
    return {key: (name, column) for key, column in values.items()}


def sweep(count: int = 40, si: bool = False, both: bool = False, samples: int = 8) -> xr.Dataset:
    """Samples over twelve decades, zeros among them."""
    name = "frequency" if si else "eta"
    gap = 10.0 ** RANDOM.uniform(-11, 1, (2, count, samples))
    gap[:, ::3, 0] = 0.0
    found = xr.Dataset(
        {
            "xi_rel": (("direction", name, "sample"), gap),
            "impacts_per_period": (("direction", name), 1.0 + (gap[..., 1] > 1e-3)),
        },
        {**along(count, si), "sample": np.arange(501, 501 + samples), "direction": ["up", "down"]},
        known(si),
    )
    return found if both else found.sel(direction="up", drop=True)


def exponents(si: bool) -> xr.Dataset:
    """Exponents of all verdicts, some far below zero."""
    name, count = "frequency" if si else "eta", 30
    flags = {"flag_values": [-1, 0, 1], "flag_meanings": "periodic neutral chaotic"}
    found = {
        "exponent": (name, np.linspace(-0.5, 0.2, count)),
        "standard_error": (name, np.full(count, 0.01)),
        "verdict": (name, np.arange(count) % 3 - 1, flags),
    }
    return xr.Dataset(found, along(count, si), known(si))


def coexisting(si: bool) -> xr.Dataset:
    """Two attractors at each frequency."""
    name, count = "frequency" if si else "eta", 20
    over = (name, "attractor")
    found = {
        "number": (name, np.full(count, 2)),
        "share": (over, np.tile([0.9, 0.1], (count, 1))),
        "multiplicity": (over, np.tile([1.0, 0.0], (count, 1))),
        "impacts_per_period": (over, np.tile([2.0, 1.4], (count, 1))),
        "xi_rel_max": (over, RANDOM.uniform(0.1, 9.0, (count, 2))),
    }
    return xr.Dataset(found, along(count, si), known(si))


def plane(si: bool) -> xr.Dataset:
    """More attractors than there are colours, and starts that settle on none."""
    kinds = np.arange(-1, 7).repeat(2).reshape(4, 4)
    over = "attractor"
    found = {
        "attractor_of": (("v_rel", "x_rel"), kinds),
        "share": (over, np.full(7, 1 / 8)),
        **{name: (over, np.ones(7)) for name in ("multiplicity", "xi_rel_max")},
        "impacts_per_period": (over, np.ones(7)),
    }
    sides = {"x_rel": np.arange(4.0), "v_rel": np.arange(4.0), "eta": 1.3}
    return xr.Dataset(found, sides, known(si))


def curves(si: bool) -> xr.Dataset:
    """Resonance curves of both structures in both directions."""
    name, count = "frequency" if si else "eta", 60
    over = ("structure", "direction", name)
    peak = 1e-2 / (0.01 + np.abs(np.linspace(0.9, 1.3, count) - 1.05))
    shape = peak * np.array([[[1.0], [1.1]], [[1.2], [1.2]]])
    found = dict.fromkeys(("x1_max", "x2_max", "a1_max", "a2_max"), (over, shape))
    found["x_rel_max"] = (over, shape * np.array([1.0, 0.0])[:, None, None])
    names = {"structure": BOTH, "direction": ["up", "down"]}
    told = {f"peak_{key}": ("peak", [0.9, 1.1]) for key in found}
    told |= {f"{what}_{name}": (what, [75.0, 80.0]) for what in ("peak", "jump")}
    told |= {"peak_structure": ("peak", BOTH)}
    told |= {"jump_before": ("jump", [0.4, 0.1]), "jump_after": ("jump", [0.1, 0.4])}
    told |= {"jump_direction": ("jump", ["up", "down"])}
    return xr.Dataset(found | told, {**along(count, si), **names}, known(si))


def lines(si: bool) -> xr.Dataset:
    """Spectra of three kinds, the first line of all at one place."""
    name = "frequency" if si else "eta"
    acceleration = np.full((2, 3, 2, 81), 1e-9)
    acceleration[..., 2] = 5.0
    acceleration[:, 1:, :, 4::2] = 0.1
    kinds = ["bonded", "delaminated", "sampled"]
    names = {"kind": kinds, "mass": [1, 2], "order": np.arange(81) / 2}
    found = {"acceleration": ((name, "kind", "mass", "order"), acceleration)}
    return xr.Dataset(found, {**along(2, si), **names}, known(si))


def moving(si: bool, impacts: int = 8) -> xr.Dataset:
    """A motion over eight periods."""
    turns = np.linspace(0.0, 8.0, 801)
    time = turns * (0.08 if si else 6.0)
    wave = 1e-3 * np.sin(2.0 * np.pi * turns)
    names = ("x1", "x2", "v1", "v2", "x_rel", "v_rel")
    found = dict.fromkeys(names, ("time", wave))
    found |= {"v_rel": ("time", wave), "contact_force": ("time", 0.0 * wave)}
    at = time[1] + np.arange(impacts) * (time[-1] / 9.0)
    found |= {"impact_time": ("impact", at), "impact_velocity": ("impact", 0.0 * at + 2.0)}
    found["sticks"] = ("impact", np.arange(impacts) % 2)
    return xr.Dataset(found, {"time": time, "periods_done": ("time", turns)}, known(si))


def mapped(si: bool) -> xr.Dataset:
    """A map with frequencies without impacts."""
    values = RANDOM.uniform(0.5, 20.0, (5, 6))
    found = {
        "impacts_per_period": (("e", "eta"), np.where(values > 15.0, 0.0, values)),
        "multiplicity": (("e", "eta"), values.round() % 10),
        "xi_rel_max": (("e", "eta"), values),
        "exponent": (("e", "eta"), values - 10.0),
    }
    sides = {"e": np.linspace(0.1, 0.9, 5), "eta": np.linspace(0.5, 2.0, 6)}
    return xr.Dataset(found, sides, {**known(si), "e": "0.1 ... 0.9"})


def tracked(size: float = 1.0) -> xr.Dataset:
    """Orders of a swept sine; beside large ones a small record is visible at its start alone."""
    hertz = np.linspace(9.0, 16.0, 60)
    amplitude = size * np.ones((1, 2, 1)) * np.where(hertz < 9.2, 3e-3 / size, 1.0)
    variables = {
        "amplitude": (("channel", "order", "time"), amplitude, {"units": "m/s2"}),
        "phase": (("channel", "order", "time"), 0.0 * amplitude, {"units": "rad"}),
        "sweep_rate": ("time", np.ones(60)),
    }
    sides = {"channel": ["acceleration1"], "order": [1.0, 2.0], "time": np.arange(60.0)}
    sides["frequency"] = ("time", hertz, {"units": "Hz"})
    structure = Structure.from_halves(m1=1.5, m2=1.2, f1=11.9, f2=13.5, zeta1=0.005, zeta2=0.01)
    title = f"Orders: Shaken by swept sine 9 to 16 Hz in 100 s: {structure.label()}"
    return xr.Dataset(variables, sides, {"analysis": "orders", "title": title})


def levels(si: bool) -> xr.Dataset:
    """Accelerations over one and a half decades, as resonance_levels gives them."""
    hertz = np.linspace(30.0, 60.0, 40)
    size = 2.0 + 60.0 / (1.0 + (hertz - 45.0) ** 2)
    over = ("level", "structure", "direction", "frequency")
    level = 9.80665 * np.array([0.3, 0.7, 1.1])
    shape = level[:, None, None, None] * size * np.ones((3, 2, 2, 40))
    variables = dict.fromkeys(("a1_max", "a2_max", "x_rel_max"), (over, shape))
    names = {"structure": BOTH, "direction": ["up", "down"], "level": level}
    sides = {"frequency": 2.0 * np.pi * hertz, "hertz": ("frequency", hertz)}
    threshold = ("frequency", level[0] * 30.0 / size, {"event": "opens"})
    variables["threshold_acceleration"] = threshold
    return xr.Dataset(variables, {**sides, **names}, {**known(si), "clearance": -2e-5})


def capture() -> xr.Dataset:
    """Starts of all three kinds, the border, its interval, and the fold."""
    along, over = ("rotor_inertia",), ("rotor_inertia", "voltage")
    passes = np.array([[0, 1, 1, 1], [0, 0, 0, 1]])
    decision = [["converged"] * 4, ["converged", *["undecided"] * 2, "bounded"]]
    variables = {
        "passes": (over, passes),
        "decision": (over, decision),
        "passage_time": (over, np.where(passes, 5.0, np.nan)),
        "border": (along, [1.05, 1.15], {"tolerance": 0.01}),
        "border_low": (along, [1.047, 1.08]),
        "border_high": (along, [1.053, 1.22]),
        "fold": (along, [1.12, 1.5]),
    }
    sides = {"voltage": [1.0, 1.1, 1.2, 1.3], "rotor_inertia": ("rotor_inertia", [1.0, 2.0])}
    sides["rotor_inertia"] = (along, [1.0, 2.0], {"units": "kg.m2"})
    return xr.Dataset(variables, sides)


def late_jumps(ends, errors, jumps: bool = True) -> xr.Dataset:
    """Voltages of jumps up at two rates, and those at rate 0 with their errors."""
    rates, nan = np.array([1e-4, 2e-4]), np.nan
    each = {"structure": ["bonded", "delaminated"], "jump": ["up", "down"]}
    late = np.full((2, 2, 2), nan)
    late[:, :, 0] = 1.5 + rates[:, np.newaxis] ** (2 / 3) if jumps else nan
    made = {"voltage": (("rate", *each), late)}
    made["jumps"] = (tuple(each), [[end, nan] for end in ends])
    made["standard_error"] = (tuple(each), [[error, nan] for error in errors])
    made["decided"] = (tuple(each), [["by held voltages", ""]] * 2)
    return xr.Dataset(made, {"rate": rates, **each})
