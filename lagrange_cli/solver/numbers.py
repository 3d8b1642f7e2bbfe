"""The numbers of a motion: the formulas of `keys`, evaluated as they stand, in balls of Arb.

Formulas may lose digits: a ball that has lost too many is computed again with more.  This module
adds the functions that formulas use, the roots of the cubic, the mean of 1/(1 - u), and the limits.
Equation numbers are Chrapan's.
"""

# mypy: disable-error-code="no-any-return"

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from operator import itemgetter
from typing import Any

from flint import acb, arb, arb_poly, ctx

from ..arithmetic.enclosures import TooFewDigitsError, at_precision, exact, fraction, root, sign
from ..arithmetic.formulas import evaluated
from ..top.derived import rates_of, steady_roots
from .attitude import Course, course_of
from .facts import Facts
from .keys import LINES


def square(x: arb) -> arb:
    """Return the square of a number; `x**2` is NaN for a ball that contains 0."""
    return x * x


def acos(x: arb) -> arb:
    """Return the angle from 0 to pi with a cosine."""
    return arb.atan2(root(1 - square(x)), x)


def nome_of(k: arb, k_prime: arb) -> arb:
    """Return the nome exp(-pi K'/K); 0 for k = 0."""
    if k.is_zero():
        return arb(0)
    return (-arb.pi() * arb(1).agm(k_prime) / arb(1).agm(k)).exp()


def complete_E(k_prime: arb) -> arb:
    """Return the complete integral of the second kind E(k), 2 R_G(0, k'^2, 1)."""
    if k_prime.is_zero():
        return arb(1)
    return 2 * acb.elliptic_rg(acb(0), acb(square(k_prime)), acb(1)).real


def integral_F(sine: arb, cosine: arb, k: arb) -> arb:
    """Return Legendre's integral F(phi, k'), where k' is the complement of k.

    The sine and the cosine of phi may have a common positive factor.
    """
    s2, c2 = square(sine), square(cosine)
    terms = c2, c2 + square(k) * s2, c2 + s2
    return sine * acb.elliptic_rf(*map(acb, terms)).real


def ellint_E(phi: arb, k: arb) -> arb:
    """Return Legendre's incomplete integral of the second kind, E(phi, k)."""
    return acb.elliptic_e_inc(acb(phi), acb(square(k))).real


FUNCTIONS: dict[str, Any] = {
    "abs": abs,
    "acos": acos,
    "agm": lambda x, y: y.agm(arb(x)),
    "atan2": arb.atan2,
    "complete_E": complete_E,
    "cos": itemgetter(1),  # of theta0
    "ellint_E": ellint_E,
    "integral_F": integral_F,
    "max": lambda x, y: x.max(arb(y)),
    "nome_of": nome_of,
    "sin": itemgetter(0),
    "sqrt": root,
    "square": square,
}
"""The functions of formulas."""
_FORMULAS = {
    "beta_minus_b": "momentum_constant - b",
    "beta_plus_b": "momentum_constant + b",
    "roots_sum_a": "energy_constant + b**2",  # a (u1 + u2 + u3), by the coefficients of the cubic
    "above_u1": "1 - u1",
    "above_u2": "1 - u2",
    "below_u1": "1 + u1",
    "below_u2": "1 + u2",
    "height": "u1 - u2",
    "rise": "u1 - u0",
    "fall": "u0 - u2",
    "wide": "roots_sum_a - a*(u1 + 2*u2)",  # a (u3 - u2)
    "narrow": "roots_sum_a - a*(2*u1 + u2)",  # a (u3 - u1)
    "far": "wide - a*fall",  # a (u3 - u0)
}
"""Numbers that the formulas of `keys` use, and their formulas."""
_ZEROS: dict[str, Callable[[Facts], bool]] = {
    "beta_minus_b": lambda facts: not facts.minus,
    "beta_plus_b": lambda facts: not facts.plus,
    "height": lambda facts: facts.steady,
    "rise": lambda facts: facts.turning > 0,
    "fall": lambda facts: facts.turning < 0,
    "narrow": lambda facts: facts.separatrix,
    "m_k": lambda facts: facts.steady or not facts.a,
}
"""Whether the facts of a motion make a number exactly 0."""


