"""Questions of someone who has installed the package: run outside the clone."""

from pathlib import Path

import orchestrate
from orchestrate.weak_drive.compiled import load_step_function

assert "site" in Path(orchestrate.__file__).as_posix(), orchestrate.__file__
beam = orchestrate.Structure(m1=1.5, m2=1.4, k1=8400.0, k2=10100.0, d1=1.1, d2=1.1, e=0.6)
motion = orchestrate.simulate(beam, frequency=78.0, amplitude=1e-3, periods=5)
assert motion.sizes["time"] == 1001
response = orchestrate.sweep(beam, eta=[1.0, 1.05], transient=50, samples=20)
assert response.sizes["eta"] == 2
drive = orchestrate.Drive.from_file("beam")
run = orchestrate.couple(beam, drive, voltage=(5.6, 5.7), rate=1.0)
assert run.sizes["revolution"] > 0
assert load_step_function() is not None  # the compiled master came along
