"""Plans of tests, followed to the letter: verdicts on the structure and on its sound twin."""

from __future__ import annotations

from typing import Any

import numpy as np

from orchestrate import Structure, SweptSine, measure, plan_test, shake
from orchestrate.diagnosis.plan_test import default_sensor, default_sweep_range

from .recipe import KINDS, OPENED, SPLIT, Conditions, draw_guess, draw_log_uniform
from .verdicts import DELAMINATED, NO_OPENING, PLANNED, REFUSED, TWIN, verdict_on

SENSORS = {"one sensor": ("acceleration1",), "two sensors": ("acceleration1", "acceleration2")}
LEVEL = (0.3, 3.0)  # m/s2, for which a preload is drawn
OFF, OFF_CLEARANCE = 0.03, 0.3  # of the guess that is planned with


def judged_plan(seed: int, kind: str, number: int) -> dict[str, Any]:
    """Draw a structure, plan its test with a guess, and test it and its bonded form so."""
    rng = np.random.default_rng([seed, SPLIT.index(kind), number])
    own = KINDS[kind](rng, draw_log_uniform(rng, *LEVEL), Conditions())
    restitution = rng.uniform(0.35, 0.85)
    structure = Structure.from_halves(**vars(own.halves), e=restitution, clearance=own.clearance)
    near = own.clearance * rng.uniform(1.0 - OFF_CLEARANCE, 1.0 + OFF_CLEARANCE)
    guess = draw_guess(rng, own, OFF).replace(clearance=near)
    every, answers = default_sensor(default_sweep_range(guess)[1]), {}
    for asked, names in SENSORS.items():
        sensors = dict.fromkeys(("box_acceleration", *names), every)
        plan = plan_test(guess, sensor=sensors, jobs=1, progress=False)
        ends = {name: float(plan[f"recommended_{name}"]) for name in ("first", "last", "duration")}
        sine = SweptSine(**ends, acceleration=float(plan.recommended_level))
        known = {"counts": bool(plan.counts), "level": sine.acceleration}
        for group, one in ((PLANNED, structure), (TWIN, structure.as_bonded())):
            history = shake(one, sine, jobs=1, progress=False)
            record = measure(history, sensors, excitation=sine)
            verdict, reason, _ = verdict_on([record], guess)
            gap = 0.0 if one.bonded else float(history.x_rel.max())
            is_wrong = verdict in (REFUSED, NO_OPENING if gap > OPENED else DELAMINATED)
            said = {"group": group, "verdict": verdict, "reason": reason, "mm": 1e3 * gap}
            answers[f"{asked} {group}"] = {**known, **said, "problem": reason if is_wrong else ""}
    return {"answers": answers}
