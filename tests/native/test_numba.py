"""The way from Numba to an object file: where a new version breaks it, these tests say so."""

import shutil
import subprocess

import pytest

from fmu_src.export import compile_kernel
from fmu_src.export.errors import CannotExport
from fmu_src.export.platforms import PLATFORMS, usual

IR = """
target triple = "x86_64-unknown-linux-gnu"
define i32 @kernel_advance(ptr %memory, double %time) {
  %made = call ptr @NRT_MemInfo_alloc(i64 8)
  store double %time, ptr %made
  store ptr %made, ptr %memory
  ret i32 0
}
declare ptr @NRT_MemInfo_alloc(i64)
"""


def test_installed_numba_compiles_the_kernel(kernel_objects):
    """Fails, not skips, where Numba is there and its output is not what it was; ``kernel_objects``
    says what is wrong.
    """
    assert set(kernel_objects) == set(usual())
    assert kernel_objects["x86_64-linux"][:4] == b"\x7fELF"
    assert kernel_objects["x86_64-windows"][:2] == b"\x64\x86"


@pytest.mark.skipif(shutil.which("objdump") is None, reason="objdump is not installed")
def test_kernel_has_no_instruction_beyond_the_baseline(kernel_objects, tmp_path):
    """No fused multiply-add, whose bits would differ, and no AVX, which older processors lack;
    nothing is called but what the linker has.
    """
    (tmp_path / "kernel.o").write_bytes(kernel_objects["x86_64-linux"])
    code = subprocess.run(
        ["objdump", "-d", "--no-show-raw-insn", "kernel.o"],
        cwd=tmp_path,
        capture_output=True,
        text=True,
        check=True,
    ).stdout
    instructions = {
        line.split("\t")[1].split()[0] for line in code.splitlines() if line.count("\t") > 0
    }
    assert {"mulsd", "addsd"} <= instructions
    assert not [name for name in instructions if name.startswith("v") or name == "fld"]
    symbols = subprocess.run(
        ["objdump", "-t", "kernel.o"], cwd=tmp_path, capture_output=True, text=True, check=True
    ).stdout
    assert {line.split()[-1] for line in symbols.splitlines() if "*UND*" in line} <= {"memset"}


def test_every_function_is_told_of_its_memory():
    """Where a new Numba names parameters otherwise, the kernel would be slower without a word."""
    numba = pytest.importorskip("numba")

    @numba.njit(error_model="numpy")
    def below(m, i):  # calls itself, so that it stays a function
        return m[0] if i < 1.0 else m[int(i)] + 0.5 * below(m, i - 1.0)

    @numba.njit(error_model="numpy")
    def entry(m, time):
        m[1] = below(m, time)
        return 0

    ir, _ = compile_kernel.entry_ir(entry, 7)
    told = {line for line in ir.splitlines() if "dereferenceable(56)" in line}
    for name in ("c_entry", "below"):
        assert [line for line in told if line.startswith("define") and name in line], name


def test_a_kernel_that_needs_the_runtime_of_numba_is_refused():
    """What a new Numba would most likely do."""
    with pytest.raises(CannotExport, match="by this version of Numba needs NRT_MemInfo_alloc"):
        compile_kernel.emit_object(IR, PLATFORMS["x86_64-linux"])


@pytest.mark.parametrize(
    ("source", "told"),
    [
        (
            "__version__ = '9.9'\ndef njit(**_): return lambda f: f",
            "Numba 9.9 cannot compile the kernel: AttributeError: .*types",
        ),
        ("raise ModuleNotFoundError('No module named numba')", "No module named numba"),
    ],
    ids=["another interface", "missing"],
)
def test_a_numba_that_cannot_do_it_is_named_in_one_line(monkeypatch, tmp_path, source, told):
    (tmp_path / "numba.py").write_text(source + "\n")
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    compile_kernel.compile_objects.cache_clear()
    with pytest.raises(CannotExport, match=told) as caught:
        compile_kernel.compile_objects("oscillator", usual())
    assert "\n" not in str(caught.value)
