"""What the tests of dynamics share."""

import pytest

from orchestrate.fmu import OSCILLATOR, EventInstance, Instance, find_or_export


@pytest.fixture(scope="module")
def instances(exported):
    """The oscillator without events, and with them."""
    fmu = find_or_export(OSCILLATOR).path
    with Instance(fmu) as plain, EventInstance(fmu) as eventful:
        yield plain, eventful
