"""Commands on measured records: channels, how they are read, and halves, a structure of knocks."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated, Any

from ..errors import InputError
from .command import Command, option
from .grammar import floats, with_option_names
from .output import InColumns, Reading, file_checksum
from .text import table

Pair = Annotated[Any, floats("H1,H2, two numbers such as 3,2", ",", (2,))]


class Halves(InColumns, Reading, Command):
    """Fit a structure to knocks of a hammer on each half, and write it as TOML file."""

    calls, takes = "halves", "resolution estimator"
    records: list[Path] = option(
        "knocks on half 1 and on half 2, a file each; or on a sound beam, with --thicknesses",
        position=True,
        needed=True,
    )
    thicknesses: Pair = option("of layers 1 and 2 of a sound beam, in any unit", value="H1,H2")
    output: Path | None = option("where to write the structure", value="FILE.toml")
    examples = """
  {program} halves half1.csv half2.csv --output beam.toml
  {program} halves sound.uff --thicknesses 3,2 --output beam.toml
  {program} halves half1.csv half2.csv --channels knocks.toml
A record has a column of force, in N, and the acceleration of the half that is struck. Knock so
softly that the halves do not strike each other: 2/pi x peak x width below 2 pi f m x gap. The file
is a guess: --structure of diagnose, plan and others; complete it by e and clearance."""

    def __call__(self) -> None:
        from .. import halves, read_record

        if len(self.records) > 2:
            raise InputError(f"{self.records[-1]}: expected one record of each half")
        records = [read_record(path, **self.given(InColumns, Reading)) for path in self.records]
        if len({*map(file_checksum, self.records)}) < len(records):
            text = f"the same numbers as {self.records[0]}; expected one record of each half"
            raise InputError(f"{self.records[-1]}: {text}")
        if len(records) == 2 and all("force1" in one and "force2" not in one for one in records):
            print(f"{self.records[1]}: taken for knocks on half 2, as the second record")
            names = {"force1": "force2", "acceleration1": "acceleration2"}
            if "acceleration2" in records[1]:  # both faces are measured
                del names["acceleration1"]
            records[1] = records[1].rename({n: new for n, new in names.items() if n in records[1]})
        try:
            fits = halves(*records, **self.keywords())
        except InputError as error:
            name, _, text = str(error).partition(": ")
            path = dict(zip(("record", "other"), self.records, strict=False)).get(name, name)
            raise InputError(f"{path}: {text}" if text else name) from None
        columns = {"half": [str(half) for half in fits.knocked.values]}
        for name in ("mass", "frequency", "damping"):
            cells = zip(fits[name].values, fits[f"{name}_error"].values, strict=True)
            unit = str(fits[name].units).removeprefix("1")
            columns[f"{name} {unit}".rstrip()] = [f"{x:.5g} +- {s:.2g}" for x, s in cells]
        columns["misfit"] = [f"{misfit:.1%}" for misfit in fits.misfit.values]
        print(*table(columns), sep="\n")
        print("e = {e:g} and clearance = {clearance:g} m are assumed".format(**fits.attrs))
        if self.output is not None:
            print(self.output)


class Channels(InColumns, Reading, Command):
    """List the columns of a record, and as which channels they are read; write that as a file."""

    record: Path = option("as for analyse", position=True, needed=True)
    output: Path | None = option(
        "where to write how the columns are read, as TOML: to complete with units, sensitivities, "
        "delays and sensors, and to give as --channels",
        value="FILE.toml",
    )
    examples = """
  {program} channels run.csv
  {program} channels run.csv --channels base=Table,face1=3 --unit face1=g --output setup.toml
  {program} channels run.csv --channels setup.toml
diagnose, analyse and others take --channels setup.toml too. Where the channels cannot be read as
they are, the last line says what is missing."""

    def __call__(self) -> None:
        from .. import channels

        reading = self.given(InColumns, Reading)
        found = channels(self.record, **reading, output=self.output)
        names = ("role", "known", "quantity", "unit")
        rows = {name: found[name].values.tolist() for name in names}
        rms = ["" if value != value else f"{value:.4g}" for value in found.rms.values]
        print(*table({"column": found.column.values.tolist(), **rows, "rms": rms}), sep="\n")
        if rate := found.attrs["sample_rate"]:
            print(f"{rate:.6g} samples a second")
        if refused := found.attrs["refused"]:
            print(f"not to be read so: {with_option_names(refused, self)}")
        if self.output is not None:
            print(self.output)
