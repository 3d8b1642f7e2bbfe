"""The numbers of many motions: the formulas of `keys`, evaluated in bounded numbers.

A formula may lose digits: then its bound is wide.  What is not a formula of the table is here: the
functions that formulas use, the roots of the cubic (4,9), the mean rates, and the limits.  They
avoid differences of nearly equal numbers, so that doubles are enough for most tops.  The same code
in pairs of doubles computes the others.  Equation numbers are Chrapan's.
"""

from __future__ import annotations

from collections.abc import Sequence
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np
from scipy.special import ellipe, ellipeinc, ellipkinc, ellipkm1, elliprf

from ..arithmetic.bounded import EPS, PAIR_EPS, Bounded, atan2, best, choose, lifted, size_of, sqrt
from ..arithmetic.formulas import evaluated
from ..arithmetic.pairs import DoubleDouble
from ..arithmetic.types import Array, Mask
from ..solver.facts import Regime
from ..solver.keys import LINES, exists
from .tops import UNKNOWN, TopArrays, pi_of

GOOD = 1e-13
"""Relative error up to which a number is trusted, of a cosine absolute."""
_FINE = 0.9 * GOOD
"""Relative error up to which a mean rate is good enough for what is computed from it."""
_NEWTON_STEPS, _STEPS_IN_PAIRS = 100, 3


def _relative(x: Bounded) -> Array:
    """Return relative errors; 0 for an exact number."""
    return np.where(x.error == 0, 0.0, x.error / x.size)


def _by_relative_errors(value: Array, *parts: Bounded, least: Any = 16.0) -> Bounded:
    """Return numbers whose relative error is at most twice the sum of those of some parts."""
    error = least * EPS + 2 * sum(map(_relative, parts))
    return Bounded(value, error * abs(value))


def agm(one: float, k: Bounded) -> Bounded:
    """Return the arithmetic-geometric mean of 1 and k; its relative error is at most that of k."""
    k = k.rounded()
    return _by_relative_errors(np.pi / 2 / ellipkm1(k.value * k.value), k)


def nome_of(k: Bounded, k_prime: Bounded) -> Bounded:
    """Return the nome exp(-pi K'/K); its derivatives by log k and log k' are at most 2.

    The exponential loses log(1/q) digits.  Small nomes are a series instead (DLMF 19.5.5).
    """
    k, k_prime = k.rounded(), k_prime.rounded()
    x, y = k.value, k_prime.value
    exponent = np.pi * ellipkm1(x * x) / ellipkm1(y * y)
    part = x * x / (2 * (1 + y) * (1 + np.sqrt(y)) ** 2)  # (1 - sqrt(k'))/(1 + sqrt(k'))/2
    fourth = part**4
    series = part * (1 + fourth * (2 + fourth * (15 + fourth * 150)))
    value = np.where(x < y, series, np.exp(-exponent))
    return _by_relative_errors(value, k, k_prime, least=16 + 16 * np.where(x < y, 0.0, exponent))


def integral_F(sine: Bounded, cosine: Bounded, k: Bounded) -> Bounded:
    """Return F(phi, k'), where tan(phi) = sine/cosine: its terms are positive (DLMF 19.25.5)."""
    s, c, k = sine.rounded(), cosine.rounded(), k.rounded()
    s2, c2 = s.value * s.value, c.value * c.value
    found = s.value * elliprf(c2, c2 + k.value * k.value * s2, c2 + s2)
    return _by_relative_errors(found, s, c, k)


FUNCTIONS: dict[str, Any] = {
    "abs": abs,
    "agm": agm,
    "atan2": atan2,
    "complete_E": lifted(lambda k_prime: ellipe(1 - k_prime * k_prime), lambda _: 1.0),
    "cos": itemgetter(1),  # of theta0
    "ellint_E": lifted(
        lambda phi, k: ellipeinc(phi, k * k),
        lambda phi, k: 1.0,
        lambda phi, k: k * ellipkinc(phi, k * k),
    ),
    "integral_F": integral_F,
    "max": lambda x, y: choose(x.doubles >= y, x, Bounded(x.value * 0.0 + y)),
    "nome_of": nome_of,
    "sin": itemgetter(0),
    "sqrt": sqrt,
    "square": lambda x: x * x,
}
"""The functions of formulas."""


