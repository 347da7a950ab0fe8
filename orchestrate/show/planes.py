"""Draw planes: maps, basins, bifurcation curves over two parameters, sections and phase curves."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import xarray as xr
from matplotlib.axes import Axes
from matplotlib.colors import ListedColormap, LogNorm
from matplotlib.figure import Figure
from matplotlib.ticker import FuncFormatter, LogLocator, MultipleLocator

from ..constants import TURN
from ..flags import flag_words
from ..model import Structure
from ..units import (
    display_scale_of,
    display_units_of,
    omega_of,
    shows_lengths_as_ratios,
    unit_of_xi,
)
from . import labels
from .colours import BESIDES_RED, BLACK, BLUE, GREEN, GREY, ORANGE, PURPLE, RED, SKY, YELLOW
from .kinds import MORE, draws
from .labels import branch_title, has_frequency_unit, title_from_attributes
from .scales import (
    append_unit,
    axis_values,
    displayed_lengths,
    parameter_scale_and_label,
    varied_dimensions,
)
from .style import XI_REL, XI_REL_RATE, add_figure_legend, draw_line, make_panels, styled

COLUMNS = {  # of a map: the quantities that have a panel
    "impacts_per_period": "impacts per $T$",
    "multiplicity": "multiplicity",
    "xi_rel_max": f"largest {XI_REL}",
    "impulse_max": r"largest impulse over $m_1 \omega a \eta^2$",
    "exponent": r"$\lambda$ per unit of $\tau$",
}
SHADES = (  # of multiplicity
    *("#dfe6ee", SKY, GREEN, YELLOW, ORANGE, RED, PURPLE),  # 1 to 7
    *("#7a4a1e", BLACK),  # 8 and more, none
)
MULTIPLICITIES = ("1", "2", "3", "4", "5", "6", "7", "8+", "not\nperiodic")
NOTHING = "#d9d9d9"  # no impacts
BASINS = (*BESIDES_RED[:4], RED)  # of the first attractors
OTHER = "#bbbbbb"
BORDERS = {
    **{"fold": ORANGE, "period doubling": RED, "Neimark-Sacker": BLUE},
    **{"grazing of an impact": GREEN, "grazing of a flight": BLACK, "earlier release": PURPLE},
}
POINT_MARKS = ("*", "D", "o", "s", "^", "P", "v", "X", "<", ">", "h")  # by kind of codimension two
SHARES = {0.0: "0", 0.25: "π/2", 0.5: "π", 0.75: "3π/2", 1.0: "2π"}  # of a turn
STATES = (BLUE, RED, GREY)  # separate motion, sequence of impacts, permanent contact


@draws("map", partner=MORE)
@styled
def draw_map(*maps: xr.Dataset, title: str = "", overlay: Sequence[xr.Dataset] = ()) -> Figure:
    columns = [name for name in COLUMNS if all(name in data for data in maps)]
    rows = -(-len(columns) // 3) if len(maps) == 1 else 1  # of each: so that it fits a slide
    across, down = -(-len(columns) // rows), rows * len(maps)
    words = title or (title_from_attributes(maps[0]) if len(maps) == 1 else "")
    size = (max(3.1 * across, 4.5), 0.4 + 2.8 * down)
    figure, axes = make_panels(down, across, size, words)
    for plane in axes[len(maps) * len(columns) :]:
        plane.remove()
    for row, data in enumerate(maps):
        first, second = varied_dimensions(data[columns[0]], 2)
        up, right = (second, first) if first in ("eta", "frequency") else (first, second)
        x, y = axis_values(data, right), axis_values(data, up)
        for column, name in enumerate(columns):
            plane = axes[row * len(columns) + column]
            values, label = displayed_values(data, name)
            draw_map_panel(plane, values.transpose(up, right), x.values, y.values)
            words = "" if column or title or len(maps) == 1 else title_from_attributes(data)
            plane.set_title("\n".join(filter(None, [words, label])))
            plane.set(ylabel="" if column % across else y.label, xlabel=x.label)
            limits = plane.axis()
            for curve in overlay:
                scales = [parameter_scale_and_label(data, name)[0] for name in (right, up)]
                across_line, along = curve[right] / scales[0], curve[up] / scales[1]
                kind = str(curve.attrs["kind"])
                draw_line(plane, across_line, along, "-", "white", 2.6)
                draw_line(plane, across_line, along, "-", BORDERS[kind], 1.3, kind)
                mark_codimension_two_points(plane, curve, (right, up), scales)
            plane.axis(limits)
    if overlay:
        add_figure_legend(figure, axes)
    return figure


def displayed_values(data: xr.Dataset, name: str) -> tuple[xr.DataArray, str]:
    """Return a quantity and its label; gaps and impulses in SI, or in the unit asked for."""
    in_si = has_frequency_unit(data) or display_units_of(data).length
    unit = unit_of_xi(data) if name in ("xi_rel_max", "impulse_max") and in_si else None
    if unit is None:
        return data[name], COLUMNS[name]
    if name == "impulse_max":  # over m1 omega a eta^2
        impulses = (data[name] * unit * float(data.attrs["m1"]) * omega_of(data)).rename(name)
        factor, letter = labels.si_prefix(float(impulses.max()))
        return impulses / factor, f"largest impulse in {letter}N s"
    gaps = (data[name] * unit).rename(name)
    return displayed_lengths(data, gaps, f"largest {labels.gap_name(data)}")


def draw_map_panel(plane: Axes, data: xr.DataArray, x: np.ndarray, y: np.ndarray) -> None:
    """Draw one map with its colour bar; a y axis in equal ratios becomes logarithmic."""
    values, shades = data.values, dict[str, Any]()
    if data.name == "multiplicity":
        values = np.where(values == 0, 9, np.minimum(values, 8))
        shades = {"vmin": 0.5, "vmax": 9.5, "cmap": ListedColormap(SHADES)}
    elif data.name == "exponent":
        reach = float(np.nanmax(np.abs(values)))
        shades = {"vmin": -reach, "vmax": reach, "cmap": "PuOr_r"}
    else:
        above_zero = values[values > 0.0]
        values = np.ma.masked_less_equal(values, 0.0)
        if above_zero.size:
            shades = {"norm": LogNorm(above_zero.min(), above_zero.max())}
    picture = plane.pcolormesh(x, y, values, rasterized=True, **shades)
    bar = plane.figure.colorbar(picture, ax=plane)
    if data.name == "multiplicity":
        bar.set_ticks(range(1, 10), labels=MULTIPLICITIES)
        bar.ax.minorticks_off()
    if data.name == "impacts_per_period":
        bar.ax.yaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        bar.ax.yaxis.set_major_formatter("{x:g}")
        bar.ax.minorticks_off()
    if np.ma.is_masked(values):
        plane.set_facecolor(NOTHING)
        bar.ax.set_xlabel("grey: none", fontsize=7)
    plane.set_yscale("log" if is_geometric_sequence(y) else "linear")
    plane.grid(False)


def is_geometric_sequence(values: np.ndarray) -> bool:
    if len(values) < 3 or values[0] <= 0.0 or values[-1] <= values[0]:
        return False
    return bool(np.allclose(values, np.geomspace(values[0], values[-1], len(values))))


@draws("basin")
@styled
def draw_basin(data: xr.Dataset, title: str = "", names: tuple[str, str] = ("", "")) -> Figure:
    y, x = map(str, data.attractor_of.dims)
    # with a unit of frequency the title has it
    by_ratio = "eta" in data.coords and not display_units_of(data).frequency
    eta = rf"$\eta$ = {float(data.eta):.4g}" if by_ratio else ""
    words = title or labels.join_by_commas([title_from_attributes(data, ("eta", x, y)), eta])
    figure, (plane,) = make_panels(1, 1, (6.4, 5.6), words)
    kinds = data.attractor_of.where(data.attractor_of >= 0).values.clip(max=len(BASINS))
    limits: Any = {"vmin": -0.5, "vmax": len(BASINS) + 0.5, "rasterized": True}
    (right, x_label), (up, y_label) = (coordinate_scale_and_label(data, name) for name in (x, y))
    shades = ListedColormap([*BASINS, OTHER])
    plane.pcolormesh(data[x] / right, data[y] / up, kinds, cmap=shades, **limits)
    add_attractors_to_legend(plane, data)
    if "state" in data and "phase" not in (x, y):
        columns = dict(zip(("x1", "x2", "v1", "v2"), data.state.values.T, strict=True))
        clearance = 0.0 if data.attrs.get("bonded") else float(data.attrs.get("clearance", 0.0))
        columns["x_rel"] = columns["x2"] - columns["x1"] + clearance
        columns["v_rel"] = columns["v2"] - columns["v1"]
        kept = plane.axis()
        cross: Any = {"marker": "X", "markeredgecolor": BLACK, "markersize": 8.0}
        cross["linestyle"] = "none"
        colours = [*BASINS, *[OTHER] * data.sizes["attractor"]]
        for at_x, at_y, colour in zip(columns[x] / right, columns[y] / up, colours, strict=False):
            plane.plot(at_x, at_y, markerfacecolor=colour, **cross)
        plane.axis(kept)
        plane.plot([], [], markerfacecolor="white", label="states on them", **cross)
    plane.set(xlabel=names[0] or x_label, ylabel=names[1] or y_label)
    plane.grid(False)
    figure.legend(loc="outside lower left")
    return figure


@styled
def draw_phase_curves(attractors: xr.Dataset, motions: Sequence[xr.Dataset]) -> Figure:
    figure, (plane,) = make_panels(1, 1, (6.4, 5.6), title_from_attributes(motions[0]))
    (right, x_label), (up, y_label) = (
        coordinate_scale_and_label(motions[0], n) for n in ("x_rel", "v_rel")
    )
    add_attractors_to_legend(plane, attractors)
    for motion, colour in zip(motions, (*BASINS, *[OTHER] * len(motions)), strict=False):
        _, gap, rate = gap_through_impacts(motion)
        plane.plot(gap / right, rate / up, color=colour, linewidth=1.2)
    plane.set(xlabel=x_label, ylabel=y_label)
    figure.legend(loc="outside lower left")
    return figure


def gap_through_impacts(data: xr.Dataset) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time, gap and gap velocity, with points before and after each impact (14)."""
    at, closing = data.impact_time.values, data.impact_velocity.values
    e = Structure.from_attributes(data.attrs).restitution(closing)
    after = np.where(data.sticks.values == 1, 0.0, e * closing)
    time = np.concatenate([data.time.values, at, at])
    gap = np.concatenate([data.x_rel.values, 0.0 * at, 0.0 * at])
    rate = np.concatenate([data.v_rel.values, -closing, after])
    order = np.argsort(time, kind="stable")
    return time[order], gap[order], rate[order]


