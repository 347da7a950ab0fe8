"""``diagnose`` and ``report``: records in, verdicts and pages out."""

from __future__ import annotations

import hashlib
import io
import re
from contextlib import redirect_stdout
from dataclasses import replace

import pytest
import xarray as xr

import orchestrate
from orchestrate.cli import main, parse_arguments
from orchestrate.cli.diagnosis import Sweep
from orchestrate.diagnosis import settings

GUESSED = (
    "[structure]\nm1 = 1.5\nm2 = 1.2\nf1_hz = 44.0\nf2_hz = 52.0\nzeta1 = 0.01\nzeta2 = 0.01\n"
)


@pytest.fixture(scope="module")
def run(exported, tmp_path_factory):
    """The folder of a record of a beam that opens, its page, and what its diagnosis printed.

    Its searches end early.
    """
    folder, said = tmp_path_factory.mktemp("diagnosed"), io.StringIO()
    short = replace(settings.SETTINGS, rugged_starts=2, rounds=1, steps=5)
    halves = {"m1": 1.5, "m2": 1.2, "f1": 42.0, "f2": 52.0, "zeta1": 0.01, "zeta2": 0.01}
    beam = orchestrate.Structure.from_halves(**halves, e=0.5)
    sweep = orchestrate.SweptSine(first=38.0, last=58.0, duration=4.0, acceleration=4.0)
    sensor = orchestrate.Sensor(bandwidth=600.0, sample_rate=1600.0, noise=3e-3, participation=1.4)
    history = orchestrate.shake(beam, sweep, sample_rate=1600.0, progress=False)
    felt = orchestrate.measure(history, sensor, excitation=sweep).drop_vars("acceleration2")
    record = str(orchestrate.write_record(felt, folder / "parted.csv"))
    (folder / "beam.toml").write_text(GUESSED)
    options = ["--structure", str(folder / "beam.toml"), "--notes", "Tested <here>"]
    with redirect_stdout(said), pytest.MonkeyPatch.context() as patch:
        patch.setattr(settings, "SETTINGS", short)
        assert main(["diagnose", record, *options, "--output", str(folder), "--jobs", "1"]) == 0
        page = next(folder.glob("diagnose_parted_*.html")).read_text(encoding="utf-8")
        yield folder, page, said.getvalue()


def stored_verdict(folder):
    """The file of the record's verdict."""
    found = folder.glob("diagnose_parted_*.nc")
    (path,) = (path for path in found if not path.stem.endswith("_signs"))
    return path


def test_a_record_has_a_verdict_with_its_reason_and_its_numbers(run):
    folder, _, said = run
    assert "parted.csv: Delaminated. The record is that of two halves that part" in said
    assert said.count("decided by: ") == said.count("to settle it: ") == 1 and "intact" not in said
    parted = xr.load_dataset(stored_verdict(folder))
    best = parted.sel(hypothesis="delaminated")
    assert best.participation.item() == pytest.approx(1.4, rel=0.05) and float(parted.ratio) > 3.0
    for name, true in (("f1", 42.0), ("f2", 52.0)):
        assert float(best.value.sel(parameter=name)) == pytest.approx(true, rel=0.02)
        assert 1e-4 < float(best.standard_error.sel(parameter=name)) / true < 0.05
    assert float(best.value.sel(parameter="e")) == pytest.approx(0.5, abs=0.08)
    (signs,) = folder.glob("diagnose_parted_*_signs.nc")
    assert xr.load_dataset(signs).exceeds.sel(sign="order_2").item() == 1


