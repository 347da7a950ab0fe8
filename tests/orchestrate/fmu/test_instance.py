"""What is set is what is read, errors are the FMU's words, states come back bit by bit."""

import math

import pytest

from orchestrate.errors import FmuError, InputError
from orchestrate.fmu import FORMS, OSCILLATOR, Instance, describe

from .altered import altered_fmu

CHAOS = {"box_amplitude": 1.0 / 1.2**2, "box_frequency": 1.2}
STATE = ("x1", "x2", "v1", "v2", "x_rel", "x_rel_max", "impact_time", "impact_energy", "phase")


@pytest.fixture
def instance(any_fmu):
    """Make an instance in chaotic motion, at t = 100 s."""
    with Instance(any_fmu) as instance:
        instance.initialize(**CHAOS)
        instance.step(0.0, 100.0)
        yield instance


def trajectory(instance, start, steps=25):
    """Values along some steps."""
    values = []
    for n in range(steps):
        instance.step(start + 2.0 * n, start + 2.0 * n + 2.0)
        values.append(instance.get(*STATE, "impact_count", "in_contact"))
    return values


@pytest.mark.parametrize(("form", "version"), list(zip(FORMS, ("2.0", "2.0", "3.0"), strict=True)))
def test_description(oscillator_in, form, version):
    fmu = oscillator_in(form)
    found = describe(fmu, OSCILLATOR)
    assert (found.path, found.name, found.fmi_version) == (fmu, OSCILLATOR, version)
    assert found.guid.strip("{}").replace("-", "").isalnum() and len(found.guid) == 38
    assert found.variables["e"].causality == "parameter" and found.variables["x_rel"].unit == "m"
    assert found.needs_tool == (form == "fmi2-python")
    assert describe(str(fmu)).variables.keys() == found.variables.keys()


def test_what_is_set_is_read(any_fmu):
    values = {"m2": 0.1, "e": 0.3, "bonded": True, "box_amplitude": -1.5e-7, "x_rel_max_on": False}
    with Instance(any_fmu) as instance:
        instance.set(**values)
        instance.initialize()
        assert instance.get(*values) == list(values.values())
        instance.set(box_frequency=2.0)
        assert instance.get("box_frequency", "m2") == [2.0, 0.1]


def test_initialize_begins_at_a_time(any_fmu):
    with Instance(any_fmu) as instance:
        instance.initialize(start_time=5.0, x1_start=-0.25, **CHAOS)
        assert instance.get("x1") == [-0.25]
        with pytest.raises(FmuError, match=r"currentCommunicationPoint = 0.0 s: .*5\.0 s"):
            instance.step(0.0, 1.0)
        instance.step(5.0, 6.0)


@pytest.mark.parametrize(
    "call", [lambda i: i.get("gap"), lambda i: i.set(gap=1.0), lambda i: i.read("x1", "gap")]
)
def test_a_variable_that_is_not_there(instance, call):
    with pytest.raises(InputError, match="variable gap: the FMU TwoMassImpactOscillator has none"):
        call(instance)


def test_errors_are_the_fmus_words_in_one_line(instance):
    for call, words in (
        (lambda: instance.set(box_amplitude=math.nan), "box_amplitude = nan m"),
        (lambda: instance.restore_state(b"short"), "saved by this FMU"),
        (lambda: instance.read("in_contact"), "in_contact.*Boolean"),
    ):
        with pytest.raises(FmuError, match=words) as error:
            call()
        assert "\n" not in str(error.value)


def test_a_restored_state_gives_the_same_bits(instance, any_fmu):
    state = instance.save_state()
    assert isinstance(state, bytes)
    once = trajectory(instance, 100.0)
    assert len({tuple(values) for values in once}) == len(once)
    instance.restore_state(state)
    assert trajectory(instance, 100.0) == once
    with Instance(any_fmu, name="another") as other:
        other.initialize()
        other.restore_state(state)
        assert trajectory(other, 100.0) == once


def test_reset(instance):
    instance.reset()
    instance.initialize(**CHAOS)
    assert instance.get("impact_count", "x1") == [0, 0.0]
    once = trajectory(instance, 0.0)
    instance.reset()
    instance.initialize()
    assert instance.get("box_frequency") == [0.4]  # start values are back too
    instance.reset()
    instance.initialize(**CHAOS)
    assert trajectory(instance, 0.0) == once


def test_an_fmu_without_a_binary_for_this_machine(any_fmu, tmp_path):
    fmu = altered_fmu(any_fmu, tmp_path / "a.fmu", modelIdentifier=(OSCILLATOR, "Elsewhere"))
    with pytest.raises((FmuError, InputError), match="Elsewhere") as error:
        Instance(fmu)
    assert "\n" not in str(error.value)
