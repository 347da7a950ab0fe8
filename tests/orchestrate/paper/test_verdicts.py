"""Verdicts follow from the data: numbers that change turn each of them over."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from orchestrate.dynamics.lyapunov import CHAOTIC, PERIODIC
from orchestrate.paper.cases import CASES
from orchestrate.paper.claims import (
    CLAIMS,
    answers,
    section1,
    section2,
    section3,
    section3_influence,
    section4,
    section5,
)
from orchestrate.paper.claims.claim import NO, PARTLY, UNDECIDED, YES, check_parts
from orchestrate.paper.claims.results import Results
from orchestrate.paper.later_responses import classify_changes
from orchestrate.response.curves import CONTACT, FLIGHT

from .limits import make_limits

UP = "orbit_e0.7_D0.005_up"
GAMMAS = np.array([1e-3, 1e-5, 1e-7, 1e-9])


def along_eta(etas, **columns):
    """A dataset over eta."""
    variables = {name: ("eta", np.asarray(values)) for name, values in columns.items()}
    return xr.Dataset(variables, {"eta": np.asarray(etas, dtype=float)})


WINDOWS = {  # exact limits of the elastic case, rounded
    "T, contact": (0.40, 0.42),
    "T/2": (0.89, 1.06),
    "T/1": (1.30, 2.65),
    "2T/1": (3.60, 4.75),
    "3T/1": (5.70, 6.84),
    "4T/1": (7.79, 8.94),
}


def limits():
    """What the limits job gives, of the elastic case."""
    return make_limits("elastic", WINDOWS)


# -- section 1: Figure 2(a) ------------------------------------------------------------------------


def ramp(damping, bump=0.0):
    """A run whose amplitude is a linear oscillator's, but for a bump half way up."""
    speed = np.linspace(0.6, 1.099, 400)
    amplitude = section1.linear_curve(np.array([0.06, 1.1, damping]), speed)
    amplitude = amplitude * (1.0 + bump * np.exp(-(((speed - 0.9) / 0.02) ** 2)))
    columns = {"amplitude": 1e-3 * amplitude, "voltage": np.linspace(4.0, 7.0, 400)}
    rows = {name: ("revolution", values) for name, values in columns.items()}
    rows["Omega"] = ("revolution", speed)
    return xr.Dataset({**rows, "jumps": ("jump", [np.nan])}, {"jump": ["up"]})


def test_an_amplitude_curve_is_like_a_linear_one_or_not():
    def verdict(bump):
        data = {"ramp_bonded": ramp(0.005), "ramp_delaminated": ramp(0.008, bump)}
        return section1.check_linear_amplitudes(Results(data))

    plain = verdict(0.0)
    assert plain.verdict == YES and "D = 0.0080 at 1.1000 omega" in plain.value
    assert verdict(0.3).verdict == NO


def test_the_break_ends_what_is_compared():
    run = ramp(0.005)
    broken = run.assign(jumps=("jump", [6.0]))
    speed, amplitude = section1.ascending_branch(broken)
    assert speed.max() < run.Omega.values[270] and len(speed) == len(amplitude)


# -- section 2: chattering (16) --------------------------------------------------------------------


def sequences(restitutions, change=None):
    """Sequences as (16) has them, one row changed."""
    counts = np.array(
        [5 + np.log(GAMMAS / GAMMAS[0]) / np.log(min(e, 0.999)) for e in restitutions]
    )
    data = {
        "impacts": np.round(counts),
        "sticks": np.array([[float(e < 1.0)] * 4 for e in restitutions]),
        "ratio_error": np.full(counts.shape, 1e-9),
    }
    for name, value in (change or {}).items():
        data[name][0, -1] = value
    dims = "e", "gamma"
    variables = {name: (dims, values) for name, values in data.items()}
    return xr.Dataset(variables, {"e": list(restitutions), "gamma": GAMMAS})


@pytest.mark.parametrize(
    ("restitutions", "change", "verdict"),
    [
        ((0.1, 0.9), None, YES),
        ((0.1, 0.9, 1.0), None, PARTLY),
        ((0.1, 0.9), {"ratio_error": 1e-3}, PARTLY),  # times that do not shrink by e
        ((0.1, 0.9), {"impacts": 9.0}, PARTLY),  # a count that has an end
        ((0.1, 0.9), {"sticks": 0.0}, PARTLY),
        ((0.1,), {"ratio_error": 1e-3}, NO),
    ],
)
def test_chattering_is_endless_or_not(restitutions, change, verdict):
    found = section2.check_chattering(Results({"chattering": sequences(restitutions, change)}))
    assert found.verdict == verdict


