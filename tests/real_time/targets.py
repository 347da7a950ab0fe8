"""Run one chaotic trajectory on a desktop, a bare Cortex-M7 and RISC-V: same bits."""

from __future__ import annotations

from pathlib import Path

from .sources import BITS, CORTEX_M7, HERE, compile_program, run_command

PROGRAM = "trajectory.c"
TOOLS = {  # what each target needs
    "desktop": ("gcc",),
    "Cortex-M7": ("arm-none-eabi-gcc", "qemu-system-arm"),
    "RISC-V 64": ("riscv64-linux-gnu-gcc", "qemu-riscv64"),
}
SMALL = ("-ffunction-sections", "-fdata-sections", "-Wl,--gc-sections")
BARE = ("--specs=rdimon.specs", "-nostartfiles", "-T", str(HERE / "mps2-an500.ld"))
BOARD = ("-M", "mps2-an500", "-nographic", "-semihosting-config", "enable=on,target=native")


def parse_output(text: str) -> dict[str, str]:
    return dict(line.split(maxsplit=1) for line in text.splitlines())


def run_on_desktop(sources: Path, folder: Path, *flags: str) -> dict[str, str]:
    """Compile and run the trajectory on this machine; return its printed values."""
    program = compile_program(sources, [PROGRAM], folder / "desktop", "gcc", "-O2", *BITS, *flags)
    return parse_output(run_command(program))


def run_on_cortex_m7(sources: Path, folder: Path, *flags: str) -> dict[str, str]:
    """Run the trajectory on a bare Cortex-M7 under QEMU; return values and program size."""
    options = ("-O2", *CORTEX_M7, *BITS, *SMALL, *BARE, "-DSTACK_PAINTED", *flags)
    program = compile_program(
        sources, [PROGRAM, "startup.c"], folder / "cortex-m7", "arm-none-eabi-gcc", *options
    )
    result = parse_output(run_command("qemu-system-arm", *BOARD, "-kernel", program))
    code, data, zeros = run_command("arm-none-eabi-size", program).splitlines()[1].split()[:3]
    return {**result, "code": code, "data": data, "zeros": zeros}


def run_on_riscv64(
    sources: Path, folder: Path, *flags: str, standard: tuple[str, ...] = BITS
) -> dict[str, str]:
    """Run the trajectory on RISC-V 64 under QEMU; return its printed values."""
    options = ("-O2", "-static", *standard, *flags)
    program = compile_program(
        sources, [PROGRAM], folder / "riscv64", "riscv64-linux-gnu-gcc", *options
    )
    return parse_output(run_command("qemu-riscv64", program))
