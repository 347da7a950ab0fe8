"""The page: nothing from the network, all pictures and verdicts in it, every text escaped."""

import base64
import re

from orchestrate.fmu import OSCILLATOR, find
from orchestrate.paper import report
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


def test_claims_are_shown_with_their_verdicts(exported, tmp_path):
    text = page(tmp_path, QUICK, ROW)
    assert "a &lt; b" in text and "R &amp; D" in text and "not borne out" in text
    shown = re.findall(r'<li class="(\w+)"><b>(\d+)</b> ([^<]+)</li>', text)
    assert [row[:2] for row in shown] == [("yes", "0"), ("partly", "0"), ("no", "1")]
    assert '<a href="#claim1">3</a>' in text and 'id="claim1"' in text
    assert "Reduced resolution" in text
    words = re.sub(r"<[^>]+>", "", text)
    assert not re.search(r"\b(nan|True|False|None|inf)\b", words) and "not found" in words
