"""Public ``plot``: choose the picture of any result by its kind."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import partial

import xarray as xr
from matplotlib.figure import Figure

from ..errors import InputError
from ..units import Units, with_units
from . import (  # noqa: F401 -- what draws registers itself
    analysis,
    diagnosis,
    histories,
    lines,
    planes,
    resonance,
    spectra,
    weak_drive,
)
from .figure_files import parse_slide_shape, resize_for_slide
from .kinds import BONDED, BRANCHES, DRAW, MORE, OTHER, PARTNERS, require_kind

OVER_OTHERS = ("border", "branch", "drive_branch")
EXPECTED = (
    f"expected results of one of {', '.join(sorted(DRAW))}; several of one of border, branch, "
    "lyapunov, map; a sweep or resonance with branches over it, a map with borders; simulate or "
    "shake with the bonded structure's; couple with drive_branch"
)


def plot(
    *answers: xr.Dataset, title: str = "", part: str = "", units: str | Units = "", size: str = ""
) -> Figure:
    """Draw one result, or several that belong in one picture; return the figure.

    Parameters
    ----------
    *answers : xarray.Dataset
        One answer, or several that belong into one picture: branches, borders, maps or exponents; a
        sweep or resonance curves, and branches over them; a map and borders over it; a motion of
        the delaminated and of the bonded structure; runs of :func:`orchestrate.couple` or
        :func:`orchestrate.capture` of both structures, with the branches of
        :func:`orchestrate.drive_branch`.
    title : str
        Above the picture; by default structure and excitation.
    part : str
        ``"jumps"``: of runs of :func:`orchestrate.couple` the second picture, speed and amplitude
        over time around each jump. By default the first one, the ramp.
    units : str
        Of its axes and its title, such as ``"Hz, mm, g"``: a frequency in Hz, rpm, rad/s or as eta,
        a length in m, mm or um, an acceleration in m/s2 or g, a time in s or periods. By default
        Hz and the prefix that suits of a structure in SI, the paper's ratios else.
    size : str
        Shape of a slide, such as ``"16:9"``, with larger letters.

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
    'displacement'

    Notes
    -----
    Colours, letters and sizes that all pictures have in common stand in
    ``orchestrate.show.style.STYLE``, as settings of Matplotlib: what is changed there holds for
    every picture from then on.
    """
    kinds = [require_kind(answer) for answer in answers]
    shown: dict[str, list[xr.Dataset]] = {kind: [] for kind in kinds}
    for kind, answer in zip(kinds, answers, strict=True):
        shown[kind].append(with_units(answer, units))
    if part and (part != "jumps" or set(shown) != {"couple"}):
        asked = f"part={part!r} of {' and '.join(sorted(shown))}"
        raise InputError(f"plot: {asked}; expected 'jumps' of couple")
    jumps = partial(weak_drive.draw_jump_histories, by_structure(shown.get("couple", [])))
    draw = jumps if part else choose_drawing(shown)
    if draw is None:
        raise InputError(f"plot: no picture of {' and '.join(kinds) or 'nothing'}; {EXPECTED}")
    shape = parse_slide_shape(size)
    return resize_for_slide(draw(title=title) if title else draw(), shape)


def choose_drawing(results_by_kind: dict[str, list[xr.Dataset]]) -> Callable[..., Figure] | None:
    kind, *more = sorted(results_by_kind, key=lambda kind: kind in OVER_OTHERS) or [""]
    if kind not in DRAW:
        return None
    (first, *others), partner = results_by_kind[kind], PARTNERS.get(kind)
    runs = by_structure(results_by_kind[kind])
    if partner == OTHER:
        branches = results_by_kind.get("drive_branch", [])
        if len(runs) <= len(others) or more not in ([], ["drive_branch"]) or len(branches) > 1:
            return None
        if branches and kind != "couple":
            return None
        return partial(DRAW[kind], runs, **{"branches": branches[0]} if branches else {})
    if not more and (not others or partner == MORE):
        return partial(DRAW[kind], first, *others)
    if more == ["border"] and not others and kind == "map":
        return partial(DRAW[kind], first, overlay=results_by_kind["border"])
    if more == ["branch"] and not others and partner == BRANCHES:
        return partial(DRAW[kind], first, overlay=results_by_kind["branch"])
    if not more and len(others) == 1 and len(runs) == 2 and partner == BONDED:
        return partial(DRAW[kind], runs["delaminated"], bonded=runs["bonded"])
    return None


def by_structure(answers: Sequence[xr.Dataset]) -> dict[str, xr.Dataset]:
    names = ["bonded" if answer.attrs.get("bonded", False) else "delaminated" for answer in answers]
    return dict(zip(names, answers, strict=True))
