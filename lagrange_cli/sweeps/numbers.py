"""The numbers of many motions: the formulas of `keys`, evaluated in bounded numbers.

A formula may lose digits: then its bound is wide.  What is not a formula of the table is here: the
functions that formulas use, and the limits.  They, `gaps` and `means` avoid differences of nearly
equal numbers, so that doubles are enough for most tops.  The same code in pairs of doubles computes
the others.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from operator import itemgetter
from typing import Any

import numpy as np

from ..arithmetic.bounded import EPS, Bounded, atan2, choose, relative_errors, sqrt
from ..arithmetic.formulas import evaluated
from ..arithmetic.types import Array, Mask
from ..solver.facts import FAST, Regime
from ..solver.keys import LINES, exists
from .gaps import Gaps, gaps_of
from .means import mean_rates
from .tops import INPUTS, UNKNOWN, TopArrays, pi_of

GOOD = 1e-13
"""Relative error up to which a number is trusted, of a cosine absolute."""
_LIMITS = [1 - 2.0**-13]
"""Numbers k that the means with 1 bring to this distance from 1 in no, one, two ... steps."""
for _ in range(10):
    _LIMITS.append((_LIMITS[-1] / (1 + (1 - _LIMITS[-1] ** 2) ** 0.5)) ** 2)


def _by_relative_errors(value: Array, *parts: Bounded, least: float = 16.0) -> Bounded:
    """Return numbers whose relative error is at most twice the sum of those of some parts."""
    relative = least * EPS + 2 * sum(map(relative_errors, parts))
    if np.ndim(relative):
        return Bounded(value, relative * abs(value), positive=True)
    return Bounded(value, None, relative, positive=True)


def agm(one: float, k: Bounded) -> Bounded:
    """Return the arithmetic-geometric mean of 1 and k; its relative error is at most that of k."""
    k = k.rounded()
    return _by_relative_errors(agm_of(k.value), k, least=2.0 * len(_LIMITS))


def agm_of(k: Array) -> Array:
    """Return the arithmetic-geometric means of 1 and k <= 1, to 1.5 roundings for each step.

    The number of steps of a k depends on no other.  The mean is NaN if k is below 1e-197.
    """
    found, before = k * np.nan, np.inf
    m, g = np.ones_like(k), k
    least, most = np.fmin.reduce(k, axis=None), np.fmax.reduce(k, axis=None)
    for limit in _LIMITS:
        m, g = (m + g) * 0.5, np.sqrt(m * g)
        if most >= limit:
            found = np.where((limit <= k) & (k < before), (m + g) * 0.5, found)
        if least >= limit:
            break
        before = limit
    return found


def complete_E(k_prime: Bounded) -> Bounded:
    """Return E, which is at least 1; its derivative by k' is at most 1."""
    from scipy.special import ellipe  # start-up

    k_prime = k_prime.rounded()
    return _by_relative_errors(ellipe(1 - k_prime.value * k_prime.value), k_prime)


def ellint_E(phi: Bounded, k: Bounded) -> Bounded:
    """Return E(phi, k); its derivatives are at most 1 and k F(phi, k)."""
    from scipy.special import ellipeinc, ellipkinc  # start-up

    phi, k = phi.rounded(), k.rounded()
    m = k.value * k.value
    found = ellipeinc(phi.value, m)
    of_k = k.value * ellipkinc(phi.value, m)
    return Bounded(found, 16 * EPS * found + phi.error + of_k * k.error)


def nome_of(k: Bounded, k_prime: Bounded) -> Bounded:
    """Return the nome exp(-pi K'/K); its derivatives by log k and log k' are at most 2.

    The exponential loses log(1/q) digits.  Small nomes are a series instead (DLMF 19.5.5).  For the
    others, the exponent is at most pi.
    """
    k, k_prime = k.rounded(), k_prime.rounded()
    x, y = k.value, k_prime.value
    part = x * x / (2 * (1 + y) * (1 + np.sqrt(y)) ** 2)  # (1 - sqrt(k'))/(1 + sqrt(k'))/2
    fourth = part**4
    value = part * (1 + fourth * (2 + fourth * (15 + fourth * 150)))
    if (large := x >= y).any():
        value[large] = np.exp(-np.pi * agm_of(y[large]) / agm_of(x[large]))
    return _by_relative_errors(value, k, k_prime, least=16 + 4 * len(_LIMITS) * np.pi)


