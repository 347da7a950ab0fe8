"""The commands: each one's class and what the list of commands says of it.

As an attribute of this module a command is its cyclopts application, whose module is imported then.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from cyclopts import App

    from .face import Command

COMMANDS = {
    "build": (
        "Build",
        "export the FMUs, each form with the same variables and numbers, and compile the master "
        "and the explorer's kernels",
    ),
    "simulate": (
        "Simulate",
        "a motion in time: both masses, gap, contact force, impacts, phase plane and spectrum",
    ),
    "shake": (
        "Shake",
        "as in the laboratory: motion and impacts under sines, random, shock or a record",
    ),
    "analyse": (
        "Analyse",
        "what an analyser shows of a record: responses, spectra, orders, shock spectra",
    ),
    "diagnose": (
        "Diagnose",
        "whether a measured beam is delaminated: a verdict, its evidence, a report",
    ),
    "plan": (
        "Plan",
        "plan a test: frequencies and levels of a sweep at which a delamination would show",
    ),
    "resonance": (
        "Resonance",
        "resonance curves: amplitude and peak acceleration, bonded against delaminated; at several "
        "levels (--g FIRST:LAST:STEP), with the level at which a preloaded structure first opens",
    ),
    "spectra": (
        "Spectra",
        "acceleration spectra, bonded beside delaminated (Figure 3)",
    ),
    "sweep": (
        "Sweep",
        "follow responses along the frequency or another parameter: an orbit diagram",
    ),
    "map": (
        "Map",
        "responses over two parameters: impacts per period, multiplicity, largest gap, exponent",
    ),
    "lyapunov": (
        "Lyapunov",
        "largest Lyapunov exponents of responses: periodic, neutral or chaotic",
    ),
    "poincare": (
        "Poincare",
        "a Poincaré section: states at a phase of the box, at impacts or at releases",
    ),
    "attractors": (
        "Attractors",
        "coexisting motions: how many, and how many random starts lead to each",
    ),
    "basin": (
        "Basin",
        "basins of attraction: which motion each start of a plane leads to",
    ),
    "orbit": (
        "Orbit",
        "a periodic motion by Newton's method, stable or unstable, with its multipliers",
    ),
    "manifold": (
        "Manifold",
        "the unstable manifold of a saddle of the stroboscopic map, as a curve to each side",
    ),
    "branch": (
        "Branch",
        "follow periodic motions along a parameter, stable and unstable, to their bifurcations",
    ),
    "border": (
        "Border",
        "follow a bifurcation of a branch over two parameters: where a window begins or ends",
    ),
    "cosimulate": (
        "Cosimulate",
        "both FMUs together: the oscillator and a drive of anybody's",
    ),
    "couple": (
        "Couple",
        "the weak drive: structure and motor coupled, the voltage up and down (Figure 2)",
    ),
    "capture": (
        "Capture",
        "voltages switched on from rest: which pass the resonance, which are captured",
    ),
    "passage": (
        "Passage",
        "a run through the resonance at full resolution: speed, motion, power, waterfall",
    ),
    "jump-voltages": (
        "JumpVoltages",
        "voltages at which the speed jumps, at rate 0 and on ramps of several rates",
    ),
    "drive-branch": (
        "DriveBranch",
        "stationary motions of structure and motor, stable and unstable, and their bifurcations",
    ),
    "explore": (
        "Explore",
        "open a page that shows orbit diagrams and motions, computed in the browser",
    ),
    "report": (
        "Report",
        "stored results as one page with pictures and numbers, to read, print and sign",
    ),
    "paper": ("Paper", "the whole paper through the FMU: figures, claims, report"),
}


def command_class(name: str) -> type[Command]:
    """Import a command's class; it knows its name and text from then on."""
    from . import diagnosis, dynamics, laboratory, pages, responses, weak_drive

    families = (diagnosis, dynamics, laboratory, pages, responses, weak_drive)
    kind, text = COMMANDS[name]
    (found,) = (vars(family)[kind] for family in families if kind in vars(family))
    found.command, found.text = name, text
    return found  # type: ignore[no-any-return]


def __getattr__(name: str) -> App:
    """Return a command's application."""
    if name not in COMMANDS:
        raise AttributeError(name)
    return command_class(name).app()
