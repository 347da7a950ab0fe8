"""An FMU in ecos, which has an XML reader and a loop of its own."""

import ctypes
from importlib import metadata


def simulate(path, values, names, step, count):
    """Rows of time, outputs and the count of impacts after each step."""
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
