"""The whole paper at the reduced resolution: complete, and right where that resolution suffices."""

import json

import pytest

from .conftest import exported
from .papers import Papers

PATIENCE = 900.0  # s
FOUND = [
    ("absolute resonance peak, max xi_Rel", "21.558"),
    ("place of the peak", "1.047"),
    ("max xi_Rel", "2.6347"),
    ("max xi_Rel", "16.4099"),
    ("three impacts from", "between 0.969 and 0.970"),
    ("the first irregular region ends", "between 1.367 and 1.368"),
]


def test_the_whole_paper(tmp_path):
    import xarray

    papers = Papers(tmp_path, exported("fmi3") or pytest.skip("no fmi3 here"))
    try:
        process = papers.start()
        _, errors = process.communicate(timeout=PATIENCE)
        assert process.returncode == 0, errors
    finally:
        papers.clean_up()
    pictures = [f"figure{number}" for number in range(5, 13)] + ["lyapunov", "attractors", "basin", "maps", "spectra"]
    assert {f"{picture}.{ending}" for picture in pictures for ending in ("png", "pdf")} | {"report.html", "claims.json"} <= set(papers.files())
    page = (papers.output / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == len(pictures)
    assert "http://" not in page and "https://" not in page
    rows = json.loads((papers.output / "claims.json").read_text(encoding="utf-8"))["claims"]
    for text, found in FOUND:  # needs no long transients
        assert found in [row["found"] for row in rows if row["text"] == text], text
    data = xarray.load_dataset(papers.result("exponent_e0.7_D0.005"))
    assert (data.verdict.sel(eta=slice(0.78, 0.84)) == 1).all()
    assert (data.verdict.sel(eta=slice(1.4, 2.4)) == -1).all()
