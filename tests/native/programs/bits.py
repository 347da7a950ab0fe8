"""A run of an FMU with nothing but FMPy, every number as hexadecimal text."""

from pathlib import Path

import fmpy
from fmpy import fmi2, fmi3


def instance(path):
    """An instance, and its variables by name."""
    folder = fmpy.extract(path, str(Path.cwd() / "fmu"))
    found = fmpy.read_model_description(folder)
    make = fmi3.FMU3Slave if found.fmiVersion.startswith("3") else fmi2.FMU2Slave
    fmu = make(
        guid=found.guid,
        unzipDirectory=folder,
        modelIdentifier=found.coSimulation.modelIdentifier,
        instanceName="a",
    )
    fmu.instantiate()
    return fmu, {variable.name: variable for variable in found.modelVariables}


def simulate(path, end, count, values, names):
    """Rows of outputs, and the files mapped into the process."""
    fmu, variables = instance(path)
    for name, value in values.items():
        variable = variables[name]
        getattr(fmu, f"set{variable.type}")([variable.valueReference], [value])
    if isinstance(fmu, fmi2.FMU2Slave):
        fmu.setupExperiment(startTime=0.0)
    fmu.enterInitializationMode()
    fmu.exitInitializationMode()
    wanted = [(f"get{variables[name].type}", variables[name].valueReference) for name in names]
    rows = []
    for k in range(count):
        fmu.doStep(currentCommunicationPoint=end * k / count, communicationStepSize=end / count)
        rows.append([float(getattr(fmu, get)([place])[0]).hex() for get, place in wanted])
    lines = Path("/proc/self/maps").read_text().splitlines()
    mapped = {line.split("/", 1)[1].strip() for line in lines if "/" in line}
    return {"rows": rows, "mapped": sorted(mapped)}
