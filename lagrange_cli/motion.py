"""The constants of one motion: regime, roots, moduli, periods and mean rates (paper, sections 4-7).

The formulas take the arithmetic as a parameter (see `elliptic`) and are arranged so that every
number is a sum or product of positive ones: nothing cancels, from the slowest top to the fastest,
and plain doubles are good to about 5 eps.  `solve` uses 40-digit decimals and rounds once.
Equation numbers in parentheses are those of Chrapan (1952).
"""

from __future__ import annotations

import math
from decimal import localcontext
from enum import Enum
from fractions import Fraction
from typing import TYPE_CHECKING, NamedTuple

from . import decimals
from .elliptic import Arithmetic, Real, carlson_rf, complete_e, complete_k, nome, period_mean, where
from .top import LagtopError, Tilt, Top, number

if TYPE_CHECKING:
    from numpy.typing import ArrayLike

    from .angles import Angles, Sampler

WORKING_DIGITS = 50
"""Digits of the constants behind the sampled angles; 34 would do, the rest is margin."""


class Regime(Enum):
    """What kind of motion a scene describes; decided once, exactly, from the inputs."""

    REGULAR = "regular"
    NO_SPIN = "no spin"
    TORQUE_FREE = "torque-free"
    SLEEPING = "sleeping"
    HANGING = "hanging"

    @property
    def is_steady(self) -> bool:
        """Whether the tilt stays where it is and both rates are constant."""
        return self in (Regime.TORQUE_FREE, Regime.SLEEPING, Regime.HANGING)


class Invariants(NamedTuple):
    """Ratios of the inputs, each rounded once from its exact value."""

    a: Real
    """2mgs/A (4,4)."""
    b: Real
    """C r0/A (4,5)."""
    lam: Real
    """lambda = b^2/2a = (u3 + u2)/2 (4,11); the upright top sleeps stably where it is >= 1."""
    lam_minus_1: Real
    drift: Real
    """r0 (1 - C/2A), the part of the spin rate that does not come from the nutation (6,1)."""
    rate_half: Real | None
    """2mgs/(C r0) = a/b, the precession rate at T/2; None without spin."""


class Roots(NamedTuple):
    """Roots u2 <= u1 <= 1 <= u3 of the cubic (4,9), and the gaps between them and the poles +-1.

    The gaps are what the formulas need, and taken apart like this none of them is a difference.
    """

    u1: Real
    u2: Real
    u3: Real
    u1_u2: Real
    u3_u1: Real
    u3_u2: Real
    below_u1: Real
    """1 + u1."""
    below_u2: Real
    """1 + u2."""
    below_u3: Real
    """1 + u3."""
    above_u2: Real
    """1 - u2."""
    u3_above: Real
    """u3 - 1."""


