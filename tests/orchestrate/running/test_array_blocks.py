"""Results larger than memory: read, summed and written in blocks, with the same contents."""

import subprocess
import sys

import numpy as np
import pytest
import xarray as xr

from orchestrate.model import Structure
from orchestrate.response.sweep import sweep
from orchestrate.running import array_blocks, netcdf, store

PAPER = Structure.nondimensional()
SHORT = {"transient": 5, "samples": 20, "progress": False, "jobs": 1}
FREQUENCIES = np.append(np.linspace(1.0, 2.0, 120), [0.9, 0.5])  # two chunks, not in order
BOX = {"frequency": FREQUENCIES, "amplitude": 0.5}


@pytest.fixture
def small(monkeypatch):
    """Blocks of some rows, and files of any size opened lazily; how many rows were read at once."""
    counts = []
    rows = store.StoredRows.read_rows

    def counted(stored, chosen):
        counts.append(len(chosen))
        return rows(stored, chosen)

    monkeypatch.setattr(array_blocks, "BLOCK", 400)
    monkeypatch.setattr(array_blocks, "FILE_BLOCK", 100)
    monkeypatch.setattr(store, "MIN_COMPRESSED", 100)
    monkeypatch.setattr(store, "MAX_LOADED", 1000)
    monkeypatch.setattr(netcdf, "MAX_LOADED", 1000)
    monkeypatch.setattr(store.StoredRows, "read_rows", counted)
    return counts


@pytest.mark.parametrize("direction", ["both", "given"])
def test_a_sweep_in_blocks_is_that_of_memory(exported, tmp_path, small, direction):
    arguments = {"direction": direction, **BOX, **SHORT}
    whole = sweep(PAPER, **arguments)
    assert not small
    for _ in range(2):  # computed, and read again
        stored = sweep(PAPER, store=tmp_path / "a.nc", **arguments)
        assert stored.equals(whole) and stored.xi_rel.attrs == whole.xi_rel.attrs
    assert small and max(small) <= 20 and sum(small) >= 2 * len(FREQUENCIES)


def test_blocks_make_up_an_array_in_its_order(tmp_path, small):
    data = xr.Dataset()
    for shape in ((), (0,), (5000,), (3, 41, 20), (900, 2, 3)):
        values = np.random.default_rng(1).normal(size=shape)
        parts = [values[block].ravel() for block in array_blocks.block_indices(shape)]
        assert np.array_equal(np.concatenate(parts), values.ravel())
        assert all(len(part) <= 400 for part in parts)
        name = f"x{len(data)}"
        data[name] = [f"{name}_{i}" for i in range(len(shape))], values
    path = store.write_netcdf(data, tmp_path / "a.nc")
    assert store.load_result(path).equals(data) and store.load_foreign_result(path).equals(data)


IMPORTING = """
import threading
from orchestrate.running.array_blocks import lazy_array_of_rows
from orchestrate.running.runner import import_xarray
thread = threading.Thread(target=import_xarray)
thread.start()
__import__('time').sleep(0.3)
lazy_array_of_rows((3,), 2, None)
"""


def test_another_thread_may_be_importing_xarray():
    subprocess.run([sys.executable, "-c", IMPORTING], check=True)
