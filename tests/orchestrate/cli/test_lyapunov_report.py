"""What ``lyapunov`` prints of many exponents: the largest one is not passed off as an estimate."""

from __future__ import annotations

import numpy as np
import xarray as xr
from orchestrate.cli.lyapunov import print_result


def test_the_largest_of_many_is_said_to_be_chosen(capsys):
    etas = np.linspace(5.0, 5.3, 12)
    exponents = np.full(12, 0.25)
    exponents[7] = 0.2777
    columns = {"exponent": exponents, "standard_error": np.full(12, 0.003)}
    columns["impacts_per_period"] = np.ones(12)
    variables = {name: ("eta", values) for name, values in columns.items()}
    variables["verdict"] = ("eta", np.ones(12, dtype=int))
    data = xr.Dataset(variables, {"eta": etas}, {"periods": 2500, "wander": 10.0})
    print_result(data.assign_coords(period=("eta", 2.0 * np.pi / etas)))
    line = capsys.readouterr().out.splitlines()[0]
    assert line.startswith("largest exponent 0.27770 +- 0.00300 per tau at eta = 5.19")
    assert "of 12 it is chosen for its error too" in line
