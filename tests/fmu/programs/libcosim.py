"""An FMU in libcosim, which has an XML reader and a loop of its own."""

import json
import os
import sys

from libcosimpy.CosimExecution import CosimExecution
from libcosimpy.CosimLogging import CosimLogLevel, log_output_level
from libcosimpy.CosimObserver import CosimObserver
from libcosimpy.CosimSlave import CosimLocalSlave


def simulate(path, values, names, step, count):
    """Rows of time and outputs, and the number of variables; ``impact_count`` is an Integer."""
    log_output_level(CosimLogLevel.WARNING)
    execution = CosimExecution.from_step_size(int(step * 1e9))
    index = execution.add_local_slave(CosimLocalSlave(path, "oscillator"))
    variables = {v.name.decode(): v.reference for v in execution.slave_variables(index)}
    for name, value in values.items():
        assert execution.real_initial_value(index, variables[name], value)
    observer = CosimObserver.create_last_value()
    assert execution.add_observer(observer)
    reals, rows = [name for name in names if name != "impact_count"], []
    places = [variables[name] for name in reals]
    for k in range(1, count + 1):
        assert execution.step(), k
        now = execution.status().current_time * 1e-9
        found = dict(zip(reals, observer.last_real_values(index, places), strict=True))
        (found["impact_count"],) = observer.last_integer_values(index, [variables["impact_count"]])
        rows.append([now, *(found[name] for name in names)])
    print("ANSWER " + json.dumps([rows, len(variables)]))
    sys.stdout.flush()
    os._exit(0)  # libcosim's own threads outlive it, and pythonfmu's library the FMU
