"""Known limits: what an importer can still do that is answered by a crash, by silence or by a wrong
number. Each test states what is right.
"""

import pytest

from .driver import FMUS, run
from .programs.driver import open_fmu
from .test_bad_input import SLOW

PROGRAMS = [  # of pythonfmu's library, out of the slave's reach
    "extracted_below_a_folder_with_special_letters",  # of a file URI it decodes the space alone
    "null_pointer_for_a_state",  # it then releases references that the slave's exceptions keep
    "guid_of_something_else",  # it does not look at the GUID
    "value_reference_above_two_to_the_31",  # it gives the slave a signed integer
]


@pytest.mark.xfail(strict=True)
@pytest.mark.parametrize("program", PROGRAMS)
def test_pythonfmus_library(tmp_path, program):
    assert run(f"limits.{program}", FMUS["fmi2-python"], cwd=tmp_path)


@pytest.mark.xfail(strict=True, reason="a point of time may be off by a billionth of it")
def test_wrong_point_of_time_where_time_is_the_date(fmu):
    f = open_fmu(fmu).start(1.7e9).step(1.7e9 + 1.0)
    assert "expected 1700000001.0 s" in f.refused("doStep", 1.7e9 + 1.5, 1.0)


@pytest.mark.xfail(strict=True, reason="the variable that makes an answer infinite is not named")
def test_message_names_what_leaves_the_range(fmu):
    f = open_fmu(fmu).start(bonded=True, box_crackle=1e100, **SLOW)
    message = f.refused("doStep", 0.0, 1e38)
    assert "the motion leaves the range" not in message or "box_crackle = 1e+100" in message