def integral_F(sine: Bounded, cosine: Bounded, k: Bounded) -> Bounded:
    """Return F(phi, k'), where tan(phi) = sine/cosine: its terms are positive (DLMF 19.25.5)."""
    from scipy.special import elliprf  # start-up

    s, c, k = sine.rounded(), cosine.rounded(), k.rounded()
    s2, c2 = s.value * s.value, c.value * c.value
    found = s.value * elliprf(c2, c2 + k.value * k.value * s2, c2 + s2)
    return _by_relative_errors(found, s, c, k)


FUNCTIONS: dict[str, Any] = {
    "abs": abs,
    "agm": agm,
    "atan2": atan2,
    "complete_E": complete_E,
    "cos": itemgetter(1),  # of theta0
    "ellint_E": ellint_E,
    "integral_F": integral_F,
    "max": lambda x, y: choose(x.doubles >= y, x, Bounded(x.value * 0.0 + y)),
    "nome_of": nome_of,
    "sin": itemgetter(0),
    "sqrt": sqrt,
    "square": lambda x: x * x,
}
"""The functions of formulas."""
_START = frozenset(
    "m A C s g r0 thetadot0 psidot0 theta0 above_u0 below_u0 u0 a b momentum momenta "
    "beta_minus_b beta_plus_b".split()
)
"""The numbers of any start that are rounded from pairs of doubles, beside the gaps."""


_FORMULAS = {
    "beta_minus_b": "momentum - b*above_u0",
    "beta_plus_b": "momentum + b*below_u0",
    "over_fast": f"b**2 - {FAST}*a",  # not negative in a pseudo-regular precession
    "square_of_steady": "b**2 - 2*a*u0",  # negative if there is no steady precession
    "height": "rise + fall",
    "wide": "far + a*fall",
    "swing": "thetadot0**2",
    "over": "swing - a*above_u0",
}
"""Numbers that formulas of `keys` use."""


