"""The paper's case: a top released from rest, thetadot0 = psidot0 = 0 (sections 4 to 7).

The formulas take the arithmetic as a parameter (see `elliptic`) and are arranged so that every
number is a sum or product of positive ones: nothing cancels, from the slowest top to the fastest,
and plain doubles are good to about 5 eps.  Equation numbers in parentheses are Chrapan's.
"""

from __future__ import annotations

from .elliptic import Arithmetic, Real, carlson_rf, complete_e, complete_k, nome, period_mean
from .record import Record, Regime, period_of, with_constant_rates
from .roots import Roots, invariants, roots_from_rest
from .top import Tilt, Top, number


def released_record(ar: Arithmetic, top: Top) -> Record:
    """The record of a top released from rest, in the arithmetic given."""
    regime = _classify(top)
    if regime in (Regime.TORQUE_FREE, Regime.SLEEPING, Regime.HANGING):
        return _unmoved(ar, top, regime)
    return _nutating(ar, top, regime)


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


def _nutating(ar: Arithmetic, top: Top, regime: Regime) -> Record:
    """Sections 4-7; also r0 = 0, as the limit r0 -> +0."""
    inv, tilt = invariants(ar, top), top.tilt(ar)
    roots = roots_from_rest(ar, inv.lam, inv.lam_minus_1, tilt)
    k, k_prime = modulus(ar, roots), complement(ar, roots)
    K = complete_k(ar, k_prime)
    T = 2 * K / phase_rate(ar, inv.a, roots)
    half_turns, spins = ar.pi / T, regime is Regime.REGULAR
    spin = inv.drift + (-half_turns if top.r0 < 0 else half_turns)
    precession = mean_precession_rate(ar, inv.b, roots, k_prime, tilt) if spins else half_turns
    degree = ar.pi / 180
    return Record(
        top=top,
        regime=regime,
        a=inv.a,
        b=inv.b,
        u1=roots.u1,
        u2=roots.u2,
        u3=roots.u3,
        k=k,
        k_prime=k_prime,
        modular_angle_deg=ar.atan2(k, k_prime) / degree,
        nome=nome(ar, m=roots.u1_u2 / roots.u3_u2, k_prime=k_prime),
        K=K,
        K_prime=complete_k(ar, k),
        E=complete_e(ar, k_prime),
        amplitude_deg=amplitude(ar, roots) / degree,
        alpha=parameter_alpha(ar, roots),
        T_nutation=T,
        T_spin=period_of(spin, 2 * ar.pi),
        T_precession=period_of(precession, 2 * ar.pi),
        u_quarter=u_quarter(roots, k_prime),
        theta_min_deg=tilt.degrees(ar),
        theta_max_deg=2 * ar.atan2(ar.sqrt(roots.above_u2), ar.sqrt(roots.below_u2)) / degree,
        mean_spin_rate=spin,
        mean_precession_rate=precession,
        spin_rate_start=number(ar, top.r0),
        spin_rate_half=number(ar, top.r0) - inv.rate_half * roots.u2 if spins else None,
        precession_rate_start=0 * T,
        precession_rate_half=inv.rate_half,
        path="cusped" if spins else None,
    )


def _unmoved(ar: Arithmetic, top: Top, regime: Regime) -> Record:
    """No torque, or upright, or hanging: the top turns about its own axis and does nothing else.

    On the vertical only the sum (upright) or the difference (hanging) of the two angles has a
    meaning; all of it is counted as spin.  Without torque the nutation period is that of a small
    disturbance.
    """
    inv, tilt = invariants(ar, top), top.tilt(ar)
    record = Record(
        top=top,
        regime=regime,
        a=inv.a,
        b=inv.b,
        u1=tilt.cos,
        u2=tilt.cos,
        remark=_remark(top, regime),
    )
    spin, zero = number(ar, top.r0), number(ar, 0)
    if regime is not Regime.TORQUE_FREE:
        return with_constant_rates(record, tilt.degrees(ar), spin, None, 2 * ar.pi)
    quarter = ar.pi / 2 + zero
    record = record._replace(
        k=zero,
        k_prime=zero + 1,
        modular_angle_deg=zero,
        nome=zero,
        K=quarter,
        E=quarter,
        T_nutation=period_of(inv.b, 2 * ar.pi),
    )
    return with_constant_rates(record, tilt.degrees(ar), spin, zero, 2 * ar.pi)


def _remark(top: Top, regime: Regime) -> str | None:
    if regime is Regime.HANGING:
        return "only phi - psi is defined; stable"
    if regime is Regime.SLEEPING:
        stable = "stable" if top.sleeps_stably() else "unstable"
        sign = ">=" if top.sleeps_stably() else "<"
        return f"only phi + psi is defined; {stable} (lambda = b^2/2a {sign} 1)"
    return None
