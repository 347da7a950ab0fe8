"""A script as users write it, without a ``__main__`` guard: squares, slowly, on processes."""

import signal
import sys
from pathlib import Path

from orchestrate.running.runner import answer
from tests.orchestrate.running.sums import Model, Squares

signal.signal(signal.SIGINT, signal.default_int_handler)  # where tests run in the background
store, jobs, size = Path(sys.argv[1]), int(sys.argv[2]), int(sys.argv[3])
fmu = store.with_suffix(f".{jobs}.fmu")
fmu.write_bytes(b"an FMU")
print("begun", flush=True)
found = answer(
    Squares("squares", size=size, pause=0.05),
    {"store": store, "jobs": jobs},
    lambda model: Model(fmu, model),
)
print(float(found.square[-1]))
