"""Public questions made small, so that what a page shows runs in a second or two."""

import functools
import inspect

import numpy as np

from orchestrate.weak_drive.hysteresis import HysteresisSettings

VALUES = 4  # of a list, at most
MOST = {"longest": 0, "transient": 5, "settle": 5}
MOST |= {"periods": 30, "samples": 6, "starts": 3, "points": 128}
QUESTIONS = (
    *("simulate", "resonance", "sweep", "spectra", "map", "lyapunov", "attractors", "basin"),
    *("impact_statistics", "couple"),
)


def fewer(value):
    """A list with some of its values, the first and the last one among them."""
    if isinstance(value, (list, np.ndarray, tuple)) and np.ndim(value) == 1:
        if len(value) > VALUES and not isinstance(value[0], str):
            places = np.linspace(0, len(value) - 1, VALUES).astype(int)
            few = [value[place] for place in places]
            return np.array(few) if isinstance(value, np.ndarray) else type(value)(few)
        if len(value) == 4 and isinstance(value[0], str):  # a side of a plane
            return (*value[:3], min(value[3], VALUES))
    return value


def smaller(question):
    """The same question over fewer values, with short transients; a ramp of a second."""
    accepted = inspect.signature(question).parameters

    @functools.wraps(question)
    def asked(*arguments, **keywords):
        keywords = {name: fewer(value) for name, value in keywords.items()}
        for name, most in MOST.items():
            if name in accepted and question.__name__ != "couple":
                given = keywords.get(name, accepted[name].default)
                keywords[name] = most if given is None else min(given, most)
        if question.__name__ == "lyapunov":
            keywords["periods"] = 400
        if "rate" in keywords:
            ends = np.ravel(keywords["voltage"])
            keywords |= {"rate": float(abs(ends[-1] - ends[0])), "settle": 1.0}
            keywords["hysteresis"] = HysteresisSettings(grid=1.0, budget=0.1)
        return question(*arguments, **keywords)

    return asked