class Numbers(dict[str, Any]):
    """The numbers of a motion by name, in balls of some digits; each is computed on first use.

    A name is that of an input, of a line of `keys`, of a formula above, or of a property.  Angles
    are in radians.  A number that needs more digits raises TooFewDigitsError.
    """

    def __init__(self, facts: Facts, digits: int) -> None:
        super().__init__(FUNCTIONS)
        self.facts, self.digits = facts, digits

    def __missing__(self, name: str) -> Any:
        compute = partial(self._value, name)
        value = self[name] = at_precision(self.digits, compute, checked=False)
        return value

    def _value(self, name: str) -> Any:
        if name in self.facts.inputs:
            return exact(self.facts.inputs[name])
        if name in _ZEROS and _ZEROS[name](self.facts):
            return arb(0)
        formula = LINES[name].evaluated if name in LINES else _FORMULAS.get(name)
        return evaluated(formula, self) if formula else getattr(self, name)

    @property
    def pi(self) -> arb:
        """The number pi."""
        return arb.pi()

    @property
    def theta0(self) -> tuple[arb, arb]:
        """Sine and cosine of the tilt at the start, exact if they are rational."""
        return self.facts.tilt.sine_and_cosine()

    # inputs that are derived

    @property
    def r0(self) -> arb:
        """The total spin rate, derived from the rate of phi."""
        return self.facts.r0.ball(self["psidot0"], self.facts.tilt)

    @property
    def psidot0(self) -> arb:
        """The rate of steady precession that a word names."""
        return rates_of(self.facts.top.given).rate(str(self.facts.top.steady_word))

    @property
    def steady_rates(self) -> tuple[arb, arb]:
        """The slow and the fast rate of steady precession at the tilt of the start."""
        return steady_roots(self["a"], self["b"], self["u0"], self.facts.spin)

    # the cubic f(u) = (alpha - a u)(1 - u^2) - (beta - b u)^2 (4,9); alpha is energy_constant

    @property
    def roots(self) -> tuple[arb, arb]:
        """The roots u2 and u1 of the cubic (4,9); the known ones are divided out."""
        facts, u0 = self.facts, self["u0"]
        if facts.steady:
            return u0, u0
        if facts.separatrix:  # the sum of the roots less 2
            return self["roots_sum_a"] / self["a"] - 2, arb(1)
        a, b = self["a"], self["b"]
        alpha, beta = self["energy_constant"], self["momentum_constant"]
        rest = arb_poly([alpha - square(beta), 2 * b * beta - a, -self["roots_sum_a"], a])
        known = [arb(1)] * (not facts.minus) + [arb(-1)] * (not facts.plus)
        known += [u0] * bool(facts.turning and not facts.pole)
        for known_root in known:
            rest //= arb_poly([-known_root, 1])
        found = sorted([*known, *_real_roots(rest)], key=_middle)
        if any(sign(upper - lower) <= 0 for lower, upper in pairwise(found)):
            raise TooFewDigitsError
        return found[0], found[1]

    @property
    def m_k_prime(self) -> arb:
        """k'^2 (4,21)."""
        return arb(1) if self["m_k"].is_zero() else self["narrow"] / self["wide"]

    # means and growth over time

    def pole_integral(self, pole: int) -> arb:
        """Return Q (pole = 1) or P (pole = -1): K times the mean of (beta + b pole)/(1 + u pole).

        The mean is that of `mean_of_inverse`, in place of the integral (3,8).
        If the axis passes over the pole where 1 + u pole = 0, psi + pole phi grows by a whole turn
        per period there.  On the vertical all of the rotation counts as spin.
        """
        facts = self.facts
        if facts.vertical:
            return pole * self["b"] * self["K"]
        if facts.over_bottom if pole > 0 else facts.over_top:
            return 2 * self["pi"] * self["K"] / self["T_nutation"]
        momentum = self["beta_plus_b" if pole > 0 else "beta_minus_b"]
        at_u1, at_u2 = 1 + pole * self["u1"], 1 + pole * self["u2"]
        return momentum * self["K"] * mean_of_inverse(at_u1, at_u2, self["m_k_prime"])

    @property
    def means(self) -> tuple[arb, arb]:
        """The mean rates of spin and precession; on the vertical all of the rotation is spin."""
        if self.facts.vertical:
            return self["r0"], arb(0)
        P, Q, double_K = self["P"], self["Q"], 2 * self["K"]
        return self["r0"] - self["b"] - (P - Q) / double_K, (P + Q) / double_K

    @property
    def course(self) -> Course:
        """The constants of the attitude over time."""
        return course_of(self.facts, self)

    @property
    def half(self) -> tuple[arb, arb]:
        """The growth of spin and precession in half a period after the start."""
        since = self["course"].since
        return self["course"].growth(since, since + arb(0.5))

    @property
    def quarter(self) -> tuple[arb, arb]:
        """The growth of spin and precession in the quarter after a passage of u1."""
        return self["course"].growth(arb(0), arb(0.25))


