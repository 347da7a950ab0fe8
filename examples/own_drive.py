"""Couple a drive of your own with only FMPy: own_drive.py DRIVE.fmu ACCELERATION FORCE."""

import sys

import fmpy

DRIVE = sys.argv[1:] or ["build/fmi2/MotorShaker.fmu", "box_acceleration", "box_force"]
OSCILLATOR = ["build/fmi2/TwoMassImpactOscillator.fmu"]
OSCILLATOR += ["box_amplitude", "box_acceleration", "box_jerk", "box_force", "box_impulse"]
H, steps = 0.01, 2000
fmus, references = [], []
for path, *names in OSCILLATOR, DRIVE:
    model = fmpy.read_model_description(path)
    number = {variable.name: variable.valueReference for variable in model.modelVariables}
    references += [number[name] for name in names]
    fmus.append(fmpy.instantiate_fmu(fmpy.extract(path), model, fmi_type="CoSimulation"))
    fmus[-1].setupExperiment(startTime=0.0)
    fmus[-1].enterInitializationMode()
    fmus[-1].exitInitializationMode()
(oscillator, drive), (*inputs, force, impulse, acceleration, drive_force) = fmus, references
(now,), jerk = drive.getReal([acceleration]), 0.0
for time in (number * H for number in range(steps)):
    state = oscillator.getFMUState()
    for last in False, True:  # under an extrapolation, then between both accelerations
        oscillator.setReal(inputs, [0.0, now, jerk])  # its own excitation is off
        oscillator.doStep(time, H)
        at_end, total = oscillator.getReal([force, impulse])
        if not last:
            drive.setReal([drive_force], [total / H])  # the mean, exact through impacts
            drive.doStep(time, H)
            oscillator.setFMUState(state)
        drive.setReal([drive_force], [at_end])  # what its acceleration follows as set now
        (after,) = drive.getReal([acceleration])
        jerk = (after - now) / H
    oscillator.freeFMUState(state)
    now = after
print(f"after {H * steps:g} s: force {at_end:.4g} N, acceleration of the box {now:.4f} m/s2")