class Motion(NamedTuple):
    """One motion, solved: the numbers of its record, under their keys, and its angles over time.

    A number that the regime does not have is None.
    """

    top: Top
    regime: Regime
    a: Real
    b: Real
    u1: Real | None = None
    u2: Real | None = None
    u3: Real | None = None
    k: Real | None = None
    k_prime: Real | None = None
    modular_angle_deg: Real | None = None
    nome: Real | None = None
    K: Real | None = None
    K_prime: Real | None = None
    E: Real | None = None
    amplitude_deg: Real | None = None
    alpha: Real | None = None
    T_nutation: Real | None = None
    T_spin: Real | None = None
    T_precession: Real | None = None
    u_quarter: Real | None = None
    theta_min_deg: Real | None = None
    theta_max_deg: Real | None = None
    mean_spin_rate: Real | None = None
    mean_precession_rate: Real | None = None
    spin_rate_start: Real | None = None
    spin_rate_half: Real | None = None
    precession_rate_start: Real | None = None
    precession_rate_half: Real | None = None

    def numbers(self) -> dict[str, Real | None]:
        """The results by key, without the top and the regime."""
        return dict(zip(self._fields[2:], self[2:], strict=True))

    def record(self, *, radians: bool = False) -> dict[str, Real | str | None]:
        """Inputs and results by key, in the order of the paper; `radians` renames _deg to _rad."""
        inputs = self.top.inputs(radians=radians)
        results = self.numbers()
        results["theta_min_deg"] = self.top.inputs()["theta0_deg"]  # it starts there, at rest
        if radians:
            results = {_in_radians(key): _radians(key, x) for key, x in results.items()}
            results["theta_min_rad"] = inputs["theta0_rad"]
        return inputs | {"regime": self.regime.value} | results

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Tilt, spin and precession (radians) at the times t, in the shape of t.

        Spin and precession are unwrapped and 0 at t = 0; `wrap` brings them to (-pi, pi].
        Raises LagtopError for a time that is not finite or beyond 2^50 nutation periods.
        """
        return self.sampler().angles(t, wrap=wrap)

    def sampler(self) -> Sampler:
        """The series behind `angles`, to be kept where many blocks of times follow."""
        from .angles import steady_sampler, theta_sampler

        ar = many_digits(WORKING_DIGITS)
        if self.regime.is_steady:
            theta = _angle(ar, self.top.tilt(ar))
            return steady_sampler(ar, theta, number(ar, self.top.r0), ar.mpf(0))
        exact, roots = solve_in(ar, self.top), _roots(ar, self.top)
        period: Real = exact.T_nutation
        return theta_sampler(
            ar,
            period=period,
            quarter=exact.K,
            quarter_prime=exact.K_prime,
            eta_plus=_eta_plus(ar, roots),
            eta_minus=exact.alpha,
            x_size=ar.sqrt(roots.below_u1 / 2),
            y_size=ar.sqrt(exact.k_prime * roots.above_u2 / 2),
            spin=exact.mean_spin_rate * period,
            precession=exact.mean_precession_rate * period,
            sign_plus=spin_sign(self.top),
            sign_minus=-spin_sign(self.top),
        )


def solve(top: Top) -> Motion:
    """The constants of the motion of a top released from rest (thetadot0 = psidot0 = 0).

    Every number is the double nearest to its exact value.  Raises LagtopError for a start that is
    not at rest, and where a number leaves the range of doubles.
    """
    with localcontext(decimals.context()):
        exact = solve_in(decimals, top)
        rounded = {name: _double(name, value) for name, value in exact.numbers().items()}
    return Motion(top=top, regime=exact.regime, **rounded)


def solve_in(ar: Arithmetic, top: Top) -> Motion:
    """`solve` in the arithmetic given, its numbers not rounded to doubles."""
    if top.thetadot0 != 0 or top.psidot0 != 0:
        name = "thetadot0" if top.thetadot0 != 0 else "psidot0"
        raise LagtopError(
            f"{name} must be 0 (only tops released from rest are solved yet), "
            f"got {float(getattr(top, name))}",
            name,
        )
    regime = classify(top)
    return (_unmoved if regime.is_steady else _released)(ar, top, regime)


def _in_radians(key: str) -> str:
    return key.removesuffix("deg") + "rad" if key.endswith("_deg") else key


def _radians(key: str, value: Real | None) -> Real | None:
    return math.radians(value) if key.endswith("_deg") and value is not None else value


def _double(name: str, value: Real | None) -> float | None:
    if value is None:
        return None
    nearest = float(value)
    if not math.isfinite(nearest):
        raise LagtopError(
            f"{name} must be within 1.8e308 in size, got {value:.3e}: change the units"
        )
    return nearest


def classify(top: Top) -> Regime:
    """The regime of a top released from rest, by exact comparison of the inputs."""
    if top.s == 0 or top.g == 0:
        return Regime.TORQUE_FREE
    if top.theta0_deg == 0 or top.theta0_rad == 0:
        return Regime.SLEEPING
    if top.theta0_deg == 180:
        return Regime.HANGING
    return Regime.NO_SPIN if top.r0 == 0 else Regime.REGULAR


def many_digits(digits: int) -> Arithmetic:
    """An mpmath context of its own: nobody else's precision is touched."""
    import mpmath

    context = mpmath.mp.clone()
    context.dps = digits
    return context


def spin_sign(top: Top) -> int:
    """sigma = sgn r0, which the paper takes as +1; +1 also for the limit r0 -> 0."""
    return -1 if top.r0 < 0 else 1


def invariants(ar: Arithmetic, top: Top) -> Invariants:
    """(4,4), (4,5) and their combinations, formed as exact fractions and rounded once."""
    m, A, C, s, g, r0 = (Fraction(x) for x in (top.m, top.A, top.C, top.s, top.g, top.r0))
    torque = m * g * s
    lam = C * C * r0 * r0 / (4 * A * torque) if torque else Fraction(0)
    exact = Invariants(
        a=2 * torque / A,
        b=C * r0 / A,
        lam=lam,
        lam_minus_1=lam - 1,
        drift=r0 * (1 - C / (2 * A)),
        rate_half=2 * torque / (C * r0) if r0 else None,
    )
    return Invariants(*(None if x is None else number(ar, x) for x in exact))


def _roots(ar: Arithmetic, top: Top) -> Roots:
    inv = invariants(ar, top)
    return roots_from_rest(ar, inv.lam, inv.lam_minus_1, top.tilt(ar))