def _real_roots(polynomial: arb_poly) -> list[arb]:
    """Return the roots of a polynomial of degree 0 to 3 whose roots are real and simple."""
    *others, first = polynomial.coeffs()
    others = [x / first for x in others]
    if len(others) < 2:
        return [-x for x in others]
    if len(others) == 2:
        half = -others[1] / 2
        apart = (square(half) - others[0]).sqrt()
        return [half - apart, half + apart]
    c0, c1, c2 = others  # Viete's cosines, in u = 2 size cos(angle) + centre
    centre = -c2 / 3
    size = (square(centre) - c1 / 3).sqrt()
    cosine = (square(centre) * centre - (c1 * centre + c0) / 2) / (square(size) * size)
    angle = cosine.acos() / 3
    return [2 * size * (angle + 2 * i * arb.pi() / 3).cos() + centre for i in range(3)]


def _middle(x: arb) -> Any:
    if not x.is_finite():
        raise TooFewDigitsError
    return fraction(x.mid())


def mean_of_inverse(at_u1: arb, at_u2: arb, m_k_prime: arb) -> arb:
    """Return the mean over a period of 1/d, where d > 0 is linear in u, from d at u1 and u2.

    By (4,20), d = d2 cos^2 x + d1 sin^2 x, where x is the amplitude counted from u2.  The mean has
    the weight M/sqrt(cos^2 x + k'^2 sin^2 x), where M is the arithmetic-geometric mean of 1 and k'.
    Bartky's transformation (Bulirsch 1969) replaces x and leaves the mean of

        (A m^2 cos^2 x + B p sin^2 x)/(m^2 cos^2 x + p^2 sin^2 x)

    with the weight M/sqrt(m^2 cos^2 x + g^2 sin^2 x) as it is, while m and g approach M.  In the
    end they are equal within their radii.  With the weight 1 the mean is (A m + B)/(m + p), and the
    true weight lies between g/m and m/g.
    """
    p, m, g = root(at_u1 / at_u2), arb(1), root(m_k_prime)
    A, B = arb(1), 1 / p
    for _ in range(ctx.prec):
        A, B, p = (A + B / p) / 2, (B + A * m * g / p) / 2, (p + m * g / p) / 2
        m, g = (m + g) / 2, root(m * g)
        if m.overlaps(g):
            break
    value, ratio = (A * m + B) / (m + p) / at_u2, g / m
    return (value * ratio).union(value / ratio)
