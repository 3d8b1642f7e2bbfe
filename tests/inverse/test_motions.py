"""The closed form in plain doubles, against the solver and against mpmath's roots of the cubic."""

from __future__ import annotations

import math
from random import Random
from typing import Any

import mpmath
import numpy as np
import pytest
from lagtop import Top, solve
from scenes import UNIT

from lagrange_cli.bench.hard_scenes import nutating as hard_scene
from lagrange_cli.inverse.motions import angles, gaps_of, nutating, states_of

EPS = 2.0**-52


@pytest.mark.parametrize("theta0_deg", [0.0, 1e-6, 55.0, 176.0, 180.0])
def test_motions_in_doubles_are_those_of_the_solver(theta0_deg: float) -> None:
    """Of bodies with C = A, whose r0 is b; also from the vertical, by the same convention."""
    body = {"m": 0.7, "A": 0.5, "C": 0.5, "s": 1.1, "g": 9.81, "theta0_deg": theta0_deg}
    t = np.linspace(-3, 40, 50)
    for r0, thetadot0, psidot0 in ((9, 0, 0), (-9, 2, 3), (0.3, -8, 1), (40, 1, -5), (-2, 0, 9)):
        turn = psidot0 if 0 < theta0_deg < 180 else 0
        motion = solve(Top(**body, r0=r0, thetadot0=thetadot0, psidot0=turn))
        if motion.facts.vertical:
            continue
        tilt = math.radians(theta0_deg) if theta0_deg < 180 else math.pi
        state = states_of(motion.a, motion.b, tilt, thetadot0, turn)
        if theta0_deg == 180:  # whose half has the cosine 0
            state[[3, 5]] = 0
        found, exact = angles(state[np.newaxis], t)[:, 0], np.stack(motion.angles(t))
        assert found == pytest.approx(exact, abs=1e-9, rel=1e-12), (r0, motion.regime)


@pytest.mark.parametrize(
    ("cosine", "r0", "thetadot0", "psidot0"),
    [(0.5, 0, 0, 0), (-0.5, 0.5, 2.5, 1), (0.5, 1, 0.7, -2)],
)
def test_the_axis_passes_over_a_pole(
    cosine: float, r0: float, thetadot0: float, psidot0: float
) -> None:
    tilt, t = math.acos(cosine), np.linspace(0, 9, 50)
    start = {"theta0_deg": round(math.degrees(tilt)), "thetadot0": thetadot0, "psidot0": psidot0}
    motion = solve(Top(**UNIT, **start, r0=r0))
    state = states_of(motion.a, motion.b, tilt, thetadot0, psidot0)
    state[2:4] = math.sqrt((1 - cosine) / 2), math.sqrt((1 + cosine) / 2)
    state[5] = psidot0 * math.sqrt(1 - cosine**2)
    found, exact = angles(state[np.newaxis], t)[:, 0], np.stack(motion.angles(t))
    # a rounding of the momentum decides on which side the axis passes: half a turn of both angles
    turns = (found - exact)[1:] / math.pi
    assert found[0] == pytest.approx(exact[0], abs=1e-7)
    assert np.abs(turns - turns.round()).max() < 1e-6


@pytest.mark.parametrize("signs", [(1, 1), (-1, -1)])
def test_tops_of_a_nutation_have_its_period_its_tilts_and_its_rate(signs: tuple[int, int]) -> None:
    one = np.array([0.5]), np.array([1.2]), 0.4, np.array([0.3]), signs
    a, b, beta, rate = (float(x[0]) for x in nutating(*one))
    start = (beta - b * math.cos(0.5)) / math.sin(0.5) ** 2
    t = np.array([0.2, 0.4, 4.0])
    theta, _, psi = angles(states_of(a, b, 0.5, 0.0, start)[np.newaxis], t)[:, 0]
    assert theta == pytest.approx([1.2, 0.5, 0.5], abs=1e-7)
    assert psi[2] / 4 == pytest.approx(rate, rel=1e-9)


@pytest.mark.parametrize("count", [8, pytest.param(300, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", ["generic", "from rest", "near a pole", "near separatrix", "slow"])
def test_gaps_of_the_roots_have_all_digits(kind: str, count: int) -> None:
    """Against the roots of the cubic (4,9) in 60 digits, from the same doubles."""
    rng, errors = Random(f"gaps {kind}"), []
    for _ in range(count):
        scene = hard_scene(kind, rng)
        motion, tilt = solve(Top(**scene)), math.radians(scene["theta0_deg"])
        rates = scene.get("thetadot0", 0.0), scene.get("psidot0", 0.0)
        state = states_of(motion.a, motion.b, tilt, *rates)
        gaps = [float(x[0, 0]) for x in gaps_of(state[np.newaxis])]
        errors.append(relative_errors(state, gaps))
    rise, fall, apart = np.array(errors).T / EPS
    assert np.median([rise, fall]) < 1
    assert max(rise.max(), fall.max()) < 100
    if kind != "near separatrix":  # where a rounding of the state changes u3 - u1
        assert apart.max() < 100


def relative_errors(state: Any, found: list[float]) -> list[float]:
    """Return the errors of u1 - u, u - u2 and u3 - u1 relative to the exact gaps."""
    with mpmath.workdps(60):
        a, b, half_sine, half_cosine, p, q = map(mpmath.mpf, state.tolist())
        size = half_sine**2 + half_cosine**2
        u, sine = (half_cosine**2 - half_sine**2) / size, 2 * half_sine * half_cosine / size
        kinetic, momentum = p * p + q * q, q * sine
        c0, c2 = (sine * p) ** 2 / a, 2 * u - (kinetic + b * b) / a
        c1 = 2 * (b * momentum - u * kinetic) / a - sine**2
        roots = mpmath.polyroots([c0, c1, c2, 1], maxsteps=500, extraprec=600, asc=True)
        u2, u1, u3 = sorted(map(mpmath.re, roots))
        pairs = (found[0], u1), (found[1], -u2), (found[4], u3 - u1)
        return [float(abs(x - y) / abs(y)) if abs(y) > 1e-40 else 0.0 for x, y in pairs]
