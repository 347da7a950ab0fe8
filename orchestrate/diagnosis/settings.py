"""Every threshold and effort of the diagnosis, in one place that a caller reaches."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields, replace

from ..errors import InputError
from ..laboratory.record_checks import CLIPPED
from ..model.arguments import checked_mapping
from ..model.ranges import checked_range

Changes = Mapping[str, float] | None  # of a caller: names of settings with other values


@dataclass(frozen=True)
class Settings:
    """Thresholds of the verdict and of what counts as seen, errors of models, effort of searches.

    Change ``hidden`` and ``order2_noise`` for a bolder or more careful verdict,
    ``gain_deviation`` and ``delay_deviation`` for sensors that are calibrated better or worse,
    ``starts``, ``rugged_starts`` and ``steps`` where a search ends in a wrong minimum.
    """

    # -- the verdict: see `decision_rule.Beam.verdict`, and `impact_timing` for what strikes --
    doubled: float = 1.5  # a level over another from which both stand for a known frequency
    same_level: float = 0.9  # of a level: what another record reaches of it at the same one
    # by which the delaminated misfit has to be smaller than the best sound one for its numbers
    ratio: float = 1.5
    # largest misfit of a sound hypothesis, and of a delaminated one, whose numbers are stated: real
    # contacts are not the model's
    sound: float = 1.2
    delaminated: float = 3.0
    hidden: float = 0.1  # largest order 2 that noise may hide, over order 1
    clipped: float = CLIPPED  # share of a channel's samples at its extremes: it is saturated
    # response at an end of the sweep over the largest one: above, the resonance is not passed
    end_response: float = 0.7
    samples: float = 14.0  # in a period at the resonance: orders 6 to 12 show a blow
    # from the guess's frequencies to a resonance that is another beam's: none is softer than its
    # slower half, but for what a guess misses: 1.23; loose clamps make 1.4 to 1.7
    guess_factor: float = 1.3

    # -- what counts as seen: see `opening_measures` --
    # order 2 over the noise, over the floor between the orders (which impacts raise too), and over
    # order 1 (sensors and bases that are not linear make less)
    order2_noise: float = 5.0
    order2_floor: float = 2.0
    order2_ratio: float = 0.005
    # difference of two sensors over order 1, and over order 2, where gains and delays are less
    # certain
    difference: float = 0.03
    difference_order2: float = 0.2
    response: float = 0.1  # of the largest order 1: windows where less moves are not taken

    # -- errors that a good model and good sensors may have: see `evidence` --
    model_error: float = 0.03  # of orders 1, 2, 3, over the size of order 1
    irregular: float = 1.5  # errors of orders over the amplitude between the orders
    # standard deviations of a sensor's gain (1) and delay (s) against the base's, of its
    # participation factor, and the weight of these deviations, over that of a record which misses
    # as much as a good model may
    gain_deviation: float = 0.03
    delay_deviation: float = 2e-4
    participation_deviation: float = 0.5
    prior_weight: float = 0.1
    # largest error of a gain (1) and largest delay (s)
    gain_error: float = 0.12
    delay: float = 1e-3

    slow: float = 0.01  # of the largest speed: below it dry friction is viscous

    # -- standard errors: see `errors` --
    undetermined: float = 0.5  # over a damping ratio: two of more reach 0, it is not stated
    # doubt about a restitution and ln(f2/f1); of damping ratios it is the mean of both halves'
    restitution_doubt: float = 0.12
    split_doubt: float = 0.02
    contact_misfit: float = 0.3  # beyond noise: from here on a contact is another than the model's
    # part of the squares beyond noise by which they may be larger at the truth, and squares over
    # those that noise makes: less of them has no other cause
    hidden_share: float = 0.1
    noise_squares: float = 1.3

    # -- the search: see `multistart.Search.find_minima` --
    # from which to go downhill: of a sound hypothesis, and of two masses
    starts: int = 2
    rugged_starts: int = 4
    steps: int = 8  # on each way
    tolerance: float = 1e-3  # relative: a way downhill that gains less in a step ends
    points: int = 3  # of a cloud, over the count of numbers
    rounds: int = 4  # of the regressions over clouds that follow
    gain: float = 2e-3  # relative: a round that gains less is one with too large a cloud
    distinct: float = 1.03  # misfit over another from which both count as two minima
    close: float = 1.3  # misfit over the best, up to which the second best minimum goes on too
    # standard deviation of a guessed frequency's logarithm, and the part of the squared deviations
    # by which a misfit counts more
    guess_deviation: float = 0.06
    guess_weight: float = 0.02
    guess_squares: float = 20.0  # of these deviations: more of them count no more
    # without a guess: distance of both halves from the resonance, over it, damping ratio and e
    assumed_apart: float = 0.05
    assumed_damping: float = 0.01
    assumed_restitution: float = 0.6


SETTINGS = Settings()


def checked_settings(changes: Changes) -> Settings:
    """Return the settings with a caller's changes, whose names and values are checked.

    Examples
    --------
    >>> checked_settings({"ratio": 2.0}).ratio, checked_settings(None).ratio
    (2.0, 1.5)
    """
    names = [one.name for one in fields(Settings)]
    changes = checked_mapping("settings", changes)
    if unknown := [name for name in changes if name not in names]:
        raise InputError(f"settings: unknown name {unknown[0]!r}; known names: {', '.join(names)}")
    made = SETTINGS
    for name, value in changes.items():
        kind = type(getattr(SETTINGS, name))
        least = 1.0 if kind is int else 0.0
        number = checked_range(f"settings[{name!r}]", value, low=least, high=1e6)
        made = replace(made, **{name: kind(number)})
    return made
