"""Ends of flights against a dense search in C and 50 digits; balances of impacts."""

import atexit
import functools
import itertools
import shutil
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import pytest
from mpmath import mp

from orchestrate.fmu import describe
from orchestrate.fmu.unpacked import unpack_once
from tests import exact_motion, importers

from .findings import expect_none

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="programs for Linux")
NAMES = (
    *("m1", "m2", "k1", "k2", "d1", "d2", "e", "box_amplitude", "box_frequency", "phase_start"),
    *("box_acceleration", "box_jerk", "box_snap", "box_crackle", "x1", "x2", "v1", "v2"),
    "clearance",
)
WRONG = ("", "a root is missed", "no root at its end", "it does not end")
OPTIONS = ("-O3", "-march=native", "-fno-math-errno", "-fno-trapping-math", "-fcx-limited-range")
CONTACT = 6  # the kind that is no flight
BOUND = 1e-12  # of the balances, in parts of the motion's terms


@dataclass(frozen=True)
class Flight:
    """A flight as ``native/roots.c`` prints it: kind, verdict of the dense search, end, start."""

    kind: int
    verdict: int
    impact: bool
    end: float
    values: dict[str, float]

    @classmethod
    def read(cls, line: str) -> "Flight":
        """Return a flight from a line of the program's output."""
        _, kind, verdict, impact, end, *row = line.split()
        values = dict(zip(NAMES, map(float.fromhex, row), strict=True))
        return cls(int(kind), int(verdict), impact == "1", float.fromhex(end), values)


@functools.cache
def compile_roots(fmu: Path) -> tuple[str, str]:
    """Compile ``native/roots.c`` against an FMU; return its path and that of the binary."""
    folder = Path(tempfile.mkdtemp(prefix="vibroimpact-campaign-"))
    atexit.register(shutil.rmtree, folder)
    source = Path(__file__).parent / "native" / "roots.c"
    program, found = importers.compile_against(fmu, folder, [source], OPTIONS), describe(fmu)
    return str(program), str(unpack_once(found) / f"binaries/x86_64-linux/{found.identifier}.so")


def run_roots(fmu: Path, *arguments: object) -> str:
    """Run the program on an FMU; return what it prints."""
    command = [*compile_roots(fmu), *map(str, arguments)]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout


def iterate_flights(fmu: Path, seed: int, count: int) -> Iterator[Flight]:
    """Yield the flights of a seed, without contacts."""
    lines = run_roots(fmu, seed, 2 * count, "show").splitlines()
    flights = map(Flight.read, (line for line in lines if line.startswith("FLIGHT")))
    return itertools.islice((one for one in flights if one.kind != CONTACT), count)


def deviation(flight: Flight) -> float:
    """Return the gap at a flight's end over the allowed one, by Newton's law in 50 digits.

    Allowed is 1e-15 (1 + t) |v| + 1.5e-14 S with S the sum of the terms of both displacements and v
    the closing speed: a free part is rotated 32 times at most before it is made anew, four
    roundings of 1.1e-16 each time.
    """
    values, end = flight.values, flight.end
    state = [values[name] for name in ("x1", "v1", "x2", "v2")]
    with mp.workdps(50):
        first, second = exact_motion.free_motion(values, state, mp.mpf(values["phase_start"]))
        gap = exact_motion.gap_signal(values, first, second)
        terms = term_size(first, end) + term_size(second, end) + abs(values["clearance"])
        rounding = exact_motion.ROUNDING * terms
        if not flight.impact:
            return 0.0 if gap(end) > -rounding else float("inf")
        return float(abs(gap(end)) / (1e-15 * (1.0 + end) * abs(gap.derivative()(end)) + rounding))


def term_size(signal: exact_motion.Signal, t: float) -> float:
    """Return the sum of a signal's term magnitudes at a time, which scales rounding errors."""
    size, power = sum(abs(complex(c)) for c, _ in signal.terms), 1.0
    for k, part in enumerate(signal.polynomial):
        size += abs(float(part)) * power
        power *= t / (k + 1.0)
    return size


@pytest.mark.slow
@pytest.mark.budget(2_000_000)  # flights
def test_no_root_is_missed_and_none_made_up(fmu, seed, budget):
    """Flights of seven kinds, half of them with gap or preload, and up to three that follow.

    A search written by Newton's law as sums of complex exponentials samples the gap (or the contact
    force) up to the flight's end at 25 points or more a radian, and goes to the bottom of every
    dip; a gap below -1e-14 of the sum of its terms is a finding. Momentum, restitution and energy
    of impacts: speeds before one by the closed form, those after it by the FMU; e may slope.
    """
    counts, findings = Counter[str](), []
    *lines, last = run_roots(fmu, seed, budget).splitlines()
    for line in lines:
        if line.startswith("FLIGHT"):
            flight = Flight.read(line)
            findings.append(f"{WRONG[flight.verdict]}: {flight.values}")
            continue
        right, *wrong, left_out, kind = line.split(maxsplit=5)
        counts += {kind: int(right), "left out": int(left_out)}
        findings += [f"{kind}: {wrong}"] * any(map(int, wrong))
    impacts, *errors = map(float, last.split())
    findings += [f"impacts: {last}"] * (not max(errors) <= BOUND)
    assert len(counts) == 8 and min(counts.values()) > 0.005 * budget
    assert impacts > 0.1 * budget and max(errors) > 1e-17
    expect_none(findings, counts | {"impacts, largest errors": last})


@pytest.mark.slow
@pytest.mark.budget(2000)  # flights
def test_impacts_against_50_digits(fmu, seed, budget):
    parts = [(deviation(flight), flight) for flight in iterate_flights(fmu, seed, budget)]
    worst = max(part for part, _ in parts)
    assert len(parts) == budget and worst > 1e-4
    wrong = [f"{part:.3g} of the bound: {one.values}" for part, one in parts if not part <= 1.0]
    expect_none(wrong, {"largest part of the bound": worst})