class ArrayNumbers(dict[str, Any]):
    """The numbers of many motions by name, as bounded numbers; each is computed on first use.

    A name is that of a line of `keys`, of an input, or of a property of this class.  Angles are in
    radians.  Facts are attributes with the names of `solver.facts`; some are masks.  No number is
    certain if the axis passes over a pole, but for plane pendulums.
    """

    separatrix = False

    def __init__(self, tops: TopArrays, regime: Regime | None, *, pairs: bool = False) -> None:
        """Take tops of one group, to be computed in doubles or in pairs of doubles.

        Those with any start have their gaps from pairs of doubles in both cases.
        """
        super().__init__(FUNCTIONS)
        self.tops, self.regime, self.pairs, self._has = tops, regime, pairs, dict[str, Any]()
        self.pole = {Regime.SLEEPING: 1, Regime.HANGING: -1}.get(regime, 0)  # type: ignore
        self.vertical = bool(self.pole)
        self.steady = regime not in {Regime.REGULAR, Regime.NO_SPIN, None}
        self.nutates, self.plane = not self.steady, regime is Regime.NO_SPIN
        self.off_poles = not self.plane
        self["pi"] = pi_of(pairs=pairs)
        self.finer = None if pairs or regime else ArrayNumbers(tops, regime, pairs=True)
        if self.finer:
            return
        for name in INPUTS:
            if name != "psidot0" or regime is not Regime.STEADY:
                self[name] = tops.number(name, pairs=pairs)
        self.update(tops.tilt.start(pairs=pairs))

    def __missing__(self, name: str) -> Any:
        if self.finer and name in _START:
            found = self.finer[name]
            value = tuple(x.rounded() for x in found) if type(found) is tuple else found.rounded()
        elif name in LINES or name in _FORMULAS:
            formula = LINES[name].evaluated if name in LINES else _FORMULAS[name]
            value = evaluated(formula, self)
        else:
            value = getattr(self["gaps"], name) if name in Gaps._fields else getattr(self, name)
        self[name] = value
        return value

    def has(self, name: str) -> Any:
        """Return which motions have a number."""
        if name not in self._has:
            self._has[name] = name not in LINES or exists(name, self, self)
        return self._has[name]

    def is_zero(self, name: str) -> Any:
        """Return which numbers are certainly 0."""
        return (self[name].doubles == 0) & (self[name].error == 0)

    # facts

    a = property(lambda self: self["a"].doubles)
    spin = property(lambda self: self["r0"].doubles)
    moves = property(lambda self: self.nutates or (self.a != 0) | (self.spin != 0))
    stable = property(lambda self: self["b"].doubles ** 2 >= 2 * self.a)
    fast = property(lambda self: self.regime is Regime.REGULAR and self["over_fast"].doubles >= 0)

    @property
    def released(self) -> Any:
        """The top is released from rest."""
        if self.plane:
            return self["thetadot0"].doubles == 0
        return self.regime not in {Regime.STEADY, None}

    @property
    def over_top(self) -> Any:
        """The axis passes over the upper pole: a pendulum that turns over."""
        return self.plane and self["over"].doubles > 0

    @property
    def half_off_pole(self) -> Any:
        """The axis is not vertical half a period after the start."""
        return ~self.released if self.plane else True

    @property
    def turning(self) -> Any:
        """1 for a start at u1, -1 at u2, 0 between."""
        if self.regime is not None:
            return self.nutates * self.released
        at_u1 = (self.finer or self)["rise"].doubles == 0
        return np.where(self["thetadot0"].doubles == 0, np.where(at_u1, 1, -1), 0)

    def has_steady_rate(self, _: str) -> Mask:
        """Return which tops may have a rate of steady precession, uncertain at 90 degrees."""
        found: Mask = ~self["square_of_steady"].surely(-1)
        return found

    # the start

    @property
    def steady_rates(self) -> tuple[Bounded, Bounded]:
        """The slow and the fast rate of steady precession."""
        root = sqrt(self["square_of_steady"])
        q = self["b"] + choose(self["b"].doubles < 0, -root, root)
        return self["a"] / q, q / (2.0 * self["u0"])

    @property
    def psidot0(self) -> Bounded:
        """The rate of steady precession that a word names."""
        return choose(self.tops.steady == 1, *self["steady_rates"])

    # the cubic (4,9)

    gaps = property(gaps_of)

    @property
    def roots(self) -> tuple[Bounded, Bounded]:
        """The roots u2, from the nearer pole, and u1 of the cubic."""
        above, below = self["above_u2"], self["below_u2"]
        u1 = self["u0"] + self["rise"]
        u2 = choose(above.doubles < below.doubles, 1.0 - above, below - 1.0)
        return (u1, u1) if self.steady else (u2, u1)

    @property
    def narrow(self) -> Any:
        """a (u3 - u1)."""
        if not self.plane and self.regime is not None:
            return self["far"]
        return self["a_above_u3"] + self["a"] * self["above_u1"]

    @property
    def m_k_prime(self) -> Bounded:
        """k'^2 (4,21)."""
        return Bounded(1.0) if self.steady else self["narrow"] / self["wide"]

    # means

    @property
    def momenta(self) -> tuple[Bounded, Bounded]:
        """beta - b u at u1 and at u2."""
        along, b = self["momentum"], self["b"]
        return along - b * self["rise"], along + b * self["fall"]

    means = property(mean_rates)

    @property
    def half(self) -> tuple[Bounded, Bounded]:
        """The growth in half a period, an incomplete integral."""
        return UNKNOWN, UNKNOWN

    quarter = half

    # texts

    def precession_at(self, u: str) -> Array:
        """Return the signs of b (beta - b u) at u1 or u2."""
        found: Array = np.sign(self["b"].doubles) * np.sign(self["momenta"][u == "u2"].doubles)
        return found

    def is_certain(self, text: str) -> Any:
        """Return which texts are certain: the roots are apart, and beta - b is not 0."""
        if self.regime is not None:
            return (
                text != "remark"
                or self.regime is not Regime.REGULAR
                or self["over_fast"].is_not_0()
            )
        apart = self["narrow"].surely(1) & self["height"].surely(1)
        signs = [self["beta_minus_b"], *(self["momenta"] if text == "path" else ())]
        return np.logical_and.reduce([apart, *(x.is_not_0() for x in signs)])
