"""The referee asks every public function, and says what differs."""

import inspect

import numpy as np
import pytest
import xarray as xr

import orchestrate

from . import __main__ as referee
from . import questions as referee_questions


def test_every_public_function_is_asked():
    public = {name: getattr(orchestrate, name) for name in orchestrate.__all__}
    functions = {name for name, one in public.items() if inspect.isfunction(one)}
    assert functions == {*referee_questions.QUESTIONS, *referee_questions.NOT_COMPARED}


def answer(speed=1.0, word=1, contact=0):
    flags = {"flag_values": [0, 1, 2], "flag_meanings": "undecided jump none"}
    state = {"flag_values": [0, 1], "flag_meanings": "no yes"}  # one that decides nothing
    data = {
        "speed": ("time", [speed, np.nan]),
        "in_contact": ("time", [0, contact], state),
        "verdict": ("jump", [word], flags),
    }
    return referee.summarize(xr.Dataset(data))


@pytest.mark.parametrize(
    ("other", "lines"),
    [
        (answer(), []),
        (answer(speed=np.nextafter(1.0, 2.0)), ["bits of speed in 1 answers, size by up to 2e-16"]),
        (answer(contact=1), ["bits of in_contact in 1 answers, size by up to 1"]),
        (answer(speed=2.0, word=0), ["verdict: jump -> undecided: 1"]),
        ({"decisions": {"error": ["no"]}, "bits": {}}, ["error: an answer -> no: 1"]),
    ],
)
def test_what_differs_is_said(capsys, other, lines):
    """A last bit where nothing is decided anew, and a decision; numbers behind it follow."""
    assert referee.compare("couple", [answer()], [other]) is bool(lines)
    head, *lines_told = capsys.readouterr().out.splitlines()
    of_bits = int("bits" in str(lines))
    assert head.split()[:4] == ["couple", "1", str(of_bits), str(len(lines) - of_bits)]
    assert [line.strip() for line in lines_told] == lines


@pytest.mark.parametrize("group", ["sweep", "orbit"])
def test_a_question_is_the_same_one_twice(exported, group):
    one, again, other = (referee.ask(group, number, 1) for number in (0, 0, 1))
    assert one == again and "error" not in one["decisions"] and one["bits"]
    assert referee.differing_bits(one, other)
