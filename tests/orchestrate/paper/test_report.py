"""The page: nothing from the network, all pictures and verdicts in it, every text escaped."""

import base64
import re
from importlib import resources

import pytest
from markupsafe import escape

from orchestrate.errors import InputError
from orchestrate.fmu import OSCILLATOR, find
from orchestrate.paper import report
from orchestrate.paper.claims import WORDS
from orchestrate.paper.pictures import PARTS
from orchestrate.paper.reproduce import choose_parts
from orchestrate.paper.resolution import FULL, QUICK

NAMES = {*map(str, range(5, 13)), "lyapunov", "attractors", "basin", "maps", "spectra"}
PICTURE = b"\x89PNG\r\n\x1a\n....IHDR" + (1560).to_bytes(4, "big") + (1040).to_bytes(4, "big")
ROW = {
    "section": "3",
    "text": "a < b",
    "printed": "1.0",
    "how": "sweep",
    "tolerance": "-",
    "found": "nan at True",
    "verdict": "no",
    "why": "R & D",
}


def page(tmp_path, resolution, *claims):
    picture = tmp_path / "figure5.png"
    picture.write_bytes(PICTURE)
    content = {"claims": claims, "regions": []}
    path = report.write_report(tmp_path, {"5": picture}, content, resolution, find(OSCILLATOR))
    return path.read_text(encoding="utf-8")


def test_parts_have_names_and_order():
    assert set(PARTS) == NAMES
    assert choose_parts(None) == ["claims", *PARTS]
    assert choose_parts(["12", " 5 "]) == ["5", "12"]
    with pytest.raises(InputError, match="unknown figure '4'; choose from claims, 5"):
        choose_parts(["4"])


def test_it_needs_no_network(exported, tmp_path):
    text = page(tmp_path, FULL)
    text = text.replace('xmlns="http://www.w3.org/1998/Math/MathML"', "")  # a name, not a place
    assert "http://" not in text and "https://" not in text
    assert "content=\"default-src 'none'; style-src 'unsafe-inline'; img-src data:;" in text
    assert base64.b64encode(PICTURE).decode() in text
    assert 'width="1560" height="1040"' in text
    assert "Figure 5" in text and "Reduced resolution" not in text
    for file in ("figure5.pdf", "figure5.png", "figure5.nc"):
        assert f'<a href="{file}">' in text


def test_it_says_what_it_is(exported, tmp_path, monkeypatch):
    monkeypatch.setenv("SOURCE_DATE_EPOCH", "1790000000")
    text = page(tmp_path, FULL, ROW)
    assert f"vibroimpact {report.__version__}, 2026-09-21" in text
    assert "names no authors, no year and no DOI" in text
    assert "500(1)700" in re.sub(r"<[^>]+>", "", text).replace(" ", "")
    assert text.index("Summary</h2>") < text.index("Claims</h2>")
    assert '<meta name="viewport" content="width=device-width, initial-scale=1">' in text
    for label in report.COLUMNS["claims"].values():  # where there is no room for a head
        assert f'data-label="{escape(label)}"' in text


def test_claims_are_shown_with_their_verdicts(exported, tmp_path):
    text = page(tmp_path, QUICK, ROW)
    assert "a &lt; b" in text and "R &amp; D" in text and "not borne out" in text
    shown = re.findall(r'<li class="(\w+)"><b>(\d+)</b> ([^<]+)</li>', text)
    assert [row[:2] for row in shown] == [("yes", "0"), ("partly", "0"), ("no", "1")]
    assert '<a href="#claim1">3</a>' in text and 'id="claim1"' in text
    assert "Reduced resolution" in text
    words = re.sub(r"<[^>]+>", "", text)
    assert not re.search(r"\b(nan|True|False|None|inf)\b", words) and "not found" in words


def test_every_verdict_has_its_colour():
    style = resources.files("orchestrate.paper").joinpath("templates/report.css").read_text()
    for verdict in WORDS:
        assert f".{verdict} {{ --shade: var(--{verdict})" in style
