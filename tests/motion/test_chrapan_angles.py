"""Chrapan's sections 5 to 7, equation by equation, for tops of both directions of spin.

On one side stand the angles and the record of the program in 150 digits; on the other his formulas
for nutation, spin and precession over mpmath's elliptic functions, and a quadrature.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any, ClassVar

import pytest
from chrapan_top import (
    FAR,
    FIRST,
    HALF,
    LEFT,
    MOTIONS,
    PARTS,
    RIGHT,
    UPRIGHT,
    Motion,
    ar,
    moments,
    spoil,
)
from equations import EquationTests, Pair, Register, Sides
from errata import misprints

chrapan = Register()
equation, as_printed = chrapan.equation, chrapan.as_printed


@equation("(5,1)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.roots

        def inverse_rate(chi: Any, of: Motion = motion) -> Any:
            u1, u2, u3 = of.roots
            u = u1 - (u1 - u2) * ar.sin(chi) ** 2
            return 4 / ar.sqrt(of.a * (u3 - u))

        with ar.workdps(50):
            yield motion.T, ar.quad(inverse_rate, [0, ar.pi / 4, ar.pi / 2])
        yield motion.T, 4 * ar.ellipk((u1 - u2) / (u3 - u2)) / ar.sqrt(motion.a * (u3 - u2))


@equation("(5,2)")
def _() -> Sides:
    for motion in MOTIONS:
        u1, u2, u3 = motion.roots
        for part in (1, 3):
            yield motion.u(part * motion.T / 4), u3 - ar.sqrt((u3 - u1) * (u3 - u2))
        yield motion.u_quarter, motion.u(motion.T / 4)


def _nutation_rate(motion: Motion, t: Any) -> Any:
    (u1, u2, u3), u = motion.roots, motion.u(t)
    return ar.sqrt(motion.a * (u1 - u) * (u - u2) * (u3 - u) / (1 - u * u))


@equation("(5,3)")
def _() -> Sides:
    for motion, t in moments():
        sign = ar.sign(ar.sin(2 * ar.pi * t / motion.T))
        yield motion.rates(t)[0], sign * _nutation_rate(motion, t)


def _quarters(motion: Motion) -> tuple[Any, Any]:
    """Return how far the tilt goes in the first and in the second quarter of a period."""
    start, middle, end = (motion.angles(part * motion.T / 4)[0] for part in (0, 1, 2))
    return middle - start, end - middle


@equation("section 5: quarters of the nutation")
def _() -> Sides:
    for motion in [*MOTIONS, UPRIGHT]:
        quarters = motion.u(ar.mpf(0)), motion.u(motion.T / 4), motion.u(motion.T / 2)
        first, second = quarters[0] - quarters[1], quarters[1] - quarters[2]
        u1, u2, u3 = motion.roots
        ratio = ar.sqrt((u3 - u1) / (u3 - u2))
        yield first / second, ratio
        yield ar.sign(1 - ratio), 1


@as_printed("section 5: quarters of the nutation as printed, the tilt")
def _() -> Sides:
    first, second = _quarters(UPRIGHT)
    yield ar.sign(second - first), 1


@as_printed("section 5: quarters of the nutation as printed, the labels of u")
def _() -> Sides:
    """Read u(T)/4 and u(3T)/4, as the text has them."""
    for part in (1, 3):
        quarter = RIGHT.u(part * RIGHT.T) / 4
        yield ar.sign((quarter - RIGHT.u2) - (RIGHT.u1 - quarter)), 1


def _steady_spin(motion: Motion) -> Any:
    """Return the first term of (6,1) over t."""
    return motion.r0 * (1 - motion.C / (2 * motion.A))


def _printed_arccot(motion: Motion, t: Any) -> Any:
    """Return the arccot of (6,1) from u, its roots positive as the text has them."""
    (u1, u2, u3), u = motion.roots, motion.u(t)
    return ar.acot(ar.sqrt((u3 - u) * (u - u2) / ((u3 + u2) * (u1 - u))))


@equation("section 6: spin after half a period and a whole one")
def _() -> Sides:
    for motion in MOTIONS:
        for part in (1, 2):
            t = part * motion.T / 2
            right = _steady_spin(motion) * t + motion.sigma * part * ar.pi / 2
            yield motion.angles(t)[1], right


def _alike(angle: int) -> Sides:
    """Yield the growth of an angle in the first and in the second half of a period."""
    for motion in MOTIONS:
        start, half, end = (motion.angles(part * motion.T / 2)[angle] for part in range(3))
        yield half - start, end - half


@equation("section 6: the halves of the spin are alike")
def _() -> Sides:
    yield from _alike(1)


@equation("(6,2)")
def _() -> Sides:
    for motion in MOTIONS:
        half = motion.r0 - 2 * motion.mgs / (motion.C * motion.r0) * motion.u2
        yield motion.rates(motion.T)[1], motion.r0
        yield motion.rates(motion.T / 2)[1], half
        yield motion.spin_rate_half, half


@equation("(6,3)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.angles(motion.T)[1] / motion.T, motion.mean_spin_rate
        yield motion.mean_spin_rate, _steady_spin(motion) + motion.sigma * ar.pi / motion.T


def _since_whole_period(motion: Motion, t: Any) -> Any:
    """Return tau of (6,5), counted from the last whole period."""
    return t - motion.T * ar.floor(t / motion.T)


def _since_half_period(motion: Motion, t: Any) -> Any:
    """Return tau of (6,5) as printed, counted from the last half period."""
    return t - motion.T / 2 * ar.floor(2 * t / motion.T)


def _remainder(motion: Motion, angle: int, t: Any) -> Any:
    """Return the spin (1) or the precession (2) without its mean growth, by our angles alone."""
    mean = (motion.mean_spin_rate, motion.mean_precession_rate)[angle - 1]
    return motion.angles(t)[angle] - mean * t


def _spin_remainder(motion: Motion, tau: Any) -> Any:
    """Return (6,4) by Jacobi's functions, for a time since the last whole period."""
    return motion.sigma * (motion.spin_arccot(tau) - ar.pi * tau / motion.T)