# -- section 3: Figure 5(b), n = 500 ---------------------------------------------------------------


def loops(count, contact, gap=0.0):
    """Flights and impacts in turn, ``gap`` at each; at the end permanent contact or none."""
    tau, position, rate, kinds = [], [], [], []
    for number in range(count):
        tau += [number + 0.5, number + 1.0, number + 1.0]
        position += [1.0, gap, gap]
        rate += [0.0, -1.0, 0.0 if contact and number == count - 1 else 0.7]
        kinds += [FLIGHT] * 3
    if contact:
        tau, position, rate = [*tau, count + 1.0], [*position, 0.0], [*rate, 0.0]
        kinds = [*kinds[:-1], CONTACT, CONTACT]
    tau, position, rate, kinds = (
        [*tau, count + 2.0],
        [*position, 0.5],
        [*rate, 0.5],
        [*kinds, FLIGHT],
    )
    state = np.zeros((len(tau), 4))
    state[:, 1], state[:, 3] = position, rate
    variables = {"tau": np.array(tau), "kind": np.array(kinds)}
    rows = {name: ("point", values) for name, values in variables.items()}
    return xr.Dataset({**rows, "state": (("point", "coordinate"), state)})


def test_loops_of_the_relative_motion():
    def found(*shape, **more):
        return section3.check_many_loops(Results({"figure5": loops(*shape, **more)}))

    once = found(15, True)
    assert once.verdict == PARTLY
    assert "15 loops in T" in once.value and "14 begin at one, 1 at the end" in once.value
    assert found(15, True, gap=0.1).value.count("False") >= 1


def swept(multiplicity, impacts, gaps):
    """A sweep over eta = 1, 2, ..."""
    etas = np.arange(1.0, len(gaps) + 1)
    columns = {"multiplicity": multiplicity, "impacts_per_period": impacts, "xi_rel_max": gaps}
    data = along_eta(etas, **columns)
    return data.assign(xi_rel=(("eta", "sample"), np.zeros((len(gaps), 201))))


def test_what_becomes_of_responses_later():
    first = swept([1, 1, 0, 2, 1, 0], [1.0, 1.0, 1.4, 0.5, 1.0, 1.3], [1.0] * 6)
    later = swept([1, 0, 1, 2, 1, 0], [1.0, 1.2, 1.0, 1.5, 1.0, 0.9], [1.0, 1, 1, 1, 1.05, 2.0])
    found = {name: which.tolist() for name, which in classify_changes(first, later, 0.01).items()}
    assert list(found.values()) == [
        [False, False, True, False, False, False],
        [False, True, False, False, False, False],
        [False, False, False, True, False, False],
        [False, False, False, False, True, False],
    ]


@pytest.mark.parametrize(
    ("below", "beyond", "verdict"), [(1, 1, YES), (1, 20, PARTLY), (20, 1, PARTLY), (20, 20, NO)]
)
def test_whether_500_periods_suffice(below, beyond, verdict):
    """A hundred frequencies up to the end of the window T, at 2.65, and a hundred beyond it."""
    etas = np.concatenate([np.linspace(1.0, 2.6, 100), np.linspace(2.7, 8.0, 100)])

    def responses(first, second):
        irregular = np.repeat([1, 0, 1, 0], [first, 100 - first, second, 100 - second])
        found = swept(1 - irregular, np.ones(200), np.ones(200))
        return found.assign_coords(eta=etas).assign_attrs(transient=499)

    same, late = responses(0, 0), responses(below, beyond)
    later, latest = late.assign_attrs(transient=4299), same.assign_attrs(transient=49_299)
    data = {UP: same, "later_e0.7_D0.005_up": later, "latest_e0.7_D0.005_up": latest}
    found = section3.check_enough_periods(Results({**data, "limits": limits()}))
    assert found.verdict == verdict
    assert f"{below} of 100 frequencies from 1.000 to 2.650" in found.value
    assert f"({beyond} periodic, later irregular)" in found.value
    assert found.value.startswith("after n = 5,000 ") and "after n = 50,000 0 of 200" in found.value


@pytest.mark.parametrize(("own", "verdict"), [(5.0, NO), (1.0, YES)])
def test_the_most_unfavourable_detuning(own, verdict):
    kappas = [1.0, 1.2, 1.4]
    impulses = (("kappa", "eta"), [[1.0, 0.5], [own, 0.5], [7.0, 0.5]])
    data = xr.Dataset({"impulse_max": impulses}, {"kappa": kappas, "eta": [1.0, 2.0]})
    assert section3.check_most_unfavourable(Results({"map_kappa": data})).verdict == verdict


