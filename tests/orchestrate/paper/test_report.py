"""The page: nothing from the network, all pictures and verdicts in it, every text escaped."""

from __future__ import annotations

import base64
import os
import re
from importlib import resources

from markupsafe import escape

from orchestrate.access import OSCILLATOR, find
from orchestrate.paper import pictures, plan, report
from orchestrate.paper.claims.claim import WORDS
from orchestrate.paper.resolution import FULL, QUICK

PICTURE = b"\x89PNG\r\n\x1a\n....IHDR" + (1560).to_bytes(4, "big") + (1040).to_bytes(4, "big")

ROW = {
    "section": "3",
    "text": "a < b",
    "printed": "1.0",
    "how": "sweep",
    "tolerance": "-",
    "found": "2.0",
    "verdict": "no",
    "why": "R & D",
}


def page(tmp_path, resolution, **content):
    picture = tmp_path / "figure5.png"
    picture.write_bytes(PICTURE)
    known = {"resolution": resolution, "fmu": find(OSCILLATOR), "regions": [], "answers": []}
    parts = plan.make_plan(FULL).parts
    path = report.write_report(tmp_path, {"5": picture}, parts, {**known, "claims": [], **content})
    return path.read_text(encoding="utf-8")


def test_it_needs_no_network(exported, tmp_path):
    text = page(tmp_path, FULL)
    text = text.replace('xmlns="http://www.w3.org/1998/Math/MathML"', "")  # a name, not a place
    assert "http://" not in text and "https://" not in text
    assert "content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:;" in text
    assert base64.b64encode(PICTURE).decode() in text
    assert 'width="1560" height="1040"' in text
    assert "Figure 5" in text and "Reduced resolution" not in text


def test_each_figure_leads_to_its_files(exported, tmp_path):
    text = page(tmp_path, FULL)
    for file in ("figure5.pdf", "figure5.png", "figure5.nc"):
        assert f'<a href="{file}">' in text


def test_it_is_made_for_phones_and_dark_rooms(exported, tmp_path):
    text = page(tmp_path, FULL, claims=[ROW])
    assert '<meta name="viewport" content="width=device-width, initial-scale=1">' in text
    assert "prefers-color-scheme: dark" in text
    for label in report.COLUMNS["claims"].values():  # where there is no room for a head
        assert f'data-label="{escape(label)}"' in text


def test_it_says_what_it_is(exported, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")
    text = page(tmp_path, FULL, claims=[ROW])
    assert f"vibroimpact {report.__version__}, 2026-09-21" in text
    assert "names no authors, no year and no DOI" in text
    assert "500(1)700" in re.sub(r"<[^>]+>", "", text).replace(" ", "")
    assert text.index("Summary</h2>") < text.index("Claims</h2>")


def test_a_program_s_words_reach_no_reader(exported, tmp_path):
    row = {**ROW, "found": "nan at eta = nan", "why": "T: True; False"}
    text = re.sub(r"<[^>]+>", "", page(tmp_path, FULL, claims=[row]))
    assert not re.search(r"\b(nan|True|False|None|inf)\b", text)
    assert "not found" in text


def test_claims_are_told_with_their_verdicts(exported, tmp_path):
    text = page(tmp_path, QUICK, claims=[ROW])
    assert "a &lt; b" in text and "R &amp; D" in text and "not borne out" in text
    told = re.findall(r'<li class="(\w+)"><b>(\d+)</b> ([^<]+)</li>', text)
    assert told == [
        ("yes", "0", "borne out"),
        ("partly", "0", "in part"),
        ("no", "1", "not borne out"),
    ]
    assert '<a href="#claim1">3</a>' in text and 'id="claim1"' in text
    assert "Reduced resolution" in text


def test_every_verdict_has_its_colour():
    style = resources.files("orchestrate.paper").joinpath("templates/report.css").read_text()
    for verdict in (*WORDS, "undecided"):
        assert f".{verdict} {{ --shade: var(--{verdict})" in style


def test_pictures_are_drawn_where_they_are_missing_or_older_than_their_data(tmp_path, monkeypatch):
    part = plan.make_plan(FULL).parts["5"]
    (tmp_path / "figure5.nc").touch()
    assert not pictures.is_current(part, tmp_path)
    for ending in pictures.FORMATS:
        (tmp_path / f"figure5.{ending}").touch()
    assert pictures.is_current(part, tmp_path)
    monkeypatch.setattr(pictures, "load", lambda path: 1 / 0)
    assert pictures.draw_all([part], tmp_path, 2) == {"5": tmp_path / "figure5.png"}
    os.utime(tmp_path / "figure5.nc", (2e9, 2e9))
    assert not pictures.is_current(part, tmp_path)
