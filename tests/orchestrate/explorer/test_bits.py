"""The kernel in the page gives the bits of the FMU: the whole memory, after each period."""

import math

import numpy as np
import pytest

from orchestrate.fmu.webassembly import c_layout, find_or_compile_web_kernel
from orchestrate.weak_drive.master import DRIVE, MOTION, Pair
from tests.web_instance import WebInstance

from ...fmu.programs.driver import open_fmu

pytest.importorskip("wasmtime", reason="wasmtime runs the WebAssembly module")
STARTED = {"x1_start": -0.4, "x2_start": 0.7, "v1_start": 1.3, "v2_start": -0.9}
CUBIC = {"box_acceleration": 0.1, "box_jerk": -0.03, "box_snap": 0.02, "box_crackle": -0.001}
CASES = {  # frequency, periods, what is set
    "chaos": (2.95, 300, {"m2": 1.0}),
    "chaos at low restitution": (1.2, 100, {"e": 0.3}),
    "off rest": (1.2, 100, STARTED),
    "contact": (0.4, 60, {}),
    "contact, unequal masses and dampers": (0.5, 60, {"m2": 0.4, "d2": 0.2, "e": 0.2}),
    "overdamped": (1.1, 60, {"d1": 3.0, "d2": 0.5}),
    "bonded": (1.047, 40, {"bonded": True}),
    "cubic": (1.2, 6, {**STARTED, **CUBIC}),
}


class Native:
    """The kernel as a native FMU, driven as :class:`tests.web_instance.WebInstance` is; its saved
    state has its whole memory.
    """

    def __init__(self, path, size):
        self.fmu, self.size = open_fmu(path), size
        self.begin, self.set = self.fmu.start, self.fmu.set

    def bytes(self):
        return bytes(self.fmu.save()[0])[-8 * self.size - 8 : -8]

    def step(self, time, target):
        self.fmu.call("doStep", time, target - time)


@pytest.fixture(scope="module")
def kernel(exported):
    return find_or_compile_web_kernel()


@pytest.mark.parametrize("case", CASES)
def test_every_number_of_the_memory_is_that_of_the_fmu(kernel, exported, case):
    frequency, periods, values = CASES[case]
    period = 2.0 * math.pi / frequency
    values = {**values, "box_frequency": frequency, "box_amplitude": 1.0 / frequency**2}
    fmu = exported / "fmi2" / "TwoMassImpactOscillator.fmu"
    web = WebInstance(kernel)
    both = web, Native(fmu, web.model.memory_size)
    for one in both:
        one.begin(**values)
        one.set(sample_count=7)
    for n in range(periods):
        for one in both:
            one.step(n * period, (n + 1) * period)
        mine, theirs = (one.bytes() for one in both)
        slots = np.flatnonzero(np.frombuffer(mine, "u8") != np.frombuffer(theirs, "u8"))
        assert not slots.size, f"period {n}: slots {slots}"
        if case == "cubic" and n == 2:  # to the value that it has
            for one in both:
                one.set(box_snap=CUBIC["box_snap"])
    impacts = web.memory()[web.variables["impact_count"]]
    assert impacts > (200 if case == "chaos" else 0) or case == "bonded"


def test_the_module_bears_the_guid_of_its_sources(kernel):
    from fmu_src.export import webassembly

    assert webassembly.guid_inside_module(kernel.module) == webassembly.module_guid() == kernel.guid
    assert webassembly.guid_inside_module(b"\0asm") == ""
    assert len(kernel.module) < 370_000


def test_structures_lie_in_the_module_as_the_page_has_them(kernel):
    """C compiled for 32 bits says itself how large the coupling loop's structure is."""
    web = WebInstance(kernel)
    place = web.exports["sizes_of_couple"].value(web.store)
    assert web.read(place, "u4", 3).tolist() == [c_layout(Pair)["size"], MOTION, DRIVE]
    fields = c_layout(Pair)["fields"]
    assert fields["force.places.3"][1] == fields["force.places.0"][1] + 12
    assert fields["force.scales.0"] == ("f64", fields["force.count"][1] + 24)
