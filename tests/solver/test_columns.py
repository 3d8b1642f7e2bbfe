"""Columns and angles over time: the numbers, and the shapes and blocks of arrays.

Proved rows are checked by the reference in mpmath (`record_reference`), which has formulas of its
own, by Carlson's integrals, and doubles by proved rows.  Errors of doubles are in units of
eps (max(1, |value|) + |tau rate|), where tau is the time since the nearest whole period.
"""

from __future__ import annotations

import math
import random
from collections.abc import Iterable, Iterator
from fractions import Fraction
from functools import partial
from typing import Any

import mpmath
import numpy as np
import pytest
from lagtop import Motion, Top, solve
from record_reference import reference_columns, reference_record
from scenes import EPS, EVERY_KIND, UNIT

from lagrange_cli.arithmetic.enclosures import at_precision, pi_to
from lagrange_cli.arithmetic.enclosures import exact as ball_of
from lagrange_cli.solver.columns import COLUMNS, SCALARS
from lagrange_cli.solver.sampling import period_of, whole_periods
from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top.units import Units

TIMES = [0.375, -7.25, 2.0**-40, -(2.0**-40), 1e3, -1e6, 1e12]
TURN = 2 * pi_to(60)
HALF_A_TURN = Fraction("3.14159265358979323846264338328")
"""Half a turn in thirty digits."""
MEANS = {"phi": "spin", "psi": "precession"}
COLUMNS_OF_STATE = [x for x in COLUMNS if x not in {"t", "dphi", "dpsi"}]


@pytest.mark.parametrize("name", EVERY_KIND)
def test_proved_rows_are_those_of_the_reference(name: str) -> None:
    """Thirty digits of every column, of dphi, dpsi and wrapped angles; and the radii of doubles."""
    inputs, motion = Top(**EVERY_KIND[name]).as_dict(), solve(Top(**EVERY_KIND[name]))
    record = reference_record(inputs, root_digits=400)
    many = ProvedTable(motion, [*COLUMNS_OF_STATE, "dphi", "dpsi"], 30, units=Units(radians=True))
    doubles = ProvedTable(motion, COLUMNS_OF_STATE, units=Units(radians=True))
    wrapped = ProvedTable(motion, list(MEANS), 30, units=Units(radians=True), wrap=True)
    for t in (-7.25, 1e12)[: 1 if "separatrix" in name else None]:
        with mpmath.workdps(120):
            exact = reference_columns(inputs, t, root_digits=400)
            means = {x: record.get(f"mean_{y}_rate") for x, y in MEANS.items()}
            if "separatrix" in name:  # the limits at u = 1
                means = {"phi": exact["r"] - record["b"] / 2, "psi": record["b"] / 2}
            exact |= {f"d{x}": exact[x] - y * t for x, y in means.items() if y is not None}
            lacking = {*doubles.chosen} - {*exact}
            assert not lacking, f"add {lacking} to reference_columns of record_reference.py"
            for column, found in zip(many.chosen, many.row(Fraction(t)), strict=True):
                if (true := exact.get(column)) is not None:
                    apart = abs(mpmath.mpf(found.value) - true)
                    assert apart <= abs(true) * mpmath.mpf("5.01e-30") + 1e-90, (t, column)
            for column, found in zip(MEANS, wrapped.row(Fraction(t)), strict=True):
                turns = (exact[column] - mpmath.mpf(found.value)) / (2 * mpmath.pi)
                assert abs(turns - mpmath.nint(turns)) <= 1e-30, (t, column)
                assert abs(Fraction(found.value)) <= HALF_A_TURN, (t, column)
            for column, found in zip(doubles.chosen, doubles.row(Fraction(t)), strict=True):
                apart, radius = abs(found.value - exact[column]), float(found.radius)
                assert apart <= radius + 1e-90, (t, column)
                assert radius <= abs(found.value) * EPS, (t, column)


def period(motion: Motion) -> float:
    """Return the nutation period, or 0 where there is none."""
    return float(motion.T_nutation or 0)


