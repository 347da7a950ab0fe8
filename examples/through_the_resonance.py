"""A motor too weak for its resonance: what voltage it takes, and how less of it will do."""

from orchestrate import Drive, SpeedGradient, Structure, capture, couple

beam = Structure.from_file("beam")
weak = Drive.from_file("beam").replace(armature_resistance=120.0)  # Ohm

tried = capture(beam, weak, voltage=(9.0, 9.4), count=2, tolerance=0.02)  # V
print(f"switched on from rest it passes from {float(tried.border):.2f} V on")

swing = SpeedGradient(filter_time=0.4, passed=101.0, low=0.6)  # s, rad/s
for name, control in {"all of 8.73 V": None, "swung by 8.73 V": swing}.items():
    run = couple(beam, weak, voltage=8.73, duration=10.0, speed_start=0.0, control=control)
    print(f"{name}: {float(run.speed[-1]):.0f} rad/s after 10 s")
