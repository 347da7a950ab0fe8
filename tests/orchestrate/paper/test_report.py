"""The page: nothing from the network, all pictures and verdicts in it, every text escaped."""

from __future__ import annotations

import base64
import os

from orchestrate.access import OSCILLATOR, find
from orchestrate.paper import pictures, plan, report
from orchestrate.paper.resolution import FULL, QUICK

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
    picture.write_bytes(b"picture")
    known = {"resolution": resolution, "fmu": find(OSCILLATOR), "regions": [], "answers": []}
    parts = plan.make(FULL).parts
    path = report.write(tmp_path, {"5": picture}, parts, {**known, "claims": [], **content})
    return path.read_text(encoding="utf-8")


def test_it_needs_no_network(exported, tmp_path):
    text = page(tmp_path, FULL)
    assert "http://" not in text and "https://" not in text
    assert base64.b64encode(b"picture").decode() in text
    assert "Figure 5" in text and "figure5.nc" in text and "Reduced resolution" not in text


def test_claims_are_told_with_their_verdicts(exported, tmp_path):
    text = page(tmp_path, QUICK, claims=[ROW])
    assert "a &lt; b" in text and "R &amp; D" in text and "not borne out" in text
    assert "0 borne out, 0 in part, 1 not" in text and "Reduced resolution" in text


def test_pictures_are_drawn_where_they_are_missing_or_older_than_their_data(tmp_path, monkeypatch):
    part = plan.make(FULL).parts["5"]
    (tmp_path / "figure5.nc").touch()
    assert not pictures.is_current(part, tmp_path)
    for ending in pictures.FORMATS:
        (tmp_path / f"figure5.{ending}").touch()
    assert pictures.is_current(part, tmp_path)
    monkeypatch.setattr(pictures, "load", lambda path: 1 / 0)
    assert pictures.draw_all([part], tmp_path, 2) == {"5": tmp_path / "figure5.png"}
    os.utime(tmp_path / "figure5.nc", (2e9, 2e9))
    assert not pictures.is_current(part, tmp_path)
