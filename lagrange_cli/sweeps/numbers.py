"""The numbers of many motions: the formulas of `keys`, evaluated in bounded numbers.

A formula may lose digits: then its bound is wide.  What is not a formula of the table is here: the
functions that formulas use, the roots of the cubic (4,9), the mean rates, and the limits.  They
avoid differences of nearly equal numbers, so that doubles are enough for most tops.  The same code
in pairs of doubles computes the others.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Sequence
from copy import copy
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.bounded import (
    EPS,
    LOST,
    Bounded,
    atan2,
    best,
    choose,
    known,
    relative_errors,
    root_of,
    size_of,
    sqrt,
    unit_of,
)
from ..arithmetic.formulas import evaluated
from ..arithmetic.pairs import DoubleDouble
from ..arithmetic.types import Array, Mask
from ..solver.facts import FAST, Regime
from ..solver.keys import LINES, exists
from .tops import INPUTS, UNKNOWN, TopArrays, pi_of

GOOD = 1e-13
"""Relative error up to which a number is trusted, of a cosine absolute."""
_FINE = 0.9 * GOOD
"""Relative error up to which a mean rate is good enough for what is computed from it."""
_RELEASED, _FROM_PAIRS = 64 * EPS, 8 * EPS
"""Relative errors up to which the gaps of tops are good enough, released ones and others."""
_NEWTON_STEPS, _STEPS_IN_PAIRS, _MEAN_STEPS, _AGM_STEPS = 100, 2, 11, 16


def _by_relative_errors(value: Array, *parts: Bounded, least: float = 16.0) -> Bounded:
    """Return numbers whose relative error is at most twice the sum of those of some parts."""
    relative = least * EPS + 2 * sum(map(relative_errors, parts))
    if np.ndim(relative):
        return Bounded(value, relative * abs(value), positive=True)
    return Bounded(value, None, relative, positive=True)


def agm(one: float, k: Bounded) -> Bounded:
    """Return the arithmetic-geometric mean of 1 and k; its relative error is at most that of k."""
    k = k.rounded()
    return _by_relative_errors(agm_of(k.value), k, least=2.0 * _AGM_STEPS)


def agm_of(k: Array) -> Array:
    """Return the arithmetic-geometric means of 1 and k <= 1, to 1.5 roundings for each step.

    The neighbours of a number have no influence on it.
    """
    m, g, found = np.ones_like(k), k, k * np.nan
    going = np.ones(np.shape(k), np.bool_)
    for _ in range(_AGM_STEPS):
        still = going & (m - g > 2.0**-13 * m)  # after a step the distance is 2^-29 at most
        m, g = (m + g) * 0.5, np.sqrt(m * g)
        if (done := going ^ still).any():
            found = np.where(done, (m + g) * 0.5, found)
        if not still.any():
            break
        going = still
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
    if (is_large := x >= y).any():
        value = np.where(is_large, np.exp(-np.pi * agm_of(y) / agm_of(x)), value)
    return _by_relative_errors(value, k, k_prime, least=16 + 4 * _AGM_STEPS * np.pi)


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
    "u0": "cos(theta0)",
    "momentum": "psidot0*sin(theta0)**2",  # beta - b u0 (4,5)
    "beta_minus_b": "momentum - b*above_u0",
    "beta_plus_b": "momentum + b*below_u0",
    "over_fast": f"b**2 - {FAST}*a",  # not negative in a pseudo-regular precession
    "square_of_steady": "b**2 - 2*a*u0",  # negative if there is no steady precession
    "height": "rise + fall",
    "wide": "far + a*fall",
    "m_k": "a*height/wide",
    "swing": "thetadot0**2",
    "over": "swing - a*above_u0",
}
"""Numbers that formulas of `keys` use."""


class Gaps(NamedTuple):
    """Distances between the roots u2 <= u1 <= 1 <= u3 of (4,9), the poles and the start u0."""

    rise: Bounded  # u1 - u0
    fall: Bounded  # u0 - u2
    far: Bounded  # a (u3 - u0)
    above_u1: Bounded  # 1 - u1
    above_u2: Bounded
    below_u1: Bounded  # 1 + u1
    below_u2: Bounded
    a_above_u3: Bounded  # a (u3 - 1)


class ArrayNumbers(dict[str, Any]):
    """The numbers of many motions by name, as bounded numbers; each is computed on first use.

    A name is that of a line of `keys`, of an input, or of a property of this class.  Angles are in
    radians.  Facts are attributes with the names of `solver.facts`; some are masks.  No number is
    certain if the axis of a top with initial rates passes over a pole.
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

    def some(self, rows: Any) -> ArrayNumbers:
        """Return the numbers of some of the motions; those that are known are kept."""
        found = copy(self)
        found.tops, found._has = self.tops.part(rows), {}
        for name, x in self.items():
            if isinstance(x, Bounded):
                found[name] = x[rows]
            elif isinstance(x, tuple):
                parts = (y[rows] for y in x)
                found[name] = Gaps(*parts) if isinstance(x, Gaps) else tuple(parts)
        return found

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

    # the cubic a x^3 + c2 x^2 + c1 x + c0 = 0 (4,9) in x = u - u0

    @property
    def gaps(self) -> Gaps:
        """The gaps of motions that nutate, or keep their tilt.

        The largest root X = a (u3 - u0) leaves a quadratic with a negative last coefficient, so
        that its discriminant is a sum.  Its smaller root is a quotient.  Distances to a pole are
        differences, or quotients by f(1) = -(beta - b)^2 and f(-1) = -(beta + b)^2.
        """
        if self.finer:
            return Gaps(*(known(x.rounded(), _FROM_PAIRS) for x in self.finer["gaps"]))
        a, b, u0, above, below = (self[x] for x in ("a", "b", "u0", "above_u0", "below_u0"))
        sine, zero = self["theta0"][0], Bounded(0.0, positive=True)
        if self.steady:
            around = self["psidot0"] * sine
            far = self._root(around * around + self["square_of_steady"])
            return Gaps(zero, zero, far, above, above, below, below, far - a * above)
        if self.plane:
            return self._gaps_of_pendulums()
        if self.regime is None:
            return self._gaps_of_any_start()
        # u0 is a root: the others are those of X^2 - 2 half X - (a sin)^2 in X = a (u - u0)
        half, a_sine, square = 0.5 * (b * b) - a * u0, a * sine, b * b
        more = sqrt(half * half + a_sine * a_sine) + abs(half)
        far = self._root(choose(half.doubles >= 0, more, a_sine * a_sine / more))
        fall = a_sine * sine / far
        above_u2, below_u2 = above + fall, square * below / (far + a * below)
        a_above_u3 = square * above / above_u2
        return Gaps(zero, fall, far, above, above_u2, below, below_u2, a_above_u3)

    def _gaps_of_pendulums(self) -> Gaps:
        """Return the gaps if b = beta = 0: two roots are -1 and 1, and `over` is a (u - 1) at the
        third one, u."""
        a, above, below, swing = (self[x] for x in ("a", "above_u0", "below_u0", "swing"))
        zero, two = Bounded(0.0, positive=True), Bounded(2.0, positive=True)
        turns, past = self.over_top, self._root(abs(self["over"]))
        return Gaps(
            rise=choose(turns, above, swing / a),
            fall=below,
            far=choose(turns, swing, a * above),
            above_u1=choose(turns, zero, past / a),
            above_u2=two,
            below_u1=choose(turns, two, below + swing / a),
            below_u2=zero,
            a_above_u3=choose(turns, past, zero),
        )

    def _root(self, x: Bounded) -> Bounded:
        return x if self.pairs else known(x, _RELEASED)

    def _gaps_of_any_start(self) -> Gaps:
        """Return the gaps from the cubic in u - u0 or, next to the separatrix, in 1 - u."""
        a, b, u0, above, below = (self[x] for x in ("a", "b", "u0", "above_u0", "below_u0"))
        sine, momentum = self["theta0"][0], self["momentum"]
        north, south = self["beta_minus_b"], self["beta_plus_b"]
        around, along = self["psidot0"] * sine, sine * self["thetadot0"]
        energy, square = self["thetadot0"] * self["thetadot0"] + around * around, along * along
        c1 = 2.0 * (b * momentum - u0 * energy) - a * (sine * sine)
        far, rise, fall = roots_of_cubic(a, 2.0 * (a * u0) - energy - b * b, c1, square)
        below_u1, above_u2 = below + rise, above + fall
        a_above_u3 = far - a * above
        above_u1 = best(above - rise, lambda: north * north / (above_u2 * a_above_u3))
        a_above_u3 = best(a_above_u3, lambda: north * north / (above_u1 * above_u2))
        below_u2 = best(below - fall, lambda: south * south / (below_u1 * (far + a * below)))
        found = Gaps(rise, fall, far, above_u1, above_u2, below_u1, below_u2, a_above_u3)
        lost = ~(relative_errors(above_u1) + relative_errors(a_above_u3) <= LOST)
        if not lost.any():
            return found
        past = energy - a * above  # alpha - a
        c1 = 2.0 * (b * north - past)
        wide, above_u1, past_pole = roots_of_cubic(a, past + b * b - 2.0 * a, c1, north * north)
        above_u2, a_above_u3 = wide / a, a * past_pole
        far, rise, fall = a_above_u3 + a * above, above - above_u1, above_u2 - above
        rise = best(rise, lambda: square / (far * fall))
        fall = best(fall, lambda: square / (far * rise))
        below_u1 = 2.0 - above_u1
        below_u2 = best(2.0 - above_u2, lambda: south * south / (below_u1 * (far + a * below)))
        other = Gaps(rise, fall, far, above_u1, above_u2, below_u1, below_u2, a_above_u3)
        lost &= relative_errors(a_above_u3) <= relative_errors(found.a_above_u3)
        return Gaps(*(choose(lost, y, x) for x, y in zip(found, other, strict=True)))

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

    @property
    def means(self) -> tuple[Bounded, Bounded]:
        """The mean rates of spin (6,3) and precession (7,3).

        If the parts cancel, those of any start are computed again in pairs of doubles.
        """
        r0 = self["r0"]
        if self.steady:
            return r0 - self["psidot0"] * self["u0"] * (not self.vertical), self["psidot0"]
        if self.plane:  # a half turn at the bottom
            half_turn = self["pi"] / self["T_nutation"]
            over = self.over_top
            return choose(over, Bounded(0.0), half_turn), choose(over, 2.0 * half_turn, half_turn)
        gaps = self["gaps"]
        if self.released:  # at u1 without precession
            south, north = mean_parts(gaps, self["k_prime"], gaps.rise, gaps.fall)
            return r0 + self["b"] * (south - north), self["b"] * (south + north)
        k_prime, b = self["k_prime"], self["b"]
        south, north = mean_parts(gaps, k_prime, *self["momenta"])
        if self.pairs:
            past = gaps.far + self["a"] * self["below_u0"]  # a (u3 + 1)
            ends = gaps.below_u1, gaps.below_u2
            south = best(south, lambda: part_next_to(ends, k_prime, past, self["beta_plus_b"], -b))
            ends, past = (gaps.above_u1, gaps.above_u2), gaps.a_above_u3
            north = best(north, lambda: part_next_to(ends, k_prime, past, self["beta_minus_b"], b))
        spin, precession = r0 + south - north, south + north
        if not self.finer:
            return spin, precession
        lost = ~((spin.error <= _FINE * spin.size) & (precession.error <= _FINE * precession.size))
        if (rows := np.flatnonzero(lost)).size:
            finer = self.finer.some(rows)["means"]
            for x, exact in zip((spin, precession), finer, strict=True):
                y = exact.rounded()
                x.value[rows], x.error[rows] = y.value, y.error
        return Bounded(spin.value, spin.error), Bounded(precession.value, precession.error)

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


