"""Roots and elliptic constants of one motion, in balls."""

from __future__ import annotations

from fractions import Fraction
from functools import cached_property
from itertools import pairwise

from flint import arb, arb_poly, ctx

from balls.scene import Scene, Undecided, exact_arb, facts_of, middle, rational


class Constants:
    """The constants at one precision; each raises Undecided where that is too low."""

    def __init__(self, scene: Scene) -> None:
        """Compute the constants at the precision of the context."""
        self.scene, self.facts = scene, facts_of(scene)
        self.a, self.b, self.r0 = exact_arb(scene.a), exact_arb(scene.b), exact_arb(scene.r0)
        self.rise, self.turn = exact_arb(scene.theta_rate), exact_arb(scene.psi_rate)
        if scene.degrees is not None:
            self.tilt = exact_arb(scene.degrees / 180) * arb.pi()
            self.u0 = arb.cos_pi_fmpq(rational(scene.degrees / 180))
            self.sine2 = arb.sin_pi_fmpq(rational(scene.degrees / 180)) ** 2
        else:
            self.tilt = exact_arb(scene.radians or Fraction(0))
            self.u0, self.sine2 = self.tilt.cos(), self.tilt.sin() ** 2
        if self.facts.pole:
            self.u0, self.sine2 = arb(self.facts.pole), arb(0)
        energy = self.rise**2 + self.turn**2 * self.sine2
        self.alpha = energy + self.a * self.u0
        self.beta = self.turn * self.sine2 + self.b * self.u0
        self.from_b = arb(0) if self.facts.over_top else self.beta - self.b
        self.from_minus_b = arb(0) if self.facts.over_bottom else self.beta + self.b
        self.u2, self.u1 = self._roots()
        self.size = self.alpha + self.b**2

    def _roots(self) -> tuple[arb, arb]:
        """Return u2 and u1."""
        facts, one, size = self.facts, arb(1), self.alpha + self.b**2
        if facts.steady:
            return self.u0, self.u0
        if facts.separatrix:
            return size / self.a - 2, one
        known = [one] if facts.over_top else []
        known += [-one] if facts.over_bottom else []
        if not (self.scene.theta_rate or facts.pole):
            known.append(self.u0)
        others = self._others(known)
        u2, u1 = _sorted(known + others)[:2]
        return u2, u1

    def _others(self, known: list[arb]) -> list[arb]:
        """Return the roots that are not known exactly."""
        coefficients = [
            self.alpha - self.beta**2,
            2 * self.b * self.beta - self.a,
            -(self.alpha + self.b**2),
            self.a,
        ]
        if self.scene.a == 0:
            coefficients.pop()
        for root in known:  # synthetic division, from the highest coefficient down
            quotient = [coefficients[-1]]
            for coefficient in coefficients[-2:0:-1]:
                quotient.append(quotient[-1] * root + coefficient)
            coefficients = quotient[::-1]
        degree = len(coefficients) - 1
        if degree == 0:
            return []
        if degree == 1:
            return [-coefficients[0] / coefficients[1]]
        if degree == 2:
            half = -coefficients[1] / (2 * coefficients[2])
            radical = half**2 - coefficients[0] / coefficients[2]
            if not radical > 0:
                raise Undecided("two roots")
            return [half - radical.sqrt(), half + radical.sqrt()]
        cubic = arb_poly(coefficients)
        lowest = _root_from(cubic, arb(-1))
        largest = _root_from(cubic, 2 + (self.alpha + self.b**2) / self.a)
        return [lowest, (self.alpha + self.b**2) / self.a - lowest - largest, largest]

    @cached_property
    def u3(self) -> arb | None:
        """The third root, from the sum; None without torque."""
        if self.facts.separatrix:
            return arb(1)
        return self.size / self.a - self.u1 - self.u2 if self.scene.a else None

    @cached_property
    def above_u1(self) -> arb:
        """1 - u1."""
        return arb(0) if self.passes_top or self.facts.separatrix else 1 - self.u1

    @cached_property
    def below_u2(self) -> arb:
        """1 + u2."""
        return arb(0) if self.passes_bottom else 1 + self.u2

    @cached_property
    def passes_top(self) -> bool:
        """Whether the axis passes through the upper pole: 1 is u1 and not u3."""
        if not self.facts.over_top or self.facts.steady or self.facts.separatrix:
            return False
        falls = self.alpha - self.a  # -f'(1)/2
        if falls.contains(0):
            raise Undecided("which root is 1")
        return bool(falls > 0)

    @property
    def passes_bottom(self) -> bool:
        return self.facts.over_bottom and not self.facts.steady

    @cached_property
    def band(self) -> arb:
        """u1 - u2."""
        return arb(0) if self.facts.steady else self.u1 - self.u2

    @cached_property
    def wide(self) -> arb:
        """a (u3 - u2); 0 where nothing moves at all."""
        if self.idle:
            return arb(0)
        wide = self.size - self.a * (self.u1 + 2 * self.u2)
        if not wide > 0:
            raise Undecided("a (u3 - u2)")
        return wide

    @cached_property
    def m(self) -> arb:
        """k^2."""
        if self.facts.separatrix:
            return arb(1)
        return arb(0) if self.facts.steady or self.idle else self.a * self.band / self.wide

    @property
    def idle(self) -> bool:
        """Whether there is no torque, no spin and no other motion."""
        return self.facts.steady and not (self.scene.a or self.scene.b or self.scene.psi_rate)

    @cached_property
    def m1(self) -> arb:
        """k'^2, from its own numerator."""
        if self.facts.separatrix or self.m.is_zero():
            return arb(0) if self.facts.separatrix else arb(1)
        narrow = self.size - self.a * (2 * self.u1 + self.u2)
        if not narrow > 0:
            raise Undecided("a (u3 - u1)")
        return narrow / self.wide

    @cached_property
    def K(self) -> arb:
        """The quarter period, by the arithmetic-geometric mean."""
        return arb.pi() / (2 * arb(1).agm(self.m1.sqrt()))

    @cached_property
    def K_prime(self) -> arb | None:
        """The complementary one; None where k = 0."""
        if self.m.is_zero():
            return None
        return arb.pi() / (2 * arb(1).agm(self.m.sqrt()))

    @cached_property
    def speed(self) -> arb:
        """dw/dt (4,30)."""
        return self.wide.sqrt() / 2

    @cached_property
    def T(self) -> arb:
        """The nutation period (5,1)."""
        return 2 * self.K / self.speed


def _root_from(polynomial: arb_poly, outside: arb) -> arb:
    """Return the real root next to a point outside all of them.

    Newton's method gets there steadily; an interval step then proves that a root is in the ball.
    """
    slope = polynomial.derivative()
    point, tiny = outside.mid(), arb(2) ** (8 - ctx.prec)
    for _ in range(20 * ctx.prec):
        step = (polynomial(point) / slope(point)).mid()
        if not abs(step) > tiny * abs(point):
            break
        point = (point - step).mid()
    ball = arb(point, 4 * (polynomial(point) / slope(point)).abs_upper() + tiny)
    proved = point - polynomial(point) / slope(ball)
    if not (proved.is_finite() and ball.contains(proved)):
        raise Undecided("a root")
    return proved


def _sorted(roots: list[arb]) -> list[arb]:
    """Return the roots in order; raise Undecided where two of them overlap."""
    ordered = sorted(roots, key=middle)
    for low, high in pairwise(ordered):
        if not low < high:
            raise Undecided("the order of the roots")
    return ordered
