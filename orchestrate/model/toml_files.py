"""Read and write TOML files of a structure, its excitation, drive or shaker; find shipped sets.

================  ================================================================================
section           keys
================  ================================================================================
``[structure]``   SI: ``m1 m2 k1 k2 d1 d2``; or the paper's numbers: ``mu kappa`` and ``D``, or
                  ``D1 D2``, which ``m1`` and one of ``omega_hz omega_rad_s omega_rpm`` scale;
                  or each half's ``f1_hz f2_hz zeta1 zeta2`` with ``m1 m2``, one mass before a
                  stop: ``wall f1_hz zeta1``; with all: ``bonded`` and the numbers of the contact,
                  ``e gamma`` and the others of :class:`.Structure`
``[excitation]``  one of ``frequency_hz frequency_rad_s frequency_rpm eta``; one of ``amplitude``
                  (m) and ``acceleration_g`` (peak, in 9.80665 m/s^2), which may be left out with
                  ``eta``: 1/eta^2 m; ``phase`` (rad); ``box_acceleration`` (m/s^2), ``force1``
                  and ``force2`` (N)
``[motor]``       ``unbalance_mass unbalance_radius rotor_inertia motor_constant
                  armature_resistance armature_inductance``, SI; or, in place of ``motor_constant
                  armature_resistance``, a datasheet's ``rated_voltage stall_torque`` and one of
                  ``no_load_speed_rpm no_load_speed_rad_s no_load_speed_hz``: ``rotor_inertia`` is
                  then the rotor's, without the unbalance, or ``mechanical_time_constant``
                  (s) stands in place of it; or ``beta epsilon b``
``[shaker]``      an electrodynamic shaker, SI: ``table_mass suspension_stiffness suspension_damping
                  voltage_limit current_limit travel_limit``; or its data sheet's ``rated_force
                  moving_mass suspension_resonance amplifier_power`` (N, kg, Hz, VA) and
                  ``travel payload damping_ratio``; with both ``force_factor coil_resistance
                  coil_inductance current_control``
``[box]``         ``box_mass box_stiffness box_damping``, SI; or ``Omega_b D_b``. What is not SI
                  refers to the structure.
================  ================================================================================

What may be left out has the default of its class.
"""

from __future__ import annotations

import re
from collections.abc import Mapping
from os import PathLike
from pathlib import Path
from typing import Any

from ..errors import InputError
from ..files import read_text, write_atomically
from .described import Described
from .drive import Drive
from .excitation import Excitation
from .ranges import DRIVE, ELECTRODYNAMIC_SHAKER, PUSHES, STRUCTURE, written_unit_factors
from .sections import (
    QUANTITIES,
    Section,
    check_m1_given,
    read_drive,
    read_excitation,
    read_shaker,
    read_structure,
)
from .shaker import Shaker
from .spelling import expected_one_of
from .structure import Structure

FOLDER = Path(__file__).parent / "sets"
SETS = {name: FOLDER / f"{name}.toml" for name in ("paper", "quick", "beam", "rig")}
SHAKERS = {  # sets of shakers
    name: FOLDER.with_name("shakers") / f"{name}.toml"
    for name in ("shaker_10N", "shaker_100N", "shaker_1kN")
}
MAX_BYTES = 1 << 16  # of a file: some twenty numbers and as many remarks as they need
# an assignment with a decimal comma or a unit
NUMBER = (
    r"\s*(?P<key>\w+)\s*=\s*(?P<number>[-+]?[\d.]+(e[-+]?\d+)?)(?P<comma>(,\d+)?) *"
    r"(?P<unit>[^#,]*?)\s*(#.*)?"
)
SECTIONS = ("structure", "excitation", "motor", "box", "shaker")


def resolve_path(source: str | PathLike[str]) -> Path:
    """Return the TOML file's path for a shipped set's name or a user's path; raise if missing."""
    known = {**SETS, **SHAKERS}
    if str(source) in known:
        return known[str(source)]
    path = Path(source)
    if not path.is_file():
        what = "a folder" if path.is_dir() else "no such file"
        text = expected_one_of(str(source), known).removeprefix("expected")
        raise InputError(f"{source}: {what}; expected a TOML file or{text}")
    return path


