"""A sweep computes in arrays only what they can be trusted with: the judge is ball arithmetic."""

from __future__ import annotations

import math
import random
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from ball_judge import Judge
from exact_scenes import KINDS
from hard_scenes import in_doubles, nutating
from lagtop import Top, solve, sweep
from scenes import UNIT

from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.sweep.moving_tops import MovingTops
from lagrange_cli.sweep.top_arrays import TopArrays, top_arrays

COSINES = {"u1", "u2", "u_quarter"}


def allowed(key: str, judge: Judge, scene: dict[str, float]) -> float | None:
    """Return the size to which the error of a key is compared, where it is not its own."""
    if key in COSINES:
        return 1.0
    if not key.endswith("rate_half"):
        return None
    parts = judge.half_parts
    sizes = [] if parts is None else [float(abs(part)) for part in parts]
    return max([abs(scene["r0"]), *sizes])


MEANS = {"mean_spin_rate", "mean_precession_rate", "T_spin", "T_precession"}


def assert_trusted(scenes: list[dict[str, Any]], least: int) -> None:
    """Check all keys of tops, of which at least some have no error; the mean rates to ten eps.

    Worst seen in 9000 scenes: mean rates and their periods 9.3 eps, all others 3.8.
    """
    scenes = [{"thetadot0": 0.0, "psidot0": 0.0, **in_doubles(scene)} for scene in scenes]
    names = sorted({name for scene in scenes for name in scene})
    columns: dict[str, Any] = {
        name: [scene.get(name, math.nan) for scene in scenes] for name in names
    }
    records = sweep(**columns, keys=["regime", "path", *NUMBER_KEYS, "error"])
    fine = [i for i, error in enumerate(records["error"]) if not error]
    assert len(fine) >= least
    for i in fine:
        scene = scenes[i]
        motion = solve(Top(**scene))
        assert (records["regime"][i], records["path"][i]) == (motion.regime, motion.path), scene
        judge = Judge({name: Fraction(value) for name, value in scene.items()})
        for key in NUMBER_KEYS:
            value, exact = float(records[key][i]), judge.record.get(key)
            if exact is None:
                assert math.isnan(value), (key, scene)
            else:
                error = judge.relative(key, value, allowed(key, judge, scene))
                most = 10 if key in MEANS else 4
                assert error <= most or judge.ulps(key, value) <= 1, (key, error, scene)


