"""Every impact at its time: FMI 3.0 event mode with early return, with only FMPy.

python event_mode.py build/fmi3/TwoMassImpactOscillator.fmu
"""

import sys

import fmpy
from fmpy.fmi3 import FMU3Slave

fmu = sys.argv[1] if len(sys.argv) > 1 else "build/fmi3/TwoMassImpactOscillator.fmu"
folder, model = fmpy.extract(fmu), fmpy.read_model_description(fmu)
number = {variable.name: variable.valueReference for variable in model.modelVariables}
name = model.coSimulation.modelIdentifier
slave = {"guid": model.guid, "modelIdentifier": name, "instanceName": "oscillator"}
instance = FMU3Slave(unzipDirectory=folder, **slave)

instance.instantiate(eventModeUsed=True, earlyReturnAllowed=True)
instance.setFloat64([number["box_amplitude"], number["box_frequency"]], [1.0 / 0.8**2, 0.8])
instance.enterInitializationMode(startTime=0.0)
instance.exitInitializationMode()
instance.updateDiscreteStates()
instance.enterStepMode()

time, end = 0.0, 20.0
while time < end:
    event, _terminate, _early, time = instance.doStep(time, end - time)
    if event:  # an impact, and ``time`` is its time
        instance.enterEventMode()
        (speed,) = instance.getFloat64([number["impact_velocity"]])
        print(f"impact at {time:.6f} s, closing at {speed:.6f} m/s")
        instance.updateDiscreteStates()
        instance.enterStepMode()

instance.terminate()
instance.freeInstance()