@equation("(6,4)")
def _() -> Sides:
    for motion, t in moments(*FIRST):
        (u1, u2, u3), u = motion.roots, motion.u(t)
        side = ar.sign(motion.T / 2 - t)
        arccot = ar.atan2(ar.sqrt((u3 + u2) * (u1 - u)), side * ar.sqrt((u3 - u) * (u - u2)))
        yield _remainder(motion, 1, t), motion.sigma * (arccot - ar.pi * t / motion.T)


@as_printed("(6,4)")
def _() -> Sides:
    t = RIGHT.T * 5 / 8
    tau = _since_half_period(RIGHT, t)
    yield _remainder(RIGHT, 1, t), _printed_arccot(RIGHT, tau) - ar.pi * tau / RIGHT.T
    yield _remainder(RIGHT, 1, t), _printed_arccot(RIGHT, t) - ar.pi * tau / RIGHT.T


@equation("(6,5)")
def _() -> Sides:
    for motion, t in moments(*PARTS[2:], *FAR):
        for angle in (1, 2):
            there = _remainder(motion, angle, _since_whole_period(motion, t))
            yield _remainder(motion, angle, t), there


@as_printed("(6,5)")
def _() -> Sides:
    t = RIGHT.T * 5 / 8
    for angle in (1, 2):
        there = _remainder(RIGHT, angle, _since_half_period(RIGHT, t))
        yield _remainder(RIGHT, angle, t), there


@equation("sections 6 and 7: no remainder at half periods")
def _() -> Sides:
    for motion, t in moments(*(ar.mpf(i) / 2 for i in (-3, 1, 2, 5))):
        for angle in (1, 2):
            yield _remainder(motion, angle, t), 0


def _precession(motion: Motion, t: Any, growth: Any) -> Any:
    """Return (7,1) with its bracket."""
    u2, u3 = motion.roots[1:]
    drift = motion.mgs / (motion.C * motion.r0) * (2 - (u3 - u2)) * t
    waves = ar.pi * ar.floor(t / motion.T) + motion.precession_arccot(t) + motion.series(t)
    rate = ar.sqrt(motion.a * (u3 - u2))
    return drift + motion.sigma * (rate * t * growth - waves)


