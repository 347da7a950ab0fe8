"""What the tests of the command line share."""

from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from orchestrate.cli import main
from orchestrate.show.style import STYLE
from tests import ROOT

from .commands import Commands, Done

Ask = Callable[..., Done]
RATE = 1000.0


@pytest.fixture(scope="package", autouse=True)
def _exported(exported: Path) -> Iterator[None]:
    """The FMUs are there before the first command asks for them, and pictures are coarse."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(STYLE, "savefig.dpi", 40)
        yield


@pytest.fixture
def commands(tmp_path: Path) -> Iterator[Commands]:
    """Commands in a folder of the test's own."""
    found = Commands(tmp_path)
    yield found
    found.clean_up()


@pytest.fixture
def ask(capsys: pytest.CaptureFixture[str], tmp_path: Path) -> Ask:
    """Run a command in this process, its results in a folder of the test's own."""

    def asked(*options: object, output: object = tmp_path / "results") -> Done:
        capsys.readouterr()
        try:
            code = main([*map(str, options), "--output", str(output)])
        except SystemExit as ended:
            code = int(ended.code or 0)
        return Done(code, *capsys.readouterr())

    return asked


def sweep(order_2: float = 0.0, second: bool = True, noise: float = 0.0) -> xr.Dataset:
    """A swept sine from 20 to 60 Hz, and a response of known orders."""
    time = np.arange(10_000) / RATE
    angle = 2.0 * np.pi * (20.0 * time + 2.0 * time**2)
    box, response = 2.0 * np.sin(angle), 6.0 * np.sin(angle) + order_2 * np.sin(2.0 * angle)
    response += noise * np.random.default_rng(1).normal(size=len(time))
    channels = {"box_acceleration": box, "acceleration1": response, "acceleration2": 0.5 * response}
    kept = {name: ("time", channels[name]) for name in list(channels)[: 2 + second]}
    return xr.Dataset(kept, {"time": time}, {"sample_rate": RATE, "title": "A sweep"})


def in_g(record: xr.Dataset, path: Path) -> None:
    """An export of an analyser: g, a decimal comma, channels by the names of its inputs."""
    rows = zip(record.time.values, *(record[name].values / 9.80665 for name in record), strict=True)
    lines = [";".join(f"{value:.9f}" for value in row).replace(".", ",") for row in rows]
    path.write_text("\n".join(["Zeit [s];AI 1;AI 2", *lines]) + "\n")


@pytest.fixture(scope="session")
def files(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Path]:
    """Records by their names: bonded, delaminated, with one accelerometer, in g, of a simulation,
    a sine of one frequency; and a guess.
    """
    folder = tmp_path_factory.mktemp("records")
    records = {"bonded": sweep(), "parted": sweep(0.6), "measured": sweep(0.5, False, 0.01)}
    records["simulated"] = records["parted"].assign(impulse=("impact", [1.0]))
    for name, record in records.items():
        record.to_netcdf(folder / f"{name}.nc")
    in_g(sweep(second=False), folder / "bench.csv")
    time = np.arange(400) / 200.0
    rows = zip(time, np.sin(60.0 * time), np.cos(60.0 * time), strict=True)
    text = "".join(";".join(f"{value:.6g}" for value in row) + "\n" for row in rows)
    (folder / "sine.csv").write_text(f"time [s];base [m/s2];acc 1 [m/s2]\n{text}")
    guess = ROOT / "docs" / "records" / "beam.toml"
    return {path.name: path for path in (*folder.iterdir(), guess)}
