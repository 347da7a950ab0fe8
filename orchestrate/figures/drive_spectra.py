"""Figure 3: acceleration spectra at resonance, semi-logarithmic, undamaged above delaminated."""

import matplotlib
import numpy as np

matplotlib.use("Agg")
from matplotlib import pyplot as plt  # noqa: E402 - after the backend was chosen

from .weak_drive import COLOURS, save  # noqa: E402

HARMONICS = 12  # shown, of the motor's speed


def draw(spectra, path):
    """Draw spectra one below the other.

    Parameters
    ----------
    spectra : dict
        By structure: frequency and amplitude (ndarray), and the motor's mean speed.
    path : Path
        PNG file; written whole or not at all.
    """
    figure, axes = plt.subplots(
        len(spectra),
        1,
        figsize=(10, 3.5 * len(spectra)),
        sharex=True,
        sharey=True,
        layout="constrained",
        squeeze=False,
    )
    top = max(amplitude.max() for _, amplitude, _ in spectra.values())
    for panel, (name, (frequency, amplitude, speed)) in zip(
        axes[:, 0], spectra.items(), strict=True
    ):
        shown = frequency < HARMONICS * speed
        panel.semilogy(
            frequency[shown] / speed,
            np.maximum(amplitude[shown], 1e-9 * top),
            color=COLOURS[name],
            lw=0.7,
        )
        panel.set_title(f"{name}, $\\Omega$ = {speed:.4f}", loc="left", fontsize=10)
        panel.set_ylabel(r"acceleration in $\omega^2 S/M_t$")
        panel.set_ylim(1e-6 * top, 2.0 * top)
        panel.grid(True, alpha=0.3)
    axes[-1, 0].set_xlabel(r"frequency over the motor's speed $\Omega$")
    save(figure, path)
