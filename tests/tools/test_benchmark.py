"""The comparison of two versions is carried to its end."""

import pytest

from tests import ROOT
from tools import benchmark


@pytest.mark.slow
def test_a_question_that_a_version_does_not_know_is_left_out(monkeypatch, capsys):
    known = "o.simulate(structure, eta=0.8, periods=1)"
    monkeypatch.setattr(benchmark, "QUESTIONS", {"row 1": "o.unknown()", "row 2": known})
    benchmark.print_comparison_of_versions(ROOT, 1.0, 1, "row")
    _, unknown, answered = capsys.readouterr().out.splitlines()
    assert unknown.startswith("row 1") and "left out" in unknown and "unknown" in unknown
    assert answered.startswith("row 2") and len(answered.split()) == 8
