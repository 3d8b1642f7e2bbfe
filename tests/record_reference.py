"""The numbers of a motion in mpmath, by formulas the solver does not use but for the roots.

Roots by Viete's cosines in 2,000 digits or more, as in the solver: `test_explanation` inserts them
into the cubic.  Two that agree to 30 % of the digits are equal, so no sign of a polynomial is
needed.  Carlson's integrals for K, E, F and Pi, the phase of the start counted from the lowest
point (the solver uses the arithmetic-geometric mean, Bartky's transformation, and theta functions
counted from the highest point).
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cached_property, lru_cache
from typing import Any, NamedTuple

import mpmath as mp
from flint import acb, arb, ctx

from lagrange_cli.bench.reference import viete_roots

ROOT_DIGITS, DIGITS = 2_000, 120
Many = Any
"""A number of mpmath."""
Angles = tuple[Many, Many, Many, Many]
"""Tilt, spin, precession and nutation rate."""


def exact(x: Any) -> Many:
    """Return a double or a fraction as a number of mpmath."""
    numerator, denominator = Fraction(x).as_integer_ratio()
    return mp.mpf(numerator) / denominator


def carlson(integral: Callable[..., acb], *args: Any) -> Many:
    """Return R_F or R_J by FLINT, which takes a fiftieth of mpmath's time."""
    with ctx.workprec(mp.mp.prec + 32):
        found = integral(*(acb(arb(x)) for x in args)).real
        assert found.rel_accuracy_bits() >= mp.mp.prec
        return mp.mpf(found.mid())


def reference_record(
    inputs: Mapping[str, Any], *, digits: int = DIGITS, root_digits: int = ROOT_DIGITS
) -> dict[str, Many]:
    """Return all numbers of a motion by key, None for those that do not exist.

    `inputs` are those of `Top.as_dict`.
    """
    of = _motion(tuple(inputs.items()), digits, root_digits)
    with mp.workdps(root_digits):
        found = of.record
    with mp.workdps(digits):
        angles = {x for x, y in found.items() if x.endswith("_rad") and y is not None}
        return {
            key.replace("_rad", "_deg"): x * of.degrees if key in angles else x
            for key, x in found.items()
        }


class State(NamedTuple):
    """A motion at a time: unwrapped angles in radians, and their rates.

    On the vertical all of the rotation counts as spin.
    """

    theta: Many
    phi: Many
    psi: Many
    thetadot: Many
    phidot: Many
    psidot: Many


def reference_state(
    inputs: Mapping[str, Any], t: Any, digits: int = DIGITS, root_digits: int = ROOT_DIGITS
) -> State:
    """Return the state of a motion at a time."""
    return _state(tuple(inputs.items()), t, digits, root_digits)


@lru_cache(1000)
def _state(inputs: tuple[tuple[str, Any], ...], t: Any, digits: int, root_digits: int) -> State:
    of = _motion(inputs, digits, root_digits)
    with mp.workdps(root_digits):
        angles = of.angles(exact(t)) if t else (mp.acos(of.u0), mp.mpf(0), mp.mpf(0), of.fall)
        u, sin2 = mp.cos(angles[0]), mp.sin(angles[0]) ** 2
        turn = of.turn if of.steady_tilt else (of.beta - of.b * u) / sin2 if sin2 else mp.mpf(0)
        turn *= not of.vertical
        return State(*angles, of.r0 - turn * u, turn)


