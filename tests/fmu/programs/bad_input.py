"""What becomes of each mistake, of its instance, and of another one in the process."""

import gc
import sys

from bad_cases import CASES
from driver import OK, Refused, harmonic, open_fmu


def good(f):
    """Outputs of a run with parameters of its own: what a reset has to bring back."""
    return f.start(m2=1.5, x2_start=0.25, **harmonic(1.13)).step(40.0).outputs()


def failing(path, name, saved, logging=True):
    """An instance for a mistake."""
    f = open_fmu(path, name=name, logging=logging)
    f.saved = saved
    return f


def outcome(f, fail):
    """Status and messages of a call that must fail."""
    try:
        fail(f)
        return [OK, ""]
    except Refused as refused:
        return [refused.status, "\n".join(refused.messages)]


def once(path, quiet):
    """Each mistake twice, in instances "first" and "free"; ``quiet``: the second logs nothing."""
    expected = good(open_fmu(path))
    saved, _ = open_fmu(path).start().step(1.0).save()
    lone = open_fmu(path).start(**harmonic(1.13))
    rows = [lone.step(0.5 * k).outputs() for k in range(1, len(CASES) + 1)]
    witness = open_fmu(path, name="witness").start(**harmonic(1.13))
    found = {}
    for number, (key, (prepare, fail, _)) in enumerate(CASES.items(), 1):
        result = found[key] = {}
        for part in ("first", "free"):
            f = failing(path, part, saved, logging=part == "first" or not quiet)
            prepare(f)
            print("=====", key, part, file=sys.stderr, flush=True)
            result[part] = outcome(f, fail)
            print("=====", file=sys.stderr, flush=True)
            if part == "first":
                f.call("reset")
                result["reset"] = good(f) == expected
            f.free()  # the second time right after the failure
        result["witness"] = witness.step(0.5 * number).outputs() == rows[number - 1]
    gc.collect()
    return found


def again(path, repeats):
    """The same call again and again.

    pythonfmu releases references at each, which shows only after some hundred calls.
    """
    expected = good(open_fmu(path))
    saved, _ = open_fmu(path).start().step(1.0).save()
    found = {}
    for key, (prepare, fail, _) in CASES.items():
        print("=====", key, file=sys.stderr, flush=True)
        f = failing(path, "again", saved)
        prepare(f)
        refusals = sum(outcome(f, fail)[0] != OK for _ in range(repeats))
        gc.collect()
        f.call("reset")
        found[key] = [refusals, good(f) == expected]
        f.free()
        gc.collect()
    return found