# -- section 3.2 -----------------------------------------------------------------------------------


def settled(irregular):
    """Settled responses by 0.05, T-periodic but where ``irregular`` says; with their exponents."""
    etas = np.round(np.arange(0.43, 8.0, 0.05), 6)
    chaotic = np.array([any(low < eta < high for low, high in irregular) for eta in etas])
    columns = {"multiplicity": np.where(chaotic, 0, 1), "impacts_per_period": np.ones(len(etas))}
    verdicts = along_eta(etas, verdict=np.where(chaotic, CHAOTIC, PERIODIC))
    return {
        "settled_e0.7_D0.005_up": along_eta(etas, **columns),
        "exponent_e0.7_D0.005": verdicts,
        "limits": limits(),
    }


@pytest.mark.parametrize(
    ("irregular", "verdict"),
    [
        ([(2.7, 3.5), (4.8, 5.6)], YES),
        ([(2.7, 3.5), (0.5, 0.8)], PARTLY),
        ([(0.5, 0.8)], NO),
    ],
)
def test_where_irregularities_occur(irregular, verdict):
    found = section3_influence.check_irregularities(Results(settled(irregular)))
    assert found.verdict == verdict


def test_impacts_that_a_diagram_does_not_show():
    def verdict(impacts):
        data = {UP: swept([1] * len(impacts), impacts, [1.0] * len(impacts))}
        return section3_influence.check_hidden_impacts(Results(data)).verdict

    assert verdict([3.0, 2.0, 1.0]) == YES
    assert verdict([1.0, 1.0]) == NO


@pytest.mark.parametrize(("spoiled", "verdict"), [((), YES), ((1,), PARTLY), ((1, 2), NO)])
def test_one_impact_on_both_sides_of_the_second_region(spoiled, verdict):
    etas = np.array([1.5, 2.0, 4.0, 4.5])
    multiplicity = np.array([1, 1, 2, 2])
    impacts = 1.0 / multiplicity
    for n in spoiled:
        impacts[np.flatnonzero(multiplicity == n)[0]] *= 2.0
    data = along_eta(etas, multiplicity=multiplicity, impacts_per_period=impacts)
    found = section3_influence.check_one_impact_beside(Results({"settled_e0.7_D0.005_up": data}))
    assert found.verdict == verdict


def peaks(sizes):
    """A sweep with a main peak and those of three windows, and its closing velocities."""
    etas = np.concatenate([[1.0, 1.05, 1.1], *([n + 1.0, n + 1.2, n + 1.4] for n in (1, 2, 3))])
    multiplicity = np.array([0] * 3 + [1] * 3 + [2] * 3 + [3] * 3)
    gaps = np.concatenate([[0.5 * size, size, 0.4 * size] for size in sizes])
    impacts = np.where(multiplicity > 0, 1.0 / np.maximum(multiplicity, 1), 2.0)
    data = along_eta(etas, multiplicity=multiplicity, impacts_per_period=impacts, xi_rel_max=gaps)
    data = data.assign(xi_rel=(("eta", "sample"), np.zeros((len(etas), 201))))
    return {UP: data, "steady_e0.7_D0.005_up": along_eta(etas, closing_max=gaps)}


@pytest.mark.parametrize(
    ("sizes", "verdict"),
    [
        ((20.0, 0.2, 0.01, 0.0005), YES),
        ((20.0, 0.2, 0.016, 0.005), PARTLY),  # as it is: the last step is a factor of 3
        ((4.0, 3.0, 2.0, 1.0), NO),
    ],
)
def test_powers_of_ten_from_peak_to_peak(sizes, verdict):
    assert section3_influence.check_decay(Results(peaks(sizes))).verdict == verdict


@pytest.mark.parametrize(
    ("ratios", "verdict"),
    [
        ((0.8, 1.08, 1.05, 1.03, 1.02), YES),
        ((0.8, 1.25, 1.12, 1.08, 1.02), PARTLY),  # as it is: near one oscillator's at the end only
        ((0.8, 1.2, 1.3, 1.4, 1.5), NO),
    ],
)
def test_amplitudes_like_those_of_one_oscillator(ratios, verdict):
    etas, case = np.array([1.047, 2.07, 4.166, 6.268, 8.0]), CASES["elastic"]
    stiffness = (1.0 + case.kappa) / (1.0 + case.mu)
    alone = 1.0 / np.hypot(stiffness - etas**2, 2.0 * case.get("D") * etas)
    sizes = {name: np.array(ratios) * alone for name in ("xi1_max", "xi2_max")}
    data = {UP: along_eta(etas, xi_rel_max=0.1 * alone, **sizes)}
    assert section3_influence.check_single_oscillator(Results(data)).verdict == verdict


