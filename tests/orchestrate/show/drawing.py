"""A user's program in a fresh process: our pictures are drawn, and theirs are as they were."""

import sys

import matplotlib
import numpy as np
import xarray as xr

from orchestrate.show import lines
from orchestrate.show.figure_files import save
from tools.pictures import oscillator, shaker


def sweep() -> xr.Dataset:
    """Something that looks like a sweep."""
    along = ("eta", "sample"), np.linspace(0.1, 1.0, 6).reshape(3, 2)
    variables = {"xi_rel": along, "impacts_per_period": ("eta", [1.0, 2.0, 1.0])}
    return xr.Dataset(variables, {"eta": [1.0, 1.1, 1.2], "sample": [11, 12]})


def main(folder: str) -> None:
    """Draw, and see that nothing has changed."""
    matplotlib.rcParams["lines.linewidth"] = 7.0  # a user's own setting
    before = dict(matplotlib.rcParams)
    figures = {
        "orbit": lines.draw_sweep(sweep()),
        "scheme": oscillator.draw_scheme(),
        "shaker": shaker.draw_shaker(),
    }
    for name, figure in figures.items():
        save(figure, f"{folder}/{name}", ("png", "pdf"), dpi=30)
    assert dict(matplotlib.rcParams) == before
    assert "matplotlib.pyplot" not in sys.modules
    line = figures["orbit"].axes[1].lines[0]
    assert line.get_linewidth() != 7.0  # and ours do not depend on theirs
    from matplotlib import pyplot

    backend = matplotlib.get_backend()
    save(lines.draw_sweep(sweep()), f"{folder}/again", dpi=30)
    assert matplotlib.get_backend() == backend
    pyplot.plot([1, 2])
    assert pyplot.gca().lines[0].get_linewidth() == 7.0
    assert pyplot.get_fignums() == [1]  # ours are not among pyplot's


if __name__ == "__main__":
    main(sys.argv[1])
