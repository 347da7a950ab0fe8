"""Public functions as questions: their signatures are the one place of names, types, defaults."""

import dataclasses
import inspect
import math
import typing

import numpy as np
import pytest

import orchestrate
from orchestrate import InputError, Structure
from orchestrate.model.arguments import Count, checks_of
from orchestrate.response.questions import Question
from orchestrate.response.signatures import as_given, question

from ..running.test_kills import kinds_of_questions

KINDS = {
    kind.asked: kind
    for kind in sorted(kinds_of_questions(), key=lambda kind: kind.__name__)
    if issubclass(kind, Question)
}
ASKED = [name for name in KINDS if name != "cosimulate"]  # by a job that it makes itself


class EchoJob(Question):
    """A job that answers with its fields."""

    doubled: int

    def work(self, fmus, items, previous):
        """Return the fields."""
        return {"row": np.array([[self.count_of, self.doubled]])}

    def dataset(self, table):
        """Return them as a dataset."""
        return orchestrate.lazy.xr.Dataset({"row": ("n", table["row"][0])})


@question(EchoJob)
def echo(structure: Structure, *, count_of: Count = 3, loud: bool = False, **running: typing.Any):
    """Answer with numbers."""
    return as_given(doubled=2 * count_of)


@pytest.mark.usefixtures("exported")
def test_a_keyword_is_a_field_with_its_check():
    found = echo(Structure(), count_of=4, progress=False)
    assert found.row.values.tolist() == [4, 8]
    assert (found.attrs["count_of"], found.attrs["loud"]) == (4, 0)
    assert found.attrs["call"].startswith("echo(Structure(")
    with pytest.raises(InputError, match="count_of = 0: expected a whole number from 1"):
        echo(Structure(), count_of=0)
    with pytest.raises(InputError, match="loud = 'yes': expected true or false"):
        echo(Structure(), loud="yes")
    with pytest.raises(TypeError, match="quiet"):
        echo(Structure(), quiet=True)
    with pytest.raises(InputError, match="structure = 3: expected a Structure"):
        echo(3)


@pytest.mark.parametrize("name", ASKED)
def test_every_public_signature_is_known_at_run_time_and_is_its_job(name):
    function, kind = getattr(orchestrate, name), KINDS[name]
    types = typing.get_type_hints(function, include_extras=True)
    fields = {field.name: field for field in dataclasses.fields(kind)}
    for key, parameter in inspect.signature(function).parameters.items():
        assert key in types
        if parameter.kind is not parameter.VAR_KEYWORD:
            assert (key in fields) != (key in kind.replaced), key
    assert set(checks_of(kind)) <= set(fields)
    assert kind.asked == function.__name__ == name


@pytest.mark.parametrize("name", ASKED)
def test_every_keyword_that_has_a_check_refuses_by_its_name_in_one_line(name):
    for key, check in checks_of(KINDS[name]).items():
        for wrong in (object(), "\n", math.nan):
            with pytest.raises(InputError, match=rf"^{key}\b[^\n]* expected [^\n]+$"):
                check(key, wrong)