# -- sections 4 and 5 ------------------------------------------------------------------------------


def test_one_printed_digit_does_not_make_a_limit_vacuous():
    """1.1 is the end of a window from 1.08 on; the next one begins at 1.11."""
    (claim,) = (one for one in CLAIMS if one.printed == "1.1")
    etas = np.round(np.arange(1.05, 1.15, 0.001), 3)

    def verdict(end):
        one = (etas > 1.079) & (etas < end)
        columns = {
            "multiplicity": np.where(one, 1, 2),
            "impacts_per_period": np.where(one, 1.0, 1.5),
        }
        data = along_eta(etas, **columns)
        data = data.assign(xi_rel=(("eta", "sample"), np.zeros((len(etas), 201))))
        windows = limits().assign(
            case=("window", ["damped"] * 6), high=("window", [0.46, 1.08, end, 4.8, 6.9, 8.9])
        )
        windows.low.values[2] = 1.079
        names = ("orbit_e0.7_D0.05_up", "orbit_e0.7_D0.05_down")
        return claim.check(Results({**dict.fromkeys(names, data), "limits": windows})).verdict

    assert verdict(1.1004) == YES
    assert verdict(1.1174) == NO
    assert verdict(1.0884) == NO


@pytest.mark.parametrize(
    ("amplitude", "impulse", "verdict"), [(2, 2, YES), (1, 2, PARTLY), (1, 3, NO)]
)
def test_amplitudes_and_impulses_are_largest_at_the_main_peak_or_not(amplitude, impulse, verdict):
    etas, data = np.array([1.0, 1.05, 1.1, 1.2]), {}

    def peak_at(place):
        return np.where(np.arange(4) == place - 1, 2.0, 1.0)

    for case in CASES.values():
        up = {
            "xi_rel_max": peak_at(2),
            "xi1_max": peak_at(amplitude),
            "xi2_max": peak_at(amplitude),
        }
        data[f"orbit_{case.label()}_up"] = along_eta(etas, **up)
        data[f"steady_{case.label()}_up"] = along_eta(etas, closing_max=peak_at(impulse))
    assert section5.check_both_at_peak(Results(data)).verdict == verdict


# -- beyond the paper ------------------------------------------------------------------------------


def test_the_largest_impulse_of_a_map_is_that_of_a_longer_run():
    impulses = (("e", "eta"), [[1.0, 2.0], [3.0, 50.9]])
    chart = xr.Dataset({"impulse_max": impulses}, {"e": [0.5, 0.95], "eta": [1.0, 1.05]})
    run_on = along_eta([1.05], impulse_max=[55.3], verdict=[CHAOTIC])
    run_on.attrs["periods"] = 10_000
    text = answers.describe_largest_impulse(chart, run_on, "e")
    assert "55.3 m_1 omega a eta^2 at most in 10000 periods of the irregular response" in text
    assert "(50.9 in those of the map)" in text and "at eta = 1.05." in text


# -- checks that can fail --------------------------------------------------------------------------


def one_period(etas, impacts):
    """T-periodic responses with these numbers of impacts, 0: irregular; as swept and as settled."""
    counts = np.array(impacts)
    columns = {"multiplicity": (counts > 0).astype(int), "impacts_per_period": np.array(impacts)}
    data = along_eta(etas, xi_rel_max=np.arange(len(etas)), **columns)
    return data.assign(xi_rel=(("eta", "sample"), np.zeros((len(etas), 201))))


TO_AND_FRO = one_period(np.linspace(0.5, 0.6, 10), [5, 5, 4, 5, 0, 7, 8, 7, 3, 2])


def test_impacts_that_rise_in_between_do_not_decrease():
    """A number that had been there before was dropped before the numbers were compared."""
    found = section3_influence.check_impacts_decrease(Results({UP: TO_AND_FRO}))
    assert found.verdict == PARTLY
    assert "5, 4, 5, 7, 8, 7, 3, 2 impacts" in found.value
    falling = one_period([0.5, 0.51, 0.52, 0.6], [5, 0, 5, 3])
    assert section3_influence.check_impacts_decrease(Results({UP: falling})).verdict == YES
    damped = one_period(np.linspace(0.5, 0.6, 5), [7, 5, 6, 3, 2])
    verdict = section4.check_seven_to_two(Results({"orbit_e0.7_D0.05_up": damped}))
    assert verdict.verdict == PARTLY and verdict.value == "7, 5, 6, 3, 2"


