"""How fast, as ratios: ``python -m orchestrate.benchmark``.

Kernel, FMU calls and a sampled solver, measured one after the other in one run on one core; times are of this machine, the ratios travel.
"""

import math
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
from scipy.integrate import solve_ivp

from .build import default_fmu
from .fmu import Instance

MODEL = "TwoMassImpactOscillator"
ETAS = (0.3, 0.5, 0.8, 1.047, 1.13, 2.0, 2.9, 4.2, 6.3)
PURE = """
import sys
from orchestrate.benchmark import periods
print(periods(sys.argv[1], float(sys.argv[2]), int(sys.argv[3]))[0])
"""


def periods(fmu, eta, count, **values):
    """Seconds and impacts of ``count`` periods in one step, after 50 to settle."""
    period = 2.0 * math.pi / eta
    with Instance(fmu) as instance:
        instance.initialize(box_amplitude=1.0 / eta**2, box_frequency=eta, x_rel_max_on=False, **values)
        instance.step(0.0, 50 * period)
        before = instance.get("impact_count")[0]
        begin = time.perf_counter()
        instance.step(50 * period, (50 + count) * period)
        return time.perf_counter() - begin, instance.get("impact_count")[0] - before


def quiet_step(fmu, count=100_000):
    """Seconds a call of doStep where no impact falls, through FMPy."""
    with Instance(fmu) as instance:
        instance.initialize(bonded=True, x_rel_max_on=False)
        step = instance._fmu.doStep
        begin = time.perf_counter()
        for i in range(count):
            step(i * 1e-3, 1e-3)
        return (time.perf_counter() - begin) / count


def pure_python(fmu, eta, count):
    """Seconds of ``count`` periods in the Python kernel, in a process of its own."""
    import os

    environment = {**os.environ, "VIBROIMPACT_PURE_PYTHON": "1"}
    done = subprocess.run([sys.executable, "-c", PURE, str(fmu), str(eta), str(count)], env=environment, capture_output=True, text=True, check=True)
    return float(done.stdout)


def sampled(eta, count, e=0.7, D=0.005, kappa=1.2):
    """Seconds of ``count`` periods by scipy's solve_ivp with events for gap and contact force: what one writes without a closed form."""

    def flight(t, y):
        force = math.sin(eta * t)
        return [y[1], force - 2 * D * y[1] - y[0], y[3], force - 2 * D * y[3] - kappa * y[2]]

    def contact(t, y):
        pull = math.sin(eta * t) - 2 * D * y[1] - 0.5 * (1 + kappa) * y[0]
        return [y[1], pull, y[1], pull]

    def gap(t, y):
        return y[2] - y[0]

    def pressed(t, y):
        return (1.0 - kappa) * y[0]

    for event, direction in ((gap, -1), (pressed, 1)):
        setattr(event, "terminal", True)  # noqa: B010 - how solve_ivp wants it
        setattr(event, "direction", direction)  # noqa: B010
    begin = time.perf_counter()
    t, stop, y, touching = 0.0, count * 2.0 * math.pi / eta, np.zeros(4), True
    while t < stop:
        motion, event = (contact, pressed) if touching else (flight, gap)
        found = solve_ivp(motion, (t, stop), y, rtol=1e-8, atol=1e-10, events=event)
        t, y = found.t[-1], found.y[:, -1].copy()
        closing, mean = y[1] - y[3], 0.5 * (y[1] + y[3])
        touching = not touching and e * closing < 1e-4 and pressed(t, y) < 0.0
        half = 0.0 if touching else max(0.5 * e * closing, 1e-7)
        y = np.array([y[0], mean - half, y[0] + (0.0 if touching else 1e-12), mean + half])
    return time.perf_counter() - begin


def main():
    """Print the table."""
    native = default_fmu(MODEL, Path("build"))
    python = Path("build") / "fmi2-python" / f"{MODEL}.fmu"
    print(f"{'eta':>6} {'us/period':>10} {'ns/impact':>10} {'pure Python':>12} {'solve_ivp':>10}   (the last two: times the native FMU)")
    seconds = impacts = 0.0
    for eta in ETAS:
        time_taken, count = min(periods(native, eta, 2000) for _ in range(3))
        each = time_taken / 2000
        seconds, impacts = seconds + time_taken, impacts + count
        slow = pure_python(python, eta, 30) / 30 / each if python.is_file() else math.nan
        print(f"{eta:6g} {each * 1e6:10.2f} {time_taken / max(count, 1) * 1e9:10.0f} {slow:12.0f} {sampled(eta, 10) / 10 / each:10.0f}", flush=True)
    print(f"all: {seconds / impacts * 1e9:.0f} ns an impact; a step without impact through FMPy: {quiet_step(native) * 1e9:.0f} ns")


if __name__ == "__main__":
    main()
