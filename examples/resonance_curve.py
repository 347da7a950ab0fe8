"""A beam in SI on a shaker held at 0.02 g: resonance curves, bonded and delaminated."""

import numpy as np

from orchestrate import Structure, plot, resonance, to_dataframe
from orchestrate.show import figure_files

beam = Structure(m1=1.5, m2=1.4, k1=8400.0, k2=10100.0, d1=1.1, d2=1.1, e=0.6)  # SI
frequency = 2.0 * np.pi * np.arange(8.0, 20.0, 0.1)  # rad/s, of 8 to 20 Hz
amplitude = 0.02 * 9.80665 / frequency**2  # of the shaker, m

found = resonance(beam, frequency=frequency, amplitude=amplitude)
peaks = found.isel(peak=found.peak_irregular.values == 0)  # no chance maxima of irregular motion
for number in range(peaks.sizes["peak"]):
    peak = peaks.isel(peak=number)
    name = f"{peak.peak_structure.item()}, {peak.peak_direction.item()}"
    print(f"{name:17}: {1e3 * float(peak.peak_x1_max):.2f} mm at {float(peak.peak_hertz):.1f} Hz")

to_dataframe(found, units="Hz,mm,g").to_csv("beam.csv", index=False)
found.to_netcdf("beam.nc")
figure_files.save(plot(found), "beam")  # beam.png
