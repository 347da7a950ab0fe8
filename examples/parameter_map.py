"""Impacts in a period over frequency ratio and restitution: a map of 450 responses."""

import numpy as np

from orchestrate import Structure, map, plot
from orchestrate.show import figure_files

paper = Structure.nondimensional(D=0.05)
axes = {"eta": np.linspace(0.5, 1.6, 30), "e": np.linspace(0.1, 0.9, 15)}
found = map(paper, **axes, transient=100, settle=50.0)
one_period = found.multiplicity == 1
print(f"{float(one_period.mean()):.0%} of the map repeats after one period")
print(f"largest gap: xi_Rel = {float(found.xi_rel_max.max()):.2f}")
found.to_netcdf("map.nc")
figure_files.save(plot(found), "map")  # map.png
