"""Which fast tests are to notice a breakage of which module."""

KERNEL = "tests/kernels/oscillator"
FIRST = "tests/kernels/numerics/test_first_root.py"
DIAGNOSIS = "tests/orchestrate/diagnosis"
DRIVE = "tests/orchestrate/weak_drive"


def kernel(*names):
    """The tests of some modules of the oscillator's kernel: of the Python source, without FMUs."""
    return tuple(f"{KERNEL}/test_{name}.py" for name in names)


SUBJECTS = {
    "fmu_src/kernels/numerics/first_root.py": (FIRST, *kernel("roots", "maximum")),
    "fmu_src/kernels/oscillator/hermite.py": kernel("hermite", "roots", "maximum", "nodes"),
    "fmu_src/kernels/oscillator/roots.py": kernel("roots", "nodes", "maximum", "motion"),
    "fmu_src/kernels/oscillator/event_function.py": kernel("event_function", "secular", "roots"),
    "fmu_src/kernels/oscillator/impact.py": kernel("impact", "chattering", "motion"),
    "fmu_src/kernels/oscillator/contact.py": kernel("contact", "event_function", "motion"),
    "fmu_src/kernels/oscillator/series.py": kernel("series", "chattering", "motion"),
    "fmu_src/kernels/oscillator/motion.py": kernel("motion", "chattering", "stepper", "contact"),
    "fmu_src/kernels/repetition.py": ("tests/orchestrate/response/test_multiplicity.py",),
    "orchestrate/weak_drive/hysteresis.py": (f"{DRIVE}/test_hysteresis.py",),
    "orchestrate/weak_drive/steady_speed.py": (f"{DRIVE}/test_steady_speed.py",),
    "orchestrate/dynamics/decision.py": ("tests/orchestrate/dynamics/test_decision.py",),
    "orchestrate/dynamics/clusters.py": tuple(
        f"tests/orchestrate/dynamics/test_{name}.py"
        for name in ("clusters", "decision", "global_continuation")
    ),
    "orchestrate/dynamics/curve_growth.py": ("tests/orchestrate/dynamics/test_manifolds.py",),
    "orchestrate/diagnosis/decision_rule.py": (
        f"{DIAGNOSIS}/test_thresholds.py",
        f"{DIAGNOSIS}/test_verdicts.py",
    ),
    "orchestrate/diagnosis/settings.py": (
        f"{DIAGNOSIS}/test_thresholds.py",
        f"{DIAGNOSIS}/test_verdicts.py",
        f"{DIAGNOSIS}/test_even_orders.py",
        f"{DIAGNOSIS}/test_efforts.py",
    ),
    "orchestrate/diagnosis/impact_timing.py": (f"{DIAGNOSIS}/test_impact_timing.py",),
    "orchestrate/diagnosis/wiring.py": (
        f"{DIAGNOSIS}/test_wiring_thresholds.py",
        f"{DIAGNOSIS}/test_thresholds.py",
        f"{DIAGNOSIS}/test_wiring.py",
    ),
}
