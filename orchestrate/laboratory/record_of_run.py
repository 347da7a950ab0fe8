"""The run of a weak drive as a record: what accelerometers read while a motor shakes the box."""

from __future__ import annotations

from ..errors import InputError
from ..lazy import xr
from ..response.equations import absolute_accelerations_unforced
from ..response.labels import STATE, states_over_time
from .record import record
from .sensors import structure_of_history

NEEDED = ("time", *STATE, "box_acceleration", "angle")


def record_of_run(run: xr.Dataset) -> xr.Dataset:
    """Return the accelerations in a run of a weak drive as a record.

    Parameters
    ----------
    run : xarray.Dataset
        Of :func:`orchestrate.passage`: whole, or a part of it in equal steps.
        (:func:`orchestrate.couple` keeps only revolutions.)

    Returns
    -------
    xarray.Dataset
        As :func:`orchestrate.record` makes it, of box, mass 1 and mass 2, one row a communication
        step.

    Raises
    ------
    InputError
        Where it is another answer, or not in equal steps, as around two jumps.

    Notes
    -----
    The box's acceleration is what ``MotorShaker`` answers at the communication points: from the
    forces of suspension, unbalance and structure on the box. The masses' are by their equations of
    motion (6), in space, between impacts: an impulse is no part of them.

    Examples
    --------
    >>> from orchestrate import Drive, Structure, passage, track_orders
    >>> quick = Structure.from_file("quick"), Drive.from_file("quick")
    >>> run = passage(*quick, voltage=(1.3, 1.7), rate=2e-3, progress=False)
    >>> orders = track_orders(record_of_run(run), phase=run.angle)
    >>> orders.amplitude.dims
    ('channel', 'order', 'time')
    """
    if not all(name in getattr(run, "variables", {}) for name in NEEDED):
        expected = "expected an answer of passage, which keeps every step; couple keeps revolutions"
        raise InputError(f"run: no {' and '.join(NEEDED[-2:])} over the time; {expected}")
    structure = structure_of_history(run, NEEDED)
    first, second = absolute_accelerations_unforced(states_over_time(run), structure).T
    return record(
        time=run.time.values,
        box_acceleration=run.box_acceleration.values,
        acceleration1=first,
        acceleration2=second,
        source="simulated",
        title=str(run.attrs.get("title", "Run of a weak drive")),
    )