def coordinate_scale_and_label(data: xr.Dataset, name: str) -> tuple[float, str]:
    """Return the divisor to display units and the axis label of a coordinate of the plane."""
    if name == "phase":
        return 1.0, labels.symbol_with_unit(name)
    factor, word = display_scale_of(data, "m/s" if name.startswith("v") else "m")
    unit = "" if shows_lengths_as_ratios(data) else labels.typeset_unit(word)
    symbol = labels.symbol_with_unit(name).rpartition(" in ")[0]
    return factor, append_unit(labels.gap_name(data) if name == "x_rel" else symbol, unit)


def add_attractors_to_legend(plane: Axes, data: xr.Dataset) -> None:
    length = unit_of_xi(data) if display_units_of(data).length else None
    for index, colour in zip(range(data.sizes["attractor"]), BASINS, strict=False):
        part = data.isel(attractor=index)
        n, impacts = float(part.multiplicity), float(part.impacts_per_period)
        kind = labels.orbit_label(n, impacts) or f"not periodic, {impacts:.2f} impacts per T"
        xi = float(part.xi_rel_max)
        gap = f"{XI_REL} = {xi:.3g}"
        if length is not None:
            gap = f"gap = {labels.format_length(data, xi * float(length))}"
        text = f"{index}, {float(part.share):.1%}: {kind}, largest {gap}"
        plane.plot([], [], "s", color=colour, label=text)
    rest = data.share.values[len(BASINS) :].sum()
    if rest:
        words = f"{rest:.1%}: {data.sizes['attractor'] - len(BASINS)} others"
        plane.plot([], [], "s", color=OTHER, label=words)
    if "start" not in data.dims and (data.attractor_of.values < 0).any():  # in no share
        words = "no states: the gap would be below 0"
        plane.plot([], [], "s", color="white", markeredgecolor=OTHER, label=words)


