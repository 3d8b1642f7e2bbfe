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
    PARTS,
    RIGHT,
    UPRIGHT,
    Motion,
    ar,
    moments,
    spoil,
    tops,
)
from equations import EquationTests, Pairs, Register
from errata import misprints

chrapan = Register()


def period_by_quadrature(top: Motion) -> Any:
    """Return (5,1) as an integral over chi with u = u1 - (u1 - u2) sin^2 chi."""

    def inverse_rate(chi: Any) -> Any:
        u = top.u1 - (top.u1 - top.u2) * ar.sin(chi) ** 2
        return 4 / ar.sqrt(top.a * (top.u3 - u))

    with ar.workdps(50):
        return ar.quad(inverse_rate, [0, ar.pi / 4, ar.pi / 2])


def nutation_rate(top: Motion, t: Any) -> Any:
    """Return the size of the right side of (5,3)."""
    (u1, u2, u3), u = top.roots, top.u(t)
    return ar.sqrt(top.a * (u1 - u) * (u - u2) * (u3 - u) / (1 - u * u))


def quarters(top: Motion) -> Pairs:
    """Return how far u goes in the first quarter of a period, over how far in the second."""
    start, middle, end = (top.u(part * top.T / 4) for part in (0, 1, 2))
    ratio = ar.sqrt((top.u3 - top.u1) / (top.u3 - top.u2))
    return [((start - middle) / (middle - end), ratio), (ar.sign(1 - ratio), 1)]


def slower_tilt(top: Motion) -> tuple[Any, Any]:
    """Return whether the tilt goes less far in the first quarter, as section 5 says."""
    start, middle, end = (top.angles(part * top.T / 4)[0] for part in (0, 1, 2))
    return ar.sign(end - 2 * middle + start), 1


def labelled(top: Motion, part: int) -> tuple[Any, Any]:
    """Return the inequality of section 5 with u(T)/4 and u(3T)/4, as the text has them."""
    quarter = top.u(part * top.T) / 4
    return ar.sign((quarter - top.u2) - (top.u1 - quarter)), 1


def steady_spin(top: Motion) -> Any:
    """Return the first term of (6,1) over t."""
    return top.r0 * (1 - top.C / (2 * top.A))


def elementary(top: Motion) -> Any:
    """Return the precession rate mgs/(C r0) of elementary theory."""
    return top.mgs / (top.C * top.r0)


def arccot_of_u(top: Motion, t: Any) -> Any:
    """Return the arccot of (6,1) from u, its roots positive as the text has them."""
    (u1, u2, u3), u = top.roots, top.u(t)
    return ar.acot(ar.sqrt((u3 - u) * (u - u2) / ((u3 + u2) * (u1 - u))))


def signed_arccot_of_u(top: Motion, t: Any) -> Any:
    """Return the arccot of (6,4), negative roots in the second half of a period."""
    (u1, u2, u3), u, side = top.roots, top.u(t), ar.sign(top.T / 2 - t)
    return ar.atan2(ar.sqrt((u3 + u2) * (u1 - u)), side * ar.sqrt((u3 - u) * (u - u2)))


def spin(top: Motion, t: Any, arccot: Callable[[Motion, Any], Any], sigma: Any = 1) -> Any:
    """Return the spin and (6,1) with an arccot, for a direction of spin."""
    return top.angles(t)[1], steady_spin(top) * t + sigma * arccot(top, t)


def growing_arccot(top: Motion, t: Any, arccot: Callable[[Motion, Any], Any]) -> Any:
    """Return an arccot with half a turn more per whole period."""
    return ar.pi * ar.floor(t / top.T) + arccot(top, t)


def halves(top: Motion, angle: int) -> tuple[Any, Any]:
    """Return the growth of an angle in the first and in the second half of a period."""
    start, half, end = (top.angles(part * top.T / 2)[angle] for part in range(3))
    return half - start, end - half


def since(top: Motion, t: Any, parts: int = 1) -> Any:
    """Return tau of (6,5), counted from the last whole period, or half (`parts` = 2) as printed."""
    return t - top.T / parts * ar.floor(parts * t / top.T)


def remainder(top: Motion, angle: int, t: Any) -> Any:
    """Return the spin (1) or the precession (2) without its mean growth, by our angles alone."""
    mean = (top.mean_spin_rate, top.mean_precession_rate)[angle - 1]
    return top.angles(t)[angle] - mean * t


def spin_wave(top: Motion, tau: Any, arccot: Callable[[Motion, Any], Any]) -> Any:
    """Return (6,4) with an arccot, for a time since the last whole period."""
    return top.sigma * (arccot(top, tau) - ar.pi * tau / top.T)


def precession_waves(top: Motion, t: Any) -> Any:
    """Return the arccot and the series of (7,1), within a period."""
    return top.precession_arccot(t) + top.series(t)


