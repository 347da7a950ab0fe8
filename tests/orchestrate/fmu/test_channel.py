"""The fast way does what the plain way does."""

import math

import pytest

from orchestrate.errors import FmuError, InputError
from orchestrate.fmu import Channel, Instance

INPUTS = ("box_acceleration", "box_jerk", "box_snap")
OUTPUTS = ("x1", "v2", "box_force", "box_impulse")


@pytest.fixture
def pair(any_fmu):
    """Make two instances, one of them with a channel."""
    with Instance(any_fmu) as plain, Instance(any_fmu, name="fast") as fast:
        for instance in (plain, fast):
            instance.initialize(box_amplitude=0.0)
        channel = Channel(fast, INPUTS, OUTPUTS)
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


def test_states_are_kept_and_come_back(pair):
    _, channel = pair
    channel.put(1.0, 0.2)
    channel.step(0.0, 2.0)
    channel.save()
    channel.save(level=1)
    after = []
    for level in (0, 1, 0):
        channel.step(2.0, 3.0)
        after.append(channel.get())
        channel.restore(level)
    assert after[0] == after[1] == after[2]
    channel.step(2.0, 3.0)
    channel.save()
    channel.step(5.0, 1.0)
    channel.restore()
    assert channel.get() == after[0]


def test_errors_are_the_fmus_words(pair):
    _, channel = pair
    with pytest.raises(FmuError, match="box_acceleration = nan m/s2"):
        channel.put(float("nan"))
    with pytest.raises(FmuError, match="communicationStepSize = -1.0 s"):
        channel.step(0.0, -1.0)


def test_a_variable_that_is_not_there(pair):
    with pytest.raises(InputError, match="variable gap"):
        Channel(pair[0], ("gap",), OUTPUTS)
