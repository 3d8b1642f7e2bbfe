"""The record of any start, as formulas in the gaps between the roots, in any arithmetic."""

from __future__ import annotations

from functools import cached_property
from typing import Any

from ..arithmetic.generic import Arithmetic, Real, everywhere, where
from ..elliptic import complete_e, complete_k, nome, period_mean
from ..inputs.top import Top
from .cubic import Place, Start
from .general import Solution, advances, analyse, steady_rates
from .record import NUMBER_KEYS, Record, Regime, constant_rates
from .released import Nutation, u_quarter
from .roots import Roots


class GeneralNutation(Nutation):
    """The numbers of a top that nutates from any start, or of an array of such tops."""

    amplitude_deg = alpha = None

    def __init__(self, ar: Arithmetic, solution: Solution, path: Any, *, pole: int = 0) -> None:
        self.ar, self.begin, self.place, self.pole = ar, solution.start, solution.place, pole
        self.a, self.b, self.r0 = self.begin.a, self.begin.b, self.begin.r0
        self.roots, self.k, self.k_prime = solution.roots, solution.k, solution.k_prime
        self.T_nutation = solution.period
        self.path = path

    @property
    def u1(self) -> Real:
        """(4,9)."""
        return self.roots.u1

    @property
    def nome(self) -> Real:
        """(2,4)."""
        return nome(self.ar, m=self.k * self.k, k_prime=self.k_prime)

    @cached_property
    def K_prime(self) -> Real | None:
        """First kind of the complement; None without torque."""
        return complete_k(self.ar, self.k) if everywhere(self.k > 0) else None

    @property
    def E(self) -> Real:
        """Second kind."""
        return complete_e(self.ar, self.k_prime)

    @property
    def u_quarter(self) -> Real | None:
        """(5,2), where the start is at the top of the nutation."""
        at_u1 = self.place.u1_u == 0
        if not hasattr(at_u1, "any"):
            return u_quarter(self.roots, self.k_prime) if at_u1 else None
        return where(at_u1, u_quarter(self.roots, self.k_prime), float("nan"))

    @property
    def theta_min_deg(self) -> Real:
        """The tilt at u1."""
        above, below = self.roots.above_u1, self.roots.below_u1
        return 2 * self.ar.atan2(self.ar.sqrt(above), self.ar.sqrt(below)) / self._degree

    @cached_property
    def _mean_rates(self) -> tuple[Real, Real]:
        roots = self.roots
        if everywhere((roots.above_u1 > 0) & (roots.below_u2 > 0)) and roots.u3 is not None:
            return mean_rates(self.ar, self.r0, roots, self.place, self.k_prime)
        growth = advances(self.ar, self.begin, roots, self.k_prime, self.T_nutation)
        return growth[0] / self.T_nutation, growth[1] / self.T_nutation

    @property
    def mean_spin_rate(self) -> Real:
        """Over a period."""
        return self._mean_rates[0]

    @property
    def mean_precession_rate(self) -> Real:
        """Over a period."""
        return self._mean_rates[1]

    @property
    def spin_rate_start(self) -> Real | None:
        """As given; none on the vertical."""
        return None if self.pole else steady_rates(self.begin)[0]

    @property
    def precession_rate_start(self) -> Real | None:
        """As given; none on the vertical."""
        return None if self.pole else self.begin.psi_rate

    @cached_property
    def _half_rates(self) -> tuple[Real | None, Real | None]:
        return half_rates(self.r0, self.b, self.roots, self.place)

    @property
    def spin_rate_half(self) -> Real | None:
        """(4,8) half a period after the start."""
        return self._half_rates[0]

    @property
    def precession_rate_half(self) -> Real | None:
        """(4,7) half a period after the start."""
        return self._half_rates[1]


