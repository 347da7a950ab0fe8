"""An FMU in importers with readers and loops of their own: rows of time, outputs and impacts."""

import ctypes
import json
import os
import sys
from importlib import metadata

import fmpy


def ecospy(path, values, names, step, count):
    for file in metadata.files("tbb") or ():  # which its library loads, and does not find itself
        if file.name.startswith("libtbb.so."):
            ctypes.CDLL(str(file.locate()), ctypes.RTLD_GLOBAL)
    from ecospy import EcosSimulation, EcosSimulationStructure

    structure = EcosSimulationStructure()
    structure.add_model("beam", str(path))
    structure.add_parameter_set("one", {f"beam::{name}": v for name, v in values.items()})
    rows = []
    with EcosSimulation(step_size=step, structure=structure) as simulation:
        assert simulation.init(parameter_set="one")
        for _ in range(count):
            simulation.step()
            row = [simulation.get_real(f"beam::{name}") for name in names]
            rows.append([simulation.get_time(), *row, simulation.get_integer("beam::impact_count")])
    return rows


def libcosimpy(path, values, names, step, count):
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
    from libcosimpy.CosimObserver import CosimObserver
    from libcosimpy.CosimSlave import CosimLocalSlave

    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(int(step * 1e9))
    index = execution.add_local_slave(CosimLocalSlave(path, "oscillator"))
    variables = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    for name, value in values.items():
        assert execution.real_initial_value(index, variables[name], value)
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    rows, impacts = [], [variables["impact_count"]]
    for k in range(1, count + 1):
        assert execution.step(), k
        found = observer.last_real_values(index, [variables[name] for name in names])
        found += observer.last_integer_values(index, impacts)
        rows.append([execution.status().current_time * 1e-9, *found])
    print("ANSWER " + json.dumps(rows))
    sys.stdout.flush()
    os._exit(0)  # libcosim's own threads outlive it, and pythonfmu's library the FMU


def fmuloader(path, values, names, step, count):
    from fmuloader import fmi2, fmi3

    known = fmpy.read_model_description(path)
    identifier, version = known.coSimulation.modelIdentifier, known.fmiVersion[0]
    references = {variable.name: variable.valueReference for variable in known.modelVariables}
    experiment = {"start_time": 0.0, "stop_time": count * step}
    if version == "3":
        slave = fmi3.Fmi3Slave(path, model_identifier=identifier)
        slave.instantiate_co_simulation("instance", instantiation_token=known.guid)
        put, get, count_of = slave.set_float64, slave.get_float64, slave.get_int32
        enter = slave.enter_initialization_mode
    else:
        slave = fmi2.Fmi2Slave(path, model_identifier=identifier)
        slave.instantiate("instance", fmi2.Fmi2Type.CO_SIMULATION, guid=known.guid)
        put, get, count_of = slave.set_real, slave.get_real, slave.get_integer
        enter = slave.setup_experiment
    put([references[name] for name in values], list(values.values()))
    enter(**experiment)
    if version == "2":
        slave.enter_initialization_mode()
    slave.exit_initialization_mode()
    wanted, impacts, rows = [references[name] for name in names], [references["impact_count"]], []
    for k in range(count):
        slave.do_step(k * step, step)
        rows.append([(k + 1) * step, *get(wanted), *count_of(impacts)])
    slave.terminate()
    slave.free_instance()
    return rows
