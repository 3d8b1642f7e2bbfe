"""The further keys of one motion, in balls: sections 4 to 8 by the reference's own formulas."""

from __future__ import annotations

from fractions import Fraction

from flint import acb, arb

from balls.record import Motion, in_degrees
from balls.scene import Scene, Undecided, exact_arb


class Requested(Motion):
    """The numbers that a motion has on request; None where it has none."""

    def __init__(self, scene: Scene, A: Fraction, C: Fraction) -> None:
        """Take the moments of inertia, which the scene does not hold."""
        super().__init__(scene)
        self.A, self.C = A, C

    def requested(self) -> dict[str, arb | None]:
        """Return every further key."""
        found: dict[str, arb | None] = self._constants() | self._textbook()
        nutates = not (self.facts.steady or self.facts.separatrix)
        if nutates:
            found |= self._grown() | self._quarters()
        if nutates and not (self.scene.theta_rate or self.scene.psi_rate):
            found |= self._steps()
        return found

    def _constants(self) -> dict[str, arb | None]:
        """Return c1, c2, alpha, beta, and the cubic (4,9) and its slope from its coefficients."""
        u1, a = self.u1, self.a
        slope = -2 * u1 * (self.alpha - a * u1) - a * (1 - u1**2)
        slope += 2 * self.b * (self.beta - self.b * u1)
        still = self.facts.steady or self.facts.separatrix
        wide = self.size - a * (self.u1 + 2 * self.u2)
        return {
            "energy_without_spin": exact_arb(self.A) * self.alpha / 2,
            "Lz": exact_arb(self.A) * self.beta,
            "energy_constant": self.alpha,
            "momentum_constant": self.beta,
            "discriminant": wide**2,
            "f_upright": -(self.from_b**2),
            "f_hanging": -(self.from_minus_b**2),
            "f_slope_u1": arb(0) if still else slope,
            "u2_criterion": None if self.facts.vertical else self._criterion(),
            "spin_share": exact_arb(1 - self.C / (2 * self.A)),
        }

    def _textbook(self) -> dict[str, arb | None]:
        """Return the keys of elementary theory; steady rates by the quadratic formula as it is."""
        scene, ratio = self.scene, exact_arb(self.A / self.C)
        a, b = exact_arb(scene.a), exact_arb(scene.b)
        level, cosine = scene.vanishes(Fraction(0), Fraction(1)), self.u0
        hangs = not level and _is_negative(cosine)
        least = arb(0) if level or hangs else ratio * (2 * a * cosine).sqrt()
        found: dict[str, arb | None] = {
            "stability_factor": b**2 / (2 * a) if scene.a else None,
            "r0_sleeping": ratio * (2 * a).sqrt(),
            "r0_steady_min": least,
            "precession_rate_elementary": a / (2 * b) if scene.b else None,
            "T_nutation_elementary": 2 * arb.pi() / abs(b) if scene.b else None,
        }
        if level:
            return found | {"steady_rate_slow": found["precession_rate_elementary"]}
        double = scene.vanishes(scene.b**2, -2 * scene.a)
        square = arb(0) if double else b**2 - 2 * a * cosine
        if not double and _is_negative(square):
            return found
        root = square.sqrt() if scene.b >= 0 else -square.sqrt()
        slow = (b - root) / (2 * cosine) if scene.a else arb(0)
        return found | {"steady_rate_slow": slow, "steady_rate_fast": (b + root) / (2 * cosine)}

    def _criterion(self) -> arb:
        """Return a u2 u3 by the sum of the roots."""
        return self.u2 * (self.size - self.a * (self.u1 + self.u2))

    def _grown(self) -> dict[str, arb | None]:
        """Return spin and precession after half a period and after a whole one."""
        spin, turn = (rate * self.T for rate in self.mean_rates())
        found: dict[str, arb | None] = {
            "phi_period_deg": in_degrees(spin),
            "psi_period_deg": in_degrees(turn),
        }
        if self.half_parts() is None:
            return found
        half = spin / 2, turn / 2
        if not self.starts_at or self.passes_bottom or self.passes_top:
            plus, minus = self.halves_at(self.T / 2)
            half = plus - minus, plus + minus
        return found | {"phi_half_deg": in_degrees(half[0]), "psi_half_deg": in_degrees(half[1])}

    def _quarters(self) -> dict[str, arb | None]:
        """Return the mean rates of a quarter after the highest point, and of the next one."""
        prime, quarter = self.m1.sqrt(), self.T / 4
        sn2, cn2 = 1 / (1 + prime), prime / (1 + prime)
        places = (arb(1), arb(0)), (sn2, cn2), (arb(0), arb(1))
        least, between, most = (self._tilt_at(up, down) for up, down in places)
        found: dict[str, arb | None] = {
            "nutation_rate_upper": (between - least) / quarter,
            "nutation_rate_lower": (most - between) / quarter,
        }
        if self.passes_bottom or self.passes_top:
            return found
        amplitude = -arb.atan2(sn2.sqrt(), cn2.sqrt())
        w = -self.K / 2
        drift = (self.r0 - self.b) * quarter / 2
        plus = drift + self._south(w, amplitude, 0) - self._at_top(1)
        minus = -drift + self._north(w, amplitude, 0) - self._at_top(-1)
        spin, turn = self.mean_rates()
        return found | {
            "spin_rate_upper": (plus - minus) / quarter,
            "spin_rate_lower": 2 * spin - (plus - minus) / quarter,
            "precession_rate_upper": (plus + minus) / quarter,
            "precession_rate_lower": 2 * turn - (plus + minus) / quarter,
        }

    def _tilt_at(self, up: arb, down: arb) -> arb:
        """Return the tilt where u = u2 + (u1 - u2) `up` and `up` + `down` = 1."""
        below, above = self.below_u2 + self.band * up, self.above_u1 + self.band * down
        return 2 * arb.atan2(above.sqrt(), below.sqrt())

    def _steps(self) -> dict[str, arb | None]:
        """Return the steps of section 8, (4,11) and (4,12) from a, b and the start."""
        total = self.b**2 / self.a
        product = total * self.u0 - 1
        if not self.scene.b:
            total, product = arb(0), arb(-1)
        radical = total**2 - 4 * product
        if not radical > 0:
            raise Undecided("u3 - u2")
        gap = radical.sqrt()
        m, m1 = self.m, self.m1
        amplitude = arb.atan2((self.wide / self.a).sqrt(), self.below_u2.sqrt())
        return {
            "roots_sum": total,
            "roots_product": product,
            "roots_sum_squared": total**2,
            "roots_product_fourfold": -4 * product,
            "roots_gap_squared": radical,
            "roots_gap": gap,
            "u3_twice": total + gap,
            "u2_twice": 4 * product / (total + gap),
            "k_squared": m,
            "comodular_angle_deg": in_degrees(arb.atan2(m1.sqrt(), m.sqrt())),
            "E_amplitude": acb.elliptic_e_inc(acb(amplitude), acb(m1)).real,
        }


def _is_negative(x: arb) -> bool:
    """Return the sign of a ball that is not 0.  Raises Undecided where it holds 0."""
    if x.contains(0):
        raise Undecided
    return bool(x < 0)