def reference_columns(
    inputs: Mapping[str, Any], t: Any, root_digits: int = ROOT_DIGITS
) -> dict[str, Many]:
    """Return the columns of `lagtop table` at a time but t, dphi and dpsi."""
    now = reference_state(inputs, t, DIGITS, root_digits)
    of = _motion(tuple(inputs.items()), DIGITS, root_digits)
    with mp.workdps(of.digits):
        sin, u, (sin_half, cos_half) = mp.sin(now.theta), mp.cos(now.theta), _half(now.theta)
        plus, minus = (now.psi + now.phi) / 2, (now.psi - now.phi) / 2
        across, weight = now.psidot * sin, of.m * of.g * of.s
        swing = (now.thetadot**2 + across**2) * of.A / 2
        turn = _about(2, now.psi) * _about(0, now.theta) * _about(2, now.phi)
        body = mp.matrix(
            [
                across * mp.sin(now.phi) + now.thetadot * mp.cos(now.phi),
                across * mp.cos(now.phi) - now.thetadot * mp.sin(now.phi),
                of.r0,
            ]
        )
        rows = {
            f"matrix_{x}{y}": turn[i, j] for i, x in enumerate("xyz") for j, y in enumerate("xyz")
        }
        rows |= dict(
            zip(("omega_space_x", "omega_space_y", "omega_space_z"), turn * body, strict=True)
        )
        return (
            now._asdict()
            | rows
            | {
                "u": u,
                "p": body[0],
                "q": body[1],
                "r": of.r0,
                "moment": weight * sin,
                "axis_x": sin * mp.sin(now.psi),
                "axis_y": -sin * mp.cos(now.psi),
                "axis_z": u,
                "quaternion_w": cos_half * mp.cos(plus),
                "quaternion_x": sin_half * mp.cos(minus),
                "quaternion_y": sin_half * mp.sin(minus),
                "quaternion_z": cos_half * mp.sin(plus),
                "energy": swing + of.C * of.r0**2 / 2 + weight * u,
                "Lz": of.A * across * sin + of.C * of.r0 * u,
            }
        )


def _about(axis: int, angle: Many) -> Many:
    """Return the matrix of a turn about a coordinate axis."""
    turn, (i, j) = mp.eye(3), [(axis + 1) % 3, (axis + 2) % 3]
    turn[i, i] = turn[j, j] = mp.cos(angle)
    turn[j, i] = mp.sin(angle)
    turn[i, j] = -turn[j, i]
    return turn


def _half(angle: Many) -> tuple[Many, Many]:
    return mp.sin(angle / 2), mp.cos(angle / 2)


@lru_cache(1000)
def _motion(inputs: tuple[tuple[str, Any], ...], digits: int, root_digits: int) -> _Motion:
    with mp.workdps(root_digits):
        return _Motion(dict(inputs), digits)