def errors(motion: Motion, times: Iterable[float]) -> Iterator[float]:
    """Yield the errors of angles and quaternion, wrapped angles and waves at times."""
    names = ["theta", "phi", "psi", "quaternion", "dphi", "dpsi", "thetadot", "phidot", "psidot"]
    listed, table = list(times), ProvedTable(motion, names, 40, units=Units(radians=True))
    found = motion.table(listed, names[:4]) | motion.table(listed, names[4:6])
    wrapped = motion.angles(listed, wrap=True)
    means = {x: float(getattr(motion, f"mean_{y}_rate") or 0) for x, y in MEANS.items()}
    for i, t in enumerate(listed):
        row = zip(table.chosen, table.row(Fraction(t)), strict=True)
        exact = {name: Fraction(number.value) for name, number in row}
        tau = abs(math.remainder(t, period(motion)) if period(motion) else t)
        rate = {x: abs(float(exact[f"{x}dot"])) for x in ("theta", "phi", "psi")}
        rate |= {f"d{x}": abs(float(exact[f"{x}dot"]) - mean) for x, mean in means.items()}
        sizes = {x: max(1, abs(float(exact[x]))) + tau * rate[x] for x in rate}
        whole = sum(rate[x] for x in ("theta", "phi", "psi"))
        for name, column in found.items():
            size = sizes.get(name, 1 + tau * whole / 2)
            yield abs(float(Fraction(float(column[i])) - exact[name])) / (EPS * size)
        for name in means:
            value = float(getattr(wrapped, name)[i])
            off = (Fraction(value) - exact[name]) / TURN
            yield (
                abs(float((off - round(off)) * TURN))
                / EPS
                / (max(1, abs(value)) + tau * rate[name])
            )


@pytest.mark.parametrize("name", EVERY_KIND)
def test_doubles_are_those_of_proved_rows(name: str) -> None:
    """Worst seen: 1.2 units, and 0.5 ulp of the size of a rate, a moment or an energy."""
    top, times = Top(**EVERY_KIND[name]), TIMES[: 4 if "separatrix" in name else None]
    motion = solve(top)
    assert max(errors(motion, times)) <= 1.5
    theta, phi, psi = motion.angles([0.0])
    assert (theta[0], phi[0], psi[0]) == (motion.sampler().tilt, 0, 0)
    proved, doubles = (
        ProvedTable(motion, COLUMNS_OF_STATE, units=Units(radians=True)),
        motion.table(times, COLUMNS_OF_STATE),
    )
    rates = (motion.a**0.5, top.r0, top.thetadot0, top.psidot0)
    for axis, angle in motion.angles(times)._asdict().items():
        assert angle.tolist() == doubles[axis].tolist()
    speed, inertia = 1 + sum(abs(float(x)) for x in rates), float(top.A) + float(top.C)
    sizes = {  # by the unit: a rate, a momentum or an energy
        column: (inertia if "mass" in SCALARS[column].unit else 1)
        * speed ** (2 if "time²" in SCALARS[column].unit else 1)
        for column in proved.chosen
    }
    for i, t in enumerate(times):
        for column, found in zip(proved.chosen, proved.row(Fraction(t)), strict=True):
            if column not in {"theta", "phi", "psi"}:
                off = abs(doubles[column][i] - found.value)
                assert off <= 5e-16 * sizes[column], (t, column)


# Next to quarter, half and whole periods


def beside(t: float) -> tuple[float, float, float]:
    """Return a time and both neighbours."""
    return math.nextafter(t, -math.inf), t, math.nextafter(t, math.inf)


def turning_times(motion: Motion, rng: random.Random) -> Iterator[float]:
    """Yield doubles at quarters of periods, and both neighbours, from 1 to 1e15 periods."""
    reach = min(motion.sampler().max_time, motion.sampler().max_wrapped)
    for exponent in (0, 4, 9, 14):
        whole = rng.randrange(10**exponent, 10 ** (exponent + 1)) if exponent else 1
        for quarter in (0, 0.25, 0.5, 0.75):
            t = rng.choice([-1, 1]) * (whole + quarter) * period(motion)
            yield from (x for x in beside(t) if abs(x) <= reach)


def leaning(theta0_deg: float) -> dict[str, float]:
    """Return a start on a pole whose axis hardly leaves it."""
    scene = {"m": 1.0, "A": 1.7603883050112619, "C": 4.552377252163958e-06, "s": 1.0, "g": 1.0}
    rates = {"r0": -5.090700293587707, "thetadot0": 0.026177118759960684}
    return scene | rates | {"theta0_deg": theta0_deg}


