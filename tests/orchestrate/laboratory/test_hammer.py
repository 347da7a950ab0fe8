"""Knocks of a hammer: the motion, what sensors read, responses over the force, and the guess."""

import functools
import operator

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from orchestrate import (
    Hammer,
    InputError,
    Sensor,
    Structure,
    SweptSine,
    frf,
    halves,
    measure,
    plot,
    record,
    shake,
)
from orchestrate.laboratory.analysis.channels import Channels
from orchestrate.laboratory.analysis.knocks import Knocks

from ...fmu.event_driven import Motion
from ...sparing import ordinary
from . import files

BEAM = files.BEAM.replace(clearance=1e-3)
KNOCK = Hammer(peak=20.0, width=0.004, at=0.05, duration=0.5)


def force(knock):
    """The half-sine by its definition."""

    def at(t):
        part = (t - knock.at) / knock.width
        return knock.peak * np.sin(np.pi * part) if 0.0 <= part <= 1.0 else 0.0

    return at


def knocks(count, apart, **one):
    """Equal knocks one after the other."""
    many = (Hammer(at=0.1 + n * apart, duration=(n + 1) * apart, **one) for n in range(count))
    return functools.reduce(operator.add, many)


@pytest.mark.parametrize("half", [1, 2])
@pytest.mark.parametrize("bonded", [False, True])
def test_a_soft_knock_moves_the_linear_oscillator(half, bonded):
    knock = Hammer(peak=-20.0, width=0.004, at=0.05, half=half, duration=0.3)
    data = shake(BEAM.replace(bonded=bonded), knock, sample_rate=2000.0, accuracy=1e-9)
    own = ("1", "2") if bonded else (str(half),)
    m, k, d = (sum(getattr(BEAM, letter + n) for n in own) for letter in "mkd")
    given, time = force(knock), data.time.values

    def rates(t, y):
        return [y[1], (given(t) - k * y[0] - d * y[1]) / m]

    run = solve_ivp(rates, (0, 0.3), [0, 0], "DOP853", time, rtol=1e-11, atol=1e-15, max_step=2e-4)
    x = data[f"x{half}"].values
    assert np.abs(x - run.y[0]).max() <= 1e-7 * np.abs(x).max() and data.sizes["impact"] == 0
    felt = (np.vectorize(given)(time) - k * run.y[0] - d * run.y[1]) / m
    assert np.abs(data[f"a{half}_abs"].values - felt).max() <= 1e-6 * np.abs(felt).max()
    assert bonded or not data[f"a{3 - half}_abs"].any()
    assert not data.box_acceleration.any() and data[f"force{half}"].attrs["units"] == "N"


@pytest.mark.parametrize("half", [1, 2])
def test_impacts_after_a_hard_knock_are_those_of_an_event_driven_integration(half):
    beam = BEAM.replace(clearance=2e-4)
    knock = Hammer(peak=(300.0, -300.0)[half - 1], width=0.004, at=0.01, half=half, duration=0.15)
    data = shake(beam, knock, sample_rate=2000.0, accuracy=1e-10)
    motion, given = Motion(beam.parameters()), force(knock)
    motion.force = lambda n, t: given(t) if n == half else 0.0
    for end in (knock.at, knock.at + knock.width, 0.15):  # the pulse's corners
        motion.run(end)
    impacts = np.array(motion.impacts)
    assert len(impacts) == data.sizes["impact"] > 5
    assert np.abs(impacts - data.impact_time.values).max() <= 1e-7 / beam.f1


@pytest.mark.parametrize("clearance", [2e-4, -1e-4])
def test_sensors_solve_the_motion_under_the_force(clearance):
    """Samples of the history are met through impacts, contact and release; filters are causal."""
    knock = Hammer(peak=600.0, width=0.004, at=0.05, duration=0.3)
    history = shake(BEAM.replace(clearance=clearance), knock, sample_rate=2000.0, accuracy=1e-8)
    assert history.sizes["impact"] > 20
    felt = measure(history, Sensor(bandwidth=1000.0, noise=0.1), excitation=knock)
    assert felt.attrs["reconstruction_error"] <= 1e-9 * float(abs(history.a1_abs).max())
    assert set(felt.data_vars) == {"force1", "acceleration1", "acceleration2"}
    assert 580.0 < float(felt.force1.max()) < 605.0 and not felt.force1[:100].any()


