"""Made-up results of every kind, as questions give them, and where a drawn figure has its texts."""

import numpy as np
import xarray as xr
from matplotlib.backends.backend_agg import FigureCanvasAgg

BEAM = {"m1": 1.5, "m2": 1.4, "k1": 8437.5, "k2": 9450.0, "d1": 1.125, "d2": 1.95}
PAPER = {"m1": 1.0, "m2": 1.0, "k1": 1.0, "k2": 1.2, "d1": 0.01, "d2": 0.01}
RANDOM = np.random.default_rng(1)
BOTH = ["delaminated", "bonded"]


def rendered(figure):
    """A figure that knows where everything is."""
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return figure, canvas.get_renderer()


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
    about = {**known(si), "question": "resonance"}
    return xr.Dataset(found | told, {**along(count, si), **names}, about)
