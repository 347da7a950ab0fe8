"""Figure 3: spectra of a mass's acceleration at resonance, undamaged against delaminated.

The motor hangs at the resonance at a voltage below the jump. The velocity of mass 1 in space is sampled, its spectrum multiplied by the frequency: an
impact is a jump of the velocity, and so is not missed between two samples, as samples of the acceleration would.
"""

import math

import numpy as np

from .coupling import Master, Scheme
from .exchange import OSCILLATOR, SHAKER, SPEED, V1, V
from .fmu import Instance

SETTLE = 800.0  # 1/omega


def record(setup, fmus, eta0, count, h):
    """Velocity of mass 1 in space at ``count`` points after settling from rest.

    Parameters
    ----------
    setup : Setup
    fmus : (path-like, path-like)
        Oscillator and shaker.
    eta0 : float
        Voltage.
    count : int
    h : float
        Time between the samples, in 1/omega.

    Returns
    -------
    velocity : ndarray, shape (count,)
        Over omega S/M_t.
    speed : float
        Mean speed of the motor over omega.
    """
    with Instance(fmus[0], OSCILLATOR) as oscillator, Instance(fmus[1], SHAKER) as shaker:
        voltage = eta0 * setup.volts
        oscillator.initialize(**setup.oscillator())
        shaker.initialize(**setup.shaker(), voltage=voltage)
        master = Master(oscillator, shaker, setup, Scheme(h=h / setup.omega))
        for _ in range(math.ceil(SETTLE / h)):
            master.step(voltage)
        rows = []
        for _ in range(count):
            master.step(voltage)
            rows.append((master.x[V1] + master.s[V], master.s[SPEED]))
        master.close()
    velocity, speed = np.array(rows).T
    return velocity / (setup.omega * setup.length), float(speed.mean() / setup.omega)


def spectrum(velocity, h):
    """Amplitude spectrum of the acceleration from samples of the velocity.

    Parameters
    ----------
    velocity : ndarray, shape (n,)
    h : float
        Time between samples.

    Returns
    -------
    frequency, amplitude : ndarray
        Angular frequency, and amplitude of a sine of the acceleration there.
    """
    n = len(velocity)
    window = np.hanning(n)
    values = np.abs(np.fft.rfft((velocity - velocity.mean()) * window)) * 2.0 / window.sum()
    frequency = 2.0 * np.pi * np.fft.rfftfreq(n, h)
    return frequency, values * frequency
