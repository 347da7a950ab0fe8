"""Public ``plot``: choose the picture of any result by the function that made it."""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence

import xarray as xr
from matplotlib.figure import Figure

from ..errors import InputError
from ..units import Units, with_units
from . import (
    analysis,
    attractors,
    basin,
    borders,
    branches,
    capture,
    cosimulation,
    diagnosis,
    drive_spectra,
    jump_voltages,
    lyapunov,
    manifold,
    maps,
    motion,
    orbit_diagram,
    poincare,
    resonance,
    resonance_levels,
    shaken,
    spectra,
    threshold,
    weak_drive,
)

DRAW: dict[str, Callable[[xr.Dataset], Figure]] = {  # questions whose answer needs no other
    "attractors": attractors.draw,
    "basin": basin.draw,
    "border": borders.draw,
    "branch": branches.draw,
    "detect": diagnosis.draw_detect,
    "contact_threshold": threshold.draw,
    "cosimulate": cosimulation.draw,
    "drive_branch": weak_drive.draw_stationary,
    "fit": diagnosis.draw_detect,
    "drive_spectra": drive_spectra.draw,
    "jump_voltages": jump_voltages.draw,
    "lyapunov": lyapunov.draw,
    "manifold": manifold.draw,
    "map": maps.draw,
    "plan_test": diagnosis.draw_plan,
    "poincare": poincare.draw,
    "resonance": resonance.draw,
    "resonance_levels": resonance_levels.draw,
    "shake": shaken.draw,
    "signs": diagnosis.draw_signs,
    "simulate": motion.draw,
    "spectra": spectra.draw,
    "sweep": orbit_diagram.draw,
}
SEVERAL: dict[str, Callable[..., Figure]] = {  # of which one picture shows any number
    "border": borders.draw,
    "branch": branches.draw,
    "lyapunov": lyapunov.draw,
    "map": maps.draw,
}
OVERLAY: dict[str, Callable[..., Figure]] = {  # over which branches are drawn
    "resonance": resonance.draw,
    "sweep": orbit_diagram.draw,
}
BESIDE: dict[str, Callable[..., Figure]] = {"simulate": motion.draw, "shake": shaken.draw}
OF_BOTH: dict[str, Callable[..., Figure]] = {"couple": weak_drive.draw, "capture": capture.draw}
PARTS: dict[str, Callable[..., Figure]] = {"jumps": weak_drive.draw_jumps}  # of couple
KNOWN = ", ".join(sorted({*DRAW, *OF_BOTH, *analysis.DRAW}))
EXPECTED = (
    f"expected answers of one of {KNOWN}; several of one of {', '.join(SEVERAL)}; a sweep or "
    "resonance with branches over it; simulate or shake with the bonded structure's; couple with "
    "drive_branch"
)


