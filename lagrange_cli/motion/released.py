"""The paper's case: a top released from rest, thetadot0 = psidot0 = 0 (sections 4 to 7).

The formulas take the arithmetic as a parameter (see `elliptic`) and are arranged so that every
number is a sum or product of positive ones: nothing cancels, from the slowest top to the fastest,
and plain doubles are good to about 5 eps.  Equation numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

from functools import cached_property

from ..arithmetic.generic import Arithmetic, Real, number, where
from ..elliptic import carlson_rf, complete_k, nome, period_mean
from ..inputs.top import Tilt, Top
from .record import NUMBER_KEYS, Record, Regime, constant_rates, period_of
from .roots import Invariants, Roots, invariants, roots_from_rest


def released_record(ar: Arithmetic, top: Top) -> Record:
    """The record of a top released from rest, in the arithmetic given."""
    regime, inv, tilt, r0 = _classify(top), invariants(ar, top), top.tilt(ar), number(ar, top.r0)
    if regime in STILL:
        numbers = unmoved(ar, regime, inv, tilt, r0)
        return Record(top, regime, **numbers, remark=remark(regime, inv.lam_minus_1 >= 0))
    motion = Nutation(ar, inv, tilt, r0, spins=regime is Regime.REGULAR)
    numbers = {key: getattr(motion, key) for key in NUMBER_KEYS}
    return Record(top, regime, **numbers, path=motion.path)


STILL = (Regime.TORQUE_FREE, Regime.SLEEPING, Regime.HANGING)
"""The regimes in which a top that is released from rest stays as it is."""


def _classify(top: Top) -> Regime:
    if top.pole:
        return Regime.SLEEPING if top.pole > 0 else Regime.HANGING
    if top.s == 0 or top.g == 0:
        return Regime.TORQUE_FREE
    return Regime.NO_SPIN if top.r0 == 0 else Regime.REGULAR


def modulus(ar: Arithmetic, roots: Roots) -> Real:
    """k (4,19)."""
    return ar.sqrt(roots.u1_u2 / roots.u3_u2)


def complement(ar: Arithmetic, roots: Roots) -> Real:
    """k' (4,21), from its own numerator."""
    return ar.sqrt(roots.u3_u1 / roots.u3_u2)


def phase_rate(ar: Arithmetic, a: Real, roots: Roots) -> Real:
    """dw/dt of w = sqrt(a (u3 - u2)) t / 2 (4,30)."""
    return ar.sqrt(a * (roots.u3_u2 / 4))


def amplitude(ar: Arithmetic, roots: Roots) -> Real:
    """The amplitude of alpha (7,2), by its tangent."""
    return ar.atan2(ar.sqrt(roots.u3_u2), ar.sqrt(roots.below_u2))


def parameter_alpha(ar: Arithmetic, roots: Roots) -> Real:
    """alpha = F(amplitude, k') (1,6), as a Carlson integral of the gaps."""
    return ar.sqrt(roots.u3_u2) * carlson_rf(ar, roots.below_u2, roots.below_u1, roots.below_u3)


def u_quarter(roots: Roots, k_prime: Real) -> Real:
    """u(T/4) (5,2), written from u1 downwards so that a large u3 does no harm."""
    return roots.u1 - roots.u1_u2 * (k_prime / (1 + k_prime))


def mean_precession_rate(ar: Arithmetic, b: Real, roots: Roots, k_prime: Real, tilt: Tilt) -> Real:
    """(7,3) as a sum of two positive means, complete integrals of the third kind over K.

    psi' = b (u1 - u)/(1 - u^2) (4,7) splits at the poles u = +-1 into partial fractions; the
    parameters of the two integrals are (u3 -+ 1)/(u3 - u2).
    """
    south = period_mean(ar, k_prime, roots.u3_above / roots.u3_u2, 0, 1)
    north = period_mean(ar, k_prime, roots.below_u3 / roots.u3_u2, 0, 1)
    weighted = tilt.sin_half * (tilt.sin_half * south) + tilt.cos_half * (tilt.cos_half * north)
    return b * (weighted / roots.u3_u2)