@pytest.mark.parametrize("count", [8, pytest.param(40, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", KINDS)
def test_every_key_is_within_ten_eps(kind: str, count: int) -> None:
    rng = random.Random(f"trusted {kind}")
    assert_trusted([KINDS[kind](rng) for _ in range(count)], count // 2)


EXAMPLE = {name: float(getattr(Top(), name)) for name in ("m", "A", "C", "s", "g")}
WHIRLS, STIFF = random.Random(4), random.Random("stiff (fast spin)")
CANCELLING: dict[str, list[dict[str, float]]] = {
    "over the lower pole from next to the upper one": [
        EXAMPLE | {"r0": 0, "theta0_deg": tilt, "psidot0": 1}
        for tilt in (1e-9, 1e-12, 1e-30, 1e-100)
    ],
    # the mean precession goes as 1/thetadot0^2 where the parts are of the size 1
    "mean rates": [
        UNIT | {"r0": 1, "theta0_deg": 60, "thetadot0": rate} for rate in (1e3, 1e4, 1e5, 1e8, 1e20)
    ],
    # parts that cancel are computed in pairs of doubles; the worst error seen is 0.5 eps
    "mean rates in pairs of doubles": [
        EXAMPLE
        | {"theta0_deg": 30, "r0": WHIRLS.uniform(-5, 5), "thetadot0": WHIRLS.uniform(5, 300)}
        for _ in range(30)
    ],
    # among them a spin rate far below its parts: gaps good to 2^-38 would put it 31 eps off
    "stiff tops": [nutating("stiff (fast spin)", STIFF) for _ in range(25)],
    "a cosine": [EXAMPLE | {"theta0_deg": 90, "r0": 1e10}],
}


@pytest.mark.parametrize("name", CANCELLING)
def test_numbers_whose_parts_cancel(name: str) -> None:
    assert_trusted(CANCELLING[name], len(CANCELLING[name]))


@pytest.mark.parametrize("body", [(1.0, 1.0, 1.0, 1.0, 1.0), (2.0, 3.0, 0.5, 4.0, 9.81)])
def test_tops_at_the_threshold_of_sleeping_go_one_by_one(body: tuple[float, ...]) -> None:
    """Where (C r0)^2 = 4 A m g s nearly, lambda - 1 has lost its digits."""
    m, A, C, s, g = body
    r0 = 2 * math.sqrt(A * m * g * s) / C * np.array([0.9, 1 - 1e-15, 1.0, 1 + 1e-15, 1.1, -1.0])
    fixed = {
        "m": m,
        "A": A,
        "C": C,
        "s": s,
        "g": g,
        "theta0_deg": 10.0,
        "thetadot0": 0,
        "psidot0": 0,
    }
    regimes = top_arrays(fixed | {"r0": r0}, r0.size).regimes().values()
    assert np.any(list(regimes), axis=0).tolist() == [True, False, False, False, True, False]


def starts_next_to_the_pole(count: int) -> dict[str, Any]:
    """Return tops of any size that start 1e-7 to 1 degree from the vertical, with any rates."""
    rng = np.random.default_rng(5)

    def power(low: float, high: float) -> Any:
        return 10 ** rng.uniform(low, high, count)

    def sign() -> Any:
        return rng.choice([-1, 1], count)

    body = {name: power(-1, 1) for name in ("m", "A", "s", "g")}
    body["C"] = body["A"] * rng.uniform(0.1, 1.9, count)
    start = {"r0": sign() * power(0, 2), "theta0_deg": power(-7, 0)}
    rates = {"thetadot0": sign() * power(-12, 2), "psidot0": sign() * power(-10, 2)}
    return body | start | rates


def roots_of(top: dict[str, Any]) -> tuple[Any, Any, Any, Any]:
    """Return a and u2 < u1 < u3: f(u) = (e + a (u0 - u))(1 - u^2) - (beta - b u)^2 by mpmath."""
    m, A, C, s, g, r0, tilt, theta_rate, psi_rate = (
        mpmath.mpf(float(top[name])) for name in TopArrays._fields[:9]
    )
    sine, cosine = mpmath.sin(tilt * mpmath.pi / 180), mpmath.cos(tilt * mpmath.pi / 180)
    a, b, e = 2 * m * g * s / A, C * r0 / A, theta_rate**2 + (psi_rate * sine) ** 2
    beta, whole = psi_rate * sine**2 + b * cosine, e + a * cosine
    c2, c1, c0 = (x / a for x in (-whole - b * b, 2 * beta * b - a, whole - beta**2))
    p, q = (c2**2 - 3 * c1) / 9, (9 * c1 * c2 - 27 * c0 - 2 * c2**3) / 54
    angle = mpmath.acos(q / p ** (mpmath.mpf(3) / 2))
    turns = (angle + 2 * mpmath.pi * n for n in range(3))
    return a, *sorted(2 * mpmath.sqrt(p) * mpmath.cos(x / 3) - c2 / 3 for x in turns)


def test_bounds_of_gaps_hold_and_are_close() -> None:
    """The judge is mpmath; bounds that are too wide would leave most of these tops to `solve`."""
    given = starts_next_to_the_pole(400) | {"theta0_rad": np.full(400, np.nan)}
    starts = MovingTops(TopArrays(*(given[name] for name in TopArrays._fields)))
    assert starts.small.mean() > 0.9
    gaps, worst = starts.fine.gaps, starts.noise
    with mpmath.workdps(90):
        for i in np.flatnonzero(starts.small)[:60]:
            a, u2, u1, u3 = roots_of({name: values[i] for name, values in given.items()})
            exact = {
                "u1_u2": u1 - u2,
                "above_u1": 1 - u1,
                "above_u2": 1 - u2,
                "a_u3_u1": a * (u3 - u1),
            }
            for name, value in exact.items():
                pair = getattr(gaps, name)
                found = mpmath.mpf(float(pair.high[i])) + mpmath.mpf(float(pair.low[i]))
                assert abs(found / value - 1) <= worst[i], (name, i)