def test_a_record_has_a_page_with_its_evidence(run):
    """Also anew from what is stored, in other units; numbers where the record holds them."""
    folder, page, said = run
    assert page.index("Delaminated.") < page.index("<h2>Why</h2>") < page.index("Read and signed")
    assert "Tested &lt;here&gt;" in page and page.count("data:image/png;base64,") == 3
    assert hashlib.sha256((folder / "parted.csv").read_bytes()).hexdigest() in page
    assert re.search(r"FMU TwoMassImpactOscillator</td><td[^>]*>\{[0-9a-f-]{36}\}", page)
    assert "intact" not in page and "no certificate" in page
    assert str(next(folder.glob("diagnose_parted_*.html"))) in said
    stored = stored_verdict(folder)
    with redirect_stdout(io.StringIO()):
        assert main(["report", str(stored), "--output", str(folder), "--units", "g"]) == 0
    again = (folder / f"report_{stored.stem}.html").read_text(encoding="utf-8")
    for text, unit in ((page, "m/s²"), (again, "g")):
        cells = re.findall(r"<td[^>]*>([^<]*)</td>", text)
        rows = dict(zip(cells, cells[1:], strict=False))
        assert rows["file of the record"] == "parted.csv"
        assert (rows["sampling rate"], rows["unit of its numbers"]) == ("1600 Hz", "m/s²")
        assert rows["duration"].startswith("4") and " Hz upwards" in rows["sweep"]
        assert rows["level of the base, peak"].endswith(f" {unit}")
        assert "--notes" in rows["command that made it"]
    row = r'<td data-label="parameter">f1, [^<]*</td><td[^>]*>([\d.]+) ± ([\d.]+) Hz'
    f1, error = map(float, re.search(row, page).groups())
    assert abs(f1 - 42.0) < 4.0 * error < 2.0


def test_answers_are_stored_and_taken_again_beside_a_refused_record(run, files, capsys):
    """Another guess has files of its own."""
    folder, _, said = run
    verdicts = {path: xr.load_dataset(path) for path in folder.glob("diagnose_*[!s].nc")}
    assert len(verdicts) == 1
    options = ["--structure", str(folder / "beam.toml"), "--output", str(folder)]
    options += ["--jobs", "1", "--plot", "none"]
    code = main(["diagnose", str(files["sine.csv"]), str(folder / "parted.csv"), *options])
    out, err = capsys.readouterr()
    (verdict,) = [line for line in said.splitlines() if "parted.csv: " in line]
    assert code == 2 and verdict in out
    (line,) = [line for line in err.splitlines() if line.startswith("error")]
    assert line.startswith(f"error: 1 of 2 records refused: {files['sine.csv']}: ")
    assert all(xr.load_dataset(path).equals(data) for path, data in verdicts.items())
    assert all({"identity", "fmu_guid"} <= set(data.attrs) for data in verdicts.values())
    names = set()
    for setting in ("e=0.4", "e=0.6"):
        words = ["diagnose", str(folder / "parted.csv"), "--structure", "beam", "--set", setting]
        command = parse_arguments(words)
        names.add(command.file_stem(Sweep(command.records[0]), command.read_and_report_structure()))
    assert len(names) == 2


def test_a_stored_result_becomes_a_page(ask, tmp_path):
    options = ("--structure", "beam", "--frequency", "78", "--amplitude", "0.001", "--plot", "none")
    ask("simulate", *options, "--periods", "3").success()
    (stored,) = (tmp_path / "results").glob("simulate*.nc")
    page = tmp_path / "results" / f"report_{stored.stem}.html"
    done = ask("report", stored, "--title", "A <study>", "--notes", "Us").success()
    text = page.read_text(encoding="utf-8")
    assert str(page) in done.out and "A &lt;study&gt;" in text
    assert "data:image/png;base64," in text and xr.load_dataset(stored).attrs["fmu_guid"] in text
    ask("report", tmp_path / "lost.nc").complaint("lost.nc", "no such file")
    xr.Dataset({"x": ("y", [1.0])}).to_netcdf(tmp_path / "other.nc")
    ask("report", tmp_path / "other.nc").complaint("cannot plot")
    assert len(list((tmp_path / "results").glob("*.html"))) == 1