def receptance(mass, spring, damper, frequency, decay):
    """Acceleration over force of an oscillator, in an exponential window."""
    s = 2j * np.pi * frequency + decay
    return s * s / (mass * s * s + damper * s + spring)


def test_frequency_response_over_the_force_is_the_oscillators():
    """H1 of three knocks against the closed form; a double hit is left out and named."""
    history = shake(BEAM, knocks(3, 4.0, peak=20.0, width=0.004))
    answer = frf(history)
    assert [*answer.coords] == ["estimator", "channel", "frequency"]
    frequency, used = answer.frequency.values, answer.excited.values > 0
    decay = float(answer.window_decay)
    exact = receptance(BEAM.m1, BEAM.k1, BEAM.d1, frequency, decay)
    for estimator in ("H1", "H2", "Hv"):
        own = answer.sel(channel="acceleration1", estimator=estimator)
        curve = own.magnitude.values * np.exp(1j * own.phase.values)
        assert np.abs(curve - exact)[used].max() <= 5e-3 * np.abs(exact).max()
    assert answer.magnitude.attrs["units"] == "1/kg" and answer.averages == 3
    struck = knocks(3, 4.0, peak=20.0, width=0.004) + Hammer(peak=5.0, width=0.004, at=4.15)
    text = r"1 of 3 knocks left out: double hits.* at 4\.0\d+ s"
    with pytest.warns(UserWarning, match=text) as told:
        assert frf(shake(BEAM, struck, sample_rate=2000.0)).averages == 2
    assert told[0].filename == __file__
    twice = Hammer(peak=5.0, width=0.004, at=0.1) + Hammer(peak=5.0, width=0.004, at=0.15)
    with pytest.raises(InputError, match="double hits.*expected a knock"):
        frf(shake(BEAM, twice, sample_rate=2000.0))
    assert plot(history) and plot(answer)


@pytest.mark.parametrize(
    ("beats", "count", "longest"),  # begin, width and size of each, of 1,000 samples
    [
        (((100, 4, 1.0), (600, 4, 0.049)), 1, 4),
        (((100, 4, 1.0), (600, 4, 0.051)), 2, 4),  # beyond a twentieth of the largest force
        (((300, 99, 1.0),), 1, 99),
        (((300, 101, 1.0),), 0, 0),  # no knocks: a tenth of the record
        (((100, 4, 1.0), (148, 4, 1.0), (520, 4, 1.0)), 1, 4),  # a double hit: a tenth of 484
        (((100, 4, 1.0), (149, 4, 1.0), (520, 4, 1.0)), 3, 4),
        (((100, 4, 1.0), (107, 2, 1.0), (520, 4, 1.0)), 2, 9),  # one: as close as it is long
        (((100, 4, 1.0), (108, 2, 1.0), (520, 4, 1.0)), 1, 4),
        (((100, 1, 1.0), (102, 1, 1.0), (520, 1, 1.0)), 1, 1),
    ],
)
@pytest.mark.filterwarnings("ignore:.*left out")
def test_each_threshold_of_a_knock(beats, count, longest):
    force = np.zeros(1000)
    for begin, width, size in beats:
        force[begin : begin + width] = size
    channels = Channels(np.arange(1000) / 1e3, 1e3, ("force1",), force[np.newaxis], "x")
    found = Knocks.find_in_force(force, channels, None)
    assert ((len(found.starts), found.width) if found else (0, 0)) == (count, longest)
    if found:  # a hundredth is left at the end of a segment, no force past a knock's length
        assert np.exp(-found.window_decay * found.length / found.rate) == pytest.approx(0.01)
        spectrum, past = found.compute_spectra(force, force[np.newaxis])[1], 3 * found.width
        for place in (past - 1, past):
            other = 3.0 + force  # an offset is none
            other[found.starts[0] + place] += 0.04
            off = np.abs(found.compute_spectra(other, force[np.newaxis])[1] - spectrum).max()
            assert (off < 1e-9 * spectrum.max()) == (place == past)


