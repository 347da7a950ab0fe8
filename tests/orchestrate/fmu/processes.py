"""Processes that unpack an FMU, for the tests of what they leave: ``processes.py FMU ENDING``."""

import os
import signal
import sys

from orchestrate.fmu import Instance
from orchestrate.temporary import process_temporary_folder


def work(path: str) -> None:
    with Instance(path) as instance:
        instance.initialize()
        instance.step(0.0, 1.0)


def main(path: str, ending: str) -> None:
    work(path)
    mine = process_temporary_folder()
    print(mine, flush=True)
    if ending == "kill":
        os.kill(os.getpid(), signal.SIGKILL)
    if ending == "fork":
        child = os.fork()
        if child == 0:
            work(path)
            print(process_temporary_folder(), flush=True)
            sys.exit()  # runs what is registered for the end of the process, the parent's too
        os.waitpid(child, 0)
        assert list(mine.iterdir()), "the child has removed what is its parent's"
    if ending == "wait":
        sys.stdin.readline()
        work(path)


if __name__ == "__main__":
    main(*sys.argv[1:])