def precession_wave(top: Motion, tau: Any) -> Any:
    """Return (7,4) for a time since the last whole period."""
    return top.sigma * (ar.pi * tau / top.T - precession_waves(top, tau))


def drift(top: Motion) -> Any:
    """Return the first term of (7,1) over t."""
    return elementary(top) * (2 - (top.u3 - top.u2))


def curve(top: Motion) -> Any:
    """Return the bracket of (7,1)."""
    E, F, rest = top.growth()
    return E - F * rest


def precession(top: Motion, t: Any, bracket: Any, waves: Any, sigma: Any = 1) -> Any:
    """Return the precession and (7,1) with a bracket and with waves, for a direction of spin."""
    rate = ar.sqrt(top.a * (top.u3 - top.u2))
    return top.angles(t)[2], drift(top) * t + sigma * (rate * t * bracket - waves)


def printed_rates(mean: Any, half: Any) -> Pairs:
    """Return a mean rate and a rate at T/2 over those of the precession that section 8 prints."""
    return [(mean / ar.mpf("7.98957"), 1), (half / ar.mpf("14.2682"), 1)]


def mean_precession(top: Motion, sigma: Any) -> Any:
    """Return (7,3) for a direction of spin."""
    return drift(top) + sigma * 4 / top.T * (top.K * curve(top) - ar.pi / 4)


chrapan.each(
    tops,
    {
        "(5,1)": lambda top: [
            (top.T, period_by_quadrature(top)),
            (top.T, 4 * ar.ellipk(top.k**2) / ar.sqrt(top.a * (top.u3 - top.u2))),
        ],
        "(5,2)": lambda top: [
            (top.u_quarter, top.u(top.T / 4)),
            *(
                (top.u(i * top.T / 4), top.u3 - ar.sqrt((top.u3 - top.u1) * (top.u3 - top.u2)))
                for i in (1, 3)
            ),
        ],
        "section 6: spin after half a period and a whole one": lambda top: [
            spin(top, i * top.T / 2, lambda *_, i=i: i * ar.pi / 2, top.sigma) for i in (1, 2)
        ],
        "section 6: the halves of the spin are alike": lambda top: halves(top, 1),
        "(6,2)": lambda top: [
            (top.rates(top.T)[1], top.r0),
            *(
                (x, top.r0 - 2 * elementary(top) * top.u2)
                for x in (top.rates(top.T / 2)[1], top.spin_rate_half)
            ),
        ],
        "(6,3)": lambda top: [
            (top.angles(top.T)[1] / top.T, top.mean_spin_rate),
            (top.mean_spin_rate, steady_spin(top) + top.sigma * ar.pi / top.T),
        ],
        "section 7: precession after half a period and a whole one": lambda top: [
            precession(top, i * top.T / 2, curve(top), i * ar.pi / 2, top.sigma) for i in (1, 2)
        ],
        "section 7: the halves of the precession are alike": lambda top: halves(top, 2),
        "(7,2)": lambda top: [
            (ar.radians(top.amplitude_deg), ar.asin(ar.sqrt((top.u3 - top.u2) / (top.u3 + 1)))),
            (top.alpha, ar.ellipf(ar.radians(top.amplitude_deg), 1 - top.k**2)),
        ],
        "section 7: rates of the precession at T/2 and T": lambda top: [
            (top.rates(top.T)[2], 0),
            (top.rates(top.T / 2)[2], 2 * elementary(top)),
        ],
        "(7,3)": lambda top: [
            (top.mean_precession_rate, mean_precession(top, top.sigma)),
            (top.mean_precession_rate, top.angles(top.T)[2] / top.T),
        ],
    },
)
chrapan.each(lambda: [*tops(), (UPRIGHT,)], {"section 5: quarters of the nutation": quarters})
chrapan.each(
    moments,
    {
        "(5,3)": lambda top, t: (
            top.rates(t)[0],
            ar.sign(ar.sin(2 * ar.pi * t / top.T)) * nutation_rate(top, t),
        ),
        "(6,1)": lambda top, t: spin(
            top, t, partial(growing_arccot, arccot=Motion.spin_arccot), top.sigma
        ),
        "(7,1)": lambda top, t: precession(
            top, t, curve(top), growing_arccot(top, t, precession_waves), top.sigma
        ),
    },
)
chrapan.each(
    partial(moments, *HALF),
    {
        "(6,1) from u, in the first half of a period": lambda top, t: spin(
            top, t, arccot_of_u, top.sigma
        )
    },
)
chrapan.each(
    partial(moments, *FIRST),
    {
        "(6,4)": lambda top, t: (remainder(top, 1, t), spin_wave(top, t, signed_arccot_of_u)),
        "(7,4)": lambda top, t: (remainder(top, 2, t), precession_wave(top, t)),
    },
)
chrapan.each(
    partial(moments, *PARTS[2:], *FAR),
    {
        "(6,5)": lambda top, t: [
            (remainder(top, angle, t), remainder(top, angle, since(top, t))) for angle in (1, 2)
        ]
    },
)
chrapan.each(
    partial(moments, *(ar.mpf(i) / 2 for i in (-3, 1, 2, 5))),
    {
        "sections 6 and 7: no remainder at half periods": lambda top, t: [
            (remainder(top, angle, t), 0) for angle in (1, 2)
        ]
    },
)
chrapan.each(
    partial(moments, *FAR),
    {
        "(6,6)": lambda top, t: (
            top.angles(t)[1],
            top.mean_spin_rate * t + spin_wave(top, since(top, t), Motion.spin_arccot),
        ),
        "(7,5)": lambda top, t: (
            top.angles(t)[2],
            top.mean_precession_rate * t + precession_wave(top, since(top, t)),
        ),
    },
)
chrapan.each(
    lambda: [(RIGHT,)],
    {
        "section 8: rates of the precession": lambda top: printed_rates(
            top.mean_precession_rate, top.precession_rate_half
        )
    },
)