def test_a_continuous_force_is_averaged_as_the_box_is():
    """A stinger's random force: Welch's method, H1 of the oscillator in the middle of the band."""
    rng, rate = np.random.default_rng(1), 1000.0
    given = rng.normal(size=200_000)
    f = np.fft.rfftfreq(len(given), 1.0 / rate)
    answer = np.fft.rfft(given) * receptance(2.0, 2.0 * (2 * np.pi * 50.0) ** 2, 30.0, f, 0.0)
    made = record(sample_rate=rate, force2=given, acceleration2=np.fft.irfft(answer, len(given)))
    own = frf(made, resolution=0.1).sel(estimator="H1", channel="acceleration2")
    exact = np.abs(receptance(2.0, 2.0 * (2 * np.pi * 50.0) ** 2, 30.0, own.frequency.values, 0.0))
    assert np.abs(own.magnitude - exact)[400:600].max() <= 0.02 * exact.max()
    assert "window_decay" not in own and own.averages > 30


@pytest.mark.parametrize("seed", ordinary(range(20)))
def test_noisy_knocks_make_the_guess(seed, tmp_path):
    """Frequencies within 2 %, damping within 20 %, masses within 5 %."""
    draw = np.random.default_rng([seed, 1]).uniform  # other numbers than the structure's
    beam = files.random_structure(seed, lowest=15.0, clearance=0.01)
    records, f1 = [], beam.f1
    for half in (1, 2):
        knock = knocks(3, 5.0, peak=draw(5.0, 20.0), width=draw(0.1, 0.2) / f1, half=half)
        history = shake(beam, knock, sample_rate=100.0 * f1)
        largest = {f"acceleration{half}": float(abs(history[f"a{half}_abs"]).max())}
        largest |= {f"force{half}": 0.5 * knock.parts[0].peak}  # rms of 1 % and 0.5 %
        sensors = {
            name: Sensor(bandwidth=20.0 * f1, noise=0.01 * peak / np.sqrt(25.6 * f1), seed=seed)
            for name, peak in largest.items()
        }
        records.append(measure(history, sensors, excitation=knock))
    found = halves(*records[::-1], output=tmp_path / "beam.toml")
    for structure in (
        Structure.from_attributes(found.attrs),
        Structure.from_file(tmp_path / "beam.toml"),
    ):
        for name, bound in (("f", 0.02), ("zeta", 0.2), ("m", 0.05)):
            for own in (f"{name}1", f"{name}2"):
                assert getattr(structure, own) == pytest.approx(getattr(beam, own), rel=bound), own


def test_a_sound_beam_is_split_by_its_layers_and_touching_halves_are_refused():
    knock = {"peak": 10.0, "width": 0.01}
    sound = shake(BEAM.as_bonded(), knocks(1, 5.0, **knock), sample_rate=1000.0)
    found = halves(sound, thicknesses=(3.0, 2.0))
    one = Structure.from_attributes(found.attrs)
    assert one.m1 + one.m2 == pytest.approx(BEAM.m1 + BEAM.m2, rel=1e-3)
    assert one.omega_3 * one.f1 == pytest.approx(BEAM.omega_3 * BEAM.f1, rel=1e-4)
    touching = [
        shake(BEAM.replace(clearance=0.0), knocks(1, 5.0, half=n, **knock), sample_rate=1000.0)
        for n in (1, 2)
    ]
    with pytest.raises(InputError, match=r"one oscillator leaves \d+ % .* softer knocks"):
        halves(*touching)
    on_the_box = sound.drop_vars("box_acceleration").rename(force1="box_acceleration")
    for wrong, words in (
        (lambda: halves(sound), "neither of a second record and thicknesses="),
        (lambda: halves(sound, sound), "both knock on half 1"),
        (lambda: halves(on_the_box, thicknesses=(1, 1)), "no force"),
        (lambda: frf(sound.drop_vars("force1")), "box_acceleration does not change; expected"),
        (lambda: KNOCK + SweptSine(first=1, last=2, duration=1, acceleration=1.0), "a sum of"),
        (lambda: KNOCK + Hammer(peak=1.0, width=0.1, half=2), "a sum of force1 and force2"),
        (lambda: measure(sound, {"box_acceleration": Sensor(bandwidth=100.0)}), "force1"),
    ):
        with pytest.raises(InputError, match=words):
            wrong()
