"""Tables and ROC curves of the campaign on diagnoses, from the rows of its runs."""

from __future__ import annotations

from collections.abc import Sequence
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from . import roc
from .diagnosis_rows import (
    COLUMNS,
    DELAMINATED,
    FAILED,
    FITTED,
    NO_OPENING,
    NOT_DESCRIBED,
    REFUSED,
    UNDECIDED,
    USUAL,
    WITHIN,
)

VERDICTS = (DELAMINATED, NO_OPENING, NOT_DESCRIBED, UNDECIDED, REFUSED, FAILED)
SIGNS = {  # what has a curve: label and colour
    "order ratio": ("order 2 over order 1", "#1f5f99"),
    "kurtosis": ("kurtosis above 300 Hz", "#c06020"),
    "ratio": ("detect: ratio of misfits", "#207040"),
}
NONLINEAR = ("hardening", "friction", "clamp")
PICTURE = "diagnosis.png"
NOISE, LEVEL, SIZE = (0.001, 0.01, 0.03, 0.1), (2.0, 4.5, 10.0), (0.1, 0.3, 0.5, 0.7, 0.9)
FALSE = 0.05  # part of false ones at which signs are compared


def make_table(rows: Sequence[Sequence[Any]]) -> pd.DataFrame:
    """Return rows as a pandas table with named columns."""
    return pd.DataFrame(list(rows), columns=list(COLUMNS))


def table_lines(rows: Sequence[Sequence[Any]]) -> list[str]:
    """Return the Markdown lines of all tables for the ledger's page."""
    table = make_table(rows)
    return [
        *verdict_lines(table),
        "",
        *target_lines(table),
        "",
        *curve_lines(table),
        "",
        "![Curves](diagnosis.png)",
        "",
    ]


def verdict_lines(table: pd.DataFrame) -> list[str]:
    """Return Markdown lines of the table of verdicts by kind of beam."""
    head = " | ".join(VERDICTS)
    lines = [f"| beam | {head} | wrong |", "|---" * (len(VERDICTS) + 2) + "|"]
    for kind, own in table.groupby("kind", sort=True):
        counts = [int((own.verdict == verdict).sum()) for verdict in VERDICTS]
        cells = [str(kind), *map(str, counts), str(int((own.wrong != "").sum()))]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def target_lines(table: pd.DataFrame) -> list[str]:
    """Return Markdown lines on the quantities that have targets."""
    usual = table[table.noise.between(*USUAL) & (table.verdict != REFUSED)]
    compliant = usual[usual.kind.isin(("sound", "delaminated"))]
    nonlinear = usual[usual.kind.isin(NONLINEAR)]
    calm = nonlinear[nonlinear.verdict == DELAMINATED]
    errors = np.abs(compliant[["f1 error", "f2 error"]].astype(float).to_numpy().ravel())
    errors = 100.0 * errors[np.isfinite(errors)]
    wrong, undecided = (compliant.wrong != "").sum(), (compliant.verdict == UNDECIDED).sum()
    lines = [
        "At 1 to 5 % noise, where the record was not refused:",
        "",
        f"- two masses, sound or delaminated: wrong "
        f"{roc.format_share(int(wrong), len(compliant))}; "
        f"undecided {roc.format_share(int(undecided), len(compliant))};",
        f"- sound beams that harden, soften, rub or rattle in their clamp: called delaminated "
        f"{roc.format_share(len(calm), len(nonlinear))};",
    ]
    if len(errors):
        median, nine = np.quantile(errors, (0.5, 0.9))
        lines.append(
            f"- f1 and f2 of two masses called delaminated ({len(errors)} numbers): median error "
            f"{median:.2f} %, nine of ten within {nine:.2f} %;"
        )
    lines += deviation_lines(compliant)
    seconds = table.seconds.astype(float)
    lines.append(
        f"- a verdict takes {seconds.median():.1f} s of one processor in the median, "
        f"{seconds.max():.1f} s at most."
    )
    return lines


def deviation_lines(table: pd.DataFrame) -> list[str]:
    """Return Markdown lines on how often stated 95 % intervals hold the truth."""
    parts = []
    for name in FITTED:
        known = table[f"{name} deviation"].dropna().astype(float).abs()
        if len(known):
            parts.append(f"{name} {roc.format_share(int((known <= WITHIN).sum()), len(known))}")
    return [f"- intervals of 95 % that hold the truth: {', '.join(parts)};"] if parts else []


def curve_lines(table: pd.DataFrame) -> list[str]:
    """Return Markdown lines of areas under the ROC curves and detector rates, by group."""
    lines = [
        "Beams that opened against sound ones: of each sign, and of the ratio of misfits by which "
        "the detector decides, the area under its curve with its standard error, and the part of "
        f"opened beams above the threshold that {100 * FALSE:.0f} % of the sound ones pass; of the "
        "verdicts the parts called delaminated.",
        "",
        "| beams | opened, sound | order 2 over 1 | kurtosis | ratio | "
        "called delaminated: opened | sound |",
        "|---|---|---|---|---|---|---|",
    ]
    for name, own in (*group_rows(table), *groups_by_setup(table)):
        if not has_both(own):
            continue
        opened, sound = own[own.opened == 1], own[own.delaminated == 0]
        cells = [name, f"{len(opened)}, {len(sound)}"]
        cells += [sign_cell(own, sign) for sign in SIGNS]
        cells += [
            roc.format_share(int((g.verdict == DELAMINATED).sum()), len(g)) for g in (opened, sound)
        ]
        lines.append(f"| {' | '.join(cells)} |")
    return lines


