"""Public ``report``: write results as one HTML page."""

from __future__ import annotations

from os import PathLike
from pathlib import Path

from ..errors import InputError
from ..files import write_atomically
from ..lazy import xr
from ..units import Units, with_units
from .answers import answer_section, origin_section, signs_section, title_of
from .kinds import require_kind
from .page import Page, Section
from .verdict import make_verdict, verdict_sections


def report(
    *answers: xr.Dataset,
    output: str | PathLike[str] = "report.html",
    title: str = "",
    notes: str = "",
    units: str | Units = "",
) -> Path:
    """Write results as one HTML page to read, print and sign; return its path.

    On paper a verdict has one page with what decided it, the record and the signature, a page with
    the signs, and an appendix.

    Parameters
    ----------
    *answers : xarray.Dataset
        Of any questions, stored ones too. A verdict of :func:`orchestrate.detect` comes first,
        with its sentence, what was measured over the fits, parameters with errors, what was
        assumed and what would change it; :func:`orchestrate.signs` of the same record, with it.
    output : path-like
        The file.
    title : str
        By default that of the first answer.
    notes : str
        A sentence below the title: who, which beam, which test.
    units : str
        Of pictures and numbers, as in :func:`orchestrate.plot`.

    Returns
    -------
    Path
        The file. It needs no network and runs no script.

    Raises
    ------
    InputError
        Where there is no answer.
    StoreError
        Where the file cannot be written.

    Examples
    --------
    >>> import orchestrate
    >>> beam = orchestrate.Structure.from_file("beam")
    >>> motion = orchestrate.simulate(beam, frequency=78.0, amplitude=1e-3)
    >>> page = orchestrate.report(motion, output="motion.html", notes="A trial.")
    >>> "A trial." in page.read_text(encoding="utf-8")
    True
    """
    if not answers:
        raise InputError("report: no answer given; expected one at least")
    shown = [with_units(answer, units) for answer in answers]
    first, *others = sorted(shown, key=lambda answer: require_kind(answer) != "detect")
    verdict = make_verdict(first) if require_kind(first) == "detect" else None
    sections: list[Section] = []
    for answer in (first, *others):
        kind = require_kind(answer)
        if kind == "detect":
            sections += verdict_sections(answer)
        else:
            sections.append(signs_section(answer) if kind == "signs" else answer_section(answer))
    heading, record = title or title_of(first), str(first.attrs.get("record_file", ""))
    about = notes or (record if record not in heading else "")
    page = Page(heading, about, [*sections, origin_section([first, *others])], verdict)
    text = page.html().encode()
    return write_atomically(output, lambda path: path.write_bytes(text))
