"""A script: an orbit diagram of the paper on processes. Arguments: store, jobs, e, D, direction."""

import sys

import numpy as np

from orchestrate import Structure, sweep

store, jobs, e, D, direction = sys.argv[1:]
sweep(
    Structure.nondimensional(e=float(e), D=float(D)),
    eta=np.round(np.arange(0.1, 8.0005, 0.001), 3),
    direction=direction,
    jobs=int(jobs),
    store=store,
    progress=False,
)