def mean_parts(gaps: Gaps, k_prime: Bounded, x: Bounded, y: Bounded) -> list[Bounded]:
    """Return the means over a period of the partial fractions of psi' (4,7) at both poles,

        south = (beta - b u)/(2 (1 + u)),    north = (beta - b u)/(2 (1 - u)),

    from x and y, beta - b u at u1 and u2.  Then psi' = south + north, phi' = r0 + south - north.

    If x and y have one sign, a relative error is at most that of x, y and d = 1 +- u, twice that of
    k' (which changes the weight of each time), and ten roundings for each step, which only adds
    numbers of one sign.  Otherwise it is relative to the mean of the sizes.
    """
    ends = [(gaps.below_u1, gaps.below_u2), (gaps.above_u1, gaps.above_u2)]
    values, steps = _means(
        k_prime.value, [(d1.value, d2.value) for d1, d2 in ends], x.value, y.value
    )
    unit, positive = unit_of(k_prime.value), x.positive and y.positive
    of_momenta = np.maximum(relative_errors(x), relative_errors(y))
    mixed = np.flatnonzero(x.doubles * y.doubles < 0)
    found = []
    for (d1, d2), value in zip(ends, values, strict=True):
        rho = np.maximum(relative_errors(d1), relative_errors(d2)) + 2 * relative_errors(k_prime)
        rho = rho + 10 * unit * ((_MEAN_STEPS if positive else steps) + 1)
        if positive and not np.ndim(rho + of_momenta):
            found.append(Bounded(value, None, rho + of_momenta, positive=True) * 0.5)
            continue
        error = (rho + of_momenta) * size_of(value)
        if mixed.size:
            k, *d = (v.doubles[mixed] for v in (k_prime, d1, d2))
            sizes = (v.error[mixed] + rho[mixed] * v.size[mixed] for v in (x, y))
            error[mixed] = _means(k, [d], *sizes)[0][0]
        found.append(Bounded(value, error, positive=positive) * 0.5)
    return found


