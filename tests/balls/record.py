"""The record of one motion, in balls."""

from __future__ import annotations

from fractions import Fraction
from typing import NamedTuple

from flint import acb, arb

from balls.angles import Moving
from balls.scene import Undecided, exact_arb


class Remainders(NamedTuple):
    """Periodic parts of spin and precession, their rates, and the time since a whole period."""

    dphi: arb
    dpsi: arb
    dphi_rate: arb
    dpsi_rate: arb
    tau: arb


class Motion(Moving):
    """One motion at one precision; every method raises Undecided where that is too low."""

    def record(self) -> dict[str, arb | None]:
        """Return every number of the record that the motion has; None where it has none."""
        numbers: dict[str, arb | None] = {"a": self.a, "b": self.b}
        numbers |= {"u1": self.u1, "u2": self.u2}
        if self.facts.vertical:
            return numbers | self._constant_rates(self.r0, None)
        numbers["u3"] = self.u3
        spin, turn = self._rates_at_start()
        if self.facts.separatrix:
            numbers |= {"k": arb(1), "k_prime": arb(0), "modular_angle_deg": arb(90)}
            numbers |= {"nome": arb(1), "K_prime": arb.pi() / 2, "E": arb(1)}
            numbers |= {"spin_rate_start": spin, "precession_rate_start": turn}
            return numbers | self._tilts()
        numbers |= self._elliptic()
        if self.facts.steady:
            return numbers | self._constant_rates(spin, turn)
        mean_spin, mean_turn = self.mean_rates()
        numbers |= self._tilts() | {
            "mean_spin_rate": mean_spin,
            "mean_precession_rate": mean_turn,
            "T_spin": _period(mean_spin),
            "T_precession": _period(mean_turn),
            "spin_rate_start": None if self.facts.pole else spin,
            "precession_rate_start": None if self.facts.pole else turn,
        }
        if self.starts_at > 0:
            prime = self.m1.sqrt()
            numbers["u_quarter"] = self.u1 - self.band * prime / (1 + prime)
        numbers |= self._half_rates()
        return numbers | self._amplitude()

    def _rates_at_start(self) -> tuple[arb, arb]:
        return self.r0 - self.u0 * self.turn, self.turn

    def _elliptic(self) -> dict[str, arb | None]:
        k, k_prime = self.m.sqrt(), self.m1.sqrt()
        prime = self.K_prime
        return {
            "k": k,
            "k_prime": k_prime,
            "modular_angle_deg": in_degrees(arb.atan2(k, k_prime)),
            "nome": arb(0) if prime is None else (-arb.pi() * prime / self.K).exp(),
            "K": self.K,
            "K_prime": prime,
            "E": acb(self.m).elliptic_e().real,
            "T_nutation": None if self.idle else self.T,
        }

    def _constant_rates(self, spin: arb, turn: arb | None) -> dict[str, arb | None]:
        tilt = in_degrees(self.tilt)
        return {
            "theta_min_deg": tilt,
            "theta_max_deg": tilt,
            "mean_spin_rate": spin,
            "spin_rate_start": spin,
            "T_spin": _period(spin),
            "mean_precession_rate": turn,
            "precession_rate_start": turn,
            "T_precession": None if turn is None else _period(turn),
        }

    def _tilts(self) -> dict[str, arb | None]:
        least = arb.atan2(self.above_u1.sqrt(), (1 + self.u1).sqrt())
        most = arb.atan2((1 - self.u2).sqrt(), self.below_u2.sqrt())
        at = self.starts_at
        return {
            "theta_min_deg": in_degrees(self.tilt if at > 0 else 2 * least),
            "theta_max_deg": in_degrees(self.tilt if at < 0 else 2 * most),
        }

    def mean_rates(self) -> tuple[arb, arb]:
        """Return the mean rates of spin and precession; on the separatrix, their limits."""
        if self.facts.separatrix:
            return self.r0 - self.b / 2, self.b / 2
        if self.facts.steady:
            turn = arb(0) if self.facts.pole else self.turn
            return self.r0 - turn * self.u0, turn
        south, north = self._growth(1), self._growth(-1)
        return self.r0 - self.b + (south - north) / self.T, (south + north) / self.T

    def remainders(self, t: Fraction) -> Remainders:
        """Return spin and precession at a time less their mean growth."""
        state, (spin, turn) = self.at(t), self.mean_rates()
        return Remainders(
            dphi=state.phi - spin * exact_arb(t),
            dpsi=state.psi - turn * exact_arb(t),
            dphi_rate=state.phi_rate - spin,
            dpsi_rate=state.psi_rate - turn,
            tau=state.tau,
        )

    def _growth(self, sign: int) -> arb:
        """Return what a pole adds to (psi +- phi)/2 over a period."""
        if self.passes_bottom if sign > 0 else self.passes_top:
            return arb.pi()
        factor = self.from_minus_b if sign > 0 else self.from_b
        return factor * self.whole(sign) / ((1 + sign * self.u2) * self.speed)

    def half_parts(self) -> tuple[arb, arb] | None:
        """Return (beta +- b)/2/(1 +- u) at T/2; None where that is on a pole."""
        low, high = self.below_u2, self.above_u1
        if self.starts_at:
            if (high if self.starts_at < 0 else low).is_zero():
                return None
            to_u2 = self.band if self.starts_at < 0 else arb(0)
        else:
            sn2 = (self.u0 - self.u2) / self.band
            to_u2 = self.band * ((self.u1 - self.u0) / self.band) / (1 - self.m * sn2)
        below, above = low + to_u2, high + (self.band - to_u2)
        south = arb(0) if self.from_minus_b.is_zero() else self.from_minus_b / 2 / below
        north = arb(0) if self.from_b.is_zero() else self.from_b / 2 / above
        return south, north

    def _half_rates(self) -> dict[str, arb | None]:
        parts = self.half_parts()
        if parts is None:
            return {"spin_rate_half": None, "precession_rate_half": None}
        south, north = parts
        return {
            "spin_rate_half": self.r0 - self.b + south - north,
            "precession_rate_half": south + north,
        }

    def _amplitude(self) -> dict[str, arb | None]:
        """Return (7,2) and alpha (1,6), which a release from rest has."""
        if self.scene.theta_rate or self.scene.psi_rate or not self.scene.a:
            return {}
        amplitude = arb.atan2((self.wide / self.a).sqrt(), self.below_u2.sqrt())
        alpha = acb.elliptic_f(acb(amplitude), acb(self.m1)).real
        if self.passes_bottom and self.K_prime is not None:
            alpha = self.K_prime
        return {"amplitude_deg": in_degrees(amplitude), "alpha": alpha}


def _period(rate: arb) -> arb | None:
    """Return 2 pi over a rate; None where that is 0, as far as can be told."""
    if rate.contains(0):
        if rate.is_zero() or bool(abs(rate) < arb(2) ** -1100):
            return None
        raise Undecided("a rate")
    return 2 * arb.pi() / abs(rate)


def in_degrees(angle: arb) -> arb:
    return angle * 180 / arb.pi()
