"""Small changes of the motion of a top: by its parameters, and by forces along the way.

With coordinates q, momenta p, and S = d(q, p)/d(q0, p0), which is symplectic, generalized forces Q
change q by S_qq int(-S_qp^T Q) + S_qp int(S_qq^T Q).  So one quadrature gives the motion of another
machine to first order, without an integration.
"""

from __future__ import annotations

import math
from copy import copy
from functools import cached_property

import numpy as np
from scipy.integrate import cumulative_simpson
from scipy.interpolate import make_interp_spline

from ..arithmetic.types import Array
from ..names import ANGLES
from .motions import angles, states_of

_STEP = 1e-5
"""Step of differences, over the size of a parameter."""
_LEAST_SIZE = 0.1
"""Least size of a parameter for its step, in units of the period."""


class Variations:
    """A motion on a grid of times, in units of its nutation period and with A = 1, and its changes.

    The `state` is (a, b, theta, thetadot, psidot) at t = 0.  The ratio A/C is NaN if the spin is
    not recorded.  Changes of theta, phi and psi have the shape (3, ..., times).
    """

    def __init__(self, state: Array, ratio: float, t: Array) -> None:
        first = angles(states_of(*state[np.newaxis].T), t)[0, 0]
        at = int(np.argmax(np.sin(first)))  # the coordinates are singular at a pole
        self.t, self.since, self.length, self.ratio = t, t - t[at], float(t[-1]), ratio
        self.a, self.b, theta, _, turned = state
        beta = turned * math.sin(theta) ** 2 + self.b * math.cos(theta)
        theta, rate = first[at], make_interp_spline(t, first, k=5)(t[at], 1)
        turned = (beta - self.b * math.cos(theta)) / math.sin(theta) ** 2
        self.epoch = np.array([self.a, self.b, theta, rate, turned])
        steps = _STEP * np.maximum(np.abs(self.epoch), _LEAST_SIZE)
        ends = [self.epoch, *(self.epoch + np.diag(steps)), *(self.epoch - np.diag(steps))]
        found = angles(states_of(*np.transpose(ends)), self.since)
        self.slopes = ((found[:, 1:6] - found[:, 6:]) / (2 * steps[:, np.newaxis])).swapaxes(0, 1)
        self.angles, self.r0 = found[:, 0], self.b * ratio
        self.angles[1] += np.nan_to_num(self.r0 - self.b) * self.since
        self.sine, self.cosine = np.sin(self.angles[0]), np.cos(self.angles[0])
        precession = (beta - self.b * self.cosine) / np.maximum(self.sine, 1e-9) ** 2
        spin = np.nan_to_num(self.r0) - precession * self.cosine
        self.rates = np.stack([self.slope(self.angles[0]), spin, precession])

    def slope(self, y: Array, order: int = 1) -> Array:
        """Return a derivative with respect to time."""
        return np.asarray(make_interp_spline(self.t, y, k=5, axis=-1)(self.t, order))

    def only(self, **changes: Array | float) -> Array:
        """Return a change of some of the angles."""
        return np.stack(np.broadcast_arrays(*[changes.get(x, 0.0) + 0 * self.t for x in ANGLES]))

    def along(self, change: Array, ratio: float) -> Variations:
        """Return the same with forces along a changed motion, whose A/C may be another one."""
        found = copy(self)
        found.angles, found.rates, found.ratio = self.angles + change, self.rates.copy(), ratio
        found.rates += self.slope(change)
        found.sine, found.cosine = np.sin(found.angles[0]), np.cos(found.angles[0])
        return found

    @cached_property
    def by_parameters(self) -> Array:
        """The changes by a, b at the same r0, the state at the epoch, r0, and the zeros."""
        a, b, *start = self.slopes
        rest = self.only(phi=self.since), self.only(phi=1.0), self.only(psi=1.0)
        return np.stack([a, b - rest[0], *start, *rest])

    @cached_property
    def canonical(self) -> tuple[Array, Array]:
        """S_qq and S_qp, each of shape (3 angles, 3 coordinates, times)."""
        _, by_b, by_theta, by_rate, by_turn = self.slopes
        sine, cosine = math.sin(self.epoch[2]), math.cos(self.epoch[2])
        spun = self.only(phi=np.nan_to_num(self.ratio - 1) * self.since)
        turned = by_theta + by_turn * (self.b - 2 * cosine * self.epoch[4]) / sine
        momenta = [by_rate, by_b + spun - by_turn * cosine / sine**2, by_turn / sine**2]
        return np.stack([turned, *self.by_parameters[6:]], axis=1), np.stack(momenta, axis=1)

    def pushed(self, **forces: Array) -> Array:
        """Return the change by generalized forces on theta, phi and psi."""
        force, (place, momentum) = self.only(**forces), self.canonical
        found = []
        for x, y in ((place, -momentum), (momentum, place)):
            work = cumulative_simpson(np.einsum("ikt,i...t->k...t", y, force), x=self.t, initial=0)
            found.append(np.einsum("ikt,k...t->i...t", x, work))
        return np.asarray(sum(found))

    @cached_property
    def frame(self) -> tuple[Array, Array, Array]:
        """The figure axis, the line of nodes (where psi grows), and where theta grows."""
        sine, cosine = np.sin(self.angles[2]), np.cos(self.angles[2])
        axis = np.stack([self.sine * sine, -self.sine * cosine, self.cosine])
        down = np.stack([self.cosine * sine, -self.cosine * cosine, -self.sine])
        return axis, np.stack([cosine, sine, 0 * sine]), down
