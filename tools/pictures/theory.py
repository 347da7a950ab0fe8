"""Draw the pictures of the theory page: states of the motion, and certified roots."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from numpy.polynomial import Polynomial
from scipy.optimize import brentq

from orchestrate.show.colours import BLACK, BLUE, GREEN, GREY, ORANGE, RED
from orchestrate.show.style import make_panels, styled

WAVES = ((0.5, 1.0, math.pi), (0.16, 3.0, 2.3))  # of the gap: amplitude, frequency, phase
MEAN = 0.515
DIP = 1.0  # a time at which the gap would be below 0
STEPS = 5  # towards the root that are drawn


@styled
def draw_states_over_a_period(data: xr.Dataset) -> Figure:
    figure, (gap, force) = make_panels(2, 1, (9.0, 4.6), sharex=True, height_ratios=(2, 1))
    turns = data.periods_done.values - float(data.periods_done[0])
    gap.plot(turns, data.x_rel, color=BLACK, linewidth=1.3)
    at = np.interp(data.impact_time, data.time, turns)
    gap.plot(at, np.zeros_like(at), "|", color=RED, markersize=9)
    force.plot(turns, data.contact_force, color=BLUE, linewidth=1.3)
    pressed = np.flatnonzero(data.contact_force.values > 0.0)
    begin, end = turns[pressed[0]], turns[pressed[-1]]
    for panel in (gap, force):
        panel.axvspan(begin, end, color=ORANGE, alpha=0.25, linewidth=0.0)
    top = float(data.x_rel.max())
    chatter = at[at < begin]
    words = {
        "flight": (turns[int(np.argmax(data.x_rel.values))], 0.93 * top, "center"),
        "permanent\ncontact": (0.5 * (begin + end), 0.45 * top, "center"),
    }
    for word, (x, y, side) in words.items():
        gap.text(x, y, word, ha=side, va="top", fontsize=9)
    arrow: Any = {"arrowprops": {"arrowstyle": "->", "color": GREY}, "fontsize": 9, "ha": "center"}
    gap.annotate("chattering", (chatter[-8], 0.02 * top), (begin - 0.1, 0.62 * top), **arrow)
    gap.annotate("impact", (at[at > end][0], 0.0), (at[at > end][0], 0.5 * top), **arrow)
    gap.annotate("release", (end, 0.0), (end + 0.07, 0.3 * top), **arrow)
    gap.set_ylabel(r"gap $x_2 - x_1$ in m")
    force.set(ylabel="contact force in N", xlabel="time in periods of the shaking", xlim=(0, 1))
    return figure


def gap_derivative(time: float | np.ndarray, order: int) -> Any:
    """Return a derivative of a given order of an example gap of two waves."""
    mean = MEAN if order == 0 else 0.0
    waves = (a * k**order * np.sin(k * time + p + order * math.pi / 2.0) for a, k, p in WAVES)
    return mean + sum(waves)


@styled
def draw_certified_root_search() -> Figure:
    figure, (sampled, certified) = make_panels(1, 2, (9.6, 3.4), sharey=True)
    time = np.linspace(0.0, 3.4, 800)
    for panel in (sampled, certified):
        panel.plot(time, gap_derivative(time, 0), color=BLACK, linewidth=1.3, label="gap")
        panel.axhline(0.0, color=GREY, linewidth=0.8)
        panel.set(xlabel="time", xticks=[], ylim=(-0.18, 1.1))
    grid = np.linspace(0.0, 3.4, 6)
    sampled.plot(grid, gap_derivative(grid, 0), "o", color=RED, label="samples: all above 0")
    sampled.set_title("a solver that samples sees no impact")
    sampled.set_ylabel("gap")
    draw_bounding_steps(certified)
    certified.set_title("a bound below the gap: no root before its own")
    for panel in (sampled, certified):
        panel.legend(loc="upper center")
    return figure


def draw_bounding_steps(axes: Axes) -> None:
    now = 0.0
    for step in range(STEPS):
        largest = sum(a * k**2 for a, k, _ in WAVES)
        gap, rate = (float(gap_derivative(now, order)) for order in (0, 1))
        bound = Polynomial([gap, rate, -0.5 * largest])
        length = float(max(bound.roots().real))  # it falls from a value above 0: one root ahead
        along = np.linspace(0.0, length, 100)
        label = "bounds" if step == 0 else None
        axes.plot(now + along, bound(along), color=GREEN, linewidth=1.4, label=label)
        axes.plot(now, gap_derivative(now, 0), "o", color=GREEN, markersize=4)
        now += length
    root = brentq(gap_derivative, now, DIP, args=(0,))
    axes.plot(root, 0.0, "*", color=RED, markersize=12, label="first root: the impact")
