"""Wiring errors of a sound beam's record: each is named with what mends it, none on a clean one."""

from __future__ import annotations

import re

import numpy as np
import pytest
from scipy.signal import detrend

from orchestrate import InputError, detect, read_record, record, signs
from orchestrate.diagnosis.order_windows import checked_sensor_channels, split_sweeps
from orchestrate.diagnosis.undamaged import SoundStructure
from orchestrate.diagnosis.wiring import WiringSettings, wiring_notes
from orchestrate.laboratory.analysis.channels import Channels
from orchestrate.laboratory.conversion import differentiate_and_advance
from orchestrate.model import Structure

RATE, COUNT = 1024.0, 20_480
BASE, FACE = "box_acceleration", "acceleration1"


def sweep(participation=1.3, seed=5, noise=0.01):
    """A beam of 45 Hz, read at a place with this participation factor; 20 to 80 Hz in 20 s."""
    time, rng = np.arange(COUNT) / RATE, np.random.default_rng(seed)
    base = 4.0 * np.sin(2.0 * np.pi * (20.0 * time + 1.5 * time**2))
    made = Channels(time, RATE, (BASE,), base[None], "sweep")
    face = base + participation * (SoundStructure(45.0, 0.01).acceleration(made) - base)
    return {
        name: values + rng.normal(0.0, noise * values.std(), COUNT)
        for name, values in ((BASE, base), (FACE, face))
    }


def notes(channels, rate=RATE):
    return wiring_notes(checked_sensor_channels(record(sample_rate=rate, **channels)))


def lost(channels):
    kept = np.delete(np.arange(COUNT), slice(9000, 9037))
    return {name: values[kept] for name, values in channels.items()}


def with_hum(channels, name, hertz=50.02):
    line = 0.4 * np.sin(2.0 * np.pi * hertz * np.arange(COUNT) / RATE)
    return {**channels, name: channels[name] + line}


def changed(**faces):
    return lambda one: {**one, FACE: faces["face"](one[FACE])}


def late(values, delay):
    return differentiate_and_advance(values, RATE, 0, -delay)


ERRORS = {
    "polarity": (
        changed(face=np.negative),
        r"moves -\S+ times the base at 20.* scale=\"face1=-1\"",
    ),
    "unit": (changed(face=lambda one: one / 9.80665), r'unit="face1=g", or unit="base=m/s2"'),
    "scale": (changed(face=lambda one: 5.0 * one), r'moves \S+ times .* scale="face1=0.2"'),
    "delay": (changed(face=lambda one: late(one, 0.002)), r'(2|2.1) ms .* delay="face1=0.0021?"'),
    "swapped": (lambda one: {BASE: one[FACE], FACE: one[BASE]}, "exchange both in channels="),
    "dead": (
        changed(face=lambda one: np.random.default_rng(1).normal(0.0, 0.05, COUNT)),
        "is its cable dead",
    ),
    "clipped": (
        changed(face=lambda one: np.where(np.arange(COUNT) % 997, one, 900.0)),  # spikes alone
        "saturated in 0.1 % .* wider range",
    ),
    "lost samples": (lost, "phase jumps by .* rad at 8.78"),
    "hum": (lambda one: with_hum(one, FACE), "face 1 has a line of 0.39 m/s2 at 50 Hz"),
}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.parametrize("kind", ERRORS)
def test_each_error_is_named_alone_with_what_mends_it(kind):
    change, words = ERRORS[kind]
    (note,) = notes(change(sweep()))
    assert note.kind == kind and re.search(words, note.text)


@pytest.mark.parametrize(("name", "unit"), [(FACE, "m/s"), (FACE, "um"), (BASE, "mm/s")])
def test_a_velocity_or_displacement_that_is_read_as_an_acceleration_is_named(name, unit):
    channels, (prefix, _, per) = sweep(noise=1e-3), unit.rpartition("m")
    for _ in range(1 if per else 2):
        channels[name] = detrend(np.cumsum(detrend(channels[name]))) / RATE
    channels[name] *= {"": 1.0, "m": 1e3, "u": 1e6}[prefix]
    (note,) = notes(channels)
    asked = f'the other\'s? unit="{"base" if name == BASE else "face1"}={unit}"'
    assert note.kind == "quantity" and note.text.endswith(asked)
    assert f"moves as a {'velocity' if per else 'displacement'}, not an acc" in note.text


@pytest.mark.parametrize("participation", [0.3, 0.8, 1.6])
def test_a_clean_record_has_no_note(participation):
    assert notes(sweep(participation)) == []


def test_hum_is_a_line_at_a_frequency_of_the_mains():
    """Not at another one, and no tone of the base."""
    (of_base,) = notes(with_hum(sweep(noise=0.05), BASE))
    (of_face,) = notes(with_hum(sweep(), FACE, 60.02))
    assert "base has a line" in of_base.text and "at 60 Hz" in of_face.text
    assert notes(with_hum(sweep(), FACE, 55.0)) == []
    tone = 4.0 * np.sin(np.arange(COUNT) * np.pi / 8.0) + 1e-3 * sweep(noise=0.0)[BASE]
    assert notes({BASE: tone, FACE: 3.0 * tone}) == []


