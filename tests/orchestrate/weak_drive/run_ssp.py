"""Run an SSP package: ``TOOL FILE STEP COUNT NAME``; exit code 3: the tool is not installed."""

import ctypes
import json
import sys
from importlib import metadata

PLACES = [("oscillator", "x1"), ("oscillator", "x2")]


def with_fmpy(path, step, count):
    """FMPy applies no bindings: it is handed the parameters, by the components' names."""
    from fmpy.ssp.simulation import simulate_ssp
    from fmpy.ssp.ssd import ParameterSet, read_ssd, read_ssv

    found = ParameterSet(name="all")
    for component in read_ssd(path).system.elements:
        for binding in component.parameterBindings:
            for parameter in read_ssv(path, binding.source).parameters:
                parameter.name = f"{component.name}.{parameter.name}"
                found.parameters.append(parameter)
    stop = (count - 0.5) * step
    rows = simulate_ssp(path, stop_time=stop, step_size=step, parameter_set=found)
    return [float(rows[".".join(place)][-1]) for place in PLACES]


def with_ecospy(path, step, count):
    """Parameter sets are applied by their name. It loads tbb, which lies where pip has put it."""
    for file in metadata.files("tbb") or ():
        if file.name.startswith("libtbb.so."):
            ctypes.CDLL(str(file.locate()), ctypes.RTLD_GLOBAL)
    from ecospy import EcosLib, EcosSimulation

    with EcosSimulation(step_size=step, ssp_path=path) as simulation:
        if not simulation.init(parameter_set="initialValues"):
            raise SystemExit(EcosLib.get_last_error())
        simulation.step(count)
        return [simulation.get_real("::".join(place)) for place in PLACES]


def with_libcosimpy(path, step, count):
    """Times are in nanoseconds."""
    from libcosimpy.CosimExecution import CosimExecution
    from libcosimpy.CosimObserver import CosimObserver

    execution = CosimExecution.from_ssp_file(path, step_size=round(step * 1e9))
    observer = CosimObserver.create_last_value()
    execution.add_observer(observer)
    execution.step(count)
    found = []
    for component, name in PLACES:
        index = execution.slave_index_from_instance_name(component)
        variables = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
        found += observer.last_real_values(index, [variables[name]])
    return found


if __name__ == "__main__":
    tool, file, length, number, shown = sys.argv[1:]
    PLACES.append(("shaker", shown))
    try:
        values = globals()[f"with_{tool}"](file, float(length), int(number))
    except (ImportError, OSError) as error:
        print(error, file=sys.stderr)
        raise SystemExit(3) from None
    print("\n" + json.dumps(values))
