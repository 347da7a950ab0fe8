"""Steps that reach ``evaluation_limit``, and what is left of the instance."""

from driver import DISCARD, Refused, harmonic, open_fmu

DRIVES = {
    "TwoMassImpactOscillator": (harmonic(0.3), 40.0),
    "MotorShaker": ({"voltage": 6.0, "speed_start": 40.0}, 0.4),
    "ElectrodynamicShaker": (
        {"command": 9.0, "command_1": -4.0, "coil_inductance": 0.02, "current_limit": 1.0},
        4.0,
    ),
}
PER_STEP = ("evaluations", "box_impulse", "box_impulse_moment", "x_rel_max")


def bits(values):
    """Numbers to their last bits."""
    return {name: float(value).hex() for name, value in values.items()}


def of_the_motion(f):
    """Outputs that are not about the last step."""
    return bits({k: v for k, v in f.outputs().items() if k not in PER_STEP})


def a_discarded_step(path, model, limit):
    """Status and message of a step that needs more; outputs before it, and after it."""
    values, end = DRIVES[model]
    f = open_fmu(path).start(**values)
    f.step(end / 4)
    before = bits(f.outputs())
    f.set(evaluation_limit=limit)
    try:
        f.step(end)
    except Refused as refused:
        return refused.status, refused.messages, before, bits(f.outputs())
    raise AssertionError("the step was done")


def divided_steps(path, model, limit):
    """Where a run comes to whose discarded steps are divided; how many were; the most evaluations
    of a step; and where it comes to without a limit.
    """
    values, end = DRIVES[model]
    free = open_fmu(path).start(**values).step(end)
    f = open_fmu(path).start(**values, evaluation_limit=limit)
    waiting, discarded, most = [end], 0, 0
    while waiting:
        try:
            f.step(waiting[-1])
        except Refused as refused:
            assert refused.status == DISCARD, refused
            discarded += 1
            waiting.append((f.time + waiting[-1]) / 2)
        else:
            waiting.pop()
            most = max(most, *f.get("evaluations"))
    return of_the_motion(f), discarded, most, of_the_motion(free)


def evaluations(path):
    """Evaluations of steps of which the first is a long one, and the others have no impact."""
    f = open_fmu(path).start(x2_start=1e3, box_amplitude=1e-3)
    return [f.step(time).get("evaluations")[0] for time in (3.0, 3.0001, 3.0002)]


def a_limit_out_of_range(path, value):
    """What is said of it."""
    f = open_fmu(path).start()
    try:
        f.set(evaluation_limit=value)
    except Refused as refused:
        return refused.messages
    raise AssertionError("accepted")