RANDOM = random.Random(180)
TURNING: dict[str, tuple[dict[str, Any], list[float], float]] = {
    "one frame is circular": ({"r0": 60.0}, [], 3),
    "both frames are theta functions": ({}, [], 3),
    "any start": ({"psidot0": 20.0, "thetadot0": 1.0}, [], 3),
    "over the top": (EVERY_KIND["over the top"], [], 3),
    "without torque": ({"g": 0.0, "psidot0": 3.0}, [], 3),
    "disc": (UNIT | {"A": 2, "C": 4, "r0": 5, "theta0_deg": 30}, [], 3),
    # worst seen 2.02 units, psi of the first: the sum of four terms, two of them beyond 2
    **{
        f"start at {tilt} degrees": (
            leaning(tilt),
            [-3.492421435710449, *(RANDOM.uniform(-30, 30) for _ in range(40))],
            2.1,
        )
        for tilt in (180.0, 0.0)
    },
    # a part of the quaternion that is next to 0 was off by 4.3 units, and had the wrong sign
    "half a turn": (
        UNIT
        | {"A": 1.6139871423392762, "C": 1.1020614314651334, "r0": 1.0071601560733234e-161}
        | {"theta0_deg": 179.9999982350077}
        | {"thetadot0": -2.4896274011607793, "psidot0": -3.945225420389403},
        [2.855707002683582],
        1,
    ),
    "half a turn without torque": (
        UNIT
        | {"s": 0, "A": 1.8186743437876096, "C": 1.8186743437876096, "r0": 0, "theta0_deg": 60}
        | {"thetadot0": -1.728785074701102, "psidot0": 3.4138511764757373},
        [-9.172979917259354],
        1,
    ),
    # nearly a plane pendulum: spin and precession leap by half a turn next to the lower pole
    "leap at T/4": (
        UNIT
        | {"A": 1.5275931285817506, "C": 1.4194100335683093, "theta0_deg": 90}
        | {"r0": -4.246738603445492e-67},
        [*beside(2.2915591431742084), *beside(-2.2915591431742084)],
        4,
    ),
    # roots that are 1e-51 apart: 40 digits decide no mean rate
    "a start with many digits": (
        UNIT | {"r0": 1, "theta0_deg": 90, "thetadot0": 1, "psidot0": 1 + Fraction(1, 10**51)},
        *([0.3, 77.7], 2),
    ),
    # on one side of the pole phi = psi = r0 t/2, and on the other both are half a turn off
    **{
        f"from the pole at {rate}": (
            {"m": 1, "A": 2, "C": 2, "s": 1, "g": 0, "r0": 1.5, "theta0_deg": 0, "thetadot0": rate},
            *([5e-324, 1e-230, -1e-230], 2),
        )
        for rate in (1e-100, 1e-7, -1e-100)
    },
    **{
        f"leap at T/2, r0 = {r0}": (UNIT | {"r0": r0, "theta0_deg": tilt}, [], 4)
        for r0, tilt in ((1e-30, 90), (-1e-14, 60), (1e-18, 150))
    },
}
"""Scenes, times (quarters of periods if there are none), and the bound of the error."""


@pytest.mark.parametrize("name", TURNING)
def test_nothing_leaps_next_to_turning_points_and_poles(name: str) -> None:
    scene, times, most = TURNING[name]
    motion = solve(Top(**scene))
    assert max(errors(motion, times or turning_times(motion, random.Random(1)))) <= most


# Shapes and blocks; columns on request


T = np.linspace(-3, 40, 40_000)
SERIES = [50, 200]
"""Spins whose series are hyperbolic and circular."""


@pytest.mark.parametrize("shape", [(), (0,), (2, 3, 4)])
def test_shapes(shape: tuple[int, ...]) -> None:
    for angle in solve(Top()).angles(np.ones(shape, int)):
        assert angle.shape == shape
        assert angle.dtype == np.float64
    columns = solve(Top()).angles(np.arange(6).reshape(2, 3).T)
    assert columns.theta.shape == (3, 2)


def test_wrapped_angles_stay_in_their_interval() -> None:
    motion = solve(Top(**(UNIT | {"g": 0}), r0=1, theta0_deg=40))
    around = [math.nextafter(math.pi, up) for up in (0, 9)] + [math.pi, -math.pi, 3 * math.pi]
    phi = motion.angles([*around, *(-x for x in around)], wrap=True).phi
    assert ((phi > -math.pi) & (phi <= math.pi)).all()
    assert motion.angles([3.0], wrap=True).phi[0] == 3.0


@pytest.mark.parametrize("count", [0, 1, 16383, 16384, 16385])
@pytest.mark.parametrize("r0", SERIES)
def test_blocks_fit_together(r0: float, count: int) -> None:
    motion, times = solve(Top(r0=r0)), T.copy()
    for whole, part in zip(motion.angles(times), motion.angles(T[:count]), strict=True):
        np.testing.assert_array_equal(whole[:count], part)
    np.testing.assert_array_equal(times, T)


