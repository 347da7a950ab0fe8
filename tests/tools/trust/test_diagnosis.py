"""The campaign on verdicts: what counts as wrong, the signs beside it, its curves and tables."""

from __future__ import annotations

import dataclasses
import json
import math

import numpy as np
import pytest
import xarray as xr
from scipy.stats import norm

import orchestrate
from tools.benches import recipe, tutorial
from tools.benches.recipe import Setup, Truth
from tools.trust import __main__ as ledger
from tools.trust import diagnosis, diagnosis_tables, ledger_file, ledger_page, roc, signs
from tools.trust.diagnosis import DiagnosisCampaign, judge_case, verdict_problem
from tools.trust.job import HERE, sources_digest

SOUND = Truth(
    kind="sound",
    is_delaminated=False,
    opened=False,
    touched=False,
    f1=45.0,
    f2=45.0,
    zeta1=0.01,
    zeta2=0.01,
    setup=Setup(4.0, 0.02, 1, "up"),
)
SPLIT = dataclasses.replace(
    SOUND, kind="delaminated", is_delaminated=True, opened=True, touched=True, largest_gap=1e-3
)
SHUT = dataclasses.replace(SPLIT, kind="preloaded", opened=False, largest_gap=-1e-6)


@pytest.mark.parametrize(
    ("verdict", "truth", "expected"),
    [
        ("delaminated", SOUND, "is sound"),
        ("delaminated", SHUT, "did not open"),
        ("delaminated", SPLIT, ""),
        ("no opening seen", SPLIT, "opened by 1 mm"),
        ("no opening seen", dataclasses.replace(SPLIT, largest_gap=1e-5), ""),
        ("no opening seen", dataclasses.replace(SPLIT, touched=False), ""),
        ("no opening seen", SHUT, ""),
        ("no opening seen", SOUND, ""),
        ("not described", SOUND, ""),
        ("undecided", SPLIT, ""),
    ],
)
def test_what_is_wrong(verdict, truth, expected):
    found = verdict_problem(verdict, truth)
    assert expected in found and bool(found) == bool(expected)


def test_an_opening_below_the_stated_limit_is_no_wrong_verdict():
    assert verdict_problem("no opening seen", SPLIT, smallest=2e-3) == ""
    found = verdict_problem("no opening seen", SPLIT, smallest=3e-4)
    assert found.endswith("opened by 1 mm, where 0.3 mm would have been seen")


def test_the_signs_tell_the_tutorials_beams_apart():
    numbers = {}
    for name in tutorial.BEAMS:
        record = orchestrate.read_record(tutorial.FOLDER / f"{name}.csv")
        numbers[name] = signs.order_ratio(record), signs.kurtosis_above(record)
    assert numbers["beam_a"][0] > 0.1 and numbers["beam_a"][1] > 20.0
    assert numbers["beam_b"][0] < 5e-3 and numbers["beam_b"][1] == pytest.approx(3.0, abs=0.1)
    assert numbers["beam_c"][0] < 1e-2 and numbers["beam_c"][1] > 5.0, "it rattles elsewhere"


def test_the_ratio_of_orders_is_that_of_a_made_signal():
    time = np.arange(20_000) / 1000.0
    phase = 2.0 * np.pi * (20.0 + time) * time
    made = orchestrate.record(
        time=time,
        box_acceleration=np.sin(phase),
        acceleration1=3.0 * np.sin(phase + 0.4) + 0.6 * np.sin(2.0 * phase),
    )
    assert signs.order_ratio(made) == pytest.approx(0.2, rel=2e-2)
    still = made.assign(box_acceleration=("time", np.random.default_rng(1).normal(size=20_000)))
    assert math.isnan(signs.order_ratio(still)), "there is no sweep"


def test_curves_of_numbers_with_a_known_area():
    rng = np.random.default_rng(2)
    numbers = np.concatenate([rng.normal(1.5, 1.0, 4000), rng.normal(0.0, 1.0, 4000)])
    found = roc.compute_curve(numbers, np.arange(8000) < 4000)
    exact = norm.cdf(1.5 / math.sqrt(2.0))
    assert abs(found.area - exact) < 3.0 * roc.area_error(exact, 4000, 4000) < 0.02
    assert found.true_rate_at(0.05) == pytest.approx(norm.sf(norm.isf(0.05) - 1.5), abs=0.03)
    assert roc.compute_curve([2.0, 3.0, 1.0, 0.0], [True, True, False, False]).area == 1.0
    assert roc.compute_curve([1.0, 1.0, 1.0], [True, False, False]).area == 0.5
    assert roc.compute_curve([np.nan, 1.0, 0.0], [True, True, False]).area == pytest.approx(0.5)
    with pytest.raises(ValueError, match="negative"):
        roc.compute_curve([1.0], [True])


