"""The variable table of ``TwoMassImpactOscillator``.

Standard library only: it travels inside the FMU.
"""

from __future__ import annotations

from typing import Any

from ...kernels.oscillator import memory
from ...runtime.table import (
    BOOLEAN,
    COUNT,
    HUGE,
    INTEGER,
    LARGE,
    Variable,
    cubic_input,
    evaluation_limit_parameter,
    input_variable,
    non_negative_parameter,
    output_variable,
    parameter,
    positive_parameter,
    start_value_parameter,
    with_slot_numbers,
)

MECHANICS = ("m1", "m2", "k1", "k2", "d1", "d2")
STARTS = ("x1_start", "x2_start", "v1_start", "v2_start")
DRIVE = ("phase_start", "box_amplitude", "box_frequency")
EXTRA = ("box_acceleration", "box_jerk", "box_snap", "box_crackle")
# parameters of the structure that were added later: behind all others, because value references
# are given out for good
ADDED = (
    parameter(
        "clearance",
        "m",
        0.0,
        "Gap between the faces where both springs are unloaded; below 0 the masses are "
        "pressed together, at rest with the preload F = -clearance k1 k2/(k1 + k2); "
        "ignored where bonded",
        minimum=-HUGE,
        maximum=HUGE,
    ),
    parameter(
        "e_slope",
        "s/m",
        0.0,
        "Decrease of the coefficient of restitution with the closing speed v: it is "
        "e/(1 + e_slope v); 0: e at all speeds",
        minimum=0.0,
        maximum=HUGE,
    ),
)
STRUCTURE = (*MECHANICS, "e", "gamma", *(added.name for added in ADDED))  # its numbers
FAMILY = ("wall", "stroke")
GAP = ("x1_start", "x2_start", "clearance", "bonded")
# with a preload, displacements at the start count from the loaded springs
LOADED = ("clearance", "bonded", "wall", "k1", "k2")
UNIT = ("m1", "box_amplitude", "box_frequency")  # with k1, a eta^2
CLOSING = (*STARTS, "clearance", "stroke")  # bonded masses start at one velocity: no impact
PUSHES = ("phase_start", "force1_amplitude", "force2_amplitude", "force1", "force2")
# after an impact at the start; whether the masses stick hangs on the forces, at a wall on the box
IMPACT_2 = (*STRUCTURE, *FAMILY, *STARTS, *PUSHES)
IMPACT = (*IMPACT_2, "box_amplitude", "box_frequency", "box_acceleration")


DISCRETE: dict[str, Any] = {"variability": "discrete"}


def sample_outputs(name: str, unit: str, description: str) -> tuple[Variable, ...]:
    return tuple(
        Variable(
            f"{name}[{i + 1}]",
            f"{description}, sample {i + 1} of the last step",
            "local",
            unit,
            initial="calculated",
            series=name,
        )
        for i in range(memory.SAMPLES)
    )


def peak_output(name: str, unit: str, signal: str) -> Variable:
    text = f"Largest absolute {signal} over the last communication step, exact, not sampled"
    return Variable(name, text, "local", unit, initial="calculated", minimum=0.0)


