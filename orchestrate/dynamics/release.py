"""How long permanent contact lasts: root search for the first zero (19) of the contact force."""

from __future__ import annotations

import math

import numpy as np

from .closed_form import ClosedForm, Floats

SAMPLES = 64  # of the contact force in a span at least, so that no short contact is passed over
SAMPLES_PER_PERIOD = 16  # and in a period of the fastest oscillation: the force is a sum of two


def contact_durations(
    form: ClosedForm, phase: Floats, position: Floats, velocity: Floats, spans: Floats
) -> Floats:
    """Return how long permanent contacts last, in tau; infinite if not released in the span.

    The zero is bracketed by samples of the force, and solved for by Chandrupatla's method.

    Parameters
    ----------
    form : ClosedForm
    phase, position, velocity : ndarray, shape (n,)
        Of the excitation and of both masses where the contacts begin.
    spans : ndarray, shape (n,)
        Longest durations, in units of tau.

    Returns
    -------
    ndarray, shape (n,)
        In units of tau; infinite where a contact outlasts its span.
    """
    from scipy.optimize.elementwise import find_root

    if not len(spans):
        return np.zeros(0)

    def force(time: Floats, *begin: Floats) -> Floats:
        """Return the contact force (18) a time after permanent contact has begun."""
        return form.force(*form.common_motion(time, *begin))

    periods = form.fastest * float(spans.max()) / (2.0 * math.pi)
    count = max(SAMPLES, math.ceil(SAMPLES_PER_PERIOD * periods))
    times = np.linspace(0.0, 1.0, count + 1)[1:] * spans[:, None]
    begin = phase, position, velocity
    opens = force(times, *(part[:, None] for part in begin)) >= 0.0  # below zero at first: pressed
    first = opens.argmax(axis=1)
    high = np.take_along_axis(times, first[:, None], 1)[:, 0]
    root = find_root(force, (high - spans / count, high), args=begin)
    # where rounding leaves no change of sign in the bracket, its end is near enough
    return np.where(opens.any(axis=1), np.where(root.success, root.x, high), np.inf)
