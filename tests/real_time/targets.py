"""An FMU's C sources on real-time targets: unpacked, compiled, and one chaotic trajectory run on a
desktop, a bare Cortex-M7 and RISC-V, with the same bits.
"""

from __future__ import annotations

import shutil
import subprocess
import zipfile
from os import PathLike
from pathlib import Path

HERE = Path(__file__).parent
BITS = ("-std=c99", "-ffp-contract=off")
CORTEX_M7 = ("-mcpu=cortex-m7", "-mthumb", "-mfpu=fpv5-d16", "-mfloat-abi=hard")
TOOLS = {  # what each target needs
    "desktop": ("gcc",),
    "Cortex-M7": ("arm-none-eabi-gcc", "qemu-system-arm"),
    "RISC-V 64": ("riscv64-linux-gnu-gcc", "qemu-riscv64"),
}
SMALL = ("-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections")
BARE = (
    *("-DSTACK_PAINTED", "--specs=rdimon.specs", "-nostartfiles"),
    *("-T", str(HERE / "mps2-an500.ld"), str(HERE / "startup.c")),
)
BOARD = ("-M", "mps2-an500", "-nographic", "-semihosting-config", "enable=on,target=native")


def unpack(fmu: str | PathLike[str], folder: Path) -> Path:
    """Unpack the FMU's ``sources/`` into a folder; return the path."""
    with zipfile.ZipFile(fmu) as archive:
        inside = [name for name in archive.namelist() if name.startswith("sources/")]
        archive.extractall(folder, inside)
    return folder / "sources"


def c_files(sources: Path) -> list[Path]:
    return sorted(sources.glob("*.c"))


def missing_programs(*programs: str) -> list[str]:
    """Return those of some programs that this machine does not have."""
    return [program for program in programs if shutil.which(program) is None]


def run_command(
    *command: str | PathLike[str], cwd: Path | None = None, timeout: float = 600.0
) -> str:
    """Run a command in a folder; return what it prints."""
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=timeout)
    if done.returncode:
        raise RuntimeError(f"{' '.join(map(str, command))}: {done.stdout}{done.stderr}")
    return done.stdout


def compile_and_run(
    sources: Path, target: Path, compiler: str, *options: str, under: tuple[str, ...] = ()
) -> dict[str, str]:
    """Compile an FMU's sources with the trajectory; return the values that it prints."""
    files = *c_files(sources), HERE / "trajectory.c"
    run_command(compiler, f"-I{sources}", *files, *options, "-lm", "-o", target)
    return dict(line.split(maxsplit=1) for line in run_command(*under, target).splitlines())


def run_on_desktop(sources: Path, folder: Path, *flags: str) -> dict[str, str]:
    """Run the trajectory on this machine; return its printed values."""
    return compile_and_run(sources, folder / "desktop", "gcc", "-O2", *BITS, *flags)


def run_on_cortex_m7(sources: Path, folder: Path, *flags: str) -> dict[str, str]:
    """Run the trajectory on a bare Cortex-M7 under QEMU; return values and program size."""
    options = ("-O2", *CORTEX_M7, *BITS, *SMALL, *BARE, *flags)
    program, board = folder / "cortex-m7", ("qemu-system-arm", *BOARD, "-kernel")
    result = compile_and_run(sources, program, "arm-none-eabi-gcc", *options, under=board)
    code = run_command("arm-none-eabi-size", program).splitlines()[1].split()[0]
    return {**result, "code": code}


def run_on_riscv64(
    sources: Path, folder: Path, *flags: str, standard: tuple[str, ...] = BITS
) -> dict[str, str]:
    """Run the trajectory on RISC-V 64 under QEMU; return its printed values."""
    options = ("-O2", "-static", *standard, *flags)
    compiler, under = "riscv64-linux-gnu-gcc", ("qemu-riscv64",)
    return compile_and_run(sources, folder / "riscv64", compiler, *options, under=under)
