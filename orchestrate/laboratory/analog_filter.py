"""The exact response of an analogue low-pass filter, by its poles and residues.

With partial fractions ``H(s) = sum r/(s - p)`` the response is ``sum r z`` where each
``z' = p z + a(t)``. Over a cell of length h on which ``a`` is a polynomial the solution is in
closed form (the phi functions of exponential integrators, Hochbruck and Ostermann, Acta Numerica
19, 2010), and an impulse of strength S, a Dirac in ``a``, adds S to z. So the response of a signal
of polynomials and impulses has no error but rounding.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from ..constants import TURN
from .pieces import Floats

Complexes = NDArray[np.complex128]
BLOCK = 1 << 16  # cells at once, for the memory
FAR = 3.0  # |z| from which the recurrence upwards loses no digits of the first seven
NEAR = 1.0


@dataclass(frozen=True)
class PolynomialSignal:
    """Hold a signal as polynomials, one per cell of time; cells adjoin each other."""

    # s
    starts: Floats
    ends: Floats
    derivatives: Floats  # value and derivatives at the start of each, m/s2, m/s3, ..


@dataclass(frozen=True)
class AnalogFilter:
    """Describe an analogue filter by simple poles and their residues: more poles than zeros."""

    poles: Complexes  # rad/s; of conjugate pairs the one above the real axis
    # 1/s; of pairs twice theirs, so that the response is the real part of the sum
    residues: Complexes

    @classmethod
    def from_zeros_and_poles(cls, zeros: Complexes, poles: Complexes) -> AnalogFilter:
        """Make the filter of gain 1 at frequency 0 from its zeros and poles, rad/s."""
        gain = np.prod(-poles) / np.prod(-zeros)
        upper = poles[poles.imag > -1e-9 * np.abs(poles)]
        residues = []
        for pole in upper:
            others = poles[poles != pole]
            pair = 2.0 if pole.imag > 1e-9 * abs(pole) else 1.0
            residues.append(pair * gain * np.prod(pole - zeros) / np.prod(pole - others))
        return cls(upper, np.array(residues))

    def frequency_response(self, frequency: Floats) -> Complexes:
        s = 1j * TURN * np.asarray(frequency)[..., None]
        there = self.residues / (s - self.poles)
        mirrored = np.conj(self.residues) / (s - np.conj(self.poles))
        response: Complexes = 0.5 * (there + mirrored).sum(axis=-1)
        return response

    def apply(
        self, signal: PolynomialSignal, impulse_times: Floats, impulses: Floats, times: Floats
    ) -> Floats:
        """Compute the output at equally spaced times, from rest at the first time."""
        from scipy.signal import lfilter

        is_inside = (impulse_times >= times[0]) & (impulse_times <= times[-1])
        hit_times, strengths = impulse_times[is_inside], impulses[is_inside]
        hit_steps = step_indices(hit_times, times)
        gains = self._state_increments(signal, times)
        output = np.zeros(len(times))
        for pole, residue, gain in zip(self.poles, self.residues, gains, strict=True):
            felt = strengths * np.exp(pole * (times[hit_steps + 1] - hit_times))
            gain += sum_by_step(hit_steps, felt, len(gain))
            decay = np.exp(pole * (times[-1] - times[0]) / (len(times) - 1))
            output[1:] += (residue * lfilter([1.0], [1.0, -decay], gain)).real
        return output

    def _state_increments(self, signal: PolynomialSignal, times: Floats) -> Complexes:
        """Compute what the signal adds to each pole's state over each step, at the step's end."""
        increments = np.zeros((len(self.poles), len(times) - 1), dtype=complex)
        step = (times[-1] - times[0]) / (len(times) - 1)
        for begin in range(0, len(signal.starts), BLOCK):
            part = slice(begin, begin + BLOCK)
            starts, ends = signal.starts[part], signal.ends[part]
            steps = step_indices(ends, times)
            lengths, remaining = ends - starts, times[steps + 1] - ends
            count = signal.derivatives.shape[1]
            moments = signal.derivatives[part] * lengths[:, None] ** np.arange(1, count + 1)
            # of lengths that differ by less than 1e-12 of a step one counts
            whole, which = np.unique(np.round(lengths / (1e-12 * step)), return_inverse=True)
            for row, pole in zip(increments, self.poles, strict=True):
                weights = phi_functions(pole * (whole * (1e-12 * step)), count)[:, which]
                gained = np.einsum("nk,kn->n", moments, weights) * np.exp(pole * remaining)
                row[steps[0] : steps[-1] + 1] += sum_by_step(steps - steps[0], gained)
        return increments


def step_indices(moments: Floats, times: Floats) -> NDArray[np.int_]:
    """Return for each moment the index of the step of ``times`` that contains it, ends included."""
    indices: NDArray[np.int_] = np.searchsorted(times, moments, side="left") - 1
    return np.clip(indices, 0, len(times) - 2)


def sum_by_step(steps: NDArray[np.int_], values: Complexes, count: int = 0) -> Complexes:
    """Sum complex values by the index of their step; return ``count`` sums or more."""
    real = np.bincount(steps, values.real, count)
    sums: Complexes = real + 1j * np.bincount(steps, values.imag, count)
    return sums


def phi_functions(z: Complexes, count: int) -> Complexes:
    """Compute ``phi_k(z)``, the integral of ``exp(z (1 - u)) u^(k-1)/(k-1)!`` over u in [0, 1]."""
    phi = np.empty((count, len(z)), dtype=complex)
    size = np.abs(z)
    far = size > FAR  # from one to the next: nothing cancels there
    last = np.exp(z[far])
    for k in range(count):
        last = phi[k, far] = (last - 1.0 / math.factorial(k)) / z[far]
    for low, high in ((-1.0, NEAR), (NEAR, FAR)):
        part = (size > low) & (size <= high)
        if part.any():
            phi[:, part] = phi_by_downward_recurrence(z[part], count, high)
    return phi


def phi_by_downward_recurrence(z: Complexes, count: int, max_size: float) -> Complexes:
    """Compute ``phi_k(z)`` from ``phi_(k+1)``, the last one by its Taylor series: for small z."""
    top = max(count, math.ceil(max_size))
    terms = [1.0 / math.factorial(top)]
    while terms[-1] * max_size ** (len(terms) - 1) > 1e-18 * terms[0]:
        terms.append(terms[-1] / (top + len(terms)))
    last = np.full(len(z), terms[-1], dtype=complex)
    for term in terms[-2::-1]:
        last = last * z + term
    phi = np.empty((count, len(z)), dtype=complex)
    for k in range(top, 0, -1):
        if k <= count:
            phi[k - 1] = last
        last = last * z + 1.0 / math.factorial(k - 1)
    return phi


def low_pass_zeros_and_poles(
    kind: str, order: int, bandwidth: float
) -> tuple[Complexes, Complexes]:
    """Return zeros and poles of a low-pass filter that is 3 dB down at ``bandwidth``, Hz."""
    from scipy.signal import bessel, butter

    edge = TURN * bandwidth
    if kind == "bessel":
        zeros, poles, _ = bessel(order, edge, analog=True, output="zpk", norm="mag")
    else:
        zeros, poles, _ = butter(order, edge, analog=True, output="zpk")
    return np.asarray(zeros, complex), np.asarray(poles, complex)


def anti_aliasing_zeros_and_poles(sample_rate: float) -> tuple[Complexes, Complexes]:
    """Return zeros and poles of an elliptic anti-aliasing filter for a sampling rate, Hz."""
    from scipy.signal import ellip, ellipord

    edge = TURN * sample_rate / 2.56
    order, _ = ellipord(edge, TURN * sample_rate - edge, 0.01, 80.0, analog=True)
    order += 1 - order % 2  # of odd order it has more poles than zeros
    zeros, poles, _ = ellip(order, 0.01, 80.0, edge, analog=True, output="zpk")
    return np.asarray(zeros, complex), np.asarray(poles, complex)


def filters_in_series(parts: Sequence[tuple[Complexes, Complexes]]) -> AnalogFilter:
    """Return one analog filter that acts as filters one after another."""
    zeros, poles = (np.concatenate(roots) for roots in zip(*parts, strict=True))
    return AnalogFilter.from_zeros_and_poles(zeros, poles)
