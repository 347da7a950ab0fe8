"""An FMU in fmuloader, whose ctypes and callbacks are its own."""

import fmpy
from fmuloader import fmi2, fmi3


def opened(path):
    """A slave of the FMU's version, instantiated, and references by name."""
    found = fmpy.read_model_description(path)
    identifier, references = found.coSimulation.modelIdentifier, {}
    for variable in found.modelVariables:
        references[variable.name] = variable.valueReference
    if found.fmiVersion.startswith("3"):
        slave = fmi3.Fmi3Slave(path, model_identifier=identifier)
        slave.instantiate_co_simulation("instance", instantiation_token=found.guid)
        return slave, references
    slave = fmi2.Fmi2Slave(path, model_identifier=identifier)
    slave.instantiate("instance", fmi2.Fmi2Type.CO_SIMULATION, guid=found.guid)
    return slave, references


def simulate(path, values, names, step, count):
    slave, references = opened(path)
    third = hasattr(slave, "get_float64")
    put = slave.set_float64 if third else slave.set_real
    get = slave.get_float64 if third else slave.get_real
    put([references[name] for name in values], list(values.values()))
    experiment = {"start_time": 0.0, "stop_time": count * step}
    if third:
        slave.enter_initialization_mode(**experiment)
    else:
        slave.setup_experiment(**experiment)
        slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    wanted = [references[name] for name in names]
    rows = [[0.0, *get(wanted)]]
    for k in range(count):
        slave.do_step(k * step, step)
        rows.append([(k + 1) * step, *get(wanted)])
    slave.terminate()
    slave.free_instance()
    return rows
