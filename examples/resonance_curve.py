"""A beam in SI on a shaker held at 0.02 g: resonance curves, bonded and delaminated."""

import numpy as np

from orchestrate import Structure, sweep

beam = Structure(m1=1.5, m2=1.4, k1=8400.0, k2=10100.0, d1=1.1, d2=1.1, e=0.6)  # SI
frequency = 2.0 * np.pi * np.arange(8.0, 20.0, 0.1)  # rad/s, of 8 to 20 Hz
amplitude = 0.02 * 9.80665 / frequency**2  # of the shaker, m
shaken = {"frequency": frequency, "amplitude": amplitude, "transient": 300, "samples": 50}

delaminated = sweep(beam, direction="both", **shaken)
bonded = sweep(beam.as_bonded(), **shaken)

curves = {
    "bonded": bonded,
    "delaminated, up": delaminated.sel(direction="up"),
    "delaminated, down": delaminated.sel(direction="down"),
}
for name, curve in curves.items():
    top = curve.sel(frequency=curve.x1_max.idxmax())
    hertz = float(top.frequency) / (2.0 * np.pi)
    print(f"{name:17}: {1e3 * float(top.x1_max):.2f} mm at {hertz:.1f} Hz")

table = delaminated[["x1_max", "x2_max", "a1_max", "a2_max", "impacts_per_period"]]
table.to_dataframe().to_csv("beam.csv")
delaminated.to_netcdf("beam.nc")
