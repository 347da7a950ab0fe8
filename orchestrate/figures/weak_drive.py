"""Figure 2 and the Sommerfeld effect: speed against voltage, amplitude and impacts against speed, and where the motor's power goes."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 - after the backend was chosen

from .files import write  # noqa: E402

COLOURS = {"bonded": "C0", "delaminated": "C3"}
SINKS = (
    ("dampers", "dampers of the masses"),
    ("box_damper", "damper of the box"),
    ("impact_loss", "impacts"),
)
WINDOW = 10  # revolutions a power is averaged over


def draw(datasets, theory, path):
    """Draw runs of one parameter set.

    Parameters
    ----------
    datasets : list of xarray.Dataset
        Of :func:`orchestrate.driveresult.dataset`.
    theory : dict of ndarray, or None
        Omega, eta0 and amplitude of the averaged theory, bonded.
    path : Path
        PNG file; written whole or not at all.
    """
    figure, axes = plt.subplots(3, 2, figsize=(13, 13), layout="constrained")
    for data in datasets:
        colour, label = COLOURS[data.structure], data.structure
        there = data.time.values <= data.turn_time
        for part, style in ((there, "-"), (~there, "--")):
            name = f"{label}, {'there' if style == '-' else 'back'}"
            axes[0, 0].plot(
                data.eta0[part], data.Omega[part], style, color=colour, lw=1.2, label=name
            )
            axes[0, 1].plot(
                data.Omega[part], data.amplitude[part], style, color=colour, lw=1.2, label=name
            )
            if label == "delaminated":
                impacts(axes[1, 0], data, part, style, name)
        mark_jumps(axes[0, 0], data, colour)
        histories(axes[2], data, colour)
    if theory:
        axes[0, 0].plot(
            theory["eta0"], theory["Omega"], "k:", lw=1.0, label="averaged theory, bonded"
        )
        axes[0, 1].plot(
            theory["Omega"], theory["amplitude"], "k:", lw=1.0, label="averaged theory, bonded"
        )
    powers(axes[1, 1], datasets[-1])
    label_axes(axes)
    limits(axes[0], datasets)
    save(figure, path)


def impacts(axes, data, part, style, name):
    """Impacts of each revolution, and their running mean."""
    speed, count = data.Omega.values[part], data.impacts.values[part]
    colour = "C3" if style == "-" else "C1"
    axes.plot(speed, count, ".", ms=2.0, color=colour, alpha=0.3)
    if len(count) > WINDOW:
        mean = np.convolve(count, np.full(WINDOW, 1.0 / WINDOW), "valid")
        axes.plot(
            np.convolve(speed, np.full(WINDOW, 1.0 / WINDOW), "valid"),
            mean,
            style,
            color=colour,
            lw=1.2,
            label=f"{name}, mean of {WINDOW}",
        )
    axes.set_yscale("log")


def mark_jumps(axes, data, colour):
    """The breaks, with their values."""
    for name, place in (("jump_up", 0.06), ("jump_down", 0.94)):
        value = data.attrs[name]
        if np.isfinite(value):
            axes.axvline(value, color=colour, lw=0.6, alpha=0.6)
            axes.text(
                value,
                place,
                f" {value:.4f}",
                color=colour,
                transform=axes.get_xaxis_transform(),
                fontsize=8,
                rotation=90,
            )


def histories(axes, data, colour):
    """Speed and amplitude over time around the jumps."""
    time, eta0 = data.time.values, data.eta0.values
    for panel, name in zip(axes, ("jump_up", "jump_down"), strict=True):
        value = data.attrs[name]
        rising = (name == "jump_up") == (data.eta0_last > data.eta0_first)
        there = time <= data.turn_time if rising else time > data.turn_time
        if not np.isfinite(value) or not there.any():
            continue
        at = time[there][np.argmin(np.abs(eta0[there] - value))]
        near = np.abs(time - at) < 500.0
        panel.plot(
            time[near] - at,
            data.Omega.values[near],
            color=colour,
            label=f"{data.structure}: $\\Omega$",
        )
        panel.plot(
            time[near] - at,
            data.amplitude.values[near] / 10.0,
            color=colour,
            lw=0.8,
            ls="--",
            label=f"{data.structure}: amplitude/10",
        )


def powers(axes, data):
    """Mean power of motor and sinks against the speed, one way."""
    time = data.time.values
    there = np.flatnonzero(time <= data.turn_time)[::WINDOW]
    if len(there) < 3:
        return
    span = np.diff(time[there])
    speed = 0.5 * (data.Omega.values[there][1:] + data.Omega.values[there][:-1])
    axes.plot(speed, np.diff(data.motor.values[there]) / span, "k", lw=1.5, label="motor")
    for name, label in SINKS:
        axes.plot(speed, np.diff(data[name].values[there]) / span, lw=1.0, label=label)
    axes.plot(speed, np.diff(data.stored.values[there]) / span, color="0.7", lw=0.8, label="stored")
    axes.set_title(f"power, {data.structure}, there", loc="left", fontsize=10)


def label_axes(axes):
    """Names of what is drawn."""
    names = (
        (r"voltage $\eta_0$", r"mean speed $\Omega$"),
        (r"mean speed $\Omega$", r"amplitude of $x_1$ in $S/M_t$"),
        (r"mean speed $\Omega$", "impacts in a revolution"),
        (r"mean speed $\Omega$", "power"),
        ("time from the jump up", ""),
        ("time from the jump down", ""),
    )
    for panel, (x, y) in zip(axes.flat, names, strict=True):
        panel.set_xlabel(x)
        panel.set_ylabel(y)
        panel.grid(True, alpha=0.3)
        if panel.get_legend_handles_labels()[0]:
            panel.legend(fontsize=7)


def limits(axes, datasets):
    """Ranges of the computed runs: the theory goes on."""
    for panel, name in zip(axes, ("eta0", "Omega"), strict=True):
        low, high = (f([f(data[name].values[5:]) for data in datasets]) for f in (min, max))
        panel.set_xlim(low, high + 1e-3)
    axes[0].set_ylim(*axes[1].get_xlim())
    axes[1].set_ylim(0.0, 1.05 * max(data.amplitude.values[5:].max() for data in datasets))


def save(figure, path):
    """A picture, whole or not at all."""
    try:
        write(figure, path, dpi=130, format="png")
    finally:
        plt.close(figure)
