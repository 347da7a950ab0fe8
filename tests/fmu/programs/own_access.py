"""A discarded step in the project's own access, then in FMPy's loop: who is told what."""

import sys

import fmpy
import numpy as np

from orchestrate.errors import FmuError
from orchestrate.fmu.instance import Instance


def main(path):
    with Instance(path) as instance:
        instance.initialize()
        instance.step(0.0, 1.0)
        instance.set(box_frequency=1e9)
        try:
            instance.step(1.0, 2.0)
        except FmuError as error:
            print(error)
        instance.set(box_frequency=0.4)
        instance.step(1.0, 2.0)  # it stayed where it was
    columns = [("time", "f8"), ("box_frequency", "f8")]
    signal = np.array([(0.0, 0.9), (4.5, 0.9), (4.5, 1e9), (10.0, 1e9)], dtype=columns)
    fmpy.simulate_fmu(path, stop_time=10.0, output_interval=1.0, input=signal)


if __name__ == "__main__":
    main(sys.argv[1])
