"""A structure in words: a line, a table, a label for file names."""

from __future__ import annotations

from typing import Any

from .ranges import ADDED, STRUCTURE
from .structure_numbers import FLAGS, MODAL_PARAMETERS, StructureNumbers


def format_short(value: float) -> str:
    """Format a float for a file name: all its digits, without a trailing ``.0``."""
    return repr(value).removesuffix(".0")


class StructureText(StructureNumbers):
    """Base of :class:`Structure` with its texts."""

    def _format_pair(self, letter: str) -> str:
        """Return a letter and its parameter of both halves, for a label: ``k1.0-2.0``."""
        return letter + "-".join(format_short(self.get(f"{letter}{half}")) for half in self.halves)

    @property
    def halves(self) -> str:
        """Return the numbers of the masses; only the first with a wall."""
        return "1" if self.wall else "12"

    @property
    def kind(self) -> str:
        """Return what it is in a word or some: bonded, delaminated, or against a wall."""
        return "bonded" if self.bonded else "against a wall" if self.wall else "delaminated"

    def _texts_by_quantity(self) -> dict[str, str]:
        """Return texts of the halves' masses, frequencies and damping, of e, and of what is set."""
        halves = (
            *(("masses", "m", 1.0, "kg"), ("natural frequencies", "f", 1.0, "Hz")),
            ("damping", "zeta", 100.0, "%"),
        )
        texts = {}
        for words, letter, scale, unit in halves:
            pair = (scale * self.get(f"{letter}{half}") for half in self.halves)
            texts[words] = f"{' and '.join(f'{value:.4g}' for value in pair)} {unit}"
        texts["e"] = f"{self.e:g}"
        added = {name: getattr(self, name) for name in ADDED if getattr(self, name)}
        return texts | {name: f"{value:g} {STRUCTURE[name].unit}" for name, value in added.items()}

    def __str__(self) -> str:
        """Return the structure in a line, frequencies in Hz and damping ratios in per cent."""
        texts = (f"{name} {text}" for name, text in self._texts_by_quantity().items())
        return f"{self.kind}: {', '.join(texts)}"

    def _repr_pretty_(self, printer: Any, cycle: bool) -> None:
        """Print the line of ``str`` in IPython."""
        printer.text(f"Structure({self})")

    def _repr_html_(self) -> str:
        rows = {"structure": self.kind, **self._texts_by_quantity()}
        cells = (f"<tr><th>{name}</th><td>{text}</td></tr>" for name, text in rows.items())
        return f"<table>{''.join(cells)}</table>"

    def label(self) -> str:
        """Return a short text of the parameters for file names and titles, unique per structure."""
        default = type(self)()
        if (self.m1, self.k1) == (1.0, 1.0):
            damping_ratios = dict.fromkeys(format_short(self.get(f"D{i}")) for i in self.halves)
            parts = [f"e{format_short(self.e)}", f"D{'-'.join(damping_ratios)}"]
            names: tuple[str, ...] = (*(() if self.wall else ("mu", "kappa")), "gamma", *ADDED)
        else:
            masses, *si = (self._format_pair(letter) for letter in ("m", "k", "d"))
            halves = [self._format_pair(letter) for letter in ("f", "zeta")]
            own = [name for name in MODAL_PARAMETERS if name[-1] in self.halves]
            numbers = self._si_from_halves({name: self.get(name) for name in own})
            exact = all(getattr(self, name) == value for name, value in numbers.items())
            shorter = exact and len("".join(halves)) < len("".join(si))
            parts = [f"e{format_short(self.e)}", masses, *(halves if shorter else si)]
            names = ("gamma", *ADDED)
        for name in names:
            if self.get(name) != default.get(name):
                parts.append(f"{name}{format_short(self.get(name))}")
        return "_".join([*parts, *(name for name in FLAGS if getattr(self, name))])
