"""Impact: Newton's restitution (15) in the corrected form, and the end of chattering (17).

The coefficient may decrease with the closing speed v: ``e(v) = e/(1 + e_slope v)``, the law of the
Hunt-Crossley contact force to first order in v. The separation e(v) v grows with v, so that an
impact that closes faster never parts more slowly; and e(v) <= e: impacts follow one another at
least as fast as with e, and where v tends to 0 chattering is that of e.
"""

from . import memory as at


def common_velocity(m, v1, v2):
    return (v1 + m[at.MU] * v2) * m[at.SHARE]


def restitution_coefficient(m, closing):
    """Return the coefficient at a closing velocity (m/tau); e to the last bit where constant."""
    return m[at.E] / (1.0 + m[at.E_SLOPE] * (closing * m[at.OMEGA]))


def velocities_after_impact(m, v1, v2, e):
    """Return both velocities after an impact, (15), with ``(1+e)/(1+mu)`` in its second line."""
    if m[at.WALL] != 0.0:  # rarely
        return -e * (v1 - v2), 0.0
    common = common_velocity(m, v1, v2)
    part = e * (v1 - v2) * m[at.SHARE]
    return common - m[at.MU] * part, common + part


def chattering_ends(m, separation, force):
    """Return whether chattering ends here in permanent contact, (17) without a velocity scale.

    The masses are pressed together by ``force`` (18) < 0 and would part with the velocity
    ``separation``. The next flight is a parabola of duration ``2 separation/|force|``, each later
    one shorter by e at least: all that are left last less than gamma over the faster half's
    frequency. Both sides scale with the amplitude, and neither knows which half is number 1. With
    e = 1 chattering has no end.

    Parameters
    ----------
    m : flat memory
    separation : float
        Gap velocity after the impact, >= 0.
    force : float
        f of (18) at the common velocity: the gap's acceleration.
    """
    return force < 0.0 and 2.0 * separation < m[at.STICKING_TIME] * -force


def record_impact(m, time, closing, e, sticks):
    """Count an impact and its loss, with that of the flights left out where the masses stick."""
    m[at.IMPACT_COUNT] += 1.0
    m[at.IMPACT_TIME] = time
    velocity = closing * m[at.OMEGA]
    m[at.IMPACT_VELOCITY] = velocity
    energy = 0.5 * m[at.REDUCED_MASS] * velocity * velocity
    m[at.IMPACT_ENERGY] += energy * (1.0 if sticks else (1.0 - e) * (1.0 + e))
    if sticks:  # rarely
        m[at.STICKING_ENERGY] += energy * e * e
