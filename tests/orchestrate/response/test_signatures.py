"""Public functions as questions: their signatures are the one place of names, types, defaults."""

import dataclasses
import inspect
import math
import typing

import pytest

import orchestrate
from orchestrate import InputError
from orchestrate.model.arguments import checks_by_field
from orchestrate.response.questions import Question

from ..running.test_kills import kinds_of_questions

FOUND = sorted(kinds_of_questions(), key=lambda kind: kind.__name__)
KINDS = {kind.asked: kind for kind in FOUND if issubclass(kind, Question)}
ASKED = [name for name in KINDS if name != "cosimulate"]  # by a job that it makes itself


@pytest.mark.parametrize("name", ASKED)
def test_every_public_signature_is_known_at_run_time_and_is_its_job(name):
    function, kind = getattr(orchestrate, name), KINDS[name]
    types = typing.get_type_hints(function, include_extras=True)
    fields = {field.name: field for field in dataclasses.fields(kind)}
    for key, parameter in inspect.signature(function).parameters.items():
        assert key in types
        if parameter.kind is not parameter.VAR_KEYWORD:
            assert (key in fields) != (key in kind.replaced), key
    assert set(checks_by_field(kind)) <= set(fields)
    assert kind.asked == function.__name__ == name


@pytest.mark.parametrize("name", ASKED)
def test_every_keyword_that_has_a_check_refuses_by_its_name_in_one_line(name):
    for key, check in checks_by_field(KINDS[name]).items():
        for wrong in (object(), "\n", math.nan):
            with pytest.raises(InputError, match=rf"^{key}\b[^\n]* expected [^\n]+$"):
                check(key, wrong)