def test_noise_and_a_whole_turn_are_no_lost_samples():
    """The phase of a base in noise jumps by chance; a turn more or less is how it is counted."""
    for seed in range(4):
        assert "lost samples" not in [one.kind for one in notes(sweep(noise=0.45, seed=seed))]
    turn = round(RATE / (20.0 + 3.0 * 9000 / RATE))
    kept = np.delete(np.arange(COUNT), slice(9000, 9000 + turn))
    less = {name: values[kept] for name, values in sweep(noise=0.001).items()}
    assert "lost samples" not in [note.kind for note in notes(less)]


def rising(seed=0, noise=0.02, leak=0.0, lost=0):
    """A table of constant displacement, 0.02 m/s2 at 5 Hz, 2 to 40 Hz in 30 s; a beam of 25 Hz."""
    rate, rng = 300.0, np.random.default_rng(seed)
    time = np.arange(9000) / rate
    hertz = 2.0 + 38.0 * time / 30.0
    sine = np.sin(2.0 * np.pi * np.cumsum(hertz) / rate)
    base = 0.02 * (hertz / 5.0) ** 2 * sine
    made = Channels(time, rate, (BASE,), base[None], "rising")
    face = base + 1.3 * (SoundStructure(25.0, 0.01).acceleration(made) - base)
    kept = np.delete(np.arange(9000), slice(7000, 7000 + lost))
    pairs = ((BASE, base), (FACE, face + leak * sine))
    return {name: (one + rng.normal(0.0, noise, 9000))[kept] for name, one in pairs}


@pytest.mark.filterwarnings("ignore::UserWarning")
@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_notes_weigh_what_the_base_moves():
    """Where it moves little, noise turns its phase and a leak of the drive outweighs a face."""
    assert [notes(rising(seed), 300.0) for seed in range(4)] == [[]] * 4
    assert [note.kind for note in notes(rising(lost=3), 300.0)] == ["lost samples"]
    leaking = rising(noise=0.002, leak=0.1)
    assert notes(leaking, 300.0) == []  # it moved as a displacement
    (note,) = notes({**leaking, FACE: -leaking[FACE]}, 300.0)
    assert note.kind == "polarity"
    nowhere = WiringSettings(moves=1e9)
    made = checked_sensor_channels(record(sample_rate=300.0, **rising(lost=3)))
    assert wiring_notes(made, nowhere) == []


@pytest.mark.filterwarnings("error::RuntimeWarning")
def test_few_samples_are_named_and_a_short_sweep_above_the_resonance_says_nothing():
    """Above a third of the sampling rate no frequency beside the orders is resolved."""
    for part in (4, 6):
        few = {name: values[::part] for name, values in sweep().items()}
        assert [note.kind for note in notes(few, RATE / part)] == ["sampling"]
    above = {name: values[9000:] for name, values in sweep().items()}
    assert notes(changed(face=np.negative)(above)) == []


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_a_dead_base_is_told_from_swapped_columns():
    still = np.random.default_rng(2).normal(0.0, 0.02, COUNT)
    (note,) = notes({**sweep(), BASE: still})
    assert note.kind == "dead" and "base's cable" in note.text
    guess = Structure.from_halves(m1=1.0, m2=1.0, f1=40.0, f2=50.0, zeta1=0.01)
    limited = sweep()[FACE].clip(-60.0, 60.0)
    made = record(sample_rate=RATE, box_acceleration=still, acceleration1=limited)
    with pytest.raises(InputError, match="no sine.*; .*is the base's cable dead.*saturated"):
        detect(made, guess)
    with pytest.raises(InputError, match="cable dead[?]$"):
        detect(made, guess, settings={"clipped": 1.0})


@pytest.mark.parametrize("noise", [0.8, 1.0])
def test_noise_that_hides_the_bases_sine_is_named_and_no_exchange_is_proposed(noise):
    """A low level: both sensors have the same noise, and the face moves by far more than that."""
    channels, rng = sweep(), np.random.default_rng(3)
    size = noise * channels[BASE].std()
    (note,) = notes({name: one + rng.normal(0.0, size, COUNT) for name, one in channels.items()})
    assert note.kind == "noise" and "noise or drift hides" in note.text, note
    assert "exchange" not in note.text and "higher level" in note.text