def plot(*answers: xr.Dataset, title: str = "", part: str = "", units: str | Units = "") -> Figure:
    """Draw one result, or several that belong in one picture; return the figure.

    Parameters
    ----------
    *answers : xarray.Dataset
        One answer, or several that belong into one picture: branches, borders, maps or exponents; a
        sweep or resonance curves, and branches over them; a motion of the delaminated and of the
        bonded structure; runs of :func:`orchestrate.couple` or :func:`orchestrate.capture` of both
        structures, with the branches of :func:`orchestrate.drive_branch`.
    title : str
        Above the picture; by default structure and excitation.
    part : str
        ``"jumps"``: of runs of :func:`orchestrate.couple` the second picture, speed and amplitude
        over time around each jump. By default the first one, the ramp.
    units : str
        Of its axes and its title, such as ``"Hz, mm, g"``: a frequency in Hz, rpm, rad/s or as eta,
        a length in m, mm or um, an acceleration in m/s2 or g, a time in s or periods. By default
        Hz and the prefix that suits of a structure in SI, the paper's ratios else.

    Returns
    -------
    matplotlib.figure.Figure
        It is shown in a notebook; ``figure.savefig("picture.png")`` writes a file.

    Raises
    ------
    InputError
        Where there is no picture of these.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.nondimensional()
    >>> figure = orchestrate.plot(orchestrate.simulate(beam, eta=1.2, periods=4))
    >>> [axes.get_ylabel() for axes in figure.axes][0]
    'displacement in m'

    Notes
    -----
    Colours, letters and sizes that all pictures have in common stand in
    ``orchestrate.figures.style.STYLE``, as settings of Matplotlib: what is changed there holds for
    every picture from then on.
    """
    kinds = [function_name(answer) for answer in answers]
    answers = tuple(with_units(answer, units) for answer in answers)
    several = set(kinds)
    if part:
        return plot_part(answers, several, part, title)
    if len(answers) == 1 and kinds[0] in analysis.DRAW:
        return analysis.draw(answers[0], title=title)
    keywords = {"title": title} if title else {}
    if len(answers) == 1 and kinds[0] in DRAW:
        return DRAW[kinds[0]](answers[0], **keywords)
    if len(several) == 1 and kinds[0] in SEVERAL:
        return SEVERAL[kinds[0]](*answers, **keywords)
    (below, *more) = sorted(several - {"branch"}) or [""]
    if "branch" in several and below in OVERLAY and not more and kinds.count(below) == 1:
        parts = [answer for answer, kind in zip(answers, kinds, strict=True) if kind == "branch"]
        return OVERLAY[below](answers[kinds.index(below)], overlay=parts, **keywords)
    if len(several) == 1 and kinds[0] in BESIDE and len(answers) == 2:
        delaminated, bonded = sorted(answers, key=is_bonded)
        if is_bonded(bonded) and not is_bonded(delaminated):
            return BESIDE[kinds[0]](delaminated, bonded=bonded, **keywords)
    return plot_drive(answers, kinds, title)


def plot_part(answers: Sequence[xr.Dataset], kinds: set[str], part: str, title: str) -> Figure:
    """Draw a further picture of results, such as the jumps of runs, by its name ``part``."""
    if part not in PARTS or kinds != {"couple"}:
        asked = f"part={part!r} of {' and '.join(sorted(kinds))}"
        raise InputError(f"plot: {asked}; expected {' or '.join(map(repr, PARTS))} of couple")
    runs = {"bonded" if is_bonded(answer) else "delaminated": answer for answer in answers}
    return PARTS[part](runs, title=title)


def plot_drive(answers: Sequence[xr.Dataset], kinds: Sequence[str], title: str) -> Figure:
    """Draw results on the weak drive, of one structure or of both."""
    of_drive = [kind for kind in kinds if kind in OF_BOTH]
    runs = {
        "bonded" if is_bonded(answer) else "delaminated": answer
        for answer, kind in zip(answers, kinds, strict=True)
        if kind in OF_BOTH
    }
    rest = [answer for answer, kind in zip(answers, kinds, strict=True) if kind not in OF_BOTH]
    alike = len(set(of_drive)) == 1 and len(runs) == len(of_drive)
    if alike and not rest:
        return OF_BOTH[of_drive[0]](runs, title=title)
    if alike and of_drive[0] == "couple" and len(rest) == 1 and "drive_branch" in kinds:
        return weak_drive.draw(runs, branches=rest[0], title=title)
    raise InputError(f"plot: no picture of {' and '.join(kinds) or 'nothing'}; {EXPECTED}")


def function_name(answer: object) -> str:
    """Return the name of the public function that made a result."""
    attributes = answer.attrs if isinstance(answer, xr.Dataset) else {}
    if "analysis" in attributes:  # of a record
        return str(attributes["analysis"])
    call = attributes.get("call")
    if not isinstance(call, str):
        kind = type(answer).__name__
        raise InputError(f"plot: {kind} is no answer of a question; {EXPECTED}")
    name = call.partition("(")[0].removesuffix("Job")  # a job by its class: CoupleJob
    return re.sub(r"(?<=[a-z])(?=[A-Z])", "_", name).lower()


def is_bonded(answer: xr.Dataset) -> bool:
    """Return whether a result is of the undamaged (bonded) structure."""
    return bool(answer.attrs.get("bonded", False))
