"""The same bits again: two instances, two processes, a saved and restored state, the compiled
kernel and its Python source.
"""

import pytest

from .driver import FMUS, run


def test_two_instances_side_by_side(fmu, tmp_path):
    """Stepped in turns, with other parameters in between, they do not touch each other."""
    same, end, impacts = run("determinism.two_instances_side_by_side", fmu, cwd=tmp_path)
    assert same == 1024
    assert end
    assert impacts > 50


def test_two_processes(fmu, tmp_path):
    first = run("driver.outputs", fmu, 2000.0, cwd=tmp_path)
    assert first["impact_count"] > 300
    assert (
        run("driver.outputs", fmu, 2000.0, cwd=tmp_path, env={"PYTHONHASHSEED": "7", "LC_ALL": "C"})
        == first
    )


def test_state_is_saved_and_restored_in_one_process(fmu, tmp_path):
    """Back and forth in flight and in contact, in the same and in another instance, at several
    depths.
    """
    seen = run("determinism.state_is_saved_and_restored_in_one_process", fmu, cwd=tmp_path)
    assert {where for _, where, *_ in seen} == {"flight", "contact"}
    assert len(seen) == 5  # chaotic motion has hardly any contact
    for name, where, same, moved, impacts in seen:
        assert same, (name, where)
        assert moved, (name, where)
        assert impacts > 50


def test_state_is_saved_before_and_during_initialisation(fmu, tmp_path):
    """Start values, start time and the phase of the calling sequence belong to the state."""
    plain, late, early = run(
        "determinism.state_is_saved_before_and_during_initialisation", fmu, cwd=tmp_path
    )
    assert late == plain
    assert early == plain


def test_state_goes_into_another_process(fmu, tmp_path):
    """Serialised here, deserialised there: as if the run had never stopped."""
    saved = run("determinism.state_goes_into_another_process_save", fmu, cwd=tmp_path)
    assert len(saved) == 5
    other = {"PYTHONHASHSEED": "7"}
    resumed = run(
        "determinism.state_goes_into_another_process_resume", fmu, saved, cwd=tmp_path, env=other
    )
    for key, (_, _, outputs) in saved.items():
        assert resumed[key] == outputs, key


@pytest.mark.parametrize("eta", [1.13, 2.9])
def test_compiled_kernel_gives_the_bits_of_its_source(tmp_path, eta):
    """Over more than a thousand impacts, all outputs; the libraries mapped into the process show
    that none is compared with itself.
    """
    compiled, loaded = run(
        "determinism.compiled_kernel_gives_the_bits_of_its_source",
        FMUS["fmi2-python"],
        eta,
        cwd=tmp_path,
    )
    source, loaded_too = run(
        "determinism.compiled_kernel_gives_the_bits_of_its_source",
        FMUS["fmi2-python"],
        eta,
        cwd=tmp_path,
        pure=True,
    )
    assert loaded and not loaded_too
    assert compiled[-1]["impact_count"] > 1000
    assert compiled == source


def test_compiled_state_continues_in_the_source(tmp_path):
    """A serialised state is the same numbers for both forms."""
    data, outputs = run(
        "determinism.compiled_state_continues_in_the_source_save", FMUS["fmi2-python"], cwd=tmp_path
    )
    assert (
        run(
            "determinism.compiled_state_continues_in_the_source_resume",
            FMUS["fmi2-python"],
            data,
            cwd=tmp_path,
            pure=True,
        )
        == outputs
    )