class Nutation:
    """Sections 4 to 7; also r0 = 0, as the limit r0 -> +0.

    The numbers of a record under their keys, each computed once and only when it is asked for; of
    one top, or of an array of tops that all spin or all do not.
    """

    def __init__(
        self, ar: Arithmetic, inv: Invariants, tilt: Tilt, r0: Real, *, spins: bool
    ) -> None:
        self.ar, self.inv, self.tilt, self.r0, self.spins = ar, inv, tilt, r0, spins
        self.a, self.b = inv.a, inv.b
        self.precession_rate_start = 0 * inv.a
        self.path = "cusped" if spins else None

    @cached_property
    def roots(self) -> Roots:
        """Roots of the cubic, and their gaps."""
        return roots_from_rest(self.ar, self.inv.lam, self.inv.lam_minus_1, self.tilt)

    @property
    def u1(self) -> Real:
        """cos(theta0)."""
        return self.tilt.cos

    @property
    def u2(self) -> Real:
        """(4,11)."""
        return self.roots.u2

    @property
    def u3(self) -> Real:
        """(4,11)."""
        return self.roots.u3

    @cached_property
    def k(self) -> Real:
        """(4,19)."""
        return modulus(self.ar, self.roots)

    @cached_property
    def k_prime(self) -> Real:
        """(4,21)."""
        return complement(self.ar, self.roots)

    @property
    def modular_angle_deg(self) -> Real:
        """arcsin k."""
        return self.ar.atan2(self.k, self.k_prime) / self._degree

    @property
    def _degree(self) -> Real:
        return self.ar.pi / 180

    @property
    def nome(self) -> Real:
        """(2,4)."""
        return nome(self.ar, m=self.roots.u1_u2 / self.roots.u3_u2, k_prime=self.k_prime)

    @cached_property
    def K(self) -> Real:
        """Complete integral of the first kind."""
        return complete_k(self.ar, self.k_prime)

    @cached_property
    def K_prime(self) -> Real:
        """The same of the complement."""
        return complete_k(self.ar, self.k)

    @property
    def E(self) -> Real:
        """Second kind, by Legendre's relation as a sum of positive terms that are exact at k = 1:

        E = pi/2K' + K (K' - E')/K'."""
        rest = period_mean(self.ar, self.k, 1, 0, self.k_prime * self.k_prime)
        return self.ar.pi / (2 * self.K_prime) + self.K * rest

    @property
    def amplitude_deg(self) -> Real:
        """(7,2)."""
        return amplitude(self.ar, self.roots) / self._degree

    @property
    def alpha(self) -> Real:
        """(1,6)."""
        return parameter_alpha(self.ar, self.roots)

    @cached_property
    def T_nutation(self) -> Real:
        """(5,1)."""
        return 2 * self.K / phase_rate(self.ar, self.a, self.roots)

    @property
    def T_spin(self) -> Real:
        """Section 8."""
        return period_of(self.mean_spin_rate, 2 * self.ar.pi)

    @property
    def T_precession(self) -> Real:
        """Section 8."""
        return period_of(self.mean_precession_rate, 2 * self.ar.pi)

    @property
    def u_quarter(self) -> Real:
        """(5,2)."""
        return u_quarter(self.roots, self.k_prime)

    @property
    def theta_min_deg(self) -> Real:
        """The tilt at the start."""
        return self.tilt.degrees(self.ar)

    @property
    def theta_max_deg(self) -> Real:
        """The tilt at u2."""
        above, below = self.roots.above_u2, self.roots.below_u2
        return 2 * self.ar.atan2(self.ar.sqrt(above), self.ar.sqrt(below)) / self._degree

    @cached_property
    def mean_spin_rate(self) -> Real:
        """(6,3): a drift, and a turn in the sense of the spin every nutation."""
        half_turns = self.ar.pi / self.T_nutation
        return self.inv.drift + where(self.r0 < 0, -half_turns, half_turns)

    @cached_property
    def mean_precession_rate(self) -> Real:
        """(7,3); without spin, half a turn at each pass of the bottom."""
        if not self.spins:
            return self.ar.pi / self.T_nutation
        return mean_precession_rate(self.ar, self.b, self.roots, self.k_prime, self.tilt)

    @property
    def spin_rate_start(self) -> Real:
        """(6,2)."""
        return self.r0

    @property
    def spin_rate_half(self) -> Real | None:
        """(6,2) at T/2."""
        return self.r0 - self.inv.rate_half * self.roots.u2 if self.spins else None

    @property
    def precession_rate_half(self) -> Real | None:
        """(4,7) at T/2."""
        return self.inv.rate_half


def unmoved(
    ar: Arithmetic, regime: Regime, inv: Invariants, tilt: Tilt, r0: Real
) -> dict[str, Real | None]:
    """No torque, or upright, or hanging: the top turns about its own axis and does nothing else.

    On the vertical only the sum (upright) or the difference (hanging) of the two angles has a
    meaning; all of it is counted as spin.  Without torque the nutation period is that of a small
    disturbance.
    """
    numbers = {"a": inv.a, "b": inv.b, "u1": tilt.cos, "u2": tilt.cos}
    if regime is not Regime.TORQUE_FREE:
        return numbers | constant_rates(tilt.degrees(ar), r0, None, 2 * ar.pi)
    zero = 0 * tilt.sin
    quarter = ar.pi / 2 + zero
    without_torque = {
        "k": zero,
        "k_prime": zero + 1,
        "modular_angle_deg": zero,
        "nome": zero,
        "K": quarter,
        "E": quarter,
        "T_nutation": period_of(inv.b, 2 * ar.pi),
    }
    return numbers | without_torque | constant_rates(tilt.degrees(ar), r0, zero, 2 * ar.pi)


def remark(regime: Regime, stable: bool) -> str | None:
    """What there is to add; `stable` says whether lambda >= 1."""
    if regime is Regime.HANGING:
        return "only phi - psi is defined; stable"
    if regime is Regime.SLEEPING:
        found, sign = ("stable", ">=") if stable else ("unstable", "<")
        return f"only phi + psi is defined; {found} (lambda = b^2/2a {sign} 1)"
    return None
