"""One impact in n periods of the two-mass system, solved by hand: linear algebra alone.

Between impacts z' = A z + b sin(eta tau), so after n periods z = H(phi) + P (z0 - H(phi)) with P =
exp(A nT) and the forced response H(phi) = Hc cos phi + Hs sin phi. With the restitution S, z0 = S
z: z is linear in cos phi and sin phi, and the gap's zero gives phi. Nothing is taken from the
package.
"""

import numpy as np
from scipy.linalg import expm
from scipy.optimize import brentq

GAP = np.array([-1.0, 1.0, 0.0, 0.0])
RATE = np.array([0.0, 0.0, -1.0, 1.0])


class SingleImpact:
    """One impact in ``n`` periods: phase, closing speed, state before it, and multipliers."""

    def __init__(self, eta, n, e=0.7, D=0.005, kappa=1.2, mu=1.0):
        a = np.zeros((4, 4))
        a[:2, 2:] = np.eye(2)
        a[2:, :2] = -np.diag([1.0, kappa / mu])
        a[2:, 2:] = -2.0 * D * np.eye(2)
        b = np.array([0.0, 0.0, 1.0, 1.0])
        response = np.linalg.solve(1j * eta * np.eye(4) - a, b)
        time = 2.0 * np.pi * n / eta
        flow = expm(a * time)
        part = (1.0 + e) / (1.0 + mu)
        restitution = np.eye(4)
        restitution[2, 2:] += part * mu * np.array([-1.0, 1.0])
        restitution[3, 2:] += part * np.array([1.0, -1.0])
        # before the impact: z = H + P (S z - H)
        before = np.linalg.solve(np.eye(4) - flow @ restitution, (np.eye(4) - flow) @ response)
        self.phase = -np.angle(GAP @ before)
        self.state = (before * np.exp(1j * self.phase)).imag
        if RATE @ self.state > 0.0:
            self.phase += np.pi
            self.state = -self.state
        self.phase = self.phase % (2.0 * np.pi)
        self.closing = -RATE @ self.state
        drive = b * np.sin(self.phase)
        incoming = a @ self.state + drive
        outgoing = a @ restitution @ self.state + drive
        jump = outgoing - restitution @ incoming
        self.saltation = restitution + np.outer(jump, GAP) / (GAP @ incoming)
        found = np.linalg.eigvals(flow @ self.saltation)
        self.multipliers = found[np.lexsort((found.imag, -np.abs(found).round(12)))]
        self.a, self.eta, self.time = a, eta, time
        self.restitution, self.response = restitution, response

    @property
    def largest(self):
        return float(np.abs(self.multipliers).max())

    def gap(self, times):
        rates, vectors = np.linalg.eig(self.a)
        free = self.restitution @ self.state - (self.response * np.exp(1j * self.phase)).imag
        parts = (GAP @ vectors) * np.linalg.solve(vectors, free)
        phase = self.phase + self.eta * times
        forced = (GAP @ self.response * np.exp(1j * phase)).imag
        return forced + (np.exp(np.outer(times, rates)) @ parts).real


def border(n, low, high, test=lambda found: found.largest - 1.0, **numbers):
    """The eta at which a function of the orbit is zero."""
    return brentq(lambda eta: test(SingleImpact(eta, n, **numbers)), low, high, xtol=1e-13)
