"""Motion in time of a beam in SI: masses, gap, contact force and every impact."""

from math import pi

from orchestrate import Structure, plot, simulate
from orchestrate.show import figure_files

beam = Structure(m1=1.5, m2=1.4, k1=8400.0, k2=10100.0, d1=1.1, d2=1.1, e=0.6)  # SI
found = simulate(beam, frequency=2.0 * pi * 12.4, amplitude=1e-3, transient=200, periods=4)

print(f"largest gap: {1e3 * float(found.x_rel.max()):.2f} mm")
for time, speed in zip(found.impact_time.values, found.impact_velocity.values, strict=True):
    print(f"impact at {time:.6f} s, closing at {1e3 * speed:.1f} mm/s")
figure_files.save(plot(found, title="an own beam at 12.4 Hz"), "motion")  # motion.png