@as_printed("(7,1) as printed, for r0 < 0")
def _() -> Sides:
    t, (E, F, rest) = LEFT.T / 3, LEFT.growth()
    drift = LEFT.mgs / (LEFT.C * LEFT.r0) * (2 - (LEFT.u3 - LEFT.u2)) * t
    right = drift - (_precession(LEFT, t, E - F * rest) - drift)
    yield LEFT.angles(t)[2], right


@as_printed("(7,1) as printed, after the first period")
def _() -> Sides:
    t, (E, F, rest) = RIGHT.T * 13 / 10, RIGHT.growth()
    right = _precession(RIGHT, t, E - F * rest)
    yield RIGHT.angles(t)[2], right + ar.pi * ar.floor(t / RIGHT.T)


@equation("section 7: precession after half a period and a whole one")
def _() -> Sides:
    for motion in MOTIONS:
        E, F, rest = motion.growth()
        for part in (1, 2):
            t = part * motion.T / 2
            drift = motion.mgs / (motion.C * motion.r0) * (2 - (motion.u3 - motion.u2)) * t
            growing = ar.sqrt(motion.a * (motion.u3 - motion.u2)) * t * (E - F * rest)
            right = drift + motion.sigma * (growing - part * ar.pi / 2)
            yield motion.angles(t)[2], right


@equation("section 7: the halves of the precession are alike")
def _() -> Sides:
    yield from _alike(2)


@equation("(7,2)")
def _() -> Sides:
    for motion in MOTIONS:
        u2, u3 = motion.roots[1:]
        amplitude = ar.asin(ar.sqrt((u3 - u2) / (u3 + 1)))
        yield motion.amplitude_deg, ar.degrees(amplitude)
        yield motion.alpha, ar.ellipf(amplitude, 1 - motion.k**2)


@equation("section 7: rates of the precession at T/2 and T")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.rates(motion.T)[2], 0
        yield motion.rates(motion.T / 2)[2], 2 * motion.mgs / (motion.C * motion.r0)


@as_printed("section 7: rates of the precession at T/2 and T")
def _() -> Sides:
    yield RIGHT.rates(RIGHT.T)[1], 0
    yield RIGHT.rates(RIGHT.T / 2)[1], 2 * RIGHT.mgs / (RIGHT.C * RIGHT.r0)


def _mean_precession(motion: Motion, sigma: Any) -> Any:
    """Return (7,3) for a direction of spin."""
    u2, u3 = motion.roots[1:]
    E, F, rest = motion.growth()
    curve = motion.K * (E - F * rest) - ar.pi / 4
    return motion.mgs / (motion.C * motion.r0) * (2 - (u3 - u2)) + sigma * 4 / motion.T * curve


@equation("(7,3)")
def _() -> Sides:
    for motion in MOTIONS:
        yield motion.mean_precession_rate, _mean_precession(motion, motion.sigma)
        yield motion.mean_precession_rate, motion.angles(motion.T)[2] / motion.T


def _precession_remainder(motion: Motion, tau: Any) -> Any:
    """Return (7,4) for a time since the last whole period."""
    waves = motion.precession_arccot(tau) + motion.series(tau)
    return motion.sigma * (ar.pi * tau / motion.T - waves)


@as_printed("(7,4)")
def _() -> Sides:
    t = RIGHT.T * 5 / 8
    tau = _since_half_period(RIGHT, t)
    yield _remainder(RIGHT, 2, t), _precession_remainder(RIGHT, tau)
    for arccot in (RIGHT.precession_arccot(t), RIGHT.precession_arccot(t) - ar.pi):
        waves = arccot + RIGHT.series(t)
        yield _remainder(RIGHT, 2, t), ar.pi * tau / RIGHT.T - waves


def _spin(motion: Motion, t: Any, arccot: Callable[[Motion, Any], Any]) -> tuple[Any, Any]:
    """Return the spin and (6,1) as printed, with an arccot."""
    return motion.angles(t)[1], _steady_spin(motion) * t + arccot(motion, t)


