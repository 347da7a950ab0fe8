"""Structures, excitations and drives as hypothesis makes them up."""

from __future__ import annotations

from hypothesis import strategies as st

from orchestrate.structures import Drive, Excitation, Structure

SCALE = st.floats(1e-6, 1e6)
LOSS = st.one_of(st.just(0.0), SCALE)
SMALL = st.floats(1e-3, 1e3)
RATIO = st.one_of(st.just(0.0), st.floats(1e-9, 10.0))

STRUCTURES = st.builds(
    Structure,
    m1=SCALE,
    m2=SCALE,
    k1=SCALE,
    k2=SCALE,
    d1=LOSS,
    d2=LOSS,
    e=st.floats(0.0, 1.0),
    gamma=st.floats(1e-9, 1.0),
    clearance=st.one_of(st.just(0.0), st.floats(-1e3, 1e3)),
    bonded=st.booleans(),
)
NUMBERS = st.fixed_dictionaries(
    {"mu": SMALL, "kappa": SMALL, "D1": RATIO, "D2": RATIO, "e": st.floats(0.0, 1.0)}
)
EXCITATIONS = st.builds(Excitation, frequency=SCALE, amplitude=LOSS, phase=st.floats(-1e3, 1e3))
DRIVES = st.builds(
    Drive,
    box_mass=SCALE,
    box_stiffness=LOSS,
    box_damping=LOSS,
    unbalance_mass=SCALE,
    unbalance_radius=SCALE,
    rotor_inertia=SCALE,
    motor_constant=SCALE,
    armature_resistance=SCALE,
    armature_inductance=LOSS,
)
