"""Write the shipped Figure 6 of the explorer: ``python -m tools.figure6_states``.

Kept in the repository, so that a page is written at once and its clicks replay one branch, the same
everywhere. To be made again when the kernel changes: a test says so.
"""

from __future__ import annotations

import numpy as np

import orchestrate
from orchestrate.explorer.sweep_data import FILE, STAMP
from orchestrate.files import write_atomically
from orchestrate.fmu import OSCILLATOR
from orchestrate.fmu.webassembly import kernel_digest

KEPT = ["frequency", "amplitude", "impacts_per_period", "end_state"]
LEFT_OUT = ("identity", "history")  # of every source: the stamp tells what decides the bits


def main() -> None:
    etas = np.arange(100, 8001) / 1000
    data = orchestrate.sweep(orchestrate.Structure(), eta=etas, direction="up")
    data = data[KEPT].drop_vars("period")
    data.attrs = {name: value for name, value in data.attrs.items() if name not in LEFT_OUT}
    data = data.assign_attrs({STAMP: kernel_digest(OSCILLATOR)})
    small = {"zlib": True, "complevel": 9, "shuffle": True}
    encoding = dict.fromkeys((*KEPT, "eta"), small)
    write_atomically(FILE, lambda place: data.to_netcdf(place, engine="netcdf4", encoding=encoding))
    print(f"{FILE}  {FILE.stat().st_size / 1024:.0f} kB")


if __name__ == "__main__":
    main()
