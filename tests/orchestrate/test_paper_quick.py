"""The whole paper at the reduced resolution: complete, and right where that resolution suffices."""

import json

import pytest

from .conftest import exported
from .papers import Papers

pytestmark = pytest.mark.slow


@pytest.fixture(scope="module")
def results(tmp_path_factory):
    """Folder of a complete run."""
    papers = Papers(tmp_path_factory.mktemp("paper"), exported("fmi3") or pytest.skip("no fmi3 here"))
    papers.run().success()
    return papers.output


def test_everything_is_there(results):
    names = {path.name for path in results.iterdir()}
    pictures = [f"figure{number}" for number in range(5, 13)] + ["lyapunov", "attractors", "basin", "maps", "spectra"]
    assert {f"{picture}.{ending}" for picture in pictures for ending in ("png", "pdf")} | {"report.html", "claims.json"} <= names
    page = (results / "report.html").read_text(encoding="utf-8")
    assert page.count("data:image/png;base64,") == len(pictures)
    assert "http://" not in page and "https://" not in page


@pytest.mark.parametrize(
    ("text", "found"),
    [
        ("absolute resonance peak, max xi_Rel", "21.558"),
        ("place of the peak", "1.047"),
        ("max xi_Rel", "2.6347"),
        ("max xi_Rel", "16.4099"),
        ("three impacts from", "between 0.969 and 0.970"),
        ("the first irregular region ends", "between 1.367 and 1.368"),
    ],
)
def test_claims_that_need_no_long_transients(results, text, found):
    rows = json.loads((results / "claims.json").read_text(encoding="utf-8"))["claims"]
    assert found in [row["found"] for row in rows if row["text"] == text]


def test_chaos_is_found_and_periodic_windows_are_not_chaotic(results):
    import xarray

    data = xarray.load_dataset(results / "exponent_e0.7_D0.005.nc")
    assert (data.verdict.sel(eta=slice(0.78, 0.84)) == 1).all()
    assert (data.verdict.sel(eta=slice(1.4, 2.4)) == -1).all()