class GroupFacts(dict[str, Any]):
    """The facts of tops of one group, as those of `solver.facts`; some are masks.

    No number is certain if the axis of a top with initial rates passes over a pole.
    """

    separatrix = False

    def __init__(self, regime: Regime | None) -> None:
        super().__init__(FUNCTIONS)
        self.regime = regime
        self.pole = {Regime.SLEEPING: 1, Regime.HANGING: -1}.get(regime, 0)  # type: ignore
        self.vertical = bool(self.pole)
        self.steady = regime not in {Regime.REGULAR, Regime.NO_SPIN, None}
        self.nutates, self.released = not self.steady, regime not in {Regime.STEADY, None}
        self.plane = regime is Regime.NO_SPIN
        self.off_poles = self.half_off_pole = not self.plane

    a = property(lambda self: self["a"].doubles)
    spin = property(lambda self: self["r0"].doubles)
    moves = property(lambda self: self.nutates or (self.a != 0) | (self.spin != 0))

    @property
    def turning(self) -> Any:
        """1 for a start at u1, -1 at u2, 0 between."""
        if self.regime is not None:
            return int(self.nutates)
        at_u1 = self["rise"].doubles == 0
        return np.where(self["thetadot0"].doubles == 0, np.where(at_u1, 1, -1), 0)

    def has_steady_rate(self, _: str) -> Mask:
        """Return which tops may have a rate of steady precession, uncertain at 90 degrees."""
        found: Mask = ~self["square_of_steady"].surely(-1)
        return found


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

    def rounded(self) -> Gaps:
        """Return the gaps as doubles."""
        return Gaps(*(x.rounded() for x in self))


