"""Structures, excitations and drives as hypothesis makes them up."""

from hypothesis import strategies as st

from orchestrate.model import Drive, Excitation, Structure
from orchestrate.model.ranges import DRIVE, PUSHES, STRUCTURE, Quantity

SCALE = st.floats(1e-6, 1e6)
LOSS = st.one_of(st.just(0.0), SCALE)
SMALL = st.floats(1e-3, 1e3)
RATIO = st.one_of(st.just(0.0), st.floats(1e-9, 10.0))


def values_of(quantity: Quantity) -> st.SearchStrategy[float]:
    """Strategy of a parameter by its range: of one without a low or high end not the extremes."""
    inside = quantity.maximum <= 1.0
    if inside:
        return st.floats(quantity.minimum, quantity.maximum)
    if quantity.minimum > 0.0:
        return SCALE
    return LOSS if quantity.minimum == 0.0 else st.one_of(st.just(0.0), st.floats(-1e3, 1e3))


def structure(stroke: float, **values: float) -> Structure:
    """Structure whose stroke, where it has one, is wider than its clearance by so much."""
    return Structure(**values, stroke=stroke and stroke + max(0.0, values["clearance"]))


NUMBERS_OF_ONE = {name: values_of(quantity) for name, quantity in STRUCTURE.items()}
STRUCTURES = st.builds(structure, **NUMBERS_OF_ONE, bonded=st.booleans())
NUMBERS = st.fixed_dictionaries(
    {"mu": SMALL, "kappa": SMALL, "D1": RATIO, "D2": RATIO, "e": st.floats(0.0, 1.0)}
)
PUSHED = st.floats(-1e3, 1e3)
OF_BOX = {"frequency": SCALE, "amplitude": LOSS, "phase": st.floats(-1e3, 1e3)}
EXCITATIONS = st.builds(Excitation, **OF_BOX)
WITH_FORCES = st.builds(Excitation, **OF_BOX, **dict.fromkeys(PUSHES, PUSHED))
DRIVES = st.builds(Drive, **{name: values_of(quantity) for name, quantity in DRIVE.items()})