def _whole_precession(motion: Motion, t: Any, growth: Any) -> tuple[Any, Any]:
    """Return the precession and (7,1), with a function of E, F and 1 - E/K as its bracket."""
    return motion.angles(t)[2], _precession(motion, t, growth(*motion.growth()))


def _whole_spin(motion: Motion, t: Any, arccot: Any) -> tuple[Any, Any]:
    """Return the spin and (6,1) with an arccot, and with half a turn per whole period."""
    turned = ar.pi * ar.floor(t / motion.T) + arccot(motion, t)
    return motion.angles(t)[1], _steady_spin(motion) * t + motion.sigma * turned


ANYWHERE: dict[str, Pair] = {
    "(6,1)": lambda top, t: _whole_spin(top, t, Motion.spin_arccot),
    "(7,1)": lambda top, t: _whole_precession(top, t, lambda E, F, rest: E - F * rest),
}
FAR_AWAY: dict[str, Pair] = {
    "(6,6)": lambda top, t: (
        top.angles(t)[1],
        top.mean_spin_rate * t + _spin_remainder(top, _since_whole_period(top, t)),
    ),
    "(7,5)": lambda top, t: (
        top.angles(t)[2],
        top.mean_precession_rate * t + _precession_remainder(top, _since_whole_period(top, t)),
    ),
}
chrapan.each(moments, ANYWHERE)
chrapan.each(partial(moments, *FAR), FAR_AWAY)
chrapan.each(
    partial(moments, *HALF),
    {
        "(6,1) from u, in the first half of a period": lambda top, t: _whole_spin(
            top, t, _printed_arccot
        )
    },
)
chrapan.each(
    partial(moments, *FIRST),
    {"(7,4)": lambda top, t: (_remainder(top, 2, t), _precession_remainder(top, t))},
)

PRINTED_SIDES: dict[str, Callable[[], tuple[Any, Any]]] = {
    "(7,1) as printed, the bracket": lambda: _whole_precession(
        RIGHT, RIGHT.T / 3, lambda E, F, rest: (E - F) * rest
    ),
    "(5,3)": lambda: (RIGHT.rates(RIGHT.T * 3 / 4)[0], _nutation_rate(RIGHT, RIGHT.T * 3 / 4)),
    "(6,1) as printed, in the second half of a period": lambda: _spin(
        RIGHT, RIGHT.T * 3 / 4, _printed_arccot
    ),
    "(6,1) as printed, for r0 < 0": lambda: _spin(LEFT, LEFT.T / 4, _printed_arccot),
    "(6,1) as printed, after the first period": lambda: _spin(
        RIGHT, RIGHT.T * 13 / 10, Motion.spin_arccot
    ),
    "section 6: spin after half a period and a whole one": lambda: (
        LEFT.angles(LEFT.T)[1],
        _steady_spin(LEFT) * LEFT.T + ar.pi,
    ),
    "(6,3)": lambda: (LEFT.mean_spin_rate, _steady_spin(LEFT) + ar.pi / LEFT.T),
    "(7,3) as printed, for r0 < 0": lambda: (LEFT.mean_precession_rate, _mean_precession(LEFT, 1)),
    "(7,3) as printed, the left side": lambda: (RIGHT.mean_spin_rate, _mean_precession(RIGHT, 1)),
}
"""Equations as printed, with one pair of sides."""

chrapan.each_as_printed(lambda: [()], PRINTED_SIDES)


WORKED = Motion(theta0_deg=30)
"""The worked example of section 8."""
PRINTED = ar.mpf("7.98957"), ar.mpf("14.2682")
"""Mean precession rate and precession rate at T/2, as section 8 prints them."""


@equation("section 8: rates of the precession")
def _() -> Sides:
    yield WORKED.mean_precession_rate / PRINTED[0], 1
    yield WORKED.precession_rate_half / PRINTED[1], 1


@as_printed("section 8: rates of the precession")
def _() -> Sides:
    yield WORKED.mean_spin_rate / PRINTED[0], 1
    yield WORKED.spin_rate_half / PRINTED[1], 1


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 5, 6, 7, 8)
    tolerances: ClassVar[dict[str, float]] = {"section 8: rates of the precession": 2e-4}

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch, __name__)
