"""The pictures of the paper's report: titles, captions, methods, and how each is drawn."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from ..show import histories, lines, planes, spectra
from ..show.style import XI_REL, XI_REL_RATE, Figure
from .cases import CASES, MAPS, ORBITS
from .datasets import Datasets

ARTEFACT = (
    "Where an impact falls on the sampling phase itself, samples show either side of it, and a "
    "periodic response may count as another kind."
)
ORBIT = (
    "One sequential sweep upwards, 0.1 <= eta <= 8.0 by 0.001, each frequency started from the end "
    "of the last, stroboscopic samples taken inside the FMU's steps after the periods dropped."
)
CURVES = (
    "Each started from the up-sweep's response; states sampled inside the FMU and both sides of "
    "each impact, after the periods dropped. nT: the state repeats within 1e-6; a torus that "
    "nearly repeats is irregular."
)


@dataclass(frozen=True)
class PicturePart:
    """A part of the report: a picture, its texts, and the results it shows."""

    # `method` says how it was computed
    title: str
    text: str
    method: str
    draw: Callable[..., Figure]
    results: Callable[[Datasets], list[Any]]  # the datasets that are drawn
    files: tuple[str, ...]  # their files' names


def orbit_diagram_part(number: str, case: str) -> PicturePart:
    structure = CASES[case]
    text = (
        f"Bifurcation diagram for e = {structure.e:g}, D = {structure.get('D'):g}: all "
        "stroboscopic samples of the gap, and below them the impacts per excitation period. The "
        "axis is logarithmic down to its grey part, and linear in it, down to 0."
    )
    file = f"orbit_{structure.label()}_up"
    show: Any = lines.draw_sweep, lambda data: [data.up_sweep(case)], (file,)
    return PicturePart(f"Figure {number}", text, ORBIT, *show)


def curves_part(number: str, text: str, method: str, draw: Callable[..., Figure]) -> PicturePart:
    show: Any = draw, lambda data: [data.figure_curves(number)], (f"figure{number}",)
    return PicturePart(f"Figure {number}", text, method, *show)


PARTS = {
    "5": curves_part(
        "5",
        "Phase curves for eta = 0.4, e = 0.7, D = 0.005: (a) motion of both masses, (b) relative "
        "motion.",
        "Started from the up-sweep's response at eta = 0.4; one period, states sampled inside the "
        "FMU and both sides of each impact.",
        planes.draw_phase_curves_by_state,
    ),
    "6": orbit_diagram_part("6", ORBITS["6"]),
    "7": curves_part(
        "7",
        "Multiplicity of periodic responses at the relative resonance peaks of the windows T, 2T, "
        "3T and 4T; the excitation below.",
        "A window nT is the longest run of the up-sweep with period nT and one impact in it; its "
        "relative peak is the largest local maximum of the largest xi_Rel inside it. The last "
        "window continues beyond eta = 8.0: the sweep is continued upwards to 9.0.",
        histories.draw_paper_histories,
    ),
    "8": curves_part(
        "8",
        "Typical phase curves in the first irregular region 0.43 < eta < 1.37; T, nT: periodic.",
        CURVES,
        planes.draw_relative_phase_curves,
    ),
    "9": curves_part(
        "9",
        "Typical phase curves in the second irregular region 2.61 < eta < 3.77; T, nT: periodic.",
        CURVES,
        planes.draw_relative_phase_curves,
    ),
    "10": orbit_diagram_part("10", ORBITS["10"]),
    "11": orbit_diagram_part("11", ORBITS["11"]),
    "12": curves_part(
        "12",
        "Phase curves of both masses at the main resonance peak: (a) close to elastic impact, low "
        "internal damping; (b) close to elastic impact, significant internal damping; (c) close to "
        "plastic impact, low internal damping. Solid: mass 1, dotted: mass 2; a jump is an impact.",
        "The peak of each up-sweep's largest xi_Rel is found, and its response followed for one "
        "more period.",
        planes.draw_phase_curves_of_masses,
    ),
    "lyapunov": PicturePart(
        "Largest Lyapunov exponent",
        "Largest Lyapunov exponent per unit of tau along the up-sweeps (e, D) = (0.7, 0.005), "
        "(0.7, 0.05), (0.3, 0.005), bars of one standard error. Red: chaotic; blue: neutral, "
        "that is quasi-periodic or not decided; black: periodic.",
        "Exact solutions of the variational equations between the impacts that the FMU reports, "
        "and saltation matrices at them; chattering's end projects the deviation on the common "
        "motion. Validated in the tests against differences of neighbouring runs of the FMU, and "
        "against -D without impacts. The standard error is that of batches; the largest of "
        "many is biased by its error: those in the table come from long runs of their own.",
        lines.draw_lyapunov,
        lambda data: [data.lyapunov_exponents(case) for case in CASES],
        tuple(f"exponent_{structure.label()}" for structure in CASES.values()),
    ),
    "attractors": PicturePart(
        "Coexisting attractors",
        "Random starts, e = 0.7, D = 0.005. Above: largest xi_Rel of each attractor, in the colour "
        "of its multiplicity and impacts; grey lines connect what is one attractor. Middle: share "
        "of the starts that lead to it. Below: number of attractors; where responses are irregular "
        "the number depends on the clustering's threshold.",
        "At each frequency random starts, half of them in a box three times the largest gap from "
        "rest around zero, half around the response from rest, each run on until its state repeats "
        "within 1e-6, at most for 8,000 periods: what has not repeated then is irregular, a torus "
        "or chaos. Periodic ones are decided by their orbits: Newton's method begins with the "
        "impacts that the FMU reports, and the multipliers say that the orbit is stable. Every "
        "attractor is carried to the neighbouring frequencies and matched there. Irregular "
        "responses are clustered by their statistics (25 %).",
        lines.draw_attractors,
        lambda data: [data.attractors()],
        ("attractors",),
    ),
    "basin": PicturePart(
        "Basins of attraction",
        "Which attractor a start leads to: gap and gap velocity at phase 0, the means of both "
        "masses those of the two attractors; e = 0.7, D = 0.005. The frequency is the one of "
        "1.07-1.37 at which random starts share themselves most evenly between two periodic "
        "attractors.",
        "Each point is a start of the FMU, followed until settled and decided as the random starts "
        "are.",
        lambda data: planes.draw_basin(data, "", (f"{XI_REL}(0)", f"{XI_REL_RATE}(0)")),
        lambda data: [data.basin()],
        ("basin",),
    ),
    "maps": PicturePart(
        "Parameter maps",
        "Impacts per period, multiplicity, largest xi_Rel and largest impulse (over m_1 omega a "
        "eta^2) over frequency and restitution, damping, and detuning kappa = k_2/k_1; the other "
        "parameters are those of Figure 6. A delamination shows best where the impulse is largest.",
        "Each point starts from rest and is followed until settled; impulses are those of single "
        f"impacts, which the FMU reports at their times. {ARTEFACT}",
        planes.draw_map,
        lambda data: [data.map(parameter) for parameter in MAPS],
        tuple(f"map_{parameter}" for parameter in MAPS),
    ),
    "spectra": PicturePart(
        "Spectra (the paper's Figure 3)",
        "Amplitude spectra of the absolute acceleration of mass 1, bonded (left) and delaminated "
        "(right), at the resonance peak and at two other frequencies; e = 0.7, D = 0.005. Orange: "
        "what sampled accelerations show, without the impacts' impulses.",
        "64 settled periods, 1024 states each sampled inside the FMU; the acceleration's spectrum "
        "is omega^2 times that of the absolute displacement, which holds the impulses as kinks. A "
        "Hann window.",
        spectra.draw_spectra,
        lambda data: [data.spectra()],
        ("spectra",),
    ),
}


def picture_file_stem(part: str) -> str:
    return f"figure{part}" if part.isdigit() else part
