"""Steps of most commands: call the public function, print a summary, write the files."""

from __future__ import annotations

import inspect
from abc import abstractmethod
from collections.abc import Collection, Iterable, Mapping
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..errors import InputError
from ..lazy import xr
from ..units import Units, with_readable_lengths, with_units
from .command import Command, Options, Question, option, option_names
from .grammar import read_earlier_result
from .notes import print_frequency_notes, trivial_notes
from .output import Files, digest, importing_matplotlib, result_name

if TYPE_CHECKING:
    from ..model import Structure

UNIT_OF_OPTION = {"hz": "Hz", "rpm": "rpm", "frequency": "rad/s", "eta": "eta"}
UNIT_OF_KEY = {  # of a structure's file
    "frequency_hz": "Hz",
    "frequency_rpm": "rpm",
    "frequency_rad_s": "rad/s",
    "eta": "eta",
}
VARIED = ("eta", "frequency", "level", "values")


class Overlay(Options):
    """The option of branches over a picture."""

    overlay: list[str] = option(
        "NetCDF files of branches that are drawn over the picture", (), value="FILE,...", many=True
    )


class Asked(Command):
    """A command that asks its public function and shows the result."""

    def ask(self) -> tuple[Structure | None, Question]:
        """Return the structure and the keywords of the public function, at one frequency."""
        structure = self.read_structure()
        excitation = self.read_excitation(structure, si=True, one=True)
        return structure, {**self.keywords(), **excitation}

    @abstractmethod
    def summary(self, data: Any) -> Iterable[str]:
        """Return the lines that are printed of the result."""

    def has_picture(self, question: Question) -> bool:
        return True

    def draw(self, data: xr.Dataset, *others: xr.Dataset) -> Any:
        """Return the figure of the result, with others in it."""
        import orchestrate

        return orchestrate.plot(data, *others)

    def __call__(self) -> None:
        """Ask, print the summary, write result and picture."""
        structure, question = self.ask()
        if structure is None or not getattr(self, "beside", False):
            self.answer(structure, question)
            return
        for name in ("store", "start"):
            if getattr(self, name) is not None:
                raise InputError(f"--beside: computes two structures; expected it without --{name}")
        bonded = self.answer(structure.as_bonded(), question, picture=False)
        print("delaminated:")
        delaminated = structure.as_delaminated()
        self.answer(delaminated, question, ending="with_bonded", beside=(bonded,))

    def answer(
        self,
        structure: Structure | None,
        question: Question,
        *,
        picture: bool = True,
        ending: str = "",
        function: str = "",
        beside: tuple[xr.Dataset, ...] = (),
    ) -> xr.Dataset:
        """Compute one result, print its summary, write files, drawn with others; return it."""
        import orchestrate

        function = function or self.calls
        known = inspect.signature(getattr(orchestrate, function)).parameters
        if "others" not in known and (unknown := [name for name in question if name not in known]):
            text = f"{function} does not know it yet; expected the command without it"
            raise InputError(f"{option_names(unknown[:1])}: {text}")
        branches = self.read_overlay(structure, question) if structure else []
        over = f"over_{digest(*branches)}" if branches else ""
        file = getattr(self, "structure", "") or getattr(self, "start", None) or "paper"
        name = result_name(function, file, structure, question)
        files = Files.from_options(self, f"{name}_{ending}" if ending else name, over)
        picture = picture and self.has_picture(question)
        if structure:
            print_frequency_notes(self, structure, question)
        with importing_matplotlib(picture and files.lacks_pictures()):
            running = self.running(files.result)
            data: xr.Dataset = getattr(orchestrate, function)(structure, **question, **running)
        asked = with_units(data, self.display_units(question))
        (shown,) = with_readable_lengths(asked)
        notes = trivial_notes(structure, question, shown) if structure else ()
        for line in (*notes, *self.summary(shown)):
            print(line)
        draw = partial(self.draw, shown, *branches, *beside)
        files.write(asked, draw if picture else None)
        self.write_more(files, question, data)
        return data

    def write_more(self, files: Files, question: Question, data: xr.Dataset) -> None:
        """Write what a command has besides the result."""

    def read_overlay(self, structure: Structure, question: Mapping[str, Any]) -> list[xr.Dataset]:
        """Return the branches of ``--overlay``; raise for one that does not fit the question."""
        texts = getattr(self, "overlay", [])
        paths = [Path(name) for text in texts for name in text.split(",")]
        if not paths:
            return []
        branches = [read_earlier_result("--overlay", path) for path in paths]
        if self.calls == "map":
            from ..show.overlay import explain_border_mismatch

            both = {name for name, value in question.items() if isinstance(value, tuple)}
            for path, curve in zip(paths, branches, strict=True):
                if why := explain_border_mismatch(curve, both, structure.parameters()):
                    raise InputError(f"--overlay {path}: {why}")
            return branches
        if self.calls == "resonance" and "level" in question:
            raise InputError(f"--overlay: with several levels, --g {self.g}; expected one")
        if not is_curve(question):
            raise InputError("--overlay: one value has no picture; expected a range or a list")
        from ..show.overlay import explain_mismatch

        over = question.get("over") or ("eta" if "eta" in question else "frequency")
        parameters = structure.parameters()
        if self.calls == "resonance":  # of both
            parameters.pop("bonded")
        for path, branch in zip(paths, branches, strict=True):
            if why := explain_mismatch(branch, over, parameters):
                raise InputError(f"--overlay {path}: {why}")
        return branches

    def display_units(self, question: Mapping[str, Any]) -> Units:
        """Return the display units: those of ``--units``, else those of the question's options."""
        varied = str(getattr(self, "over", "")).replace(" ", "").split(",")  # two of a border
        over = next((UNIT_OF_OPTION[name] for name in varied if name in UNIT_OF_OPTION), "")
        given = [unit for name, unit in UNIT_OF_OPTION.items() if getattr(self, name, None)]
        keys = self.excitation_keys() if "frequency" in question and not given else ()
        given += [unit for key, unit in UNIT_OF_KEY.items() if key in keys]
        both = question.get("over") or ()  # of a border
        by_ratio = "eta" in question or (not isinstance(both, str) and "eta" in both)
        frequency = over or next(iter(given), "eta" if by_ratio else "Hz")
        in_g = getattr(self, "g", None) is not None or "acceleration_g" in keys
        usual = Units(frequency, acceleration="g" if in_g else "")
        return self.read_units().with_defaults(usual)

    def excitation_keys(self) -> Collection[str]:
        """Return the keys of the section ``[excitation]`` in the TOML file of ``--structure``."""
        from ..model.toml_files import parse, resolve

        if self.structure is None:  # but that of a stored result
            return ()
        return tuple(parse(resolve(self.structure)).get("excitation", {}))


def is_curve(question: Mapping[str, Any]) -> bool:
    """Return whether a parameter has several values, so that a curve can be drawn."""
    varied = (question.get(name) for name in VARIED)
    return any(len(values) > 1 for values in varied if isinstance(values, tuple))