def test_intervals_of_parts():
    """Wilson's, against a table: 2 of 100."""
    assert roc.wilson_interval(2, 100) == (
        pytest.approx(0.0055, abs=1e-4),
        pytest.approx(0.07, abs=1e-3),
    )
    low, high = roc.wilson_interval(0, 50)
    assert low == pytest.approx(0.0, abs=1e-12) and 0.05 < high < 0.08


@pytest.fixture
def quick(monkeypatch):
    """Short records, and a detector that reads the truth, but errs about hardening beams."""
    monkeypatch.setattr(recipe, "DURATION", 3.0)
    monkeypatch.setattr(diagnosis, "KINDS", ("sound", "delaminated", "hardening", "gap"))

    def asked(case):
        truth = case.truth
        wrong = truth.kind == "hardening"
        verdict = "delaminated" if truth.opened or wrong else "no opening seen"
        numbers = {"f1": 1.02 * truth.f1, "f1 error": 0.01 * truth.f1, "f2": 0.97 * truth.f2}
        return diagnosis.DetectorAnswer(verdict, numbers)

    monkeypatch.setattr(diagnosis, "run_detector", asked)


def test_a_run_keeps_a_row_for_each_beam(quick, exported):
    found = DiagnosisCampaign().run(exported, 4, 4)
    assert found.done == 4 and found.findings == 1 and len(found.rows) == 4
    assert found.notes[0].startswith("seed 4, beam 2: hardening") and "is sound" in found.notes[0]
    assert found.worst == pytest.approx(3.0) and found.counts["sound, no opening seen:"] == 1
    assert json.loads(json.dumps(found.rows)) == [list(row) for row in found.rows]
    first = dict(zip(diagnosis.COLUMNS, found.rows[1], strict=True))
    assert (first["f1 error"], first["f2 error"]) == (0.02, -0.03)
    assert (first["f1 deviation"], first["f2 deviation"]) == (2.0, None)
    assert first == {**judge_case(diagnosis.draw_case(4, 1)), "seconds": first["seconds"]}


def made_rows(count):
    """Beams, half of them delaminated, with signs that overlap."""
    rng, rows = np.random.default_rng(5), []
    for number in range(count):
        split = number % 2
        row = dict.fromkeys(diagnosis.COLUMNS, 0)
        row |= {"kind": "delaminated" if split else "sound", "delaminated": split}
        row |= {"opened": split, "touched": split, "gap": 1e-3 * split, "size": None, "wrong": ""}
        row |= {"noise": 0.02, "level": 5.0, "excitation": "up", "seconds": 2.0}
        row |= {"order ratio": float(rng.normal(split)), "kurtosis": 3.0 + 10.0 * split}
        row |= {"verdict": "delaminated" if split else "no opening seen", "sensors": 1}
        row |= {"ratio": 1.0 + 2.0 * split if number > 9 else None}
        row |= {"f1 error": 0.01 if split else None, "f2 error": -0.02 if split else None}
        row |= dict.fromkeys((f"{name} deviation" for name in diagnosis.FITTED), None)
        row |= {"f1 deviation": (-2.5 if number < 20 else 1.5) if split else None}
        rows.append([row[name] for name in diagnosis.COLUMNS])
    rows[0][diagnosis.COLUMNS.index("verdict")] = "delaminated"
    rows[0][diagnosis.COLUMNS.index("wrong")] = "called delaminated, and is sound"
    return rows


def test_tables_and_picture(tmp_path):
    text = "\n".join(diagnosis_tables.table_lines(made_rows(200)))
    assert "| sound | 1 | 99 | 0 | 0 | 0 | 0 | 1 |" in text
    assert "two masses, sound or delaminated: wrong 0.5 % of 200 (0.1 to 2.8)" in text
    assert "median error 1.50 %, nine of ten within 2.00 %" in text
    assert "intervals of 95 % that hold the truth: f1 90.0 % of 100 (82.6 to 94.5);" in text
    assert text.count("1.000 ± 0.000; 100 % | 100.0 % of 100") >= 3
    assert "| sensors: 1 | 100, 100 |" in text and "excitation: up" in text
    assert diagnosis_tables.sign_curve(diagnosis_tables.make_table(made_rows(10)), "ratio") is None
    path = diagnosis_tables.draw(made_rows(200), tmp_path / "diagnosis.png")
    assert path.stat().st_size > 10_000


def test_rows_go_into_the_record_and_onto_the_page(quick, exported, tmp_path):
    run = ledger.run_campaign(DiagnosisCampaign(), 4, 5, tmp_path, jobs=1, progress=False)
    assert len(run.rows) == 5 and run.findings == 1
    place = tmp_path / "trust.jsonl"
    assert ledger_file.append_entry(run, place) and ledger_file.read_entries(place) == [run]
    text = ledger_page.page_text([run])
    assert "| hardening | 1 | 0 | 0 | 0 | 0 | 0 | 1 |" in text
    without = dataclasses.replace(run, rows=[])
    ledger_file.append_entry(without, tmp_path / "other.jsonl")
    assert "rows" not in json.loads((tmp_path / "other.jsonl").read_text())


