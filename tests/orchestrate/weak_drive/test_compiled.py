"""The compiled steps against the same in Python: equal to the last bit, refusals too."""

import ctypes
import math

import numpy as np
import pytest

from fmu_src.export.errors import CannotExport
from orchestrate.access import c_library as libraries
from orchestrate.errors import FmuError
from orchestrate.weak_drive import compiled
from orchestrate.weak_drive.compiled import SOURCE, CompiledMaster, Pair, create_master
from orchestrate.weak_drive.extremes import Revolution
from orchestrate.weak_drive.master import ALGORITHMS, Master, Scheme

from .coupled import QUICK, master, rest

COUNT = 400
SCHEMES = [
    *(Scheme(name, 0.1, matched) for name in ALGORITHMS for matched in (True, False)),
    *(Scheme(name, 0.4, tolerance=1e-8) for name in ("rollback", "iterated")),
    Scheme(0.4, matched=False, tolerance=1e-6, halvings=3, easy=0.1),
    Scheme("gauss-seidel", 0.1, beginning=(1, 3, 9)),
]


def done(kind, system, scheme, speed=1.2):
    """All that a master remembers after each interval, its revolutions, and both FMUs' states."""
    voltages = [1.4 + 0.3 * math.sin(0.02 * i // 7) for i in range(COUNT)]
    with master(system, scheme, rest(speed), kind=kind) as m:
        assert type(m) is kind
        kept, seen, at = np.full((COUNT, len(m.get_state())), math.nan), [], 0
        m.revolution = Revolution.begin(m.motion, m.shaking)
        while at < COUNT:
            at = m.run(voltages, at, kept=kept)
            seen.append((at, *vars(m.revolution).values()))
            turn = m.shaking.angle // (2.0 * math.pi)
            m.revolution = Revolution.begin(m.motion, m.shaking, turn, m.time)
        m.revolution = None
        m.run(voltages[:2], h=0.03)
        states = [one.instance.save_state() for one in (m.oscillator, m.shaker)]
        return kept, seen, m.get_state(), states


@pytest.mark.parametrize("scheme", SCHEMES, ids=str)
def test_the_same_bits(scheme):
    system = QUICK.with_structure(D1=0.01, D2=0.05)  # the force jumps at impacts
    rows, seen, memory, states = done(Master, system, scheme)
    found = done(CompiledMaster, system, scheme)
    assert rows[-1, -8 - 10 - 10 + 7] > 0.0  # impact energy
    assert len(seen) > 5
    assert np.array_equal(found[0], rows)
    assert found[1:] == (seen, memory, states)


@pytest.mark.parametrize("system", [QUICK.as_bonded(), QUICK.with_lag(0.3)], ids=["bonded", "lag"])
def test_the_same_bits_of_other_systems(system):
    scheme = Scheme(0.4, tolerance=1e-8)
    rows, *others = done(Master, system, scheme, -1.2)  # backward
    found = done(CompiledMaster, system, scheme, -1.2)
    assert np.array_equal(found[0], rows)
    assert list(found[1:]) == others


def refusal(kind):
    """What is said where the shaker refuses a voltage, and where the run goes on from there."""
    with master(QUICK, Scheme(), rest(1.2), kind=kind) as m:
        m.step(1.4)
        with pytest.raises(FmuError) as caught:
            m.run([1.4, math.inf, 1.4])
        return str(caught.value)


def test_a_refusal_is_told():
    text = refusal(CompiledMaster)
    assert text == refusal(Master)
    assert "voltage = inf" in text


def test_fmus_of_other_forms_step_in_python():
    with master(QUICK, Scheme(), rest(), "fmi2") as m:
        assert type(m) is Master
    with master(QUICK, Scheme(), rest()) as m:
        assert type(m) is CompiledMaster


def test_a_library_that_cannot_be_loaded_is_no_failure(tmp_path, monkeypatch):
    (tmp_path / "compiled.so").write_bytes(b"nothing")
    monkeypatch.setattr(libraries, "library", lambda source: tmp_path / "compiled.so")
    assert compiled.load_step_function.__wrapped__() is None


def test_without_a_library_python_does_it(monkeypatch):
    monkeypatch.setattr(compiled, "load_step_function", lambda: None)
    with master(QUICK, Scheme(), rest(), kind=create_master) as m:
        assert type(m) is Master


def test_a_library_of_other_sources_is_made_anew(tmp_path):
    found = libraries.library(SOURCE, tmp_path)
    first = found.read_bytes()
    assert libraries.library(SOURCE, tmp_path) == found
    assert found.read_bytes() == first
    found.write_bytes(first.replace(b"{", b"("))
    assert libraries.library(SOURCE, tmp_path).read_bytes() == first


def test_no_compiler_is_no_failure(tmp_path, monkeypatch):
    def none(*arguments):
        raise CannotExport("no C compiler")

    monkeypatch.setattr(libraries.sources, "export", none)
    assert libraries.library(SOURCE, tmp_path) is None


def test_structures_have_the_sizes_of_the_source():
    """A field forgotten on one side would shift all that follow."""
    with master(QUICK, Scheme(), rest()) as m:
        numbers = [8 * len(m.get_state()), 8 * len(compiled.PLACES)]
    sizes = (ctypes.c_uint * 3).in_dll(ctypes.CDLL(str(libraries.library(SOURCE))), "sizes")
    assert list(sizes) == [ctypes.sizeof(Pair), *numbers]
