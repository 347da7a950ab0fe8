"""The rule of the verdict, number by number."""

import math
import re
import warnings
from dataclasses import replace

import numpy as np
import pytest

from orchestrate.diagnosis.decision_rule import Beam, Findings
from orchestrate.diagnosis.detect import beam_job
from orchestrate.diagnosis.fit import reported_derivatives
from orchestrate.diagnosis.hypotheses import FREE, Delaminated
from orchestrate.diagnosis.settings import SETTINGS

from .records import BEAM, record, record_evidence
from .test_impact_timing import FACES

OPENED = Findings(
    excess=10.0, order2=0.2, apart=0.0, strikes=FACES, sensors=1,
    low=1.0, high=4.0, first=20.0, last=90.0, smallest=1e-6, hidden=0.01,
    clipped=0.0, end_response=0.2, resonance=46.0, guessed=(42.0, 52.0),
)  # fmt: skip
QUIET = replace(OPENED, excess=0.3, strikes=replace(FACES, heard=1.5))
STRUCK = {name: float(value) for name, value in vars(FACES).items()}
CASES = """
faces strike: -> delaminated
nothing strikes, no order 2: heard=1.5 excess=0.3 -> no opening seen
the same, by two sensors that differ: heard=1.5 excess=0.3 apart=4 -> undecided
something faint: heard=5 excess=0.3 -> undecided
order 2, and nothing strikes, as of a crack: heard=1.5 -> undecided
it stiffens with the stroke: stiffens=0.8 -> undecided
the resonance is not known: stiffness=nan -> undecided
the base strikes: base=30 -> not described
dry friction: locked=0.3 -> not described
the times are in ms: resonance=0.046 -> undecided
opens from the higher level on: heard=1.5 excess=0.3 | high=8 -> delaminated
the higher level contradicts: | high=8 heard=1.5 excess=0.3 -> undecided
it stiffens at the higher level: | high=8 stiffens=0.8 -> undecided
two levels in place of a frequency: stiffness=nan | high=8 stiffness=nan -> delaminated
two levels, and a frequency that is another: stiffness=1.2 | high=8 stiffness=1.2 -> undecided
one record is saturated: clipped=0.01 | -> delaminated
nothing at both levels: heard=1.5 excess=0.3 | heard=1.5 excess=0.3 high=8 -> no opening seen
what knows no frequency does not contradict: | stiffness=nan -> delaminated
the base strikes, or a stop: base=30 | stiffens=0.8 -> undecided
kinks: blow=0.05 -> not described
"""  # what is changed of a record in which faces strike, or of several -> their verdict


def changed(text):
    """The findings of a record that differs from `OPENED` by these numbers."""
    given = {name: float(value) for name, value in (one.split("=") for one in text.split())}
    struck = {name: given.pop(name) for name in [*given] if name in STRUCK}
    return replace(OPENED, strikes=replace(FACES, **struck), **given)


@pytest.mark.parametrize("case", CASES.strip().splitlines())
def test_each_case_has_its_word(case):
    name, _, rest = case.partition(": ")
    changes, expected = rest.split("-> ") if "-> " in rest else ("", rest)
    beam = Beam(tuple(changed(text) for text in changes.split("|")))
    assert beam.verdict() == expected, name
    advice = beam.next_measurement()
    assert advice and "intact" not in f"{advice} {beam.reason()}"


@pytest.mark.parametrize(
    ("changes", "reason", "advice"),
    [
        ({"clipped": 0.012}, "1.2 % of a channel's samples", "larger range"),
        ({"end_response": 0.98}, "98 % of the largest one, at 46 Hz, where 70 %", "passes the res"),
        ({"resonance": 0.046}, "a factor of 913 from the guess's 42 to 52", "in s"),
        ({"hidden": 0.19}, "order 2 of up to 19 % of order 1, where at most 10 %", "less noise"),
        ({"apart": 4.0}, "Two modes of a sound beam", "opposite"),
    ],
)
def test_what_keeps_a_quiet_record_from_its_verdict_is_named(changes, reason, advice):
    quiet = Beam((QUIET,))
    assert quiet.verdict() == "no opening seen" and not quiet.violated_conditions()
    stopped = Beam((replace(QUIET, **changes),))
    assert stopped.verdict() == "undecided"
    assert reason in stopped.reason() and advice in stopped.next_measurement()