def test_a_run_that_was_stopped_keeps_what_it_has(quick, exported, tmp_path, monkeypatch):
    """Its record is that of a run with as many beams."""
    run_detector, left = diagnosis.run_detector, iter(range(3))

    def stopped(case):
        if next(left, None) is None:
            raise KeyboardInterrupt
        return run_detector(case)

    monkeypatch.setattr(diagnosis, "run_detector", stopped)
    with pytest.raises(KeyboardInterrupt):
        ledger.run_campaign(DiagnosisCampaign(), 4, 6, tmp_path, jobs=1, progress=False)
    kept = ledger.keep_partial_run(DiagnosisCampaign(), 4, 6, tmp_path)
    assert kept.budget == kept.done == 3 and len(kept.rows) == 3
    monkeypatch.setattr(diagnosis, "run_detector", run_detector)
    whole = ledger.run_campaign(DiagnosisCampaign(), 4, 3, tmp_path, jobs=1, progress=False)
    of_beams = [[row[:-2] for row in one.rows] for one in (kept, whole)]  # without the seconds
    assert of_beams[0] == of_beams[1] and kept.package == whole.package
    with pytest.raises(orchestrate.InputError, match="holds no batch"):
        ledger.keep_partial_run(DiagnosisCampaign(), 5, 6, tmp_path)


def test_other_benches_are_another_campaign():
    assert (
        sources_digest()
        == ledger_file.digest(HERE, HERE.parent / "benches")
        != ledger_file.digest(HERE)
    )


def test_each_kind_of_beam_is_asked_about():
    assert set(diagnosis.KINDS) == set(recipe.KINDS)


def made_answer(record, guess, **running):
    """What the detector answers, of two delaminated hypotheses the second is the better one."""
    names = ["bonded", "delaminated", "delaminated, with clearance"]
    values = [[np.nan] * 5, [1.0, 2.0, 0.1, 0.1, 0.5], [41.0, 52.0, 0.01, 0.02, 0.6]]
    return xr.Dataset(
        {
            "verdict": ((), "delaminated"),
            "ratio": ((), 3.0),
            "smallest_opening": ((), 4e-5),
            "misfit": ("hypothesis", [6.0, 3.0, 2.0]),
            "value": (("hypothesis", "parameter"), np.array(values)),
            "standard_error": (("hypothesis", "parameter"), 0.01 * np.array(values)),
        },
        {"hypothesis": names, "parameter": list(diagnosis.FITTED)},
    )


def test_the_numbers_are_those_of_the_best_delaminated_hypothesis(monkeypatch):
    monkeypatch.setattr(orchestrate, "detect", made_answer)
    case = recipe.Case(xr.Dataset(), orchestrate.Structure(), SPLIT)
    verdict, numbers, _ = diagnosis.run_detector(case)
    assert (verdict, numbers["ratio"]) == ("delaminated", 3.0)
    assert numbers["smallest"] == 4e-5
    assert (numbers["f1"], numbers["f2"], numbers["f2 error"]) == (41.0, 52.0, 0.52)
    deviation = diagnosis.normalized_deviations(numbers, SPLIT)
    assert deviation["f2"] == pytest.approx((52.0 - 45.0) / 0.52, rel=0.01)
    assert deviation["e"] is None, "there was no impact"
    assert diagnosis.frequency_errors(numbers, SPLIT) == pytest.approx(
        {"f1": 41.0 / 45.0 - 1.0, "f2": 52.0 / 45.0 - 1.0}, abs=1e-3
    )
    beam = dataclasses.replace(SPLIT, size=0.5)
    assert diagnosis.frequency_errors(numbers, beam) == {}, "finite elements have no f1 and f2"


def test_what_the_detector_cannot_take_is_refused():
    """Noise has no orders; the campaign goes on."""
    made = np.random.default_rng(3).normal(size=(2, 4000))
    record = orchestrate.record(box_acceleration=made[0], acceleration1=made[1], sample_rate=1000.0)
    case = recipe.Case(record, orchestrate.Structure.from_file("beam"), SPLIT)
    answer = diagnosis.run_detector(case)
    assert answer.verdict == diagnosis.REFUSED and answer.message
    assert verdict_problem(answer.verdict, SPLIT, answer.message) == f"refused: {answer.message}"
    noise = dataclasses.replace(SPLIT, setup=Setup(4.0, 0.02, 1, "random"))
    assert verdict_problem(answer.verdict, noise, answer.message) == ""


def test_a_detector_that_fails_is_a_finding(monkeypatch):
    def failing(*arguments, **running):
        raise np.linalg.LinAlgError("SVD did not converge")

    monkeypatch.setattr(orchestrate, "detect", failing)
    answer = diagnosis.run_detector(recipe.Case(xr.Dataset(), orchestrate.Structure(), SPLIT))
    assert answer.verdict == diagnosis.FAILED
    expected = "failed: LinAlgError: SVD did not converge"
    assert verdict_problem(answer.verdict, SOUND, answer.message) == expected
