"""Explanations of the page's terms, shown over its controls and as a list."""

from __future__ import annotations

from typing import NamedTuple


class Term(NamedTuple):
    """A term or symbol with its explanation in a sentence or two."""

    word: str
    meaning: str


WORDS = {
    "diagram": Term(
        "orbit diagram",
        "The gap at one moment of each shaking period, drawn over the shaking frequency: few dots "
        "above a frequency for a motion that repeats, a cloud for one that does not.",
    ),
    "sweep": Term(
        "sweep",
        "The frequencies are taken in order, up or down, and each motion begins as the last ended.",
    ),
    "impact": Term("impact", "The halves strike each other and part with less speed."),
    "chatter": Term(
        "chatter",
        "Ever smaller and quicker impacts in a row, until the halves stick together for a while.",
    ),
    "level": Term(
        "level, g",
        "How strongly the box is shaken: the largest acceleration in a period, in multiples of "
        "that of gravity, 9.81 m/s².",
    ),
    "delaminated": Term(
        "delaminated, undamaged",
        "A delaminated beam is split along its middle into two halves that can part and strike "
        "each other. In an undamaged one they are glued and move as one.",
    ),
    "paper": Term(
        "the paper",
        "“A vibro-impacting model for the detection of delamination”, which has the model of two "
        "masses in a box. Its numbers have no units: they are ratios.",
    ),
    "eta": Term(
        "frequency ratio η = Ω/ω",
        "The shaking frequency Ω over ω, the natural frequency of half 1 alone.",
    ),
    "xi": Term(
        "gap and displacement ξ",
        "Lengths over aη², where a is the amplitude of the box; ξ′ and ξ″ are velocity and "
        "acceleration, with time counted as τ = ωt.",
    ),
    "xi0": Term(
        "gap at rest ξ₀",
        "The gap between the halves at rest. Below zero they are pressed together.",
    ),
    "e": Term(
        "restitution e",
        "Speed after an impact over the speed before it: at 1 nothing is lost, at 0 the halves do "
        "not bounce.",
    ),
    "D": Term("damping D", "Damping ratio of each half: how fast it comes to rest by itself."),
    "mu": Term("mass ratio μ", "Mass of half 2 over that of half 1."),
    "kappa": Term("stiffness ratio κ", "Stiffness of the spring of half 2 over that of half 1."),
    "wall": Term(
        "wall",
        "A rigid stop, fixed to the box, in place of half 2: one mass before it.",
    ),
    "play": Term(
        "largest gap, a play",
        "Where the halves are so far apart they strike again, at their other end; 0: no such end.",
    ),
    "push": Term(
        "pushes",
        "Forces on the halves, harmonic as the shaking and in step with it, and a constant "
        "acceleration of the box, as gravity.",
    ),
    "exponent": Term(
        "exponent",
        "The largest Lyapunov exponent: how fast two motions that begin almost alike come apart, "
        "per unit of τ, with its standard error. Above zero by three of them: chaos. Below by as "
        "much: the motion repeats, or comes to it. Else it nearly repeats, or is still settling: "
        "undecided here.",
    ),
    "spectrum": Term(
        "spectrum",
        "The vibrations of half 1 sorted by frequency, as an accelerometer on it would show them.",
    ),
    "phase": Term(
        "phase curves",
        "Velocity over displacement. A motion that repeats is a closed curve; an impact is a jump.",
    ),
    "section": Term(
        "stroboscopic section",
        "Gap and gap velocity at the same moment of each shaking period, as under a flashing lamp. "
        "A motion that repeats every period is one dot.",
    ),
}
