"""Dask schedulers and workers killed while a command computes."""

import random
import signal
import sys
import time
from collections.abc import Iterator, Sequence
from pathlib import Path

import pytest

from tests.orchestrate.cli import test_cluster as dask
from tests.orchestrate.cli.commands import end

from .findings import expect_none
from .test_faults import Trial, attack, format_end, wrong_message

pytestmark = pytest.mark.skipif(sys.platform != "linux", reason="processes of Linux")
CONNECTING = 1.0  # s


class Nodes:
    """A scheduler and two workers, made anew where one of them has been killed."""

    def __init__(self, folder: Path) -> None:
        """Start nothing yet."""
        self.folder, self.started = folder, []  # type: Path, list[dask.Dask]
        folder.mkdir()

    def options(self) -> Sequence[str]:
        """Return the options of a command for a whole cluster, which is started if need be."""
        if not self.started or any(process.poll() is not None for process, _ in self.started):
            self.close()
            options = ("--host", "127.0.0.1", "--port", "0", "--no-dashboard")
            self.started = [dask.start(self.folder, "scheduler", "scheduler", *options)]
            self.address = dask.read(self.started[0], r"tcp://127\.0\.0\.1:\d+")
            for name in ("one", "two"):
                place = (*dask.OPTIONS, str(self.folder))
                self.started.append(dask.start(self.folder, name, "worker", self.address, *place))
            for node in self.started[1:]:
                dask.read(node, "Registered to")
        return "--cluster", self.address

    def kill(self, trial: Trial, node: int) -> str:
        """Kill a node at a random moment of a command; return what is wrong with its end ("")."""
        process = trial.start()
        time.sleep(trial.chance.uniform(0.0, trial.seconds + CONNECTING))
        self.started[node][0].send_signal(signal.SIGKILL)
        done = end(process)
        self.started[node][0].wait()
        if node == 0:
            trial.options[-1] = self.options()[1]  # of another scheduler
            return wrong_message(done) or trial.again()
        return format_end(done) if done.code else trial.wrong_result()

    def close(self) -> None:
        """End all processes."""
        dask.end_all(self.started)
        self.started = []


@pytest.fixture
def nodes(tmp_path: Path) -> Iterator[Nodes]:
    """A cluster on this machine."""
    pytest.importorskip("distributed")
    made = Nodes(tmp_path / "nodes")
    yield made
    made.close()


@pytest.mark.slow
@pytest.mark.budget(2)  # faults
def test_a_command_on_a_cluster_survives_its_loss(exported, seed, budget, tmp_path, nodes):
    """One of two workers is killed, or the scheduler: then the command goes on at another one."""
    faults = {
        "worker killed": lambda trial: nodes.kill(trial, trial.chance.choice((1, 2))),
        "scheduler killed": lambda trial: nodes.kill(trial, 0),
    }
    names = ("sweep", "resonance", "map", "basin") if budget > len(faults) else ("sweep",)
    findings = attack(faults, names, random.Random(seed), tmp_path, budget, nodes.options)
    expect_none(findings, {"faults": budget})