def roots_from_rest(ar: Arithmetic, lam: Real, lam_minus_1: Real, tilt: Tilt) -> Roots:
    """Roots of (4,9) for release from rest, from (4,11)-(4,18) without a cancelling difference.

    With S, Q = sin^2, cos^2 of theta0/2:  (u3 - u1)(u1 - u2) = 4 S Q,
    (u3 - 1)(1 - u2) = 4 lam S,  (u3 + 1)(1 + u2) = 4 lam Q; in each pair the larger factor is a sum
    of positive terms and the smaller one the quotient.
    """
    S, Q = tilt.sin_half * tilt.sin_half, tilt.cos_half * tilt.cos_half
    x = where(S <= Q, lam_minus_1 + 2 * S, (lam + 1) - 2 * Q)
    rho = ar.hypot(x, tilt.sin)
    larger = rho + abs(x)
    smaller = tilt.sin * (tilt.sin / larger)
    larger_1 = rho + abs(lam_minus_1)
    smaller_1 = 4 * lam * S / larger_1
    fast = lam_minus_1 >= 0
    above_u2 = where(fast, smaller_1, larger_1)
    u3_above = where(fast, larger_1, smaller_1)
    below_u3 = lam + 1 + rho
    below_u2 = 4 * lam * Q / below_u3
    return Roots(
        u1=tilt.cos,
        u2=where(above_u2 < below_u2, 1 - above_u2, below_u2 - 1),
        u3=where(fast, lam + rho, 1 + u3_above),
        u1_u2=where(x >= 0, smaller, larger),
        u3_u1=where(x >= 0, larger, smaller),
        u3_u2=2 * rho,
        below_u1=2 * Q,
        below_u2=below_u2,
        below_u3=below_u3,
        above_u2=above_u2,
        u3_above=u3_above,
    )


def _angle(ar: Arithmetic, tilt: Tilt) -> Real:
    return 2 * ar.atan2(tilt.sin_half, tilt.cos_half)


def _degrees(ar: Arithmetic, angle: Real) -> Real:
    return angle * 180 / ar.pi


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


def _eta_plus(ar: Arithmetic, roots: Roots) -> Real:
    """K' - alpha, again without the difference: F of the complementary amplitude."""
    middle = roots.u1_u2 * (roots.below_u3 / roots.u3_u2)
    return ar.sqrt(roots.below_u2) * carlson_rf(ar, roots.u1_u2, middle, roots.below_u1)


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


def _released(ar: Arithmetic, top: Top, regime: Regime) -> Motion:
    """Sections 4-7 for release from rest; also r0 = 0, as the limit r0 -> +0."""
    inv, roots = invariants(ar, top), _roots(ar, top)
    tilt = top.tilt(ar)
    k, k_prime = modulus(ar, roots), complement(ar, roots)
    K = complete_k(ar, k_prime)
    T = 2 * K / phase_rate(ar, inv.a, roots)
    sigma, spins = spin_sign(top), regime is Regime.REGULAR
    spin = inv.drift + sigma * (ar.pi / T)
    precession = mean_precession_rate(ar, inv.b, roots, k_prime, tilt) if spins else ar.pi / T
    return Motion(
        top=top,
        regime=regime,
        a=inv.a,
        b=inv.b,
        u1=roots.u1,
        u2=roots.u2,
        u3=roots.u3,
        k=k,
        k_prime=k_prime,
        modular_angle_deg=_degrees(ar, ar.atan2(k, k_prime)),
        nome=nome(ar, m=roots.u1_u2 / roots.u3_u2, k_prime=k_prime),
        K=K,
        K_prime=complete_k(ar, k),
        E=complete_e(ar, k_prime),
        amplitude_deg=_degrees(ar, amplitude(ar, roots)),
        alpha=parameter_alpha(ar, roots),
        T_nutation=T,
        T_spin=2 * ar.pi / abs(spin),
        T_precession=2 * ar.pi / abs(precession),
        u_quarter=u_quarter(roots, k_prime),
        theta_min_deg=_degrees(ar, _angle(ar, tilt)),
        theta_max_deg=_degrees(ar, 2 * ar.atan2(ar.sqrt(roots.above_u2), ar.sqrt(roots.below_u2))),
        mean_spin_rate=spin,
        mean_precession_rate=precession,
        spin_rate_start=number(ar, top.r0),
        spin_rate_half=number(ar, top.r0) - inv.rate_half * roots.u2 if spins else None,
        precession_rate_start=0 * T,
        precession_rate_half=inv.rate_half,
    )


def _unmoved(ar: Arithmetic, top: Top, regime: Regime) -> Motion:
    """No torque, or upright, or hanging: the top turns about its own axis and does nothing else.

    On the vertical only the sum (upright) or the difference (hanging) of the two angles has a
    meaning; all of it is counted as spin.
    """
    inv = invariants(ar, top)
    theta, spin = _degrees(ar, _angle(ar, top.tilt(ar))), number(ar, top.r0)
    return Motion(
        top=top,
        regime=regime,
        a=inv.a,
        b=inv.b,
        u1=top.tilt(ar).cos,
        u2=top.tilt(ar).cos,
        T_spin=2 * ar.pi / abs(spin) if spin else None,
        theta_min_deg=theta,
        theta_max_deg=theta,
        mean_spin_rate=spin,
        mean_precession_rate=0 * spin if regime is Regime.TORQUE_FREE else None,
        spin_rate_start=spin,
        precession_rate_start=0 * spin if regime is Regime.TORQUE_FREE else None,
    )
