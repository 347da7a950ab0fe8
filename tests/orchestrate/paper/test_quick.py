"""The whole paper at the reduced resolution: complete, and right where that resolution suffices."""

import json

import pytest
import xarray as xr

from ..cli.commands import Commands, end

FOUND = [  # needs no long transients
    ("absolute resonance peak, max xi_Rel", "21.558"),
    ("place of the peak", "1.047"),
    ("max xi_Rel", "2.6347"),
    ("max xi_Rel", "16.4099"),
    ("three impacts from", "exact: 0.96909804 (grazing of a flight of T/3)"),
    ("the first irregular region ends", "exact: 1.36789415 (fold of 2T/3)"),
]
PICTURES = [
    *(f"figure{number}" for number in range(5, 13)),
    *("lyapunov", "attractors", "basin", "maps", "spectra"),
]


@pytest.mark.slow
def test_the_whole_paper(exported, tmp_path):
    commands = Commands(tmp_path)
    try:
        done = end(commands.start("paper", "--quick"), patience=1800.0)
        assert done.code == 0, done.err
    finally:
        commands.clean_up()
    drawn = {f"{picture}.{ending}" for picture in PICTURES for ending in ("png", "pdf")}
    assert drawn | {"report.html", "claims.json"} <= set(commands.files())
    page = (commands.output / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == len(PICTURES)
    claims = json.loads((commands.output / "claims.json").read_text(encoding="utf-8"))["claims"]
    for text, found in FOUND:
        assert any(found in row["found"] for row in claims if row["text"] == text), text
    undecided = {row["text"] for row in claims if row["verdict"] == "undecided"}
    assert {"non-unique solutions in 1.07-1.37", "two impacts from"} <= undecided
    data = xr.load_dataset(commands.output / "exponent_e0.7_D0.005.nc")
    assert (data.verdict.sel(eta=slice(0.78, 0.84)) == 1).all()
    assert (data.verdict.sel(eta=slice(1.4, 2.4)) == -1).all()