@draws("border", partner=MORE)
@styled
def draw_border(*curves: xr.Dataset, title: str = "") -> Figure:
    over = [str(name) for name in curves[0].attrs["over"]]
    figure, (plane,) = make_panels(1, 1, (9.6, 4.4), title or branch_title(curves[0], over))
    (x_unit, x_label), (y_unit, y_label) = (
        parameter_scale_and_label(curves[0], name) for name in over
    )
    for curve in curves:
        x, y, kind = curve[over[0]] / x_unit, curve[over[1]] / y_unit, str(curve.attrs["kind"])
        draw_line(plane, x, y, "-", BORDERS[kind], 1.2, kind)
    for curve in curves:
        mark_codimension_two_points(plane, curve, over, (x_unit, y_unit))
    plane.set(xlabel=x_label, ylabel=y_label)
    add_figure_legend(figure, [plane])
    return figure


def mark_codimension_two_points(
    plane: Axes, curve: xr.Dataset, over: Sequence[str], units: Sequence[float]
) -> None:
    if not curve.sizes.get("codimension_two"):
        return
    words = flag_words(curve.codimension_two_kind.attrs)
    x, y = (curve[f"codimension_two_{n}"] / unit for n, unit in zip(over, units, strict=True))
    for kind, right, up in zip(curve.codimension_two_kind.values, x.values, y.values, strict=True):
        style: Any = {"color": BLACK, "markeredgecolor": "white", "label": words[int(kind)]}
        plane.plot(right, up, POINT_MARKS[int(kind) % len(POINT_MARKS)], linestyle="none", **style)


