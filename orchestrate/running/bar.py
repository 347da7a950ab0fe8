"""Progress bar of a computation: a line that moves, or in a log a line every ten per cent."""

from __future__ import annotations

import sys
import warnings
from typing import Any

DELAY = 1.0  # s until a progress bar shows: shorter work needs none
MAX_LABEL = 24  # characters, or little is left for the bar
LOG_WIDTH = 80


class LogLineStream:
    """Text stream for tqdm that writes each new state of a bar as a line of its own."""

    def __init__(self) -> None:
        self.last = ""

    def write(self, text: str) -> None:
        """Write a bar as a line, unless it says the same as the last one but for the time."""
        state = text.strip().rpartition(" [")[0]
        if state and state != self.last:
            self.last = state
            sys.stderr.write(f"{text.strip()}\n")

    def flush(self) -> None:
        sys.stderr.flush()


def progress_bar(label: str, shown: bool, *, total: int, initial: int, unit: str) -> Any:
    from tqdm import tqdm

    options: dict[str, Any] = {
        **{"total": total, "initial": initial, "unit": unit, "desc": shorten_label(label)},
        **{"delay": DELAY, "smoothing": 0.1, "unit_scale": total > 100_000},
    }
    if not shown:
        return tqdm(disable=True, **options)
    if sys.stderr.isatty() or "ipykernel" in sys.modules:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of a notebook without widgets: it gets a line of text
            from tqdm.auto import tqdm as automatic
        return automatic(dynamic_ncols=True, **options)
    every = {"miniters": max(1.0, total / 10), "mininterval": 0.0, "maxinterval": float("inf")}
    return tqdm(file=LogLineStream(), ncols=LOG_WIDTH, **every, **options)


def update_bar(bar: Any, label: str) -> None:
    """Show a bar's label, time and time left as they are now; in a log only a new label."""
    if bar.disable:
        return
    bar.delay = 0.0  # it is shown from now on, or tqdm would not end its line
    if bar.desc != f"{shorten_label(label)}: ":
        bar.set_description(shorten_label(label))
    elif not isinstance(bar.fp.__dict__.get("_wrapped", bar.fp), LogLineStream):
        bar.refresh()


def shorten_label(label: str) -> str:
    return label if len(label) <= MAX_LABEL else f"{label[: MAX_LABEL - 3]}..."
