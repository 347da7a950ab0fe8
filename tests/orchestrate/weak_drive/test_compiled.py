"""Where the compiled steps come from: the library, made anew where it is not that of the source."""

import ctypes

from orchestrate.fmu import c_library as libraries
from orchestrate.weak_drive import compiled
from orchestrate.weak_drive.compiled import SOURCE, CompiledMaster, Pair, create_master
from orchestrate.weak_drive.master import DRIVE, MOTION, Master, Scheme

from .coupled import QUICK, master, rest


def test_fmus_of_other_forms_step_in_python(monkeypatch):
    with master(QUICK, Scheme(), rest()) as m:
        assert type(m) is CompiledMaster
    with master(QUICK, Scheme(), rest(), "fmi2-python") as m:
        assert type(m) is Master
    monkeypatch.setattr(compiled, "load_step_function", lambda: None)
    with master(QUICK, Scheme(), rest(), kind=create_master) as m:
        assert type(m) is Master


def test_a_library_that_cannot_be_loaded_is_no_failure(tmp_path, monkeypatch):
    (tmp_path / "compiled.so").write_bytes(b"nothing")
    monkeypatch.setattr(libraries, "library", lambda source: tmp_path / "compiled.so")
    assert compiled.load_step_function.__wrapped__() is None


def test_a_library_of_other_sources_is_made_anew(tmp_path):
    found = libraries.library(SOURCE, tmp_path)
    first = found.read_bytes()
    assert libraries.library(SOURCE, tmp_path) == found
    assert found.read_bytes() == first
    found.write_bytes(first.replace(b"{", b"("))
    assert libraries.library(SOURCE, tmp_path).read_bytes() == first


def test_structures_have_the_sizes_of_the_source():
    """A field forgotten on one side would shift all that follow."""
    sizes = (ctypes.c_uint * 3).in_dll(ctypes.CDLL(str(libraries.library(SOURCE))), "sizes")
    assert list(sizes) == [ctypes.sizeof(Pair), MOTION, DRIVE]