def part_next_to(
    ends: tuple[Bounded, Bounded], k_prime: Bounded, past: Bounded, momentum: Bounded, b: Bounded
) -> Bounded:
    """Return a part of `mean_parts` as b/2 and the mean of c/(2 d), c = beta -+ b, next to a pole.

    By f(+-1), |c| is the root of d1 d2 and `past`, the size of a (u3 -+ 1).  The mean of |c|/d then
    is the root of `past` times a function of r = sqrt(d1/d2) and k', whose relative derivative by
    the smaller one of r and 1/r is at most 1, and 1.9 r/k', as an integral over tan(x)/r shows.
    """
    d1, d2 = ends
    c = sqrt(d1 * d2 * past).value
    (value,), steps = _means(k_prime.value, [(d1.value, d2.value)], c, c)
    ratio = d1.doubles / d2.doubles
    weight = np.minimum(1.0, 2.0 * np.sqrt(np.minimum(ratio, 1 / ratio)) / k_prime.doubles)
    of_ends = relative_errors(d1) + relative_errors(d2)
    relative = 0.5 * (relative_errors(past) + weight * of_ends) + 2 * relative_errors(k_prime)
    relative = relative + 10 * unit_of(value) * (steps + 1)
    known = (of_ends < 0.01) & momentum.is_not_0()
    size = Bounded(value, np.where(known, relative * size_of(value), np.inf))
    return 0.5 * (size * np.sign(momentum.doubles) + b)