def times_at(rng: random.Random, exact: Fraction, power: float) -> list[float]:
    """Return times up to 2^power periods away: any, next to whole periods and next to halves."""
    found = []
    for _ in range(20):
        n = int(2 ** rng.uniform(0, power))
        for part in (Fraction(rng.random()), Fraction(0), Fraction(1, 2)):
            t = rng.choice([-1, 1]) * float((n + part) * exact)
            found += [t, math.nextafter(t, math.inf)]
    return found


@pytest.mark.parametrize("power", [3, 20, 25.9, 40, 51, 52])
@pytest.mark.parametrize("offset", [0.0, -0.5, 0.31])
def test_whole_periods_are_taken_off_exactly(power: float, offset: float) -> None:
    """What is left has an error of 2^-100 of the time, and of 2^-52 of itself; n is the nearest."""
    rng = random.Random(f"{power} {offset}")
    for _ in range(10):
        # a length with more digits than two doubles have
        exact = Fraction(rng.getrandbits(200) + 1, 2 ** rng.randrange(100, 300))
        period = at_precision(80, partial(lambda x: period_of(ball_of(x)), exact))
        t = np.array(times_at(rng, exact, power))
        whole, rest, lost = whole_periods(t, period, float(np.abs(t).max()), offset)
        for time, n, left in zip(t.tolist(), whole.tolist(), (rest - lost).tolist(), strict=True):
            true = Fraction(time) - int(n) * exact
            assert abs(Fraction(left) - true) <= abs(true) / 2**52 + abs(Fraction(time)) / 2**100
            assert abs(true / exact + Fraction(offset)) <= Fraction(1, 2) + Fraction(1, 2**19)


# The ends of the doubles

ORDINARY = UNIT | {"A": 2, "C": 1.5, "r0": 3, "theta0_deg": 40, "thetadot0": 0.5, "psidot0": -1}


@pytest.mark.parametrize("exponent", [-1060, -900, -450, -1, 160])
@pytest.mark.parametrize("g", [0.0, 1.0])
def test_a_unit_of_time_changes_only_rates(exponent: int, g: float) -> None:
    """Rates times 2^n, and the torque times 4^n: columns are the same at times over 2^n."""
    factor, names = 2.0**exponent, ("theta", "phi", "psi", "p", "axis_y", "quaternion_w")
    g = math.ldexp(g, 2 * exponent)  # 0 below all doubles
    scaled = ORDINARY | {x: ORDINARY[x] * factor for x in ("r0", "thetadot0", "psidot0")} | {"g": g}
    plain, motion = (
        solve(Top(**ORDINARY | {"g": math.ldexp(g, -2 * exponent)})),
        solve(Top(**scaled)),
    )
    times = np.array([0.3, -2.7, 1e4]) / max(1.0, 1e-285 / factor)
    before, after = plain.table(times, names), motion.table(times / factor, names)
    for name in names:
        size = factor if name == "p" else 1.0
        assert after[name] / size == pytest.approx(before[name], rel=1e-13, abs=1e-12), name


BEYOND: list[dict[str, float]] = [
    {"r0": 1e-309, "theta0_deg": 30, "psidot0": 0, "g": 0},
    {"r0": 1e-308, "psidot0": 0, "theta0_deg": 90, "A": 1, "C": 1e-2},
    {"r0": 2.2e-308, "psidot0": -2.2e-308, "theta0_deg": 90},
    {"g": 0, "r0": 5e-324, "psidot0": 1e100, "theta0_deg": 1e-140},
    {"g": 5e-324, "r0": 1e100, "thetadot0": -5e-324},
]


@pytest.mark.parametrize("inputs", BEYOND)
def test_periods_beyond_the_doubles_have_rows(inputs: dict[str, float]) -> None:
    """Each angle is that of the proved row, whose digits are not limited."""
    motion = solve(Top(**inputs))
    reach = min(motion.sampler().max_time, motion.sampler().max_wrapped, 1e200)
    times = np.array([1.0, reach, -reach * 0.7]) * min(1.0, reach)
    proved = ProvedTable(motion, ["theta", "phi", "psi"], 30, units=Units(radians=True))
    for t, row in zip(times.tolist(), np.stack(motion.angles(times)).T.tolist(), strict=True):
        for found, exact in zip(row, proved.row(Fraction(t)), strict=True):
            assert found == pytest.approx(float(exact.value), rel=4 * EPS, abs=4 * EPS)
