"""The fast way does what the plain way does."""

import math

import pytest

from orchestrate.errors import FmuError, InputError
from orchestrate.fmu import Channel, Instance

from ..weak_drive.reference_master import SteppingChannel

INPUTS = ("box_acceleration", "box_jerk", "box_snap")
OUTPUTS = ("x1", "v2", "box_force", "box_impulse")


@pytest.fixture
def pair(any_fmu):
    """Make two instances, one of them with a channel."""
    with Instance(any_fmu) as plain, Instance(any_fmu, name="fast") as fast:
        for instance in (plain, fast):
            instance.initialize(box_amplitude=0.0)
        channel = SteppingChannel(Channel(fast, INPUTS, OUTPUTS))
        yield plain, channel
        channel.close()


def test_the_same_bits(pair):
    plain, channel = pair
    for n in range(120):
        values = (math.sin(0.3 * n), 1.2 * math.cos(0.3 * n))
        plain.set(**dict(zip(INPUTS, values, strict=False)))
        plain.step(0.25 * n, 0.25 * (n + 1))
        channel.put(*values)
        channel.step(0.25 * n, 0.25)
        assert channel.get() == plain.get(*OUTPUTS)
    assert plain.get("impact_count")[0] > 0


def test_errors_are_the_fmus_words(pair):
    _, channel = pair
    with pytest.raises(FmuError, match="box_acceleration = nan m/s2"):
        channel.put(float("nan"))
    with pytest.raises(FmuError, match="communicationStepSize = -1.0 s"):
        channel.step(0.0, -1.0)


def test_a_variable_that_is_not_there(pair):
    with pytest.raises(InputError, match="variable gap"):
        Channel(pair[0], ("gap",), OUTPUTS)