FORCES = (
    *(
        input_variable(
            f"force{half}_amplitude",
            "N",
            0.0,
            f"Amplitude F of a harmonic force F sin(phase) on mass {half}, positive as x{half}",
        )
        for half in (1, 2)
    ),
    *cubic_input("force1", "N", "Force on mass 1, positive as x1"),
    *cubic_input("force2", "N", "Force on mass 2, positive as x2"),
)
IN_CONTACT = (
    *(*IMPACT, "bonded", "box_jerk", "box_snap", "box_crackle"),
    *(f"force{half}_{k}" for half in (1, 2) for k in (1, 2, 3)),
)
WALL = parameter(
    "wall",
    "",
    0.0,
    "true: mass 2 is a rigid wall fixed to the box, x2 = 0 and v2 = 0; m2, k2, d2 and forces on it "
    "have no effect, and box_force has the force on it",
    type=BOOLEAN,
)
STROKE = parameter(
    "stroke",
    "m",
    0.0,
    "Largest gap: at x_rel = stroke the faces strike on their other side, with the same e, and may "
    "stay there; at least the clearance; 0: no limit; ignored where bonded",
    minimum=0.0,
    maximum=HUGE,
)
SCALARS = (
    positive_parameter("m1", "kg", 1.0, "Mass 1"),
    positive_parameter("m2", "kg", 1.0, "Mass 2"),
    positive_parameter("k1", "N/m", 1.0, "Stiffness between mass 1 and the box"),
    positive_parameter("k2", "N/m", 1.2, "Stiffness between mass 2 and the box"),
    non_negative_parameter("d1", "N.s/m", 0.01, "Viscous damping between mass 1 and the box"),
    non_negative_parameter("d2", "N.s/m", 0.01, "Viscous damping between mass 2 and the box"),
    parameter("e", "1", 0.7, "Coefficient of restitution", minimum=0.0, maximum=1.0),
    parameter(
        "gamma",
        "1",
        3.6515e-4,
        "End of chattering: pressed together, the masses stick where all flights that are left "
        "would last less than gamma over the higher of sqrt(k1/m1) and sqrt(k2/m2); never at e = 1",
        minimum=1e-9,
        maximum=1.0,
    ),
    parameter(
        "bonded", "", 0.0, "true: the undamaged structure, both masses glued for good", type=BOOLEAN
    ),
    start_value_parameter(
        "x1_start",
        "m",
        "Displacement of mass 1 at the start, from its place at rest: with a preload F that is "
        "x1 = -F/k1, else x1 = 0",
        HUGE,
    ),
    start_value_parameter(
        "x2_start",
        "m",
        "Displacement of mass 2 at the start, from its place at rest: with a preload F that is "
        "x2 = F/k2, else x2 = 0; so that the gap is not below 0",
        HUGE,
    ),
    start_value_parameter("v1_start", "m/s", "Velocity of mass 1 at the start", HUGE),
    start_value_parameter("v2_start", "m/s", "Velocity of mass 2 at the start", HUGE),
    parameter(
        "phase_start",
        "rad",
        0.0,
        "Phase of the harmonic excitation at the start",
        minimum=-1e6,
        maximum=1e6,
    ),
    parameter(
        "x_rel_max_on",
        "",
        1.0,
        "false: x_rel_max is not computed and stays 0, for speed",
        type=BOOLEAN,
        variability="tunable",
    ),
    input_variable(
        "box_amplitude", "m", 1.0, "Amplitude a of the harmonic box motion a sin(phase)"
    ),
    input_variable(
        "box_frequency",
        "rad/s",
        0.4,
        "Angular frequency Omega of the harmonic box motion; "
        "the phase is continuous when it changes",
        minimum=0.0,
        maximum=LARGE,
        display_unit="Hz",
    ),
    *cubic_input(
        EXTRA[0], "m/s2", "Acceleration of the box added to the harmonic one", HUGE, EXTRA[1:]
    ),
    output_variable(
        "x1",
        "m",
        "Displacement of mass 1 relative to the box, from the unloaded spring",
        ("x1_start", *LOADED),
    ),
    output_variable(
        "x2",
        "m",
        "Displacement of mass 2 relative to the box, from the unloaded spring",
        ("x2_start", *LOADED),
    ),
    output_variable("v1", "m/s", "Velocity of mass 1 relative to the box", IMPACT),
    output_variable("v2", "m/s", "Velocity of mass 2 relative to the box", IMPACT_2),
    output_variable("x_rel", "m", "Gap x2 - x1 + clearance", GAP, minimum=0.0),
    output_variable("v_rel", "m/s", "Velocity of the gap v2 - v1", IMPACT),
    output_variable(
        "xi1",
        "1",
        "Displacement of mass 1 over a eta^2, paper's (3); 0 where that is below 1e-200 m",
        ("x1_start", *LOADED, *UNIT),
    ),
    output_variable(
        "xi2",
        "1",
        "Displacement of mass 2 over a eta^2, paper's (3); 0 where that is below 1e-200 m",
        ("x2_start", *LOADED, *UNIT),
    ),
    output_variable(
        "xi_rel",
        "1",
        "Gap over a eta^2, paper's (21); 0 where that is below 1e-200 m",
        (*GAP, "k1", *UNIT),
    ),
    output_variable(
        "box_force",
        "N",
        "Force of springs and dampers on the box, k1 x1 + d1 v1 + k2 x2 + d2 v2",
        IMPACT,
    ),
    output_variable(
        "box_impulse",
        "N.s",
        "Integral of box_force over the last communication step, exact, through impacts too",
    ),
    output_variable(
        "box_impulse_moment",
        "N.s2",
        "Integral of (time since the step began) times box_force over the last communication step",
    ),
    output_variable(
        "contact_force",
        "N",
        "Compressive force between the masses in permanent contact, paper's (18)",
        (*IMPACT, "bonded"),
        minimum=0.0,
    ),
    # from rest, what drives the masses first decides; their motion is the same either way
    output_variable("in_contact", "", "Permanent contact", IN_CONTACT, type=BOOLEAN, **DISCRETE),
    output_variable(
        "phase",
        "rad",
        "Phase of the harmonic excitation in [0, 2 pi)",
        ("phase_start",),
        minimum=0.0,
        maximum=6.283185307179586,
    ),
    output_variable("impact_count", "", "Impacts since the start", CLOSING, **COUNT),
    output_variable(
        "impact_time", "s", "Time of the last impact; 0 before the first", CLOSING, **DISCRETE
    ),
    output_variable(
        "impact_velocity",
        "m/s",
        "Closing speed before the last impact; 0 before the first",
        (*CLOSING, "k1", "m1"),  # in whose time speeds are kept, with its rounding
        minimum=0.0,
        **DISCRETE,
    ),
    output_variable(
        "impact_energy",
        "J",
        "Energy lost in impacts since the start",
        IMPACT,
        minimum=0.0,
        **DISCRETE,
    ),
    output_variable(
        "x_rel_max",
        "m",
        "Largest gap over the last communication step, exact, not sampled",
        (*GAP, "x_rel_max_on"),
        minimum=0.0,
    ),
    output_variable(
        "contact_count", "", "Permanent contacts begun by impacts since the start", **COUNT
    ),
    parameter(
        "sample_count",
        "",
        0,
        "States kept inside each step, at equal parts of it, the last one at its end: "
        "x1_sample and so on; 0 for none",
        type=INTEGER,
        variability="tunable",
        minimum=0,
        maximum=memory.SAMPLES,
    ),
)
PEAKS = (
    parameter(
        "peaks_on",
        "",
        0.0,
        "true: x1_max, x2_max, a1_max and a2_max are computed; they cost time",
        type=BOOLEAN,
        variability="tunable",
    ),
    peak_output("x1_max", "m", "displacement x1"),
    peak_output("x2_max", "m", "displacement x2"),
    peak_output("a1_max", "m/s2", "acceleration in space, between impacts, of mass 1"),
    peak_output("a2_max", "m/s2", "acceleration in space, between impacts, of mass 2"),
)
VARIABLES = with_slot_numbers(
    SCALARS
    + sample_outputs("x1_sample", "m", "x1")
    + sample_outputs("x2_sample", "m", "x2")
    + sample_outputs("v1_sample", "m/s", "v1")
    + sample_outputs("v2_sample", "m/s", "v2")
    + (
        output_variable(
            "evaluations",
            "",
            "Evaluations of the event function in the last communication step",
            **COUNT,
        ),
        evaluation_limit_parameter("event function"),
        *ADDED[:2],
        output_variable(
            "sticking_energy",
            "J",
            "Part of impact_energy: energy of the flights left out where chattering ended",
            IMPACT,
            minimum=0.0,
            **DISCRETE,
        ),
        *PEAKS,
        *FORCES,
        WALL,
        STROKE,
        output_variable(
            "impact_side",
            "",
            "Where the last impact was: 1 at x_rel = 0, 2 at x_rel = stroke; 0 before the first",
            CLOSING,
            maximum=2,
            **COUNT,
        ),
        output_variable(
            "contact_side",
            "",
            "Where the masses are together: 1 at x_rel = 0, 2 at x_rel = stroke; 0 apart",
            IN_CONTACT,
            maximum=2,
            **COUNT,
        ),
        *ADDED[2:],  # value references follow the order of publication
    ),
    memory,
)