def read(
    source: str | PathLike[str],
    structure: Structure | None = None,
    tables: Mapping[str, Any] | None = None,
) -> dict[str, Described]:
    """Read a TOML file; return its structure, excitation, drive and shaker, if any, by name."""
    path = resolve_path(source)
    tables = read_tables(path) if tables is None else tables
    for name, values in tables.items():
        if name in SECTIONS and not isinstance(values, dict):
            raise InputError(f"{path}: {name} = {values!r}: expected a section [{name}]")
        if not isinstance(values, dict):
            places = ", ".join(f"[{section}]" for section in SECTIONS)
            text = f"{name} = {values!r}: outside of a section; expected it below one of {places}"
            raise InputError(f"{path}: {text}")
        if name not in SECTIONS:
            raise InputError(f"{path}: {name}: no section; {expected_one_of(name, SECTIONS)}")
    sections = {name: Section(path, name, values) for name, values in tables.items()}
    contents: dict[str, Described] = {}
    if "structure" in sections:
        contents["structure"] = structure = read_structure(sections["structure"])
    if "excitation" in sections:
        contents["excitation"] = read_excitation(sections["excitation"], structure)
    if sections.keys() & {"motor", "box"}:
        for name in {"motor", "box"} - sections.keys():
            raise InputError(f"{path}: no section [{name}]; expected [motor] and [box] together")
        if "structure" in sections:
            check_m1_given(sections["structure"], sections["motor"])
        contents["drive"] = read_drive(sections["motor"], sections["box"], structure)
    if "shaker" in sections:
        contents["shaker"] = read_shaker(sections["shaker"])
    return contents


def read_section(
    source: str | PathLike[str],
    name: str,
    structure: Structure | None = None,
    tables: Mapping[str, Any] | None = None,
) -> Described:
    contents = read(source, structure, tables)
    if name not in contents:
        expected = "[motor] and [box]" if name == "drive" else f"[{name}]"
        raise InputError(f"{source}: describes no {name}; expected {expected}")
    return contents[name]


Described._reader = read_section


def read_tables(path: Path) -> dict[str, Any]:
    """Return a TOML file's tables as nested dicts; syntax errors raise ``InputError``."""
    import tomllib

    text = ""
    try:
        text = read_text(path, MAX_BYTES)
        return tomllib.loads(text)
    except OSError as error:
        reason = error.strerror or str(error)
    except ValueError as error:  # of the syntax, or of the encoding
        reason = str(error).splitlines()[0]
        if line := re.search(r"\(at line (\d+), column", reason):
            reason = explain_invalid_number(text.splitlines()[int(line[1]) - 1]) or reason
    except RecursionError:
        reason = "nested too deeply"
    expected = "expected sections and key = value"
    if path.suffix.lower() != ".toml":
        expected += ", in a file that ends in .toml: this one looks like a record or a result"
    raise InputError(f"{path}: not readable as TOML ({reason}); {expected}")


def explain_invalid_number(line: str) -> str:
    """Return what is wrong with a number that TOML does not know; nothing where it is not that."""
    pair = re.fullmatch(NUMBER, line)
    if pair is None or not (pair["comma"] or pair["unit"]):
        return ""
    key, number = pair["key"], pair["number"] + pair["comma"].replace(",", ".")
    quoted = pair["unit"] in written_unit_factors(key)
    meant = f'"{number} {pair["unit"]}"' if quoted else number
    own = f", in {QUANTITIES[key].unit}" if key in QUANTITIES and not quoted else ""
    return f"{line.partition('#')[0].strip()}: write {key} = {meant}{own}"


def write(
    path: str | PathLike[str],
    *,
    structure: Structure | None = None,
    excitation: Excitation | None = None,
    drive: Drive | None = None,
    shaker: Shaker | None = None,
) -> Path:
    """Write structure, excitation, drive and shaker to a TOML file in SI, exact to the last bit."""
    tables: dict[str, Mapping[str, float | bool]] = {}
    if structure is not None:
        tables["structure"] = structure.parameters()
    if excitation is not None:
        phase, amplitude = excitation.phase, excitation.amplitude
        box = {"frequency_rad_s": excitation.frequency, "amplitude": amplitude, "phase": phase}
        pushes = zip(PUSHES, excitation.pushes, strict=True)
        tables["excitation"] = box | {name: value for name, value in pushes if value}
    if drive is not None:
        values = drive.parameters()
        box = {name: values.pop(name) for name in list(values) if name.startswith("box_")}
        tables |= {"motor": values, "box": box}
    if shaker is not None:
        tables["shaker"] = shaker.parameters()
    text = "\n".join(format_toml_section(name, values) for name, values in tables.items())
    return write_atomically(path, lambda place: place.write_text(text, encoding="utf-8"))


def format_toml_section(name: str, values: Mapping[str, float | bool]) -> str:
    """Return one section as TOML text; each key has a comment with its meaning and unit."""
    described = {**STRUCTURE, **DRIVE, **ELECTRODYNAMIC_SHAKER}
    lines = [f"[{name}]"]
    for key, value in values.items():
        line = f"{key} = {str(value).lower() if isinstance(value, bool) else repr(value)}"
        quantity = described.get(key)
        note = f"  # {quantity.description}, {quantity.unit}" if quantity else ""
        lines.append(line + note.removesuffix(", 1"))
    return "\n".join([*lines, ""])