class _Motion:
    """The constants of a motion, in ROOT_DIGITS digits."""

    def __init__(self, inputs: Mapping[str, Any], digits: int) -> None:
        self.digits, self.degrees = digits, 180 / mp.pi
        self.tiny = mp.mpf(10) ** (-3 * mp.mp.dps // 10)
        given = {x: exact(y) for x, y in inputs.items() if y is not None and not isinstance(y, str)}
        if "spin_period" in given:
            given["phidot0"] = 2 * mp.pi / given["spin_period"]
        self.m, self.C, self.s, self.g = (given[x] for x in ("m", "C", "s", "g"))
        self.A = given["A"] if "A" in given else given["A_cm"] + self.m * self.s**2
        in_degrees = given.get("theta0_deg")
        theta = given["theta0_rad"] if in_degrees is None else in_degrees * mp.pi / 180
        self.u0, self.sin0 = self.near(mp.cos(theta), 1, 0, -1), mp.sin(theta)
        self.sin0 *= abs(self.u0) != 1
        self.fall = given["thetadot0"]
        self.turn = given["psidot0"] if "psidot0" in given else self.steady(inputs, given)
        self.r0 = given["r0"] if "r0" in given else given["phidot0"] + self.turn * self.u0
        self.r0 *= abs(self.r0) > self.tiny
        self.a, self.b = 2 * self.m * self.g * self.s / self.A, self.C * self.r0 / self.A
        self.beta = self.turn * self.sin0**2 + self.b * self.u0
        self.alpha = self.fall**2 + self.turn**2 * self.sin0**2 + self.a * self.u0
        self.find_roots()

    def near(self, x: Many, *values: Any) -> Many:
        """Return a number, or the value that it agrees with."""
        return next((mp.mpf(y) for y in values if abs(x - y) < self.tiny), x)

    def steady(self, inputs: Mapping[str, Any], given: Mapping[str, Many]) -> Many:
        """Return the rate of steady precession that a word names."""
        m, A, C, s, g = self.m, self.A, self.C, self.s, self.g
        spin, lead = (given["r0"], A) if "r0" in given else (given["phidot0"], A - C)
        lead *= self.u0
        if not lead:
            return m * g * s / (C * spin)
        gap = mp.sqrt(max((C * spin) ** 2 - 4 * lead * m * g * s, 0))
        roots = sorted([(C * spin - gap) / (2 * lead), (C * spin + gap) / (2 * lead)], key=abs)
        slow, fast = roots if spin else (max(roots), min(roots))
        return slow if inputs["psidot0"] == "steady" else fast

    def find_roots(self) -> None:
        """Set u1, u2 and a (u3 - u), and the kind of motion."""
        a, b, alpha, beta, u0 = self.a, self.b, self.alpha, self.beta, self.u0
        size = alpha + b**2
        self.vertical = abs(u0) == 1 and not self.fall
        bend = 2 * self.turn**2 * u0 - 2 * self.turn * b + a
        scale = 2 * self.turn**2 + abs(2 * self.turn * b) + a
        still = not self.fall and abs(bend) <= self.tiny * scale
        if self.vertical or still:
            u1 = u2 = u0
        elif a:
            u2, u1, _ = viete_roots(-size / a, 2 * b * beta / a - 1, (alpha - beta**2) / a)
        else:
            half, rest = b * beta / size, (beta**2 - alpha) / size
            gap = mp.sqrt(half**2 - rest)
            u2, u1 = half - gap, half + gap
        self.u1, self.u2 = self.near(u1, u0, 1), self.near(u2, u0, -1)
        if not self.fall and abs(u0) != 1 and not still:  # the start is a root
            self.u1, self.u2 = (u0, self.u2) if abs(u0 - u1) < abs(u0 - u2) else (self.u1, u0)
        self.wide, self.narrow = (size - a * (self.u1 + self.u2 + x) for x in (self.u2, self.u1))
        self.steady_tilt = self.u1 == self.u2
        self.separatrix = bool(a) and not self.steady_tilt and self.u1 == 1
        self.separatrix = self.separatrix and abs(self.narrow) < self.tiny * self.wide
        self.narrow *= not self.separatrix
        self.nutates = not (self.steady_tilt or self.separatrix)
        self.over_top = self.nutates and self.u1 == 1
        self.over_bottom = self.u2 == -1 and not self.steady_tilt
        self.k2 = mp.mpf(0) if self.steady_tilt or not a else a * (self.u1 - self.u2) / self.wide
        self.kc2 = mp.mpf(1) if not self.k2 else self.narrow / self.wide
        self.gaps = {x: (1 + x * self.u1, 1 + x * self.u2) for x in (1, -1)}
        self.momenta = {x: self.beta + x * b for x in (1, -1)}
        ratios = [x / y for x, y in (*self.gaps.values(), (b**2, a)) if x and y]
        self.digits += int(max([0, *(abs(mp.log10(x)) for x in ratios)]))  # rates may cancel
        kc = mp.sqrt(self.kc2)
        self.middle = self.u1 - (self.u1 - self.u2) * kc / (1 + kc)
        self.tilts = [mp.acos(x) for x in (self.u1, self.middle, self.u2)]
        self.at_u1 = u0 == (1 if self.steady_tilt else self.u1)

    def third(self, pole: int, sn2: Many, cn2: Many, dn2: Many) -> Many:
        """Return the integral of dw (1 + u2 pole)/(1 + u pole), from w = 0 at u2."""
        x1, x2 = self.gaps[pole]
        n = 1 - x1 / x2
        sn = mp.sqrt(sn2)
        first = carlson(acb.elliptic_rf, cn2, dn2, 1)
        return sn * (
            first + n / 3 * sn2 * carlson(acb.elliptic_rj, cn2, dn2, 1, cn2 + sn2 * x1 / x2)
        )

    def passes(self, pole: int) -> bool:
        """Return whether the axis passes over a pole."""
        return self.over_bottom if pole > 0 else self.over_top

    def half_sums(self, integrals: Mapping[int, Many], time: Many) -> tuple[Many, Many]:
        """Return the growth of phi and psi in a time, from integrals of dw (1 + u2 p)/(1 + u p)."""
        halves = []
        for pole in (1, -1):
            momentum, at_u2 = self.momenta[pole], self.gaps[pole][1]
            grown = (
                integrals[pole] * mp.pi  # a number of passages, half a turn of psi and phi each
                if self.passes(pole)
                else momentum / 2 * integrals[pole] / at_u2 * 2 / mp.sqrt(self.wide)
            )
            halves.append(pole * (self.r0 - self.b) / 2 * time + grown)
        return halves[0] - halves[1], halves[0] + halves[1]

    @cached_property
    def record(self) -> dict[str, Many]:
        """Return the numbers by key, angles in radians."""
        a, b, u0, u1, u2, u3 = self.a, self.b, self.u0, self.u1, self.u2, None
        if a:
            u3 = u2 + self.wide / a
        m, A, C, s, g, r0, turn = self.m, self.A, self.C, self.s, self.g, self.r0, self.turn
        k, kc = mp.sqrt(self.k2), mp.sqrt(self.kc2)
        released = not self.fall and not turn
        found: dict[str, Many] = {
            **{"a": a, "b": b, "u1": u1, "u2": u2, "u3": u3, "k": k, "k_prime": kc},
            "modular_angle_rad": mp.atan2(k, kc),
            **{"theta_min_rad": mp.acos(u1), "theta_max_rad": mp.acos(u2)},
            "spin_rate_start": r0 - turn * u0,
            "precession_rate_start": turn,
            "energy_constant": self.alpha,
            "energy_without_spin": A * self.alpha / 2,
            "momentum_constant": self.beta,
            "Lz": A * self.beta,
            "discriminant": self.wide**2,
            "f_upright": -((self.beta - b) ** 2),
            "f_hanging": -((self.beta + b) ** 2),
            "f_slope_u1": -(u1 - u2) * self.narrow,
            "u2_criterion": u2 * (self.wide + a * u2),
            "spin_share": 1 - C / (2 * A),
            "stability_factor": b**2 / (2 * a) if a else None,
            "r0_sleeping": 2 * mp.sqrt(A * m * g * s) / C,
            "r0_steady_min": 2 * mp.sqrt(A * m * g * s * max(u0, 0)) / C,
            "precession_rate_elementary": m * g * s / (C * r0) if r0 else None,
            "T_nutation_elementary": 2 * mp.pi * A / (C * abs(r0)) if r0 else None,
            "A_cm": A - m * s * s,
            "phidot0": (spin := self.near(r0 - self.turn * u0, 0)),
            "spin_period": 2 * mp.pi / spin if spin else None,
        }
        gap2 = b**2 - 2 * a * u0
        gap2 = mp.mpf(0) if abs(gap2) <= self.tiny * b**2 else gap2
        slow = fast = None
        if not u0:
            slow = a / (2 * b) if b else None
        elif gap2 >= 0:
            roots = sorted([(b + x * mp.sqrt(gap2)) / (2 * u0) for x in (-1, 1)], key=abs)
            slow, fast = roots if b else (max(roots), min(roots))
        found |= {"steady_rate_slow": slow, "steady_rate_fast": fast}
        turning = self.at_u1 or (u0 == u2 and not self.steady_tilt)
        on_pole = turning and (self.over_bottom if self.at_u1 else self.over_top)
        has_half = self.nutates and not on_pole
        half = None
        if has_half:
            half = u2 + (u1 - u0) * self.wide / (self.wide + a * (u2 - u0))
            rate = (self.beta - b * half) / (1 - half**2)
            found |= {"precession_rate_half": rate, "spin_rate_half": r0 - half * rate}
        if released and self.nutates:
            found |= {"roots_sum": u3 + u2, "roots_product": u3 * u2, "roots_gap": u3 - u2}
            found |= {f"{key}_squared": found[key] ** 2 for key in ("roots_sum", "roots_gap")}
            found["roots_product_fourfold"] = -4 * found["roots_product"]
            found |= {f"{key}_twice": 2 * found[key] for key in ("u3", "u2")}
            found["k_squared"] = self.k2
        with mp.workdps(self.digits):
            found |= self.integrals(k, kc, released, has_half)
        if self.vertical:
            absent = "u3 k k_prime modular_angle_rad precession_rate_start u2_criterion"
            found |= dict.fromkeys(absent.split())
        elif abs(u0) == 1:
            found |= {"spin_rate_start": None, "precession_rate_start": None}
        if not a:
            found |= {"u2_criterion": None if self.vertical else u2 * (self.wide + a * u2)}
        return found

    def integrals(self, k: Many, kc: Many, released: bool, has_half: bool) -> dict[str, Many]:
        """Return the numbers that need integrals."""
        found: dict[str, Many] = {}
        u0, wide = self.u0, self.wide
        if self.vertical:
            spin = self.r0
            return {"mean_spin_rate": spin, "T_spin": 2 * mp.pi / abs(spin) if spin else None}
        found["E"] = 2 * mp.elliprg(0, self.kc2, 1) if kc else mp.mpf(1)
        found["K_prime"] = mp.elliprf(0, self.k2, 1) if k else None
        found["nome"] = mp.mpf(0 if not k else 1)
        if not kc:
            return found
        K = found["K"] = mp.elliprf(0, self.kc2, 1)
        if k:
            found["nome"] = mp.exp(-mp.pi * found["K_prime"] / K)
        T: Many = 4 * K / mp.sqrt(wide) if wide else None
        found["T_nutation"] = T
        if self.steady_tilt:
            rates = self.r0 - self.turn * u0, self.turn
        else:
            whole = {
                x: 1 if self.passes(x) else 2 * self.third(x, mp.mpf(1), mp.mpf(0), self.kc2)
                for x in (1, -1)
            }
            grown = self.half_sums(whole, T)
            rates = grown[0] / T, grown[1] / T
        names = ("mean_spin_rate", "T_spin"), ("mean_precession_rate", "T_precession")
        for (name, period), rate in zip(names, rates, strict=True):
            size = abs(self.r0) + abs(self.b) + mp.sqrt(wide)
            is_zero = abs(rate) < mp.mpf(10) ** (20 - self.digits) * size
            found |= {name: rate * (not is_zero)}
            found |= {period: None if is_zero or not rate else 2 * mp.pi / abs(rate)}
        if not self.nutates:
            return found
        found["u_quarter"] = self.middle if self.at_u1 else None
        with mp.workdps(ROOT_DIGITS):
            upper, lower = self.tilts[1] - self.tilts[0], self.tilts[2] - self.tilts[1]
        found |= {"nutation_rate_upper": 4 * upper / T, "nutation_rate_lower": 4 * lower / T}
        found |= {"phi_period_rad": grown[0], "psi_period_rad": grown[1]}
        if not (self.over_top or self.over_bottom):
            near_u2 = 1 / (1 + kc), kc / (1 + kc), kc  # sn^2, cn^2 and dn^2 of K/2
            quarter = {x: whole[x] / 2 - self.third(x, *near_u2) for x in (1, -1)}
            phi, psi = self.half_sums(quarter, T / 4)
            found |= {"spin_rate_upper": 4 * phi / T, "precession_rate_upper": 4 * psi / T}
            found["spin_rate_lower"] = 2 * rates[0] - 4 * phi / T
            found["precession_rate_lower"] = 2 * rates[1] - 4 * psi / T
        if has_half:
            _, found["phi_half_rad"], found["psi_half_rad"], _ = self.angles(T / 2)
        if released:
            low = self.a * self.gaps[1][1]
            sin2, cos2 = wide / (wide + low), low / (wide + low)
            at, sine = (cos2, cos2 + self.k2 * sin2, 1), mp.sqrt(sin2)
            found["amplitude_rad"] = mp.atan2(mp.sqrt(wide), mp.sqrt(low))
            found["alpha"] = sine * mp.elliprf(*at)
            found["E_amplitude"] = found["alpha"] - self.kc2 * sine**3 / 3 * mp.elliprd(*at)
            found["comodular_angle_rad"] = mp.atan2(kc, k)
        return found

    def angles(self, t: Many) -> Angles:
        """Return tilt, spin, precession and nutation rate at a time."""
        if self.steady_tilt:
            turn = self.turn * (not self.vertical)
            return mp.acos(self.u0), (self.r0 - turn * self.u0) * t, turn * t, mp.mpf(0)
        turns = abs(t) * (mp.sqrt(self.wide) + abs(self.r0) + abs(self.b))
        with mp.workdps(self.digits + int(mp.log10(turns + 1))):
            return self._rising(t) if self.separatrix else self._nutating(t)

    def _rising(self, t: Many) -> Angles:
        """Return angles and nutation rate on the separatrix: 1 - u = (1 - u2) sech^2 h."""
        u0, u2, b, rate = self.u0, self.u2, self.b, mp.sqrt(self.wide) / 2
        h0 = mp.acosh(mp.sqrt((1 - u2) / (1 - u0))) * (-1 if self.fall >= 0 else 1)
        h, ratio = h0 + rate * t, mp.sqrt((1 - u2) / (1 + u2)) if 1 + u2 else mp.inf
        if b:
            psi = b * t / 2 + (b / rate) * ratio / 2 * (
                mp.atan(ratio * mp.tanh(h)) - mp.atan(ratio * mp.tanh(h0))
            )
        else:  # over the lower pole
            sides = mp.sign(h0) or mp.sign(-self.fall)  # a start on the pole is before or after it
            psi = mp.pi * (mp.sign(h) - sides) / 2
        above = (1 - u2) * mp.sech(h) ** 2
        theta = 2 * mp.asin(mp.sqrt(above / 2))
        slope = -2 * above * mp.tanh(h) * rate / mp.sin(theta)
        return theta, (self.r0 - b) * t + psi, psi, slope

    def _nutating(self, t: Many) -> Angles:
        """Return angles and nutation rate of a top that nutates: u = u2 + (u1 - u2) sn^2 w."""
        u0, u1, u2, wide = self.u0, self.u1, self.u2, self.wide
        K, speed = mp.elliprf(0, self.kc2, 1), mp.sqrt(wide) / 2
        sn2, cn2 = (u0 - u2) / (u1 - u2), (u1 - u0) / (u1 - u2)
        dn2 = self.kc2 + self.k2 * cn2
        side = 1 if self.fall < 0 or (not self.fall and not self.at_u1) else -1
        w0 = side * mp.sqrt(sn2) * mp.elliprf(cn2, dn2, 1)
        w = w0 + speed * t
        n = mp.nint(w / (2 * K))
        sn, cn, dn = (mp.ellipfun(f, w - 2 * n * K, m=self.k2) for f in ("sn", "cn", "dn"))
        integrals = {}
        for pole in (1, -1):
            if self.passes(pole):  # the passages strictly between the start and t
                shift = 0 if pole > 0 else mp.mpf(1) / 2
                first, last = (x / (2 * K) - shift for x in ((w0, w) if t > 0 else (w, w0)))
                snap = mp.nint(first) if abs(first - mp.nint(first)) < 1e-50 else first
                integrals[pole] = mp.sign(t) * (mp.ceil(last) - 1 - mp.floor(snap))
                if u0 == -pole:  # a start on the pole is before or after the passage
                    before = self.fall * pole > 0
                    integrals[pole] += mp.sign(t) * (before == (t > 0))
                continue
            whole = self.third(pole, mp.mpf(1), mp.mpf(0), self.kc2)
            grown = 2 * n * whole + mp.sign(sn) * self.third(pole, sn**2, cn**2, dn**2)
            integrals[pole] = grown - side * self.third(pole, sn2, cn2, dn2)
        phi, psi = self.half_sums(integrals, t)
        below, above = (self.gaps[pole][0] * sn**2 + self.gaps[pole][1] * cn**2 for pole in (1, -1))
        theta = 2 * mp.atan2(mp.sqrt(above), mp.sqrt(below))
        slope = -2 * (u1 - u2) * sn * cn * dn * speed / mp.sqrt(above * below)
        return theta, phi, psi, slope