@draws("poincare")
@styled
def draw_poincare(data: xr.Dataset, title: str = "") -> Figure:
    figure, (plane,) = make_panels(1, 1, (6.4, 5.0), title or title_from_attributes(data))
    count, at = data.sizes["point"], str(data.attrs["at"])
    size = 2.0 if count > 2000 else 4.0 if count > 200 else 7.0
    sticks = np.full(count, False)
    if at == "phase":
        (x, x_label), (y, y_label) = displayed_gap_and_velocity(data)
    else:
        x, x_label = data.phase / TURN, "phase of the box in rad"
        plane.set_xlim(0.0, 1.0)
        plane.xaxis.set_major_locator(MultipleLocator(0.25))
        plane.xaxis.set_major_formatter(FuncFormatter(lambda turn, _: SHARES.get(turn, "")))
    if at == "releases":
        y, y_label = displayed_lengths(data, data.v1, "velocity of both masses", "m/s")
    if at == "impacts":
        y, y_label = displayed_lengths(data, data.impact_velocity, "closing speed", "m/s")
        sticks = data.sticks.values.astype(bool)
    points: Any = {"linestyle": "none", "marker": ".", "markersize": size, "markeredgewidth": 0.0}
    kinds = (("impacts", ~sticks, BLACK), ("permanent contact follows", sticks, RED))
    for label, chosen, colour in kinds:
        if chosen.any():
            plane.plot(x[chosen], y[chosen], color=colour, label=label, **points)
    plane.set(xlabel=x_label, ylabel=y_label)
    if sticks.any():
        plane.legend()
    # axes of nearly constant values are widened: a periodic motion shows as a point
    for name, (low, high) in (("xlim", plane.get_xlim()), ("ylim", plane.get_ylim())):
        middle = 0.5 * (low + high)
        half = max(0.5 * (high - low), 0.05 * abs(middle))
        plane.set(**{name: (middle - half, middle + half)})
    return figure


def displayed_gap_and_velocity(
    data: xr.Dataset,
) -> tuple[tuple[xr.DataArray, str], tuple[xr.DataArray, str]]:
    """Return gap and gap velocity in display units, each with its axis label."""
    gap = displayed_lengths(data, data.x_rel, "gap")
    return gap, displayed_lengths(data, data.v_rel, "gap velocity", "m/s")


@draws("manifold")
@styled
def draw_manifold(data: xr.Dataset, title: str = "") -> Figure:
    figure, (plane,) = make_panels(1, 1, (7.4, 5.6), title or title_from_attributes(data))
    (gap, x_label), (rate, y_label) = displayed_gap_and_velocity(data)
    sides = {"+": (BLUE, "where the gap grows from the saddle on"), "-": (RED, "where it falls")}
    for side in map(str, data.side.values):
        colour, words = sides[side]
        draw_line(plane, gap.sel(side=side), rate.sel(side=side), "-", colour, 0.8, words)
    saddle: Any = {"color": BLACK, "markersize": 9, "linestyle": "none", "label": "saddle"}
    plane.plot(gap[0, 0], rate[0, 0], "+", **saddle)
    plane.set(xlabel=x_label, ylabel=y_label)
    add_figure_legend(figure, [plane])
    return figure


