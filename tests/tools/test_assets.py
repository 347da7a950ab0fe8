"""What the FMUs carry is what the FMUs say: reference results, tables, pictures."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from orchestrate.access import find
from tools import assets, references

NAMES = [reference.model for reference in references.REFERENCES]


def numbers(path):
    """Header and numbers of a CSV file."""
    with path.open(newline="") as stream:
        header, *rows = csv.reader(stream)
    return header, np.array(rows, dtype=float)


@pytest.mark.parametrize("reference", references.REFERENCES, ids=NAMES)
def test_references_are_what_the_fmus_answer(exported, monkeypatch, tmp_path, reference):
    kept = references.MODELS / reference.folder / "reference"
    (tmp_path / reference.folder).mkdir()
    monkeypatch.setattr(references, "MODELS", tmp_path)
    rows = references.reference_rows(reference, find(reference.model).path)
    references.write_reference(reference, rows)
    written = sorted((tmp_path / reference.folder / "reference").iterdir())
    assert [path.name for path in written] == sorted(path.name for path in kept.iterdir())
    for path in written:
        if path.suffix == ".opt":
            assert path.read_bytes() == (kept / path.name).read_bytes()
            continue
        (header, found), (names, expected) = numbers(path), numbers(kept / path.name)
        assert header == names
        np.testing.assert_allclose(found, expected, rtol=1e-10, atol=1e-12)


@pytest.mark.parametrize("reference", references.REFERENCES, ids=NAMES)
def test_pictures_are_drawn(exported, monkeypatch, tmp_path, reference):
    monkeypatch.setattr(assets, "MODELS", tmp_path)
    (tmp_path / reference.folder / "documentation").mkdir(parents=True)
    times = [float(time) for time in np.linspace(0.0, 1.0, 5)]
    rows = [[time, *np.full(len(reference.outputs), time)] for time in times]
    assets.draw_documentation(reference, find(reference.model).path, rows)
    names = {path.name for path in (tmp_path / reference.folder).rglob("*.*")}
    assert names == {"scheme.png", "plot.svg", "model.png"}