def mean_rates(
    ar: Arithmetic, r0: Real, roots: Roots, place: Place, k_prime: Real
) -> tuple[Real, Real]:
    """Of spin and precession: (4,8) and (4,7) in partial fractions about the two poles."""
    mc = k_prime * k_prime

    def mean(from_u1: Real, from_u2: Real) -> Real:
        """Of (beta - b u)/(1 +- u), both linear in cn^2 and sn^2 over dn^2."""
        at_u1, at_u2 = place.momentum_u1, mc * place.momentum_u2
        return period_mean(ar, k_prime, mc * from_u2 / from_u1, at_u1, at_u2) / from_u1

    south = mean(roots.below_u1, roots.below_u2) / 2
    north = mean(roots.above_u1, roots.above_u2) / 2
    return r0 + south - north, south + north


def half_rates(r0: Real, b: Real, roots: Roots, place: Place) -> tuple[Real | None, Real | None]:
    """Of spin (4,8) and precession (4,7) half a period after the start; None over a pole."""
    from_u1 = place.u_u2 * roots.u3_u1 / place.u3_u
    from_u2 = place.u1_u * roots.u3_u2 / place.u3_u
    below, above = roots.below_u2 + from_u2, roots.above_u1 + from_u1
    if not everywhere((below > 0) & (above > 0)):
        return None, None
    precession = (place.momentum_u2 - b * from_u2) / (below * above)
    return r0 - (below - above) / 2 * precession, precession


def general_record(ar: Arithmetic, top: Top) -> Record:
    """The record of any start, in an mpmath context."""
    solution = analyse(ar, top)
    begin, roots, degree = solution.start, solution.roots, ar.pi / 180
    if solution.nutates:
        motion = GeneralNutation(ar, solution, _path(ar, begin, roots), pole=top.pole)
        numbers = {key: getattr(motion, key) for key in NUMBER_KEYS}
        return Record(top, solution.regime, **numbers, path=motion.path)
    record = Record(
        top, solution.regime, a=begin.a, b=begin.b, u1=roots.u1, u2=roots.u2, u3=roots.u3
    )
    spin_rate, precession_rate = (None, None) if top.pole else steady_rates(begin)
    if solution.regime is Regime.SEPARATRIX:
        upright = ar.sqrt(roots.above_u1), ar.sqrt(roots.below_u1)
        lowest = ar.sqrt(roots.above_u2), ar.sqrt(roots.below_u2)
        return record._replace(
            k=solution.k,
            k_prime=solution.k_prime,
            modular_angle_deg=ar.mpf(90),
            nome=ar.mpf(1),
            K_prime=ar.pi / 2,
            E=ar.mpf(1),
            theta_min_deg=2 * ar.atan2(*upright) / degree,
            theta_max_deg=2 * ar.atan2(*lowest) / degree,
            spin_rate_start=spin_rate,
            precession_rate_start=precession_rate,
            path=_path(ar, begin, roots),
            remark="rises to the vertical in infinite time",
        )
    integrals: dict[str, Any] = _integrals(ar, solution)
    tilt = top.tilt(ar).degrees(ar)
    record = record._replace(T_nutation=solution.period, **integrals)
    return record._replace(**constant_rates(tilt, spin_rate, precession_rate, 2 * ar.pi))


def _integrals(ar: Arithmetic, solution: Solution) -> dict[str, Any]:
    """Of a top that does not nutate."""
    k, k_prime = solution.k, solution.k_prime
    return {
        "k": k,
        "k_prime": k_prime,
        "modular_angle_deg": ar.atan2(k, k_prime) * 180 / ar.pi,
        "nome": nome(ar, m=k * k, k_prime=k_prime),
        "K": complete_k(ar, k_prime),
        "K_prime": complete_k(ar, k) if k else None,
        "E": complete_e(ar, k_prime),
    }


def _path(ar: Arithmetic, begin: Start, roots: Roots) -> str | None:
    """Where the precession stands still, u = beta/b, lies on u1, between the roots or outside."""
    if not roots.u1_u2 or not (begin.b or begin.beta):
        return None
    if not begin.b or not roots.above_u1:  # over the upper pole there is no cusp
        return "wavy"
    still = begin.beta / begin.b
    if abs(still - roots.u1) <= ar.mpf(10) ** (-(ar.dps // 2)) * roots.u1_u2:
        return "cusped"
    return "looping" if roots.u2 < still < roots.u1 else "wavy"