# -- the paper's curves: along `point` tau, state (xi_1, xi_2, xi_1', xi_2'), kind and panel_of;
# along `panel` e, D, eta and multiplicity


def relative_motion(data: xr.Dataset, panel: int) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return time tau, gap xi_Rel and its velocity along one panel's curve."""
    part = data.isel(point=data.panel_of.values == panel)
    state = part.state.values
    return part.tau.values, state[:, 1] - state[:, 0], state[:, 3] - state[:, 2]


@styled
def draw_phase_curves_by_state(data: xr.Dataset) -> Figure:
    figure, (left, right) = make_panels(1, 2, (8.5, 4.2))
    state = data.state.values
    _, gap, rate = relative_motion(data, 0)
    draw_curve_by_state(left, data, (state[:, 0], state[:, 2]), "-")
    draw_curve_by_state(left, data, (state[:, 1], state[:, 3]), "--")
    draw_curve_by_state(right, data, (gap, rate), "-", dotted=True)
    title = r"(a) both masses: solid $\xi_1$, dashed $\xi_2$"
    left.set(title=title, xlabel=r"$\xi_i$", ylabel=r"$\xi'_i$")
    right.set(title="(b) relative motion", xlabel=XI_REL, ylabel=XI_REL_RATE)
    add_figure_legend(figure, [right])
    return figure


def draw_curve_by_state(
    axes: Axes,
    data: xr.Dataset,
    curve: tuple[np.ndarray, np.ndarray],
    line: str,
    dotted: bool = False,
) -> None:
    """Draw a curve in the colours of its states; contact as a thick line, or a dot."""
    names = flag_words(data.kind.attrs)
    for index, colour in enumerate(STATES):
        x, y = (np.where(data.kind.values == index, along, np.nan) for along in curve)
        contact = index == len(STATES) - 1
        width = 2.5 if contact and not dotted else 1.0
        marker, label = "o" if contact and dotted else "", names[index] if line == "-" else None
        draw_line(axes, x, y, line + marker, colour, width, label)


@styled
def draw_phase_curves_of_masses(data: xr.Dataset) -> Figure:
    count = data.sizes["panel"]
    figure, axes = make_panels(1, count, (3.3 * count, 3.7))
    reach = 1.08 * float(np.abs(data.state).max())
    for index, plane in enumerate(axes):
        state = data.state.values[data.panel_of.values == index]
        draw_line(plane, state[:, 0], state[:, 2], "-", BLACK, 1.0, r"$m_1$")
        draw_line(plane, state[:, 1], state[:, 3], ":", RED, 1.4, r"$m_2$")
        e, D, eta = (float(data[name][index]) for name in ("e", "D", "eta"))
        plane.set_title(rf"({'abcdefgh'[index]}) $e = {e:g}$, $D = {D:g}$, $\eta = {eta:.3f}$")
        plane.set_xlabel(r"$\xi_i$")
        plane.set(xlim=(-reach, reach), ylim=(-reach, reach), aspect="equal")
    axes[0].set_ylabel(r"$\xi'_i$")
    add_figure_legend(figure, axes[:1])
    return figure


@styled
def draw_relative_phase_curves(data: xr.Dataset) -> Figure:
    count, columns = data.sizes["panel"], 4
    rows = -(-count // columns)
    figure, axes = make_panels(rows, columns, (2.7 * columns, 2.6 * rows))
    for index, plane in enumerate(axes[:count]):
        _, gap, rate = relative_motion(data, index)
        plane.plot(gap, rate, "-k", linewidth=0.15, rasterized=True)
        kind = labels.format_period(int(data.multiplicity[index]))
        plane.set_title(rf"$\eta = {float(data.eta[index]):.3f}$, {kind}")
        plane.ticklabel_format(scilimits=(-2, 3))
    for plane in axes[count:]:
        plane.set_visible(False)
    for plane in axes[::columns]:
        plane.set_ylabel(XI_REL_RATE)
    for plane in axes[-columns:]:
        plane.set_xlabel(XI_REL)
    return figure
