"""The same decisions on every machine: linear algebra rounds otherwise on another processor."""

import json

import pytest

from ..processors import printed_on_each

PROCESSORS = ("Haswell", "SkylakeX", "Nehalem")
AGREEMENT = 3e-6  # of places: a branch's last points lie where steps end, 1e-6 or so from there


def answers(processors, *names):
    """What is decided with the kernels of each processor, of these questions.

    Skips where this machine's libraries do not take them.
    """
    printed = printed_on_each(["-m", "tests.orchestrate.processor_answers", *names], processors)
    found = {processor: json.loads(text.splitlines()[-1]) for processor, text in printed.items()}
    for processor, one in found.items():
        if not one["kernels"] or set(one["kernels"]) != {processor}:
            pytest.skip(f"with OPENBLAS_CORETYPE={processor} kernels are {one['kernels']}")
    return [one["answers"] for one in found.values()]


def compare(found):
    """All that is decided is equal, and places but for their last digits."""
    first = found[0]
    for other in found[1:]:
        for name, answer in first.items():
            assert other[name]["decided"] == answer["decided"], name
            assert other[name]["places"] == pytest.approx(answer["places"], rel=AGREEMENT), name


def test_decisions_do_not_depend_on_the_processor(exported):
    """With and without FMA and AVX: a branch that grazes, folds in closed form."""
    found = answers(("Haswell", "Nehalem"), "rig", "averaged")
    assert "grazing of an impact" in [leg[0] for leg in found[0]["rig"]["decided"]]
    compare(found)


@pytest.mark.slow
def test_decisions_do_not_depend_on_any_processor(exported):
    """The same, and a chattering's impacts that come and go."""
    found = answers(PROCESSORS, "rig", "averaged", "branch")
    assert found[0]["branch"]["decided"][0] > 20
    compare(found)
