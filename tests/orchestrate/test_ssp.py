"""The SSP package: another reader takes it, a fixed-step master runs it, and its error is of first order in the step."""

from fmpy.ssp.simulation import simulate_ssp
from fmpy.ssp.ssd import read_ssd, read_ssv

from orchestrate import ssp
from orchestrate.coupling import Scheme
from orchestrate.exchange import OSCILLATOR, SHAKER, SPEED, X1
from orchestrate.setups import QUICK

from ..conftest import BUILD
from .coupled import master

FMUS = tuple(BUILD / "fmi2" / f"{model}.fmu" for model in (OSCILLATOR, SHAKER))
SETUP, ETA0, TIME = QUICK.as_bonded(), 1.5, 20.0


def test_package(tmp_path):
    path = ssp.write(tmp_path / "drive.ssp", SETUP, FMUS, ETA0, 1.25)
    assert path.read_bytes() == ssp.write(tmp_path / "again.ssp", SETUP, FMUS, ETA0, 1.25).read_bytes()
    system = read_ssd(str(path)).system
    assert {element.name: element.source for element in system.elements} == {
        "oscillator": f"resources/{OSCILLATOR}.fmu",
        "shaker": f"resources/{SHAKER}.fmu",
    }
    values = read_ssv(str(path), ssp.VALUES)
    with master(SETUP, Scheme("iterated", 0.1), (0.0,) * 7 + (1.25,)) as m:
        for _ in range(round(TIME / 0.1)):
            m.step(ETA0)
        expected = m.x[X1], m.s[SPEED]
    errors = []
    for h in (0.02, 0.01):
        rows = simulate_ssp(str(path), stop_time=TIME - h / 2, step_size=h, parameter_set=values, input={"voltage": lambda _: ETA0})
        errors.append(abs(rows["oscillator.x1"][-1] - expected[0]))
        assert abs(rows["shaker.speed"][-1] - expected[1]) < 0.2 * h
    assert 1.7 < errors[0] / errors[1] < 2.5
    assert errors[1] > 0.01 * abs(expected[0])  # far too large a step for a tool that holds inputs constant