chrapan.each_as_printed(
    lambda: [(RIGHT, RIGHT.T * 5 / 8)],
    {
        "(5,3)": lambda top, t: (top.rates(t)[0], nutation_rate(top, t)),
        "(6,1) as printed, in the second half of a period": partial(spin, arccot=arccot_of_u),
        "(6,1) as printed, after the first period": lambda top, t: spin(
            top, t + top.T, Motion.spin_arccot
        ),
        "(6,4)": lambda top, t: [
            (remainder(top, 1, t), arccot_of_u(top, tau) - ar.pi * since(top, t, 2) / top.T)
            for tau in (since(top, t, 2), t)
        ],
        "(6,5)": lambda top, t: [
            (remainder(top, angle, t), remainder(top, angle, since(top, t, 2))) for angle in (1, 2)
        ],
        "(7,1) as printed, the bracket": lambda top, t: precession(
            top, t, curve(top) + top.growth()[1] * (1 - top.growth()[2]), precession_waves(top, t)
        ),
        "(7,1) as printed, after the first period": lambda top, t: precession(
            top, t + top.T, curve(top), precession_waves(top, t + top.T)
        ),
        "(7,3) as printed, the left side": lambda top, _: (
            top.mean_spin_rate,
            mean_precession(top, 1),
        ),
        "(7,4)": lambda top, t: [
            (remainder(top, 2, t), precession_wave(top, since(top, t, 2))),
            *(
                (remainder(top, 2, t), ar.pi * since(top, t, 2) / top.T + turn - wave)
                for turn in (0, ar.pi)
                for wave in [precession_waves(top, t)]
            ),
        ],
        "section 5: quarters of the nutation as printed, the labels of u": lambda top, _: [
            labelled(top, part) for part in (1, 3)
        ],
        "section 7: rates of the precession at T/2 and T": lambda top, _: [
            (top.rates(top.T)[1], 0),
            (top.rates(top.T / 2)[1], 2 * elementary(top)),
        ],
        "section 8: rates of the precession": lambda top, _: printed_rates(
            top.mean_spin_rate, top.spin_rate_half
        ),
    },
)
chrapan.each_as_printed(
    lambda: [(LEFT, LEFT.T / 3)],
    {
        "(6,1) as printed, for r0 < 0": partial(spin, arccot=arccot_of_u),
        "section 6: spin after half a period and a whole one": lambda top, _: spin(
            top, top.T, lambda *_: ar.pi
        ),
        "(6,3)": lambda top, _: (top.mean_spin_rate, steady_spin(top) + ar.pi / top.T),
        "(7,1) as printed, for r0 < 0": lambda top, t: precession(
            top, t, curve(top), precession_waves(top, t)
        ),
        "(7,3) as printed, for r0 < 0": lambda top, _: (
            top.mean_precession_rate,
            mean_precession(top, 1),
        ),
    },
)
chrapan.each_as_printed(
    lambda: [(UPRIGHT,)],
    {"section 5: quarters of the nutation as printed, the tilt": slower_tilt},
)


class TestChrapan(EquationTests):
    """Tests of the register."""

    register: ClassVar[Register] = chrapan
    errata: ClassVar[set[str]] = misprints("Chrapan", 5, 6, 7, 8)
    tolerances: ClassVar[dict[str, float]] = {"section 8: rates of the precession": 2e-4}

    def spoil(self, patch: pytest.MonkeyPatch) -> None:
        """Put tops in place whose record and angles are wrong."""
        spoil(patch)