def _means(k_prime: Any, ends: Sequence[Any], x: Any, y: Any) -> tuple[list[Any], Any]:
    """Return the means over a period of (x cn^2 + y sn^2)/(d1 cn^2 + d2 sn^2) for each (d1, d2) of
    `ends`, and the number of steps of each top, on which its neighbours have no influence.

    It is Bulirsch's cel(k', p, x, y)/K (DLMF 19.2.11), p = k'^2 d2/d1, over d1.  Each step is
    Bartky's transformation (Bulirsch 1969), which keeps it and squares the distance of m from g.
    A mean that needs too many steps is NaN.
    """
    close_to = 2.0**-52 if isinstance(k_prime, DoubleDouble) else 2.0**-26
    m, g, mc, states = 0.0 * k_prime + 1.0, k_prime, k_prime * k_prime, []
    for d1, d2 in ends:
        p = root_of(mc * d2 / d1)
        states.append((x / d1, y * mc / d1 / p, p))
    values, going = [v * np.nan for v, _, _ in states], np.ones(size_of(k_prime).shape, np.bool_)
    steps = np.zeros(going.shape)
    for _ in range(_MEAN_STEPS):
        product = m * g
        for i, (v, w, p) in enumerate(states):
            q = product / p
            states[i] = (v + w / p) * 0.5, (w + v * q) * 0.5, (p + q) * 0.5
        still = going & (size_of(m - g) > close_to * size_of(m))
        m, g = (m + g) * 0.5, root_of(product)
        steps += going
        if (done := going & ~still).any():
            pick = DoubleDouble.choose if isinstance(m, DoubleDouble) else np.where
            last = [(v * m + w) / (m + p) for v, w, p in states]
            values = [pick(done, new, old) for new, old in zip(last, values, strict=True)]
        going = still
        if not going.any():
            break
    return values, steps


