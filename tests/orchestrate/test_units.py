"""One setting of units for prints, pictures, tables and pages; datasets stay in SI."""

import re

import numpy as np
import pytest
import xarray as xr

import orchestrate
from orchestrate import InputError
from orchestrate.show.labels import title_from_attributes
from orchestrate.show.scales import displayed_gaps
from orchestrate.units import (
    Units,
    display_scale_of,
    display_units_of,
    format_quantity,
    unit_of_xi,
    with_readable_lengths,
    with_units,
)

from ..exports import once
from .test_public_face import OWN, questions

TURN, G = 2.0 * np.pi, 9.80665
# units that are not asked for with rpm, um, g
FOREIGN = re.compile(r"\bHz\b|rad/s|\bmm\b|m/s|\bin m\b|\d m\b|\beta\b|\\eta")


# answers of each kind of axis that the setting is for
AXES = ("simulate", "resonance levels", "sweep", "map", "spectra", "poincare", "basin", "lyapunov")


def words_of(figure):
    """All that is written in a picture, but for the marks of axes."""
    words = [text.get_text() for text in figure.texts]
    for one in figure.axes:
        words += [one.get_xlabel(), one.get_ylabel(), one.get_title("left")]
        words += [text.get_text() for text in one.texts]
    legends = [*figure.legends, *(one.get_legend() for one in figure.axes if one.get_legend())]
    words += [text.get_text() for legend in legends for text in legend.get_texts()]
    return [*words, figure._suptitle.get_text()] if figure._suptitle is not None else words


def of_the_structure(words):
    """A text without the halves' own frequencies, which are in Hz always, and the velocities."""
    words = re.sub(r"over \$m_1.*\$", "", words)  # numbers without a unit
    plain = re.sub(r"\$f_[12]\$ = [\d.]+ Hz", "", words)
    return plain.replace("mm/s", "")


def test_grammar():
    assert str(Units.from_text("mm Hz,g ; s".replace(" ;", ","))) == "Hz, mm, g, s"
    assert Units.from_text("µm, HZ, m/s^2") == Units("Hz", "um", "m/s2")
    assert Units.from_text("") == Units()
    assert Units("rpm").with_defaults(Units("Hz", "mm")) == Units("rpm", "mm")
    for text, words in (("stone", "stone; expected"), ("Hz, rpm", "Hz and rpm; expected one")):
        with pytest.raises(InputError, match=f"units {text}: {words}"):
            Units.from_text(text)


def test_numbers_are_divided_by_what_the_unit_says():
    data = with_units(xr.Dataset(attrs={"k1": 4.0, "m1": 1.0, "frequency": TURN}), "rpm, um, g")
    assert format_quantity(data, TURN, "rad/s") == "60 rpm"
    assert format_quantity(data, 2e-5, "m") == "20 um"
    assert format_quantity(data, 2e-5, "m/s") == "0.02 mm/s"
    assert format_quantity(data, G, "m/s2") == "1 g"
    assert format_quantity(data, 3.0, "s") == "3 s"
    assert format_quantity(with_units(data, "eta, periods"), 3.0, "rad/s") == "eta = 1.5"
    assert format_quantity(with_units(data, "periods"), 3.0, "s") == "3 periods"
    assert display_scale_of(data, "N") == (1.0, "N")
    assert unit_of_xi(xr.Dataset(attrs={"k1": 4.0, "m1": 1.0, "level": 0.2})) == 0.05
    beam = xr.Dataset({"x": ("t", [2e-5, 0.0], {"units": "m"})}, attrs={"k1": 4.0, "m1": 1.0})
    assert str(display_units_of(*with_readable_lengths(beam))) == "um"
    assert display_scale_of(with_units(xr.Dataset(), "eta"), "rad/s") == (1.0, "rad/s")  # no omega


def test_pictures_are_in_the_units_asked_for_and_in_no_other(exported, tmp_path_factory):
    answers = once(tmp_path_factory, "answers", questions)
    pressed, many = OWN.replace(clearance=-1e-6), OWN.omega * np.linspace(0.9, 1.1, 3)
    threshold = orchestrate.contact_threshold(pressed, frequency=many)
    levels = orchestrate.map(pressed, frequency=many, level=[1.0, 3.0], transient=20, samples=6)
    for answer in (*(answers[kind] for kind in AXES), threshold, levels):
        words = words_of(orchestrate.plot(answer, units="rpm, um, g"))
        foreign = [word for word in words if FOREIGN.search(of_the_structure(word))]
        assert not foreign, (answer.question, foreign)
        assert any("rpm" in word for word in words), answer.question


@pytest.mark.parametrize("over", ["frequency", "force1", "k2"])
def test_gaps_without_box_motion_have_the_length_of_what_pushes(over):
    """They were shown as 0 mm: xi is not over a eta^2 there."""
    beam = orchestrate.Structure.from_file("beam")
    values = {"frequency": [68.0, 75.0], "force1": [1.0, 5.0], "k2": [9000.0, 12000.0]}[over]
    along = {} if over == "frequency" else {"over": over, "values": values}
    asked = {"frequency": 70.0, "amplitude": 0.0, "force1": 3.0, "transient": 100}
    asked = {key: value for key, value in asked.items() if key != along.get("over")}
    varied = {"frequency": values} if over == "frequency" else {}
    found = orchestrate.sweep(beam, **along, **asked | varied, samples=20)
    shown, label = displayed_gaps(with_units(found, Units("Hz", "mm")), found.xi_rel_max)
    assert "mm" in label and "$F_1$" in title_from_attributes(found) or over == "force1"
    for value, gap in zip(values, shown.values, strict=True):
        one = beam.replace(k2=value) if over == "k2" else beam
        own = {**asked, over: value} if over != "k2" else asked
        motion = orchestrate.simulate(one, **own, periods=20)
        assert gap == pytest.approx(1e3 * float(motion.x_rel.max()), rel=5e-3)
