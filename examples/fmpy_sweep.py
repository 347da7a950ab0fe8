"""The FMU with only FMPy: the largest gap over the frequency ratio.

python fmpy_sweep.py [build/fmi2/TwoMassImpactOscillator.fmu]
"""

import math
import subprocess
import sys
from pathlib import Path

import fmpy

fmu = sys.argv[1] if len(sys.argv) > 1 else "build/fmi2/TwoMassImpactOscillator.fmu"
if not Path(fmu).exists():  # once: exports all forms
    subprocess.run([sys.executable, "-m", "orchestrate", "build", "--folder", "build"], check=True)
folder, model = fmpy.extract(fmu), fmpy.read_model_description(fmu)
number = {variable.name: variable.valueReference for variable in model.modelVariables}
instance = fmpy.instantiate_fmu(folder, model, fmi_type="CoSimulation")

instance.setupExperiment(startTime=0.0)
instance.enterInitializationMode()
instance.setReal([number["e"]], [0.7])
instance.exitInitializationMode()

time = 0.0
for eta in [1.0 + 0.005 * i for i in range(21)]:
    period = 2.0 * math.pi / eta  # omega is 1 rad/s with the default masses and springs
    inputs = {"box_amplitude": 1.0 / eta**2, "box_frequency": eta}
    instance.setReal([number[name] for name in inputs], list(inputs.values()))
    for periods in (300, 20):  # a step may be as long as you like: no impact is missed
        instance.doStep(time, periods * period)
        time += periods * period
    (gap,) = instance.getReal([number["x_rel_max"]])  # of the last step, exact
    print(f"eta = {eta:.3f}: largest gap {gap:.4f}")

instance.terminate()
instance.freeInstance()
