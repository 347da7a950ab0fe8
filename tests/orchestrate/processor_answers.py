"""What ``dynamics`` and ``weak_drive`` decide, as JSON: run with kernels of several processors.

``python -m tests.orchestrate.processor_answers NAME ...`` prints the kernels of the linear algebra
in use, and some of the answers: numbers of points, ends, kinds and stability as they are, places as
numbers.
"""

import json
import sys

import numpy as np
import scipy.linalg  # noqa: F401  (SciPy has linear algebra of its own)
import threadpoolctl

from orchestrate import Drive, Structure, branch
from orchestrate.weak_drive import averaged

from .weak_drive.coupled import System
from .weak_drive.test_drive_branch import branch_of
from .weak_drive.test_validation import random_sets

RIG = System(Structure.from_file("rig"), Drive.from_file("rig"))


def kernels():
    """Of NumPy's and SciPy's OpenBLAS."""
    return [one.get("architecture") for one in threadpoolctl.threadpool_info()]


def of_an_orbit_branch(limits):
    """Chattering whose impacts come and go, up to where permanent contact is lost."""
    structure = Structure.nondimensional(D=0.02, e=0.4, gamma=1.8257e-4)
    found = branch(structure, eta=sum(limits) / 2.0, limits=limits, progress=False)
    kinds = found.bifurcation_kind.values.tolist()
    decided = [found.sizes["point"], found.first_end, found.last_end, kinds]
    places = [*found.eta.values.tolist(), *found.bifurcation_value.values.tolist()]
    return {"decided": [*decided, found.stable.values.astype(int).tolist()], "places": places}


def of_a_drive(system):
    decided, places = [], []
    for leg in branch_of(system, most=60, range_=(1.005, 1.018))[0]:
        stable = [int(abs(one.multipliers[0]) < 1.0) for one in leg.points]
        kinds = [event.kind.label for event in leg.bifurcations]
        impacts = [one.period.impacts for one in leg.points]
        decided.append([leg.end, kinds, stable, impacts])
        motions = [*leg.points, *(event.point for event in leg.bifurcations)]
        places += [float(x) for one in motions for x in one.root.unknowns[-2:]]
    return {"decided": decided, "places": places}


def of_the_averaged_theory(count):
    """Folds and Neimark-Sacker points of random drives."""
    found = []
    for system in random_sets(count, seed=5):
        bonded = system.as_bonded()
        found += [averaged.folds(*bonded), averaged.neimark_sacker_points(*bonded)]
    kinds = [[place.kind for place in places] for places in found]
    return {"decided": kinds, "places": [place.eta0 for places in found for place in places]}


ANSWERS = {
    "branch": lambda: of_an_orbit_branch((0.79, 0.8)),
    "rig": lambda: of_a_drive(RIG),
    "averaged": lambda: of_the_averaged_theory(2),
}


def main():
    answers = {name: ANSWERS[name]() for name in sys.argv[1:]}
    print(json.dumps({"kernels": kernels(), "answers": answers}, default=np.ndarray.tolist))


if __name__ == "__main__":
    main()
