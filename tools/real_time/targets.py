"""One chaotic trajectory on a desktop, on a bare Cortex-M7 and on RISC-V: the same bits."""

from __future__ import annotations

from pathlib import Path

from .sources import BITS, CORTEX_M7, HERE, build, missing, run

PROGRAM = "trajectory.c"
TOOLS = {  # what each target needs
    "desktop": ("gcc",),
    "Cortex-M7": ("arm-none-eabi-gcc", "qemu-system-arm"),
    "RISC-V 64": ("riscv64-linux-gnu-gcc", "qemu-riscv64"),
}
SMALL = ("-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections")
BARE = ("--specs=rdimon.specs", "-nostartfiles", "-T", str(HERE / "mps2-an500.ld"))
BOARD = ("-M", "mps2-an500", "-nographic", "-semihosting-config", "enable=on,target=native")


def printed(text: str) -> dict[str, str]:
    """Return what the program said, by its names."""
    return dict(line.split(maxsplit=1) for line in text.splitlines())


def on_desktop(sources: Path, folder: Path, *flags: str) -> dict[str, str]:
    """Run the trajectory on this machine; return what the program prints, by name."""
    program = build(sources, [PROGRAM], folder / "desktop", "gcc", "-O2", *BITS, *flags)
    return printed(run(program))


def on_cortex_m7(sources: Path, folder: Path, *flags: str) -> dict[str, str]:
    """Return the trajectory on a bare Cortex-M7 under QEMU, and the bytes of the program."""
    options = ("-O2", *CORTEX_M7, *BITS, *SMALL, *BARE, "-DSTACK_PAINTED", *flags)
    program = build(
        sources, [PROGRAM, "startup.c"], folder / "cortex-m7", "arm-none-eabi-gcc", *options
    )
    result = printed(run("qemu-system-arm", *BOARD, "-kernel", program))
    code, data, zeros = run("arm-none-eabi-size", program).splitlines()[1].split()[:3]
    return {**result, "code": code, "data": data, "zeros": zeros}


def on_riscv64(
    sources: Path, folder: Path, *flags: str, standard: tuple[str, ...] = BITS
) -> dict[str, str]:
    """Return the trajectory on RISC-V 64 under QEMU."""
    options = ("-O2", "-static", *standard, *flags)
    program = build(sources, [PROGRAM], folder / "riscv64", "riscv64-linux-gnu-gcc", *options)
    return printed(run("qemu-riscv64", program))


RUNS = {"desktop": on_desktop, "Cortex-M7": on_cortex_m7, "RISC-V 64": on_riscv64}


def all_targets(sources: Path, folder: Path) -> dict[str, dict[str, str]]:
    """Return the trajectory on each target whose tools are here."""
    known = [name for name in RUNS if not missing(*TOOLS[name])]
    return {name: RUNS[name](sources, folder) for name in known}
