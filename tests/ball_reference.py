"""The reference in ball arithmetic: proved enclosures of every number of a motion.

`BallReference` raises the precision of the formulas in `balls` until an answer tells a double from
its neighbours, or an angle is known to a small part of its unit.  What no precision decides raises
`Undecided`.
"""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cached_property
from typing import Any, TypeVar

from balls.angles import State
from balls.record import Motion, Remainders
from balls.requested import Requested
from balls.scene import (
    Number,
    Scene,
    Undecided,
    arb_bits,
    exact_arb,
    facts_of,
    many_digits,
    scene_from,
)
from flint import arb

EPS = 2.0**-52
FIRST_BITS, MOST_BITS = 160, 20_000
GOOD_BITS = 90
"""Relative accuracy of a key that is good enough to tell a double from its neighbours."""

Numbers = dict[str, arb | None]
T = TypeVar("T")


class BallReference:
    """Enclosures of one motion, at whatever precision they take."""

    def __init__(self, inputs: Mapping[str, Number | None]) -> None:
        """Take the inputs under the names of the program, as exact numbers."""
        self.scene = scene_from(inputs)
        self.facts = facts_of(self.scene)
        self._moments = Fraction(inputs["A"] or 0), Fraction(inputs["C"] or 0)
        self._motions: dict[int, Requested] = {}
        self._states: dict[tuple[Fraction, int], State] = {}

    def _raised(
        self, compute: Callable[[Requested], T], good: Callable[[T], bool], first: int
    ) -> T:
        """Return the first result that is good, at more and more bits.

        Raises Undecided where even the most bits leave something open.
        """
        bits = first
        while bits <= MOST_BITS:
            with arb_bits(bits):
                try:
                    if bits not in self._motions:
                        self._motions[bits] = Requested(self.scene, *self._moments)
                    result = compute(self._motions[bits])
                    if good(result):
                        return result
                except Undecided:
                    self._motions.pop(bits, None)
            bits *= 2
        raise Undecided(f"{self.scene}")

    def _sharp(self, compute: Callable[[Requested], Numbers]) -> Numbers:
        """Return numbers by key, each to 90 bits or proved to be below 2^-1100."""
        return self._raised(
            compute, lambda found: all(x is None or _sharp(x) for x in found.values()), FIRST_BITS
        )

    @cached_property
    def record(self) -> Numbers:
        """The numbers of the record."""
        return self._sharp(Motion.record)

    @cached_property
    def requested(self) -> Numbers:
        """The numbers on request."""
        return self._sharp(Requested.requested)

    def numbers(self) -> dict[str, Any]:
        """Return the numbers of the record as numbers of mpmath, to 27 digits or more."""
        return {key: many_digits(x) for key, x in self.record.items() if x is not None}

    def exact(self, key: str) -> arb | None:
        """Return a number of the record or, where that has none of the name, one on request."""
        return self.record[key] if key in self.record else self.requested.get(key)

    @cached_property
    def half_parts(self) -> tuple[arb, arb] | None:
        """The two parts of the precession rate at T/2."""

        def good(parts: tuple[arb, arb] | None) -> bool:
            if parts is None:
                return True
            size = abs(parts[0]) + abs(parts[1])
            return all(part.is_finite() and part.rad() * 1000 <= size for part in parts)

        return self._raised(Motion.half_parts, good, 2 * FIRST_BITS)

    @property
    def phase(self) -> float:
        """The periods from the nearest passage of u1 to t = 0."""
        since = self._raised(lambda motion: motion.w0 / motion.K, arb.is_finite, FIRST_BITS)
        return float(((since - 1 if since > 0 else since + 1) / 2).mid())

    def at(self, t: float | Fraction, digits: int = 0) -> State:
        """Return the motion at a time, each angle within 2^-12 of its unit without whole turns.

        It is computed with about `digits` digits more than that takes.
        """
        time = Fraction(t)

        def good(state: State) -> bool:
            return all(_narrow(*pair) for pair in _with_units(state, wrapped=True))

        if (time, digits) not in self._states:
            first = self._bits_for(time) + 4 * digits
            self._states[time, digits] = self._raised(lambda motion: motion.at(time), good, first)
        return self._states[time, digits]

    def _bits_for(self, time: Fraction) -> int:
        """Return bits enough for the whole turns up to a time."""
        turns = abs(time) * Fraction(_size(self.scene))
        return FIRST_BITS + 64 * (max(0, math.ceil(math.log2(turns + 1))) // 64)

    def columns(self, t: float | Fraction) -> dict[str, arb]:
        """Return the columns of `lagtop table` but t, dphi and dpsi, by their definitions.

        The nutation rate has the sign of the growth of the tilt right after t.
        """
        state, later = self.at(t), self.at(Fraction(t) + Fraction(1, 2**40))
        with arb_bits(2 * FIRST_BITS):
            A, C, a, r0 = map(exact_arb, (*self._moments, self.scene.a, self.scene.r0))
            sin, cos, weight = state.theta.sin(), state.theta.cos(), a * A / 2
            growing = 1 if later.theta > state.theta else -1
            rise, across = growing * abs(state.theta_rate), state.psi_rate * sin
            sin_phi, cos_phi = state.phi.sin(), state.phi.cos()
            return {
                **dict(zip(("theta", "phi", "psi"), state[:3], strict=True)),
                **{"thetadot": rise, "phidot": state.phi_rate, "psidot": state.psi_rate},
                "p": across * sin_phi + rise * cos_phi,
                "q": across * cos_phi - rise * sin_phi,
                "r": r0,
                "u": cos,
                "moment": weight * sin,
                "axis_x": sin * state.psi.sin(),
                "axis_y": -sin * state.psi.cos(),
                "axis_z": cos,
                **{f"quaternion_{x}": y for x, y in zip("wxyz", state.quaternion, strict=True)},
                "energy": A * (rise**2 + across**2) / 2 + C * r0**2 / 2 + weight * cos,
                "Lz": A * across * sin + C * r0 * cos,
            }

    def errors(self, t: float, computed: tuple[float, ...]) -> list[float]:
        """Return the errors of theta, phi, psi and the four parts of the quaternion in units."""
        return _errors(computed, _with_units(self.at(t)))

    def wrapped_errors(self, t: float, computed: tuple[float, float]) -> list[float]:
        """Return the errors of phi and psi (radians) without whole turns, in units."""
        state, errors = self.at(t), []
        with arb_bits(8 * FIRST_BITS):
            for value, exact, rate in zip(computed, state[1:3], state[4:6], strict=True):
                turns = (arb(value) - exact) / (2 * arb.pi())
                away = 2 * arb.pi() * (turns - (turns + 0.5).floor())
                unit = EPS * (arb.max(arb(1), abs(arb(value))) + abs(state.tau * rate))
                errors.append(float((abs(away) / unit).abs_upper()))
        return errors

    def remainder_errors(self, t: float, computed: tuple[float, float]) -> list[float]:
        """Return the errors of dphi and dpsi (radians) in units."""

        def pairs(found: Remainders) -> list[tuple[arb, arb]]:
            return [
                (value, EPS * (arb.max(arb(1), abs(value)) + abs(found.tau * rate)))
                for value, rate in zip(found[:2], found[2:4], strict=True)
            ]

        time = Fraction(t)
        exact = self._raised(
            lambda motion: motion.remainders(time),
            lambda found: all(_narrow(*pair) for pair in pairs(found)),
            self._bits_for(time),
        )
        return _errors(computed, pairs(exact))

    def ulps(self, key: str, computed: float) -> float:
        """Return the distance of a key from its exact value, in gaps between doubles there.

        At most 1/2 (and a hair, where it is midway) says that no double is nearer.
        """
        exact = self.exact(key)
        if exact is None or not math.isfinite(computed):
            return math.inf
        with arb_bits(8 * FIRST_BITS):
            away = exact - exact_arb(Fraction(computed))
            outward = math.nextafter(computed, math.inf if away > 0 else -math.inf)
            gap = abs(exact_arb(Fraction(outward)) - exact_arb(Fraction(computed)))
            return float((abs(away) / gap).abs_upper())

    def away(self, key: str, computed: Fraction, digits: int) -> arb:
        """Return a bound of the distance of a number with `digits` digits from the exact value."""
        bits = 4 * digits + FIRST_BITS

        def good(exact: arb | None) -> bool:
            return exact is not None and (
                exact.rel_accuracy_bits() >= 4 * digits + 20 or bool(exact == 0)
            )

        def number(motion: Requested) -> arb | None:
            record = motion.record()
            return record[key] if key in record else motion.requested().get(key)

        exact = self._raised(number, good, bits)
        with arb_bits(bits):
            assert exact is not None
            return abs(exact - exact_arb(computed))

    def relative(self, key: str, computed: float, absolute: float | None = None) -> float:
        """Return the error of a key in eps of its exact value, or of the size given instead."""
        exact = self.exact(key)
        if exact is None or not math.isfinite(computed):
            return math.inf
        with arb_bits(8 * FIRST_BITS):
            away = abs(exact - exact_arb(Fraction(computed)))
            size = abs(exact) if absolute is None else exact_arb(Fraction(absolute))
            if not size > 0:
                return 0.0 if away.contains(0) else math.inf
            return float((away / (EPS * size)).abs_upper())


def _with_units(state: State, *, wrapped: bool = False) -> list[tuple[arb, arb]]:
    """Return each checked value and eps (max(1, |value|) + |tau rate|).

    For `wrapped` angles, whose whole turns do not count, it is eps (1 + |tau rate|).
    """
    pairs = [
        (value, EPS * (arb.max(arb(1), arb(0) if wrapped else abs(value)) + abs(state.tau * rate)))
        for value, rate in zip(state[:3], state[3:6], strict=True)
    ]
    spread = EPS * (1 + abs(state.tau * state.quaternion_rate))
    return pairs + [(part, spread) for part in state.quaternion]


def _errors(computed: tuple[float, ...], pairs: list[tuple[arb, arb]]) -> list[float]:
    """Return |computed - exact| over the unit; a NaN is infinitely wrong."""
    with arb_bits(4 * FIRST_BITS):
        return [
            float((abs(exact - value) / unit).abs_upper()) if math.isfinite(value) else math.inf
            for value, (exact, unit) in zip(computed, pairs, strict=True)
        ]


def _narrow(value: arb, unit: arb) -> bool:
    """Return whether a ball is far smaller than its unit."""
    return bool(value.is_finite() and unit.is_finite() and value.rad() < unit * 2.0**-12)


def _sharp(value: arb) -> bool:
    """Return whether a ball tells a double from its neighbours, or is sure to round to 0."""
    if not value.is_finite():
        return False
    return value.rel_accuracy_bits() >= GOOD_BITS or bool(abs(value) < arb(2) ** -1100)


def _size(scene: Scene) -> float:
    """Return about how many radians a unit of time can be."""
    rates = (scene.b, scene.r0, scene.theta_rate, scene.psi_rate)
    return math.sqrt(scene.a) + float(sum(abs(rate) for rate in rates))