@pytest.mark.parametrize("given", [None, BEAM])
def test_whose_frequencies_a_resonance_is_away_from_is_named(given):
    """Those of the first record were called the guess's, and there was none."""
    first = record(BEAM.as_bonded(), noise=0.02, both=False)
    slow = first.drop_attrs().assign_coords(time=2.0 * first.time.values)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", UserWarning)  # that says so of a guess
        beam = beam_job([first, slow], given, FREE, None, SETTINGS).beam()
    *_, away = beam.records[1].usability_conditions()
    assert not away.holds
    low, high = (32.1, 35.5) if given is None else (30.0, 38.0)
    named = re.search("from the (.*) ([0-9.]+) to ([0-9.]+) Hz", away.reason)
    assert named[1] == ("first record's" if given is None else "guess's")
    assert [float(named[2]), float(named[3])] == pytest.approx([low, high], rel=0.02)


def test_the_level_from_which_faces_strike_is_stated():
    """Each record was judged by itself, while another level was what settles it."""
    for highs in ((16.0, 8.0), (8.0,)):
        beam = Beam((QUIET, *(replace(OPENED, high=high) for high in highs)))
        assert beam.opening_level == 8.0 and "Faces strike from 8 m/s" in beam.reason()
    assert "Faces strike from" not in Beam((OPENED,)).reason()
    assert math.isnan(Beam((QUIET,)).opening_level)
    against = Beam((OPENED, replace(QUIET, high=8.0)))
    assert "contradicts: nothing heard" in against.reason()
    stop = replace(OPENED, strikes=replace(FACES, stiffens=0.8))
    for records, second in (((stop,), True), ((stop, replace(stop, high=8.0)), False)):
        advice = Beam(records).next_measurement()
        assert "other face" in advice and ("twice the level" in advice) == second
    opposite = replace(stop, sensors=2, strikes=replace(FACES, opposite=0.9))
    assert "Sensors nearer" in Beam((opposite,)).next_measurement()


def test_numbers_at_their_bounds_are_reported_with_slopes():
    evidence = record_evidence(record())
    hypothesis = Delaminated(BEAM)
    values = {**hypothesis.values_from_structure(BEAM, evidence), "e": 0.0}
    del values["clearance"]
    for e in (0.0, 1.0):
        with_e = {**values, "e": e}
        slopes = reported_derivatives(hypothesis, with_e, evidence)
        assert slopes.shape == (5, 5) and np.isfinite(slopes).all()
    assert slopes[0, 0] == pytest.approx(BEAM.f1 / values["common"], rel=1e-4)


def test_numbers_of_a_record_are_stated_as_short_as_their_limits_allow():
    """Shares in percent; the other face's with two sensors alone."""
    text = Beam((OPENED,)).reason()
    assert "At 4 m/s\u00b2 order 2 is up to 20 % of order 1, 10 times the size" in text
    assert "two faces differ" not in text and "faces strike (heard 60, base 1.2" in text
    for apart, number in ((4.04, "4"), (1.004, "1.004"), (0.9, "0.9")):
        two = Beam((replace(OPENED, sensors=2, apart=apart),))
        assert f"two faces differ by {number} times" in two.reason()
    assert "1.004 times the size" in Beam((replace(OPENED, excess=1.0041),)).reason()
    few = Beam((replace(OPENED, samples=7.0),))
    assert "with 1.18e+03 samples a second" in few.next_measurement()
    for excess, torsion in ((0.9, True), (1.1, False)):
        beam = Beam((replace(QUIET, sensors=2, apart=4.0, excess=excess),))
        assert ("Two modes of a sound beam" in beam.reason()) == torsion
        assert ("on the beam's axis" in beam.next_measurement()) == torsion
