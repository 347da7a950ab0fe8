"""The run by which a library's bits are known: what it exercises."""

import pytest

from fmu_src.export import forms, self_test
from fmu_src.export.sources import load_model

from ..sparing import ordinary


@pytest.mark.parametrize("folder", ordinary(forms.MODELS.values()))
def test_a_cubic_input_begins_in_it(folder):
    """Its values are moved as an importer sets them, with the flag that it begins anew."""
    model = load_model(folder)
    flags = []

    def advance(memory, time):
        flags.append(min(memory[flag] for flag in model.set_flags.values()))
        return model.advance(memory, time)

    memory = [0.0] * model.memory_size
    total = self_test.sum_of_run(model, memory, model.initialize, advance)
    assert flags.index(1.0) == self_test.STEPS // 2 - 1 and sum(flags) == 1.0
    assert all(memory[slot] == self_test.CHANGE for slot in model.set_flags)
    assert total == self_test.expected_sum(model)