def sign_cell(table: pd.DataFrame, sign: str) -> str:
    """Return a table cell with a sign's area under the curve and its rate."""
    curve = sign_curve(table, sign)
    if curve is None:
        return "none"
    known = table[table[sign].notna()]
    counts = int((known.opened == 1).sum()), int((known.delaminated == 0).sum())
    error = roc.area_error(curve.area, *counts)
    return f"{curve.area:.3f} ± {error:.3f}; {100.0 * curve.true_rate_at(FALSE):.0f} %"


def sign_curve(table: pd.DataFrame, sign: str) -> roc.RocCurve | None:
    """Return a sign's ROC curve for opened against sound beams; None without both."""
    known = table[table[sign].notna() & ((table.opened == 1) | (table.delaminated == 0))]
    positive = known.opened.to_numpy() == 1
    if not len(known) or positive.all() or not positive.any():
        return None
    return roc.compute_curve(known[sign].astype(float), positive)


def group_rows(table: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """Return groups of rows: all, then by noise, level and length of the delamination."""
    masses = table[table["size"].isna()]
    groups = [("all", table), ("two masses", masses)]
    for low, high in pairwise(NOISE):
        groups.append(
            (f"noise {100 * low:g} to {100 * high:g} %", rows_within(masses, "noise", low, high))
        )
    for low, high in pairwise(LEVEL):
        groups.append((f"level {low:g} to {high:g} m/s²", rows_within(masses, "level", low, high)))
    beams = table[table["size"].notna()]
    for low, high in pairwise(SIZE):
        size = beams["size"].astype(float)
        own = beams[(beams.delaminated == 0) | ((size >= low) & (size < high))]
        groups.append((f"finite elements, {low:g} to {high:g} of the length", own))
    return groups


def groups_by_setup(table: pd.DataFrame) -> list[tuple[str, pd.DataFrame]]:
    """Return groups of two-mass rows by excitation, number of sensors, kind of sound beam."""
    masses = table[table["size"].isna()]
    groups = [(f"excitation: {name}", own) for name, own in masses.groupby("excitation", sort=True)]
    groups += [(f"sensors: {count}", own) for count, own in masses.groupby("sensors", sort=True)]
    for kind in (*NONLINEAR, "sagging"):
        own = masses[(masses.kind == kind) | (masses.delaminated == 1)]
        groups.append((f"sound ones: {kind}", own))
    return groups


def rows_within(table: pd.DataFrame, name: str, low: float, high: float) -> pd.DataFrame:
    """Return a table's rows in which the column ``name`` lies in an interval."""
    values = table[name].astype(float)
    return table[(values >= low) & (values < high)]


def draw(rows: Sequence[Sequence[Any]], path: Path) -> Path:
    """Draw ROC curves and detector rates by noise, level and delamination size."""
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure

    shown = [(name, own) for name, own in group_rows(make_table(rows)) if has_both(own)]
    across = 4
    down = -(-len(shown) // across)
    figure = Figure(figsize=(3.2 * across, 3.3 * down), layout="constrained")
    FigureCanvasAgg(figure)
    panels = np.atleast_1d(figure.subplots(down, across, sharex=True, sharey=True)).ravel()
    for panel in panels[len(shown) :]:
        panel.set_visible(False)
    for panel, (name, own) in zip(panels, shown, strict=False):
        draw_panel(panel, name, own)
    panels[0].legend(fontsize=7, loc="lower right")
    figure.supxlabel("sound beams called delaminated")
    figure.supylabel("opened beams called delaminated")
    figure.savefig(path, dpi=80)
    return path


def has_both(table: pd.DataFrame) -> bool:
    """Return whether a table has both opened and sound beams."""
    return bool((table.opened == 1).sum() > 1 and (table.delaminated == 0).sum() > 1)


def draw_panel(panel: Any, name: str, table: pd.DataFrame) -> None:
    """Draw one group of rows: a ROC curve per sign, the detector as a point with intervals."""
    opened, sound = table[table.opened == 1], table[table.delaminated == 0]
    for sign, (label, colour) in SIGNS.items():
        curve = sign_curve(table, sign)
        if curve is not None:
            panel.plot(curve.false, curve.true, color=colour, label=label)
    counts = [(int((own.verdict == DELAMINATED).sum()), len(own)) for own in (sound, opened)]
    at = np.array([count / of for count, of in counts])
    ends = np.array([roc.wilson_interval(*one) for one in counts])
    bars = np.abs(ends - at[:, np.newaxis])[:, :, np.newaxis]
    style = {"fmt": "o", "color": "black", "label": "detect, with 95 % intervals"}
    panel.errorbar(*at, xerr=bars[0], yerr=bars[1], **style)
    panel.set_title(f"{name} ({len(opened)}, {len(sound)})", fontsize=8)
    panel.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.02))
    panel.grid(alpha=0.3)
