"""The report is a page like any other: claims with formulas and verdicts, pictures, their files."""

from types import SimpleNamespace

from orchestrate.paper.report import write_report
from orchestrate.paper.resolution import QUICK


def test_a_report_of_one_claim_and_one_picture(tmp_path):
    row = dict.fromkeys(("section", "text", "printed", "found", "tolerance", "how", "why"), "eta")
    picture = tmp_path / "figure5.png"
    picture.write_bytes(b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR\0\0\0\x07\0\0\0\x05")
    fmu = SimpleNamespace(name="TwoMass", fmi_version="3.0", guid="{5e2}")
    content = {"claims": [{**row, "verdict": "no"}], "regions": []}
    page = write_report(tmp_path, {"5": picture}, content, QUICK, fmu).read_text("utf-8")
    assert "<b>not borne out</b>" in page and "{5e2}" in page and "<mi>η</mi>" in page
    assert 'width="7" height="5"' in page and '<a href="figure5.pdf">figure5.pdf</a>' in page
    assert 'alt="Phase curves for ' in page and "Reduced resolution" in page