def test_each_number_of_impacts_has_its_own_frequencies():
    """A window of several numbers had been called by its first one."""
    data = {"settled_e0.7_D0.005_up": TO_AND_FRO}
    data["exponent_e0.7_D0.005"] = along_eta(TO_AND_FRO.eta, verdict=np.full(10, PERIODIC))
    text = section3_influence.check_alternation(Results(data)).value
    assert "5 (0.500 to 0.511), 4 (0.522 to 0.522), 5 (0.533 to 0.533), 7 (0.556" in text


def one_kind(n, impacts):
    """A world in which all responses of all cases repeat after nT with so many impacts."""
    etas = np.round(np.arange(0.1, 8.0, 0.01), 6)
    columns = {
        "multiplicity": np.full(len(etas), n),
        "impacts_per_period": np.full(len(etas), impacts / max(n, 1)),
        "xi_rel_max": np.linspace(1.0, 2.0, len(etas)),
        "permanent_contact": np.full(len(etas), n == 1),
        "verdict": np.full(len(etas), PERIODIC if n else CHAOTIC),
        **dict.fromkeys(("xi1_max", "xi2_max"), np.linspace(2.0, 1.0, len(etas))),
        **dict.fromkeys(("exponent", "standard_error"), np.zeros(len(etas))),
        **dict.fromkeys(("impacts", "contacts"), np.full(len(etas), 1.0 * impacts)),
        **dict.fromkeys(("closing_max", "closing_min"), np.linspace(1.0, 3.0, len(etas))),
        **dict.fromkeys(("distance_min", "distance_max"), np.full(len(etas), 0.3)),
        "periods": np.full(len(etas), 100.0),
    }
    data = along_eta(etas, **columns).assign_attrs(transient=500)
    data = data.assign(xi_rel=(("eta", "sample"), np.tile(np.linspace(1, 2, 201), (len(etas), 1))))
    kinds = ("orbit_{}_up", "orbit_{}_down", "steady_{}_up", "settled_{}_up", "exponent_{}")
    return {kind.format(case.label()): data for kind in kinds for case in CASES.values()}


@pytest.mark.parametrize(("n", "impacts"), [(1, 5), (0, 3)])
@pytest.mark.parametrize(
    "check",
    [
        section3.check_windows_in_order,
        section3.check_one_impact_everywhere,
        section3.check_impact_distance,
        section3.check_other_regions,
        section3_influence.check_impacts_decrease,
        section3_influence.check_one_impact_beside,
        section3_influence.check_decay,
        section4.make_alternation_check("damped", 1.33, 2.6),
        section4.check_seven_to_two,
        section4.check_non_unique,
        section4.check_more_contact,
        section5.check_two_impacts_each,
    ],
)
def test_nothing_is_borne_out_where_all_responses_are_of_one_kind(check, n, impacts):
    same = xr.concat([limits().assign(case=("window", [case] * 6)) for case in CASES], "window")
    world = Results({**one_kind(n, impacts), "limits": same})
    try:
        verdict = check(world).verdict
    except (IndexError, ValueError):  # what it measures is not there at all
        verdict = NO
    assert verdict != YES


def test_masses_that_never_influence_each_other_are_no_exception():
    def verdict(*impacts):
        rows = {"mu": [1.0, 2.0, 2.0], "kappa": [1.0, 2.0, 2.2], "impacts": list(impacts)}
        data = xr.Dataset({name: ("motion", np.array(row)) for name, row in rows.items()})
        return section3.check_only_equal(Results({"low_speed": data})).verdict

    assert verdict(0, 0, 9) == PARTLY  # as it is
    assert verdict(0, 9, 9) == YES
    assert verdict(9, 0, 9) == PARTLY and verdict(9, 0, 0) == NO


def test_a_contact_that_is_not_there_is_no_agreement():
    data = loops(15, True)
    data.state[data.state[:, 3] == 0.0, 3] = 0.01  # no impact slower than gamma
    for gammas, verdict in (([0.417, 0.417], PARTLY), ([0.417, np.nan], NO)):
        limit = xr.Dataset({"last_contact": (("case", "gamma"), [gammas])})
        found = section3.check_gamma_scale(Results({"figure5": data, "gamma": limit}))
        assert found.verdict == verdict, gammas


def test_without_any_part_nothing_is_decided():
    assert check_parts([], "").verdict == UNDECIDED
