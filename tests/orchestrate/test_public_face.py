"""The public face as users call it: every function, own SI parameters, scripts and notebooks."""

import json
import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate import Drive, InputError, Structure
from tests import ROOT

from ..exports import once
from .laboratory.analysis.records import analyses

FUNCTIONS = (
    *("simulate", "resonance", "sweep", "map", "lyapunov", "attractors", "basin", "spectra"),
    *("impact_statistics", "poincare", "basin_entropy", "orbit", "branch", "border", "couple"),
    *("cosimulate", "manifold"),
    *("shake", "measure", "record", "read_record", "write_record", "channels", "halves"),
    *("resonance_curve", "read_curve", "to_dataframe"),
)
OWN = Structure(m1=0.8, m2=1.1, k1=5000.0, k2=7500.0, d1=1.3, d2=0.9, e=0.6)  # 79 rad/s
NEAR = 1.05 * OWN.omega
UNIT = Structure.nondimensional()


def motor() -> Drive:
    ratios = {"beta": 0.25, "epsilon": 1e-3, "b": 0.02, "Omega_b": 0.1, "D_b": 0.005}
    return Drive.nondimensional(**ratios, structure=OWN)


def questions() -> dict[str, xr.Dataset]:
    """Each function, asked something small in SI."""
    box = {"frequency": NEAR, "amplitude": 1e-3}
    short = {"transient": 20, "samples": 8}
    many = np.linspace(0.9, 1.1, 3) * OWN.omega
    at_three, at_two = ({"frequency": many[:n], "amplitude": 1e-3} for n in (3, 2))
    pressed, levels = OWN.replace(clearance=-1e-6), {"frequency": many, "level": [0.1, 5.0]}
    plane = {"x": ("x_rel", 0.0, 1e-3, 3), "y": ("v_rel", -0.1, 0.1, 2)}
    numbers = {"kappa": [1.2, 1.5], "e": [0.3, 0.7], "exponent": True}
    volts = motor().volts(OWN)
    held = {"inputs": {"voltage": volts}, "duration": 0.2, "step": 0.01, "record": ["speed"]}
    ramp = {"voltage": (1.2 * volts, 1.25 * volts), "rate": 1e-3 * volts * OWN.omega}
    return {
        "simulate": orchestrate.simulate(OWN, **box, periods=3, points=20),
        "resonance": orchestrate.resonance(OWN, **at_three, **short),
        "resonance levels": orchestrate.resonance_levels(pressed, **levels, **short),
        "sweep": orchestrate.sweep(OWN, **at_three, **short),
        "sweep both": orchestrate.sweep(OWN, **at_three, direction="both", **short),
        "sweep over": orchestrate.sweep(OWN, over="k2", values=[6000.0, 8000.0], **box, **short),
        "map": orchestrate.map(OWN, **at_three, e=[0.3, 0.7], transient=20),
        "map exponent": orchestrate.map(OWN, **box, **numbers, transient=20),
        "lyapunov": orchestrate.lyapunov(OWN, **at_two, transient=20, periods=100),
        "attractors": orchestrate.attractors(OWN, **at_two, starts=4, seed=1, transient=20),
        "basin": orchestrate.basin(OWN, **box, **plane, transient=20),
        "spectra": orchestrate.spectra(OWN, **box, periods=4, points=128, transient=20),
        "poincare": orchestrate.poincare(OWN, **box, transient=20, periods=20, at="impacts"),
        "impact_statistics": orchestrate.impact_statistics(OWN, **box, transient=20, periods=20),
        "orbit": orchestrate.orbit(UNIT, eta=2.0),
        "manifold": orchestrate.manifold(UNIT, eta=3.0, length=0.3),
        "branch": orchestrate.branch(UNIT, eta=2.0, limits=(1.95, 2.05)),
        "cosimulate": orchestrate.cosimulate(OWN, motor(), **held),
        "couple": orchestrate.couple(OWN, motor(), **ramp),
    }


@pytest.fixture(scope="module")
def answers(exported, tmp_path_factory) -> dict[str, xr.Dataset]:
    return once(tmp_path_factory, "answers", questions)


def test_every_name_is_there():
    assert set(FUNCTIONS) <= set(orchestrate.__all__) <= set(dir(orchestrate))
    assert all(callable(getattr(orchestrate, name)) for name in FUNCTIONS)
    with pytest.raises(AttributeError, match="no_such_name"):
        orchestrate.no_such_name  # noqa: B018


def test_importing_it_and_the_model_needs_the_standard_library_alone():
    script = "import sys; before = set(sys.modules); import orchestrate, orchestrate.model\n"
    script += "print(*{n.partition('.')[0] for n in set(sys.modules) - before})"
    command = [sys.executable, "-c", script]
    done = subprocess.run(command, capture_output=True, text=True, check=True, cwd=ROOT)
    loaded = set(done.stdout.split()) - sys.stdlib_module_names
    assert loaded == {"orchestrate", "fmu_src"}


@pytest.mark.parametrize("name", FUNCTIONS)
def test_each_has_a_documented_example(name):
    text = getattr(orchestrate, name).__doc__
    for part in ("Parameters\n", "Returns\n", "Examples\n", ">>> "):
        assert part in text, part


def test_units_and_long_names_are_on_everything(answers):
    bare = [
        f"{question}: {name}.{attribute}"
        for question, data in {**answers, **analyses()}.items()
        for name, variable in data.variables.items()
        for attribute in ("units", "long_name")
        if attribute not in variable.attrs
        and (attribute != "units" or variable.dtype.kind not in "SUO" + "b" * (question in answers))
    ]
    assert bare == []


def test_attributes_say_where_it_comes_from_and_it_can_be_written(answers, tmp_path):
    for question, data in answers.items():
        assert {"title", "call", "history", "source", "Conventions", "identity"} <= set(data.attrs)
        assert any(name.startswith("fmu_guid") for name in data.attrs), question
        assert data.attrs["m2"] in (OWN.m2, UNIT.m2), question
        path = tmp_path / f"{question}.nc"
        data.to_netcdf(path)
        assert xr.load_dataset(path).equals(data), question
        identity = json.loads(data.attrs["identity"])
        assert identity.pop("code"), question  # a digest of each module
        lengths = [len(str(value)) for value in {**data.attrs, "identity": identity}.values()]
        assert max(lengths) < 2000, question


def test_a_table_has_a_row_a_response(answers):
    sweep, turns = answers["sweep"], 2.0 * np.pi * np.array([46.5, 46.75, 47.0])
    sweep = sweep.assign_coords(frequency=sweep.frequency.copy(data=turns))
    table = orchestrate.to_dataframe(sweep, units="Hz,mm")
    assert table["frequency [Hz]"].tolist() == [46.5, 46.75, 47.0]  # none is 46.75000000000001
    assert set(table.multiplicity_decided) <= {"repeated", "irregular", "undecided"}
    assert len(orchestrate.to_dataframe(sweep[["xi_rel"]])) == sweep.xi_rel.size
    assert len(orchestrate.to_dataframe(answers["resonance"])) == answers["resonance"].x1_max.size
    with pytest.raises(InputError, match="expected a result"):
        orchestrate.to_dataframe(sweep[[]])
