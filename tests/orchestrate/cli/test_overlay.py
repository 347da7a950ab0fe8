"""``--overlay``: a picture of its own, over a result that stays the same."""

from __future__ import annotations

import pytest

SWEEP = ("sweep", "--eta", "2.45:2.55:0.05", "--transient", "10", "--samples", "4")


@pytest.fixture
def window(ask, tmp_path):
    path = tmp_path / "window.nc"
    limits = ("--eta", "2.5", "--limits", "2.48:2.52", "--plot", "none")
    ask("branch", *limits, "--store", path).success()
    return path


def test_a_branch_over_a_sweep_and_resonance_curves(ask, tmp_path, window):
    folder = tmp_path / "results"
    for command in (SWEEP, ("resonance", *SWEEP[1:])):
        ask(*command).success()
        (plain,) = folder.glob(f"{command[0]}_*.png")
        done = ask(*command, "--overlay", window).success()
        assert "complete already" in done.out
        (over,) = set(folder.glob(f"{command[0]}_*.png")) - {plain}
        assert over.name.startswith(f"{plain.stem}_over_") and str(over) in done.out
        assert over.read_bytes() != plain.read_bytes()
    assert len(list(folder.glob("*.nc"))) == 2


@pytest.mark.parametrize(
    ("options", "words"),
    [
        (("--set", "e=0.3"), "a branch of another structure, e = 0.7; expected e = 0.3"),
        (("--eta", "1", "--over", "e", "--values", "0.3,0.5"), "a branch along eta; expected"),
        (
            (
                "--eta",
                "1.2",
            ),
            "one value has no picture",
        ),
        (("--overlay", "lost.nc"), "lost.nc: no such file"),
    ],
)
def test_what_does_not_fit_is_refused_before_anything_is_computed(
    ask, tmp_path, window, options, words
):
    ask(*SWEEP, "--overlay", window, *options).complaint("--overlay", words)
    assert not list((tmp_path / "results").glob("*.nc"))


def test_what_is_no_branch_is_refused(ask, tmp_path, window):
    (tmp_path / "other").mkdir()
    path = tmp_path / "other" / "sweep.nc"
    ask(*SWEEP, "--store", path, "--plot", "none").success()
    ask(*SWEEP, "--overlay", path).complaint(path, "an answer of sweep; expected one of branch")
    levels = ("resonance", "--hz", "0.4,0.41", "--g", "0.1,0.2", "--overlay", window)
    ask(*levels).complaint("--overlay", "several levels, --g 0.1,0.2; expected one")
