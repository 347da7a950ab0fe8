"""What the FMUs carry beside their code can be made: files of reference results, pictures."""

import numpy as np
import pytest

from orchestrate.fmu import find_or_export
from tools import assets, references

from ..sparing import ordinary


@pytest.mark.parametrize("reference", ordinary(references.REFERENCES))
def test_pictures_are_drawn(exported, monkeypatch, tmp_path, reference):
    monkeypatch.setattr(assets, "MODELS", tmp_path)
    (tmp_path / reference.folder / "documentation").mkdir(parents=True)
    times = [float(time) for time in np.linspace(0.0, 1.0, 5)]
    rows = [[time, *np.full(len(reference.outputs), time)] for time in times]
    assets.draw_and_save_documentation(reference, find_or_export(reference.model).path, rows)
    names = {path.name for path in (tmp_path / reference.folder).rglob("*.*")}
    assert names == {"scheme.png", "plot.svg", "model.png"}


def test_the_files_of_a_reference_are_those_that_are_kept(exported, monkeypatch, tmp_path):
    """Names, inputs and options; the numbers are tested on the exported FMUs."""
    reference = references.REFERENCES[0]
    monkeypatch.setattr(references, "MODELS", tmp_path)
    (tmp_path / reference.folder).mkdir()
    rows = [[0.0, *np.zeros(len(reference.outputs))]]
    kept = assets.MODELS / reference.folder / "reference"
    references.write_reference_files(reference, rows)
    for path in kept.iterdir():
        written = tmp_path / reference.folder / "reference" / path.name
        assert path.name.endswith("_ref.csv") or written.read_bytes() == path.read_bytes()