def roots_of_cubic(
    a: Bounded, c2: Bounded, c1: Bounded, c0: Bounded
) -> tuple[Bounded, Bounded, Bounded]:
    """Return a X, Y and Z from a x^3 + c2 x^2 + c1 x + c0 with c0 >= 0 and the roots X, Y and -Z,
    where X is the largest, and Y and Z are not negative.

    X leaves a quadratic with a negative last coefficient, so that its discriminant is a sum.
    """
    largest = largest_root(c2, a * c1, a * (a * c0))
    total, product = (c1 + a * c0 / largest) / largest, c0 / largest
    larger = (abs(total) + sqrt(total * total + 4.0 * product)) * 0.5
    smaller = product / larger
    upward = total.doubles >= 0
    return largest, choose(upward, larger, smaller), choose(upward, smaller, larger)


def largest_root(c2: Bounded, c1: Bounded, c0: Bounded) -> Bounded:
    """Return the largest root of X^3 + c2 X^2 + c1 X + c0 with c0 >= 0, which has three real ones.

    Newton's method descends to it from the larger root of X^2 + c2 X + c1, where the cubic is c0.
    If f' changes by at most 1 % within 2 |f/f'|, the root is within 1.01 |f/f'|.
    """
    b2, b1, b0 = c2.doubles, c1.doubles, c0.doubles
    x = 0.5 * (np.sqrt(np.maximum(b2 * b2 - 4 * b1, 0.0)) - b2)
    x = np.where(b2 < 0, x, np.maximum(x, b1 / np.minimum(-b2 - x, -1e-300))) * (1 + 2.0**-24)
    going = np.ones(x.shape, dtype=np.bool_)  # until the step of a top itself is small
    for _ in range(_NEWTON_STEPS):
        slope = (3 * x + 2 * b2) * x + b1
        step = (((x + b2) * x + b1) * x + b0) / slope
        x = np.where(going & (slope > 0), x - step, x)
        going &= abs(step) > 1e-9 * x
        if not going.any():
            break
    pairs = isinstance(c2.value, DoubleDouble)
    root: Any = DoubleDouble(x) if pairs else x
    for _ in range(_STEPS_IN_PAIRS if pairs else 1):
        value = ((root + c2.value) * root + c1.value) * root + c0.value
        root = root - value / ((3 * x + 2 * b2) * x + b1)
        x = Bounded(root).doubles
    exact = Bounded(root)
    value = ((exact + c2) * exact + c1) * exact + c0
    slope = (3 * x + 2 * b2) * x + b1
    of_slope = ((3 * x + 2 * abs(b2)) * x + abs(b1)) * 2.0**-49 + 2 * c2.error * x + c1.error
    error = (value.size + value.error) / slope
    changes = 2 * error * (6 * x + 2 * abs(b2) + 12 * error) + of_slope
    certain = (slope > 0) & (changes <= 0.01 * slope)
    return Bounded(root, np.where(certain, 1.02 * error, np.inf), positive=True)
