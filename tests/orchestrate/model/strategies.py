"""Structures, excitations and drives as hypothesis makes them up."""

from collections.abc import Mapping

from hypothesis import strategies as st

from orchestrate.model import Drive, Excitation, Shaker, Structure
from orchestrate.model.ranges import DRIVE, ELECTRODYNAMIC_SHAKER, PUSHES, STRUCTURE, Quantity

SCALE = st.floats(1e-6, 1e6)
LOSS = st.one_of(st.just(0.0), SCALE)
SMALL = st.floats(1e-3, 1e3)
RATIO = st.one_of(st.just(0.0), st.floats(1e-9, 10.0))


def values_of(quantity: Quantity) -> st.SearchStrategy[float]:
    """Strategy of a parameter by its range: of one without a low or high end not the extremes."""
    if quantity.maximum <= 1.0:
        return st.floats(quantity.minimum, quantity.maximum)
    if quantity.minimum > 0.0:
        return SCALE
    return LOSS if quantity.minimum == 0.0 else st.one_of(st.just(0.0), st.floats(-1e3, 1e3))


def structure(stroke: float, **values: float) -> Structure:
    """Structure whose stroke, where it has one, is wider than its clearance by so much."""
    return Structure(**values, stroke=stroke and stroke + max(0.0, values["clearance"]))


def values_of_all(quantities: Mapping[str, Quantity]) -> dict[str, st.SearchStrategy[float]]:
    return {name: values_of(quantity) for name, quantity in quantities.items()}


STRUCTURES = st.builds(structure, **values_of_all(STRUCTURE), bonded=st.booleans())
RATIOS = {"mu": SMALL, "kappa": SMALL, "D1": RATIO, "D2": RATIO}
NUMBERS = st.fixed_dictionaries({**RATIOS, "e": st.floats(0.0, 1.0)})
PUSHED = st.floats(-1e3, 1e3)
OF_BOX = {"frequency": SCALE, "amplitude": LOSS, "phase": st.floats(-1e3, 1e3)}
EXCITATIONS = st.builds(Excitation, **OF_BOX)
WITH_FORCES = st.builds(Excitation, **OF_BOX, **dict.fromkeys(PUSHES, PUSHED))
DRIVES = st.builds(Drive, **values_of_all(DRIVE))
OF_SHAKER = values_of_all(ELECTRODYNAMIC_SHAKER)
SHAKERS = st.builds(Shaker, **OF_SHAKER, current_control=st.booleans())