@pytest.mark.filterwarnings("ignore::UserWarning")
def test_what_a_note_says_mends_the_record(tmp_path):
    """Velocity in mm/s upside down and late, the base in volts, times of five digits."""
    channels, path = sweep(), tmp_path / "laser.csv"
    speed = np.cumsum(channels[FACE] - channels[FACE].mean()) / RATE
    volts = channels[BASE] / 9.80665 * 0.1
    rows = zip(np.arange(COUNT) / RATE, volts, -1e3 * late(speed, 0.0015), strict=True)
    path.write_text(
        "Time,Table,Laser tip\n" + "".join(f"{t:.5g},{b:.6g},{v:.6g}\n" for t, b, v in rows)
    )
    options = {}
    asked = '"Table" .base., column "Laser tip" .face 1.: no unit.*unit="base=...,face1=..."$'
    for said in (asked, '"Table" .base.: in V, without a sens.*sensitivity="?'):
        with pytest.raises(InputError, match=said):
            read_record(path, **options)
        if "unit" in options:
            options["sensitivity"] = "base=100 mV/g"
        options["unit"] = "base=V,face=mm/s"
    first = notes_of(path, options)
    assert [note.kind for note in first] == ["polarity", "delay"]
    for note in first:
        option, value = re.search(r'(\w+)="(\w+=[-.\d]+)"', note.text).groups()
        options[option] = value
    assert notes_of(path, options) == []
    read = read_record(path, **options)
    assert read.attrs["time_base"] == "rounded to 0.001 s, taken as 1024 Hz"
    assert read.attrs["converted"] == "face 1: velocity, differentiated by its spectrum"
    inner = slice(2000, -2000)
    error = read.acceleration1.values[inner] - channels[FACE][: read.sizes["time"]][inner]
    assert np.abs(error).max() < 0.25 * np.abs(channels[FACE]).max()


def notes_of(path, options):
    return wiring_notes(checked_sensor_channels(read_record(path, **options)))


def test_sweeps_at_several_levels_are_split_at_pauses_and_at_jumps_of_the_frequency():
    one = sweep()
    silence = {name: np.random.default_rng(9).normal(0.0, 0.01, 2048) for name in one}
    parts = (one, {name: 0.3 * values for name, values in one.items()})
    for pause in ((), (silence,)):
        both = {
            name: np.concatenate([part[name] for part in (parts[0], *pause, parts[1])])
            for name in one
        }
        found = split_sweeps(record(sample_rate=RATE, **both))
        assert [data.attrs["title"] for data in found] == ["Record, sweep 1", "Record, sweep 2"]
        for data, part in zip(found, parts, strict=True):
            assert float(np.abs(data.time[-1] - data.time[0])) == pytest.approx(20.0, abs=1.0)
            assert float(data[BASE].std()) == pytest.approx(part[BASE].std(), rel=0.05)
    alone = record(sample_rate=RATE, **one)
    assert split_sweeps(alone) == [alone]


def test_signs_need_no_base_and_a_verdict_without_one_is_refused(tmp_path):
    """A shaker with a force cell whose own order 2 a sound beam passes on, then no cell."""
    time, rng = np.arange(COUNT) / RATE, np.random.default_rng(3)
    phase = 2.0 * np.pi * (20.0 * time + 1.5 * time**2)
    force = 10.0 * np.sin(phase) + 0.3 * np.sin(2.0 * phase)
    made = Channels(time, RATE, (BASE,), force[None], "force1")
    face = 0.7 * (SoundStructure(45.0, 0.01).acceleration(made) - force)
    rattling = face + 0.2 * np.abs(face) + rng.normal(0.0, 0.01 * face.std(), COUNT)
    path = tmp_path / "shaker.csv"
    rows = zip(time, 0.022 * force, face + rng.normal(0.0, 0.01 * face.std(), COUNT), strict=True)
    lines = "".join(f"{t:.12g},{f:.12g},{a:.12g}\n" for t, f, a in rows)
    path.write_text(f"t [s],force cell [V],tip [m/s2]\n{lines}")
    excited = read_record(path, sensitivity="force=22 mV/N")
    assert excited.force1.attrs["units"] == "N" and np.allclose(excited.force1, force)
    sound = signs(excited, seeds=2).isel(channel=0)
    assert abs(float(sound.sound_f) - 45.0) < 0.2 and sound.attrs["reference"] == "force1"
    assert not (sound.exceeds == 1).any() and sound.exceeds.sel(sign="order_2") == 0
    opened = record(sample_rate=RATE, acceleration1=rattling, force1=force)
    assert signs(opened, seeds=2).exceeds.sel(sign="order_2").item() == 1
    alone = signs(record(sample_rate=RATE, acceleration1=rattling), seeds=2).isel(channel=0)
    own = alone.sel(sign="order_2")
    assert float(own.value) > 5.0 * float(own.floor) and (alone.exceeds == -1).all()
    guess = Structure.from_halves(m1=1.0, m2=1.0, f1=40.0, f2=50.0, zeta1=0.01)
    with pytest.raises(InputError, match="excited by a force; a verdict needs it: measure a swept"):
        detect(opened, guess)
    with pytest.raises(InputError, match="what excites it is unknown; .*orchestrate.signs does"):
        detect(opened.drop_vars("force1"), guess)