class ArrayNumbers(GroupFacts):
    """The numbers of many motions by name, as bounded numbers; each is computed on first use.

    A name is that of a line of `keys`, of an input, or of a property of this class.  Angles are in
    radians.
    """

    def __init__(self, tops: TopArrays, regime: Regime | None, *, pairs: bool = False) -> None:
        """Take tops of one group, to be computed in doubles or in pairs of doubles."""
        super().__init__(regime)
        self.tops, self.pairs, self._has = tops, pairs, dict[str, Any]()
        for name in tops.inputs:
            if name != "psidot0" or regime is not Regime.STEADY:
                self[name] = tops.number(name, pairs=pairs)
        sine, cosine = tops.tilt.half(pairs=pairs)
        self["theta0"] = 2.0 * (sine * cosine), (cosine - sine) * (cosine + sine)
        self["above_u0"], self["below_u0"] = 2.0 * (sine * sine), 2.0 * (cosine * cosine)
        self["pi"] = pi_of(pairs=pairs)

    def __missing__(self, name: str) -> Any:
        if name in LINES:
            value = evaluated(LINES[name].evaluated, self)
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

    # the start

    @property
    def u0(self) -> Any:
        """The cosine of the tilt at the start."""
        return self["theta0"][1]

    @property
    def momentum(self) -> Any:
        """psi' sin^2(theta0) = beta - b u0 (4,5)."""
        return self["psidot0"] * self["theta0"][0] * self["theta0"][0]

    @property
    def beta_minus_b(self) -> Any:
        """beta - b."""
        return self["momentum"] - self["b"] * self["above_u0"]

    @property
    def beta_plus_b(self) -> Any:
        """beta + b."""
        return self["momentum"] + self["b"] * self["below_u0"]

    @property
    def square_of_steady(self) -> Any:
        """b^2 - 2 a cos(theta0), negative if there is no steady precession."""
        return self["b"] * self["b"] - 2.0 * self["a"] * self["u0"]

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
        """The gaps of motions that nutate.

        The largest root X = a (u3 - u0) leaves a quadratic with a negative last coefficient, so
        that its discriminant is a sum.  Its smaller root is a quotient.  Distances to a pole are
        differences, or quotients by f(1) = -(beta - b)^2 and f(-1) = -(beta + b)^2: the better one.
        """
        a, b, u0, above, below = (self[x] for x in ("a", "b", "u0", "above_u0", "below_u0"))
        sine, momentum = self["theta0"][0], self["momentum"]
        if self.steady:
            around, zero = self["psidot0"] * sine, Bounded(0.0)
            far = around * around + self["square_of_steady"]
            return Gaps(zero, zero, far, above, above, below, below, far - a * above)
        if self.released:
            far = released_root(0.5 * b * b - a * u0, a * sine)
            fall, a_above_u3 = a * sine * sine / far, far - a * above
            a_above_u3 = best(a_above_u3, b * b * above / (above + fall))
            below_u2 = best(below - fall, b * b * below / (far + a * below))
            return Gaps(Bounded(0.0), fall, far, above, above + fall, below, below_u2, a_above_u3)
        energy = self["thetadot0"] * self["thetadot0"] + momentum * self["psidot0"]
        along = sine * self["thetadot0"]
        c0 = along * along
        c1 = 2.0 * (b * momentum - u0 * energy) - a * sine * sine
        c2 = 2.0 * a * u0 - energy - b * b
        far = largest_root(c2, a * c1, a * (a * c0), self._above_all_roots(energy))
        total, product = (c1 + a * c0 / far) / far, c0 / far
        larger = (abs(total) + sqrt(total * total + 4.0 * product)) * 0.5
        smaller = product / larger
        upward = total.doubles >= 0
        rise, fall = choose(upward, larger, smaller), choose(upward, smaller, larger)
        north, south = self["beta_minus_b"], self["beta_plus_b"]
        below_u1, above_u2 = below + rise, above + fall
        a_above_u3 = far - a * above
        above_u1 = best(above - rise, north * north / (above_u2 * a_above_u3))
        a_above_u3 = best(a_above_u3, north * north / (above_u1 * above_u2))
        below_u2 = best(below - fall, south * south / (below_u1 * (far + a * below)))
        return Gaps(rise, fall, far, above_u1, above_u2, below_u1, below_u2, a_above_u3)

    def _above_all_roots(self, energy: Bounded) -> Array:
        a, b = self["a"].doubles, self["b"].doubles
        found: Array = energy.doubles + b * b + 2 * a
        return found

    @property
    def roots(self) -> tuple[Bounded, Bounded]:
        """The roots u2, from the nearer pole, and u1 of the cubic."""
        above, below = self["above_u2"], self["below_u2"]
        u1 = self["u0"] + self["rise"]
        u2 = choose(above.doubles < below.doubles, 1.0 - above, below - 1.0)
        return (u1, u1) if self.steady else (u2, u1)

    @property
    def height(self) -> Any:
        """u1 - u2."""
        return self["rise"] + self["fall"]

    @property
    def wide(self) -> Any:
        """a (u3 - u2)."""
        return self["far"] + self["a"] * self["fall"]

    @property
    def narrow(self) -> Any:
        """a (u3 - u1)."""
        return self["far"] - self["a"] * self["rise"]

    @property
    def m_k(self) -> Bounded:
        """k^2 (4,19)."""
        return Bounded(0.0) if self.steady else self["a"] * self["height"] / self["wide"]

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

        They are computed in doubles; in pairs, if the parts cancel.
        """
        r0 = self["r0"]
        if self.steady:
            return r0 - self["psidot0"] * self["u0"] * (not self.vertical), self["psidot0"]
        if self.plane:  # a half turn at the bottom
            half_turn = self["pi"] / self["T_nutation"]
            return half_turn, half_turn
        gaps, given = self["gaps"], (self["k_prime"], *self["momenta"])
        south, north = mean_parts(gaps.rounded(), *(x.rounded() for x in given))
        spin, precession = (r0 + south - north).rounded(), (south + north).rounded()
        lost = ~((spin.error <= _FINE * spin.size) & (precession.error <= _FINE * precession.size))
        if self.pairs and (rows := np.flatnonzero(lost)).size:
            some = Gaps(*(x[rows] for x in gaps))
            south, north = mean_parts(some, *(x[rows] for x in given))
            finer = r0[rows] + south - north, south + north
            for x, exact in zip((spin, precession), finer, strict=True):
                y = exact.rounded()
                x.value[rows], x.error[rows] = y.value, y.error
        return Bounded(spin.value, spin.error), Bounded(precession.value, precession.error)

    @property
    def half(self) -> tuple[Bounded, Bounded]:
        """The growth in half a period, an incomplete integral."""
        return UNKNOWN, UNKNOWN

    quarter = half

    @property
    def is_regular(self) -> Mask:
        """Whether the roots are certainly apart."""
        found: Mask = self["narrow"].surely(1) & self["height"].surely(1)
        return found

    @property
    def path(self) -> tuple[Any, Any]:
        """The path of the axis, and whether it is certain."""
        if self.regime is not None:
            return "cusped" if self.regime is Regime.REGULAR else None, True
        sign, ends = np.sign(self["b"].doubles), self["momenta"]
        looping = (sign * ends[0].doubles < 0) & (sign * ends[1].doubles > 0)
        certain = [x.size > x.error for x in (*ends, self["beta_minus_b"])] + [self["is_regular"]]
        words = np.array(["wavy", "looping"], dtype=object)
        return words[looping.astype(int)], np.logical_and.reduce(certain)


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
    unit = PAIR_EPS if isinstance(k_prime.value, DoubleDouble) else EPS
    of_momenta = np.maximum(_relative(x), _relative(y))
    mixed = np.flatnonzero(x.doubles * y.doubles < 0)
    found = []
    for (d1, d2), value in zip(ends, values, strict=True):
        of_d = np.maximum(d1.error / d1.size, d2.error / d2.size)
        rho = of_d + 2 * k_prime.error / k_prime.size + 10 * (steps + 1) * unit
        error = (rho + of_momenta) * size_of(value)
        if mixed.size:
            k, *d = (v.doubles[mixed] for v in (k_prime, d1, d2))
            sizes = (v.error[mixed] + rho[mixed] * v.size[mixed] for v in (x, y))
            error[mixed] = _means(k, [d], *sizes)[0][0]
        found.append(Bounded(value, error) * 0.5)
    return found


def _means(k_prime: Any, ends: Sequence[Any], x: Any, y: Any) -> tuple[list[Any], Any]:
    """Return the means over a period of (x cn^2 + y sn^2)/(d1 cn^2 + d2 sn^2) for each (d1, d2) of
    `ends`, and the number of steps of each top, on which its neighbours have no influence.

    It is Bulirsch's cel(k', p, x, y)/K (DLMF 19.2.11), p = k'^2 d2/d1, over d1.  Each step is
    Bartky's transformation (Bulirsch 1969), which keeps it and squares the distance of m from g.
    """
    close_to = 2.0**-52 if isinstance(k_prime, DoubleDouble) else 2.0**-26
    m, g, mc, states = 0.0 * k_prime + 1.0, k_prime, k_prime * k_prime, []
    for d1, d2 in ends:
        p = root_of(mc * d2 / d1)
        states.append((x / d1, y * mc / d1 / p, p))
    values, going = [v for v, _, _ in states], np.ones(high(k_prime).shape, dtype=np.bool_)
    steps = np.zeros(going.shape)
    while going.any():
        product = m * g
        for i, (v, w, p) in enumerate(states):
            q = product / p
            states[i] = (v + w / p) * 0.5, (w + v * q) * 0.5, (p + q) * 0.5
        still = going & (size_of(m - g) > close_to * high(m))
        m, g = (m + g) * 0.5, root_of(product)
        steps += going
        if (still != going).any():
            pick = DoubleDouble.choose if isinstance(m, DoubleDouble) else np.where
            last = [(v * m + w) / (m + p) for v, w, p in states]
            values = [pick(going, new, old) for new, old in zip(last, values, strict=True)]
        going = still
    return values, steps


def high(x: Any) -> Any:
    """Return a value as a double."""
    return x.high if isinstance(x, DoubleDouble) else x


def root_of(x: Any) -> Any:
    """Return the square root of a value."""
    return x.sqrt() if isinstance(x, DoubleDouble) else np.sqrt(x)


def largest_root(c2: Bounded, c1: Bounded, c0: Bounded, start: Array) -> Bounded:
    """Return the largest root of X^3 + c2 X^2 + c1 X + c0 by Newton's method from above.

    If f' changes by at most 1 % within 2 |f/f'|, the root is within 1.01 |f/f'|.
    """
    x, b2, b1, b0 = start, c2.doubles, c1.doubles, c0.doubles
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
    return Bounded(root, np.where(certain, 1.02 * error, np.inf))


def released_root(half: Bounded, a_sine: Bounded) -> Bounded:
    """Return a (u3 - u0) after release from rest, where u0 is a root and X^2 - 2 half X - (a sin)^2
    has the others."""
    square = a_sine * a_sine
    more = sqrt(half * half + square) + abs(half)
    return choose(half.doubles >= 0, more, square / more)
