"""Which fast tests are to notice a breakage of which module, and what changes no answer."""

import csv
from pathlib import Path

KERNEL = "tests/kernels/oscillator"
FIRST = "tests/kernels/numerics/test_first_root.py"
DIAGNOSIS = "tests/orchestrate/diagnosis"
DRIVE = "tests/orchestrate/weak_drive"


def kernel(*names):
    """The tests of some modules of the oscillator's kernel: of the Python source, without FMUs."""
    return tuple(f"{KERNEL}/test_{name}.py" for name in names)


SUBJECTS = {
    "fmu_src/kernels/numerics/first_root.py": (FIRST, *kernel("roots", "outputs")),
    "fmu_src/kernels/oscillator/hermite.py": kernel("hermite", "roots", "outputs"),
    "fmu_src/kernels/oscillator/roots.py": kernel("roots", "hermite", "outputs", "motion"),
    "fmu_src/kernels/oscillator/event_function.py": kernel("event_function", "roots"),
    "fmu_src/kernels/oscillator/impact.py": kernel("impact", "motion"),
    "fmu_src/kernels/oscillator/contact.py": kernel("contact", "event_function", "motion"),
    "fmu_src/kernels/oscillator/series.py": kernel("series", "impact", "motion"),
    "fmu_src/kernels/oscillator/motion.py": kernel("motion", "impact", "contact", "series"),
    "fmu_src/kernels/repetition.py": ("tests/orchestrate/response/test_multiplicity.py",),
    "orchestrate/weak_drive/hysteresis.py": (f"{DRIVE}/test_hysteresis.py",),
    "orchestrate/weak_drive/steady_speed.py": (f"{DRIVE}/test_steady_speed.py",),
    "orchestrate/dynamics/decision.py": tuple(
        f"tests/orchestrate/dynamics/test_{name}.py" for name in ("decision", "global_continuation")
    ),
    "orchestrate/dynamics/clusters.py": tuple(
        f"tests/orchestrate/dynamics/test_{name}.py" for name in ("clusters", "global_continuation")
    ),
    "orchestrate/dynamics/settling.py": tuple(
        f"tests/orchestrate/dynamics/test_{name}.py"
        for name in ("settling", "clusters", "decision", "global_continuation")
    ),
    "orchestrate/dynamics/curve_growth.py": ("tests/orchestrate/dynamics/test_manifolds.py",),
    "orchestrate/laboratory/analysis/knocks.py": ("tests/orchestrate/laboratory/test_hammer.py",),
    "orchestrate/cli/notes.py": ("tests/orchestrate/cli/test_notes.py",),
    "orchestrate/diagnosis/decision_rule.py": (
        f"{DIAGNOSIS}/test_thresholds.py",
        f"{DIAGNOSIS}/test_verdicts.py",
    ),
    "orchestrate/diagnosis/settings.py": (
        f"{DIAGNOSIS}/test_thresholds.py",
        f"{DIAGNOSIS}/test_verdicts.py",
        f"{DIAGNOSIS}/test_opening_measures.py",
        f"{DIAGNOSIS}/test_efforts.py",
    ),
    "orchestrate/diagnosis/impact_timing.py": (f"{DIAGNOSIS}/test_impact_timing.py",),
    "orchestrate/diagnosis/wiring.py": (
        f"{DIAGNOSIS}/test_wiring_thresholds.py",
        f"{DIAGNOSIS}/test_wiring.py",
    ),
}
HARMLESS = Path(__file__).with_name("harmless.csv")


def harmless(module):
    """What changes no answer, by line and broken line, with its reason."""
    with HARMLESS.open(newline="") as file:
        rows = [row for row in csv.DictReader(file) if row["module"] == module]
    return {(row["line"], row["broken"]): row["reason"] for row in rows}
