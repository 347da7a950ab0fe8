"""Binaries for other machines: no fused multiply-add, and this machine's bits in an emulator."""

import re
import shutil
import struct
import zipfile
from pathlib import Path

import pytest

from fmu_src.export import compiler, forms
from fmu_src.export.errors import CannotExport
from fmu_src.export.platforms import (
    ALL,
    default_platforms,
    platform_of_this_machine,
    select_platforms,
)
from fmu_src.export.source_code import kernel_c_source
from tests import importers

from ..fmu.programs.driver import COMMON, harmonic

MULTIPLY_ADD = b"""
int kernel_advance(double *memory, double time) {
    memory[0] = memory[0] * time + time;
    return 0;
}
"""
FUSED = r"\s(v?fn?m(add|sub|la|ls)\S*)\s"  # fmadd, fmsub, fnmadd, fnmsub, fmla, fmls; vfmadd...
ARM_LIBRARIES = Path("/usr/aarch64-linux-gnu")  # Debian's libc6-arm64-cross
OLD = {"linux64", "win64", "darwin64", "aarch64-linux", "aarch64-windows", "aarch64-darwin"}
FOLDERS = {"fmi2": OLD, "fmi3": set(ALL)}
RUNS = {  # outputs, inputs, and one output that shows that something went on
    "TwoMassImpactOscillator": (COMMON, harmonic(1.13), "impact_count", 500),
    "ElectrodynamicShaker": (["box_position", "energy"], {"command": 5.0}, "energy", 2.5e4),
    "MotorShaker": (["box_position", "speed", "angle"], {"voltage": 5.0}, "angle", 1e5),
}


def assembly(source, name, folder):
    (folder / "kernel.c").write_bytes(source)
    command = [*compiler.compile_command(name), "-S", "kernel.c", "-o", "kernel.s"]
    compiler.run_compiler(command, folder, name)
    return (folder / "kernel.s").read_text()


@pytest.mark.parametrize("name", ALL)
def test_a_product_and_a_sum_are_rounded_one_by_one(name, tmp_path):
    """What every processor of ARM would do in one instruction, with other bits."""
    code = assembly(MULTIPLY_ADD, name, tmp_path)
    assert "mul" in code and not re.search(FUSED, code)


def test_platforms_by_name():
    assert select_platforms(["all"]) == ALL
    assert select_platforms(["this"]) == (platform_of_this_machine(),)
    assert select_platforms(["aarch64-linux", "x86_64-linux"]) == ("x86_64-linux", "aarch64-linux")
    assert select_platforms([]) == ()
    assert {"x86_64-linux", "x86_64-windows"} <= set(default_platforms()) <= set(ALL)
    with pytest.raises(CannotExport, match="platform sparc: expected all, this, or one of x86_64-"):
        select_platforms(["sparc", "all"])


@pytest.mark.slow
@pytest.mark.parametrize("name", ALL)
@pytest.mark.parametrize("folder", forms.MODELS.values())
def test_no_platform_fuses_a_multiply_add_in_the_kernel(folder, name, tmp_path):
    """Neither ARM's nor Intel's: the assembly that the binaries are made of."""
    code = assembly(kernel_c_source(folder), name, tmp_path)
    assert code.count("mul") > 500
    assert not re.findall(FUSED, code)


@pytest.fixture(scope="module")
def everywhere(tmp_path_factory, fmus):
    build = tmp_path_factory.mktemp("everywhere")
    for form in ("fmi2", "fmi3"):
        for name in forms.MODELS:
            forms.export(name, form, build, ALL)
    return build


@pytest.mark.slow
@pytest.mark.parametrize("name", forms.MODELS)
def test_every_platform_has_its_binary(everywhere, version, name):
    """In the folders that tools look in; those of other platforms were only built, not run."""
    with zipfile.ZipFile(everywhere / version / f"{name}.fmu") as archive:
        names = [entry for entry in archive.namelist() if entry.startswith("binaries/")]
        found = {entry.split("/")[1]: archive.read(entry) for entry in names}
    assert set(found) == FOLDERS[version]
    elf = {folder: data for folder, data in found.items() if data[:4] == b"\x7fELF"}
    assert {struct.unpack_from("<H", data, 18)[0] for data in elf.values()} == {62, 183}
    pe = [data for data in found.values() if data[:2] == b"MZ"]
    places = [struct.unpack_from("<I", data, 0x3C)[0] for data in pe]
    kinds = {struct.unpack_from("<H", d, at + 4)[0] for d, at in zip(pe, places, strict=True)}
    assert kinds == {0x8664, 0xAA64}
    assert b"\xfa\xde\x0c\xc0" in found["aarch64-darwin"]  # a signature, which macOS asks for
    assert f"{name}.dylib".encode() in found["aarch64-darwin"]


@pytest.mark.slow
@pytest.mark.skipif(
    shutil.which("qemu-aarch64") is None or not ARM_LIBRARIES.is_dir(),
    reason="qemu-user and libc6-arm64-cross are not installed",
)
@pytest.mark.parametrize("name", forms.MODELS)
def test_the_arm_binary_has_the_same_bits(everywhere, importer_of, version, name, tmp_path):
    """Through chaos, for as long as the Windows binary under wine; and calls in any order."""
    path = everywhere / version / f"{name}.fmu"
    command = importers.zig_compiler("aarch64-linux-gnu.2.28")
    program = importers.compile_importer(version, path, tmp_path / "importer", command)
    with zipfile.ZipFile(path) as archive:
        binary = archive.extract(f"binaries/aarch64-linux/{name}.so", tmp_path)
    arm = importers.Importer(program, Path(binary), version)
    under = ("qemu-aarch64", "-L", ARM_LIBRARIES)
    times = [16.0 * k for k in range(257)]
    names, values, going_on, enough = RUNS[name]
    found = arm.simulate(names, times, under=under, **values)
    assert found == importer_of(version, name).simulate(names, times, **values)
    assert found[-1][names.index(going_on)] > enough
    arm.run("many", 50, 40, 400, under=under)
    assert "FAILURES 0" in arm.run("random", 7, 300, under=under, timeout=900).stdout
