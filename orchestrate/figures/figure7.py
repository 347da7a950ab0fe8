"""Figure 7: time-displacement over 20 T at the relative resonance peak of each periodic window, with the excitation below."""

from dataclasses import replace

import numpy as np

from ..curves import Panel, curve, panel_at
from ..paper.resolution import ELASTIC
from ..paper.windows import followed, relative_peak, window

PANELS = 4
POINTS = 200  # a period
CAPTION = "Multiplicity of periodic responses at the relative resonance peaks of the windows T, 2T, 3T and 4T; the excitation below."
METHOD = (
    "A window nT is the longest run of the up-sweep with period nT and one impact in it; its relative peak is the largest local maximum of the "
    "largest xi_Rel inside it. The last window goes on beyond eta = 8.0: the sweep is continued upwards until its peak is passed."
)


def panels(sweeps):
    """The relative peaks; where none lies inside the sweep, the window's last response, to be followed further."""
    sweep, found = sweeps[0], []
    for n in range(1, PANELS + 1):
        peak = relative_peak(sweep, n)
        last = (window(sweep, n) or (None, float(sweep.eta.max())))[1]
        there = panel_at(sweep, ELASTIC, last if peak is None else peak)
        found.append(there if peak is not None else replace(there, multiplicity=-n))
    return found


def compute(fmu, panel, skip, keep):
    """20 periods at the peak, and the panel; a multiplicity -n asks for the peak of the window nT beyond the sweep."""
    if panel.multiplicity < 0:
        eta, start = followed(fmu, panel, -panel.multiplicity)
        panel = Panel(panel.case, eta, start, -panel.multiplicity)
    return curve(fmu, panel, skip, keep, POINTS), panel


def draw(data):
    """Draw gap over time for each window, and sin(eta tau); returns the figure."""
    from .canvas import BLACK, BLUE, XI_REL, relative
    from .canvas import panels as make

    figure, axes = make(PANELS + 1, 1, (10, 9), sharex=True)
    for index, plane in enumerate(axes[:PANELS]):
        tau, gap, _ = relative(data, index)
        turns = tau * float(data.eta[index]) / (2.0 * np.pi)
        plane.plot(turns, gap, "-", color=BLACK, linewidth=0.9)
        plane.set_ylabel(XI_REL)
        plane.set_title(rf"$\eta = {float(data.eta[index]):.3f}$: {'' if index == 0 else index + 1}$T$-periodic, one impact in a response period")
        plane.ticklabel_format(axis="y", scilimits=(-2, 3))
    axes[-1].plot(turns, np.sin(2.0 * np.pi * turns), "-", color=BLUE, linewidth=0.9)
    axes[-1].set(ylabel=r"$\sin\eta\tau$", xlabel=r"$\tau/T$", xlim=(0, 20))
    return figure
