"""Draw the oscillator coupled to a drive: box, masses, gap, impacts, what is recorded of it."""

from __future__ import annotations

import xarray as xr
from matplotlib.figure import Figure

from .labels import title_from_attributes
from .scales import acceleration_scale, length_scale
from .shaken import draw_impacts, draw_signal
from .style import BLACK, BLUE, RED, set_title, styled


@styled
def draw(data: xr.Dataset, title: str = "") -> Figure:
    """Draw a coupled run over time, a panel for each quantity of the drive; return the figure."""
    names = recorded(data)
    count = 4 + len(names)
    figure = Figure(figsize=(10.4, 1.2 + 1.6 * count), layout="constrained")
    rows = figure.subplots(count, 1, sharex=True)
    set_title(figure, title or f"{data.attrs['drive']}; {title_from_attributes(data)}")
    scale, unit = acceleration_scale(data)
    draw_signal(rows[0], data, "box_acceleration", scale, color=BLACK)
    rows[0].set_ylabel(f"acceleration\nof box in {unit}")
    factor, letter = length_scale(data, float(abs(data.x1).max()))
    for name, color in (("x1", BLUE), ("x2", RED)):
        draw_signal(rows[1], data, name, factor, color=color, label=f"mass {name[1]}")
    rows[1].set_ylabel(f"displacement\nin {letter}m")
    rows[1].legend(ncols=2, loc="lower right", bbox_to_anchor=(1.0, 1.0), borderaxespad=0.2)
    factor, letter = length_scale(data, float(data.x_rel.max()))
    draw_signal(rows[2], data, "x_rel", factor, color=BLACK)
    rows[2].set_ylabel(f"gap in {letter}m")
    draw_impacts(rows[3], data)
    for axes, name in zip(rows[4:], names, strict=True):
        draw_signal(axes, data, name, 1.0, color=BLACK)
        axes.set_ylabel(f"{name}\nin {data[name].attrs['units']}")
    rows[-1].set(xlabel="time in s", xlim=(0.0, float(data.time[-1])))
    return figure


def recorded(data: xr.Dataset) -> list[str]:
    """Return the names of what was recorded of the drive."""
    return [str(name) for name in data.attrs["recorded"].split(",") if name]
