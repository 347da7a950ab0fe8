"""Steps of most commands: call the public function, print a summary, write the files."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from functools import partial
from pathlib import Path
from typing import Any, Literal

import orchestrate

from ..errors import InputError
from ..lazy import xr
from ..model import Structure
from ..units import ALIKE, Units, with_readable_lengths, with_units
from .command import Command, Keywords, Options, option, option_names
from .grammar import load_earlier_result
from .notes import print_and_warn_of_frequencies, trivial_question_notes
from .options import UNITS
from .output import ResultFiles, question_digest, result_file_stem, write_unstored_netcdf
from .printing import describe, impact_lines

UNIT_OF_OPTION = {name: ALIKE.get(unit, unit) for name, unit in {**UNITS, "eta": "eta"}.items()}
VARIED = ("eta", "frequency", "level", "values")
# by structure, or by "" where there is one
States = Mapping[str, Any]
Files = Mapping[str, ResultFiles]
Runs = Mapping[str, "xr.Dataset"]


class Overlay(Options):
    """The option of branches over a picture."""

    overlay: list[str] = option(
        "NetCDF files of branches that are drawn over the picture", (), "FILE,...", many=True
    )


class Only(Options):
    """The option of one structure of both."""

    only: Literal["bonded", "delaminated"] | None = option("one of both (default: both)")


class FunctionCommand(Command):
    """A command that calls a public function, prints a summary and writes files."""

    named = ""  # how the names of results begin, if not by the function
    stores = True  # whether the function itself writes the result
    shows = ""  # variables that are printed of a result

    def read_question(self) -> tuple[Any, ...]:
        structure = self.read_and_report_structure()
        excitation = self.read_excitation(structure, needs_metres=True, one_frequency=True)
        return structure, {**self.function_keywords(), **excitation}

    def summary_lines(self, data: Any) -> Iterable[str]:
        yield from describe(data, self.shows)
        if "impact" in data.dims:
            yield from impact_lines(data)

    def all_summary_lines(self, results: Runs) -> Iterator[str]:
        for state, data in results.items():
            yield from [f"{state}:"] if state else []
            yield from self.summary_lines(data)

    def has_picture(self, question: Keywords) -> bool:
        return True

    def draw(self, results: Runs, question: Keywords, *over: xr.Dataset) -> Any:
        return orchestrate.plot(*[*results.values()][::-1], *over)

    def source_file_stems(self) -> list[str]:
        paths = (getattr(self, name, None) for name in ("drive", "structure", "start"))
        files = [Path(path).stem for path in paths if path and isinstance(path, (str, Path))]
        return list(dict.fromkeys(files))[:2] or ["paper"]

    def structures_by_state(self, structure: Any) -> dict[str, Any]:
        """Return the structures of the question, by name; ``""`` if there is one."""
        if not (getattr(self, "beside", False) or hasattr(self, "only")):
            return {"": structure}
        both = {"bonded": structure.as_bonded(), "delaminated": structure.as_delaminated()}
        if only := getattr(self, "only", None):
            return {only: both[only]}
        for name in ("store", "start"):
            if getattr(self, name, None) is not None:
                text = "computes two structures; expected it without"
                raise InputError(f"--beside: {text} {option_names([name])}")
        return both

    def compute(self, states: States, others: Any, question: Keywords, files: Files) -> Runs:
        function: Callable[..., xr.Dataset] = getattr(orchestrate, self.calls)
        results = {}
        for state, structure in states.items():
            running = self.running_keywords(files[state].result if self.stores else None)
            results[state] = function(structure, *others, **question, **running)
        return results

    def __call__(self) -> None:
        structure, *others, question = self.read_question()
        self.compute_print_and_write(structure, *others, question)

    def compute_print_and_write(self, structure: Any, *rest: Any, picture: bool = True) -> Runs:
        """Compute results, print their summary, write files; return them."""
        *others, question = rest
        states = self.structures_by_state(structure)
        branches = self.read_overlay_branches(structure, question)
        over = f"over_{question_digest(*branches)}" if branches else ""
        asked, fresh = (structure, *others, question), None if self.stores else True
        name = result_file_stem(self.named or self.calls, self.source_file_stems(), *asked)
        files = {}
        for state in states:
            word = re.sub(r"[^\w]", "-", f"_{state}" if state else "")
            files[state] = ResultFiles.from_options(self, f"{name}{word}", over, fresh)
        common = next(iter(files.values()))
        if len(files) > 1:
            fresh = any(one.fresh for one in files.values())
            common = ResultFiles.from_options(self, name, over, fresh)
        alone = isinstance(structure, Structure) and not others
        if alone:
            print_and_warn_of_frequencies(self, structure, question)
        results = self.compute(states, others, question, files)
        chosen = self.display_units(question)
        in_units = {state: with_units(data, chosen) for state, data in results.items()}
        shown = dict(zip(in_units, with_readable_lengths(*in_units.values()), strict=True))
        notes = trivial_question_notes(structure, question, [*shown.values()][-1]) if alone else ()
        print(*notes, *self.all_summary_lines(shown), sep="\n")
        self.print_units_note(*shown.values())
        for state, data in in_units.items():
            if not self.stores:
                write_unstored_netcdf(files[state], results[state])
            files[state].write_tables(data)
        if picture and self.has_picture(question):
            common.write_pictures(partial(self.draw, shown, question, *branches))
        self.write_further_files(common, shown, results)
        return results

    def write_further_files(self, files: ResultFiles, shown: Runs, results: Runs) -> None:
        """Write what a command has besides results and picture."""

    def read_overlay_branches(self, structure: Any, question: Keywords) -> list[xr.Dataset]:
        paths = [Path(name) for text in getattr(self, "overlay", []) for name in text.split(",")]
        if not paths:
            return []
        from ..show.overlay import explain_border_mismatch, explain_branch_mismatch

        branches = [load_earlier_result("--overlay", path) for path in paths]
        parameters = structure.parameters()
        if self.calls == "map":
            both = {name for name, value in question.items() if isinstance(value, tuple)}
            explain = partial(explain_border_mismatch, over=both, parameters=parameters)
        elif "level" in question:
            raise InputError(f"--overlay: with several levels, --g {self.g}; expected one")
        elif not has_several_values(question):
            raise InputError("--overlay: one value has no picture; expected a range or a list")
        else:
            over = question.get("over") or ("eta" if "eta" in question else "frequency")
            if self.calls == "resonance":  # of both
                parameters.pop("bonded")
            explain = partial(explain_branch_mismatch, over=over, parameters=parameters)
        for path, branch in zip(paths, branches, strict=True):
            if why := explain(branch):
                raise InputError(f"--overlay {path}: {why}")
        return branches

    def display_units(self, question: Keywords) -> Units:
        """Return the display units: those of ``--units``, else those of the question's options."""
        varied = str(getattr(self, "over", "")).replace(" ", "").split(",")  # two of a border
        names = [*varied, *(name for name in UNIT_OF_OPTION if getattr(self, name, None))]
        given = [UNIT_OF_OPTION[name] for name in names if name in UNIT_OF_OPTION]
        own = "frequency" in question and not given
        keys = self.toml_tables.get("excitation", {}) if own else {}
        words = [key.removeprefix("frequency_") for key in keys]
        given += [ALIKE.get(word, word) for word in words if word in (*UNITS.values(), "eta")]
        in_g = getattr(self, "g", None) is not None or "acceleration_g" in keys
        frequency = (*given, "eta" if "eta" in question else "Hz")[0]
        return self.read_units().with_defaults(Units(frequency, acceleration="g" if in_g else ""))


def has_several_values(question: Mapping[str, Any]) -> bool:
    varied = (question.get(name) for name in VARIED)
    return any(len(values) > 1 for values in varied if isinstance(values, tuple))
