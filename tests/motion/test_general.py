"""Any start: regimes and their boundaries, symmetries, conserved quantities, other integrators."""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from typing import Any

import mpmath
import numpy as np
import oracle
import pytest
from scenes import UNIT, period

from lagrange_cli import Motion, Regime, Top, solve
from lagrange_cli.arithmetic.points import EvenPoints
from lagrange_cli.arithmetic.types import Array
from lagrange_cli.bench.battery import judged_inputs
from lagrange_cli.bench.hard_scenes import STRATA, Scene, ordinary
from lagrange_cli.bench.reference import Reference, angle_units
from lagrange_cli.motion.over_time.table import rows


def columns(motion: Motion, names: str, t: Array) -> list[Array]:
    """Return columns of `lagtop table` on an even grid of times."""
    from fractions import Fraction

    step = float(t[1] - t[0])
    grid = EvenPoints(Fraction(float(t[0])), Fraction(step), t.size)
    _, blocks = rows(motion, grid, names.split(), radians=True)
    return list(np.concatenate(list(blocks)).T)


# Regimes


@pytest.mark.parametrize(
    ("start", "regime", "path"),
    [
        ({"r0": 3, "theta0_deg": 60}, Regime.REGULAR, "cusped"),
        ({"r0": 3, "theta0_deg": 60, "psidot0": 0.5}, Regime.REGULAR, "wavy"),
        ({"r0": 3, "theta0_deg": 60, "psidot0": -0.5}, Regime.REGULAR, "looping"),
        ({"r0": -3, "theta0_deg": 60, "psidot0": 0.5}, Regime.REGULAR, "looping"),
        ({"r0": 2, "theta0_deg": 90, "psidot0": 0.5}, Regime.STEADY, None),
        ({"r0": 0, "theta0_deg": 120, "psidot0": math.sqrt(2)}, Regime.NO_SPIN, "wavy"),
        ({"r0": 0, "theta0_deg": 120, "thetadot0": 1}, Regime.NO_SPIN, None),
        (
            {"r0": 1, "g": 0, "theta0_deg": 60, "psidot0": 1, "thetadot0": 1},
            Regime.TORQUE_FREE,
            "wavy",
        ),
        ({"r0": 1, "theta0_deg": 0}, Regime.SLEEPING, None),
        ({"r0": 1, "theta0_deg": 180}, Regime.HANGING, None),
        ({"r0": 1, "theta0_deg": 0, "thetadot0": 1}, Regime.REGULAR, "wavy"),
        ({"r0": 0, "theta0_deg": 180, "thetadot0": math.sqrt(2) ** 2}, Regime.NO_SPIN, None),
        ({"r0": 0, "theta0_deg": 180, "A": 0.5, "thetadot0": math.sqrt(8)}, Regime.NO_SPIN, None),
        ({"r0": 0, "theta0_deg": 90, "A": 2, "thetadot0": 1}, Regime.SEPARATRIX, None),
        ({"r0": 1, "theta0_deg": 60, "psidot0": 2 / 3, "A": 1}, Regime.REGULAR, "wavy"),
    ],
)
def test_regimes(start: dict[str, float], regime: Regime, path: str | None) -> None:
    motion = solve(Top(**(UNIT | start)))
    assert motion.regime is regime
    assert motion.path == path


def test_sleeping_says_whether_it_is_stable() -> None:
    """lambda = r0^2/4 here."""
    below = solve(Top(**UNIT, r0=math.nextafter(2, 0), theta0_deg=0))
    above = solve(Top(**UNIT, r0=2, theta0_deg=0))
    assert below.remark == "only phi + psi is defined; unstable (lambda = b^2/2a < 1)"
    assert above.remark == "only phi + psi is defined; stable (lambda = b^2/2a >= 1)"
    hanging = solve(Top(**UNIT, r0=2, theta0_deg=180))
    assert hanging.remark == "only phi - psi is defined; stable"


def test_the_separatrix_in_closed_form() -> None:
    """The plane pendulum at the energy of the upright position: tan((pi + swing)/4) = exp(t)."""
    motion = solve(Top(**(UNIT | {"A": 2}), r0=0, theta0_deg=90, thetadot0=1))
    assert (motion.T_nutation, motion.K, motion.mean_spin_rate) == (None, None, None)
    assert (motion.k, motion.k_prime, motion.u1, motion.u3) == (1, 0, 1, 1)
    assert motion.theta_max_deg == 180
    rate = math.sqrt(1 / 2)  # mgs/A
    t = np.array([-8.0, -2.0, 0.0, 0.3, 5.0, 20.0])
    angles = motion.angles(t)
    bottom = math.asinh(1) / rate  # from 90 degrees to the bottom
    expected = 2 * np.arctan(1 / np.sinh(np.abs(t - bottom) * rate))
    np.testing.assert_allclose(angles.theta, expected, rtol=1e-14)
    turned = np.where(t > bottom, math.pi, 0)
    np.testing.assert_allclose(angles.psi, turned, atol=1e-15)


def test_separatrix_with_spin_against_its_neighbours() -> None:
    """Starts beside it, at both sides, follow it for a while."""
    lam = 0.25
    scene = UNIT | {"r0": 2 * math.sqrt(lam), "theta0_deg": 60.0}
    b, a, u = scene["r0"], 2.0, 0.5
    psidot = b / (1 + u)
    thetadot = math.sqrt(a * (1 - u) - psidot**2 * (1 - u * u))
    t = np.linspace(-3, 6, 50)
    near = [solve(Top(**scene, psidot0=psidot, thetadot0=x)) for x in (thetadot, thetadot + 1e-9)]
    one, other = (np.stack(motion.angles(t)) for motion in near)
    assert np.abs(one - other).max() < 1e-5
    assert near[0].k_prime is not None
    assert near[0].k_prime < 1e-7


def neighbours(**change: float) -> list[Motion]:
    """Return a scene one ulp below, at and one ulp above a value."""
    ((key, value), *fixed) = change.items()
    steps = (math.nextafter(value, -math.inf), value, math.nextafter(value, math.inf))
    return [solve(Top(**(UNIT | dict(fixed) | {key: x}))) for x in steps]


@pytest.mark.parametrize(
    ("change", "regimes"),
    [
        ({"psidot0": 0.5, "r0": 2, "theta0_deg": 90}, (Regime.REGULAR, Regime.STEADY)),
        (
            {"thetadot0": 1.0, "r0": 0, "theta0_deg": 90, "A": 2},
            (Regime.NO_SPIN, Regime.SEPARATRIX),
        ),
        ({"r0": 2.0, "theta0_deg": 40}, (Regime.REGULAR, Regime.REGULAR)),
        ({"A": 1.0, "r0": 3, "theta0_deg": 40, "psidot0": 1}, (Regime.REGULAR, Regime.REGULAR)),
        ({"C": 1.9999999999999998, "r0": 3, "theta0_deg": 40}, (Regime.REGULAR, Regime.REGULAR)),
    ],
)
def test_one_ulp_on_both_sides_of_a_boundary(
    change: dict[str, float], regimes: tuple[Regime, Regime]
) -> None:
    """The angles do not jump: an ulp of input moves them by its condition, here below 1e-12."""
    below, at, above = neighbours(**change)
    assert (below.regime, at.regime) == regimes
    t = np.linspace(-3, 3, 61)
    for beside in (below, above):
        for mine, other in zip(at.angles(t), beside.angles(t), strict=True):
            assert np.abs(mine - other).max() < 1e-12


@pytest.mark.parametrize(
    ("edge", "near"),
    [
        ({"g": 0.0, "psidot0": 1, "thetadot0": 1}, {"g": 1e-300}),
        ({"r0": 0.0, "psidot0": 1}, {"r0": 1e-300}),
        ({"r0": 0.0, "psidot0": 1}, {"r0": -1e-300}),
        ({"thetadot0": 0.0, "psidot0": 1}, {"thetadot0": 1e-150}),
        ({"psidot0": 0.0, "thetadot0": 1}, {"psidot0": 1e-150}),
        ({"psidot0": 0.0}, {"psidot0": 1e-150}),
        ({"thetadot0": 0.0}, {"thetadot0": -1e-150}),
    ],
)
def test_next_to_zero(edge: dict[str, float], near: dict[str, float]) -> None:
    """An input that is as good as zero gives what zero gives."""
    scene = UNIT | {"r0": 3, "theta0_deg": 40}
    t = np.linspace(-3, 3, 61)
    exact, beside = (solve(Top(**(scene | edge | x))).angles(t) for x in ({}, near))
    for mine, other in zip(exact, beside, strict=True):
        assert np.abs(mine - other).max() < 1e-14


def test_near_the_pole_the_defined_angle_is_that_of_sleeping() -> None:
    t = np.linspace(-2, 2, 41)
    for r0 in (1.0, 5.0):
        sleeping = solve(Top(**UNIT, r0=r0, theta0_deg=0)).angles(t)
        near = solve(Top(**UNIT, r0=r0, theta0_deg=1e-140)).angles(t)
        assert np.abs(near.phi + near.psi - sleeping.phi - sleeping.psi).max() < 4e-15
        hanging = solve(Top(**UNIT, r0=r0, theta0_deg=180)).angles(t)
        near = solve(Top(**UNIT, r0=r0, theta0_deg=180 - 1e-13)).angles(t)
        assert np.abs(near.phi - near.psi - hanging.phi + hanging.psi).max() < 1e-12


def test_a_kick_off_the_pole() -> None:
    """Upright with thetadot0 > 0, the axis leaves along psi = 0, and comes from there for < 0."""
    t = np.array([-1e-9, 0.0, 1e-9])
    out = solve(Top(**UNIT, r0=1, theta0_deg=0, thetadot0=1)).angles(t)
    np.testing.assert_allclose(out.theta, np.abs(t), rtol=1e-12, atol=1e-30)
    np.testing.assert_allclose(out.psi, [-math.pi, 0, 0], atol=1e-8)
    back = solve(Top(**UNIT, r0=1, theta0_deg=0, thetadot0=-1)).angles(t)
    np.testing.assert_allclose(back.psi, [0, 0, math.pi], atol=1e-8)
    assert np.abs(out.phi + out.psi - t).max() < 1e-15


def test_steady_precession_has_the_period_of_a_small_nutation() -> None:
    steady = solve(Top(**UNIT, r0=2, theta0_deg=90, psidot0=0.5))
    near = solve(Top(**UNIT, r0=2, theta0_deg=90, psidot0=0.5 + 1e-9))
    assert steady.T_nutation == pytest.approx(near.T_nutation, rel=1e-9)
    assert steady.mean_precession_rate == 0.5
    assert steady.theta_min_deg == steady.theta_max_deg == 90


def test_torque_free_precession_about_the_angular_momentum() -> None:
    """The figure axis circles L = A omega + (C - A) r0 e uniformly, at the rate |L|/A."""
    scene = UNIT | {"A": 1.5, "g": 0, "r0": 2, "theta0_deg": 50, "psidot0": 0.7, "thetadot0": -0.4}
    motion = solve(Top(**scene))
    t = np.linspace(0, 20, 400)
    axis = np.array(columns(motion, "axis", t)).T
    start = axis[0]
    theta_rate = np.array([1.0, 0, 0]) * -0.4  # along the line of nodes
    omega = theta_rate + 0.7 * np.array([0, 0, 1.0])
    omega = omega - (omega @ start) * start  # the part across the axis
    momentum = 1.5 * omega + 1.0 * 2 * start
    size = float(np.linalg.norm(momentum))
    unit, turn = momentum / size, size / 1.5 * t
    parallel = (start @ unit) * unit
    normal = start - parallel
    expected = (
        parallel + np.outer(np.cos(turn), normal) + np.outer(np.sin(turn), np.cross(unit, normal))
    )
    assert np.abs(axis - expected).max() < 1e-13


# Extremes


@pytest.mark.parametrize("exponent", [-30, 30])
@pytest.mark.parametrize("key", ["m", "g", "s"])
def test_bodies_of_any_size(key: str, exponent: int) -> None:
    """a scales with the torque; in units of its own time every top of one lambda is the same."""
    scale = 2.0 ** round(exponent / math.log10(2))
    scale = scale if round(math.log2(scale)) % 2 == 0 else 2 * scale
    plain = solve(Top(**UNIT, r0=3, theta0_deg=50, psidot0=0.25, thetadot0=0.5))
    root = math.sqrt(scale)
    scene: dict[str, Any] = UNIT | {key: scale}
    other = solve(
        Top(**scene, r0=3 * root, theta0_deg=50, psidot0=0.25 * root, thetadot0=0.5 * root)
    )
    assert other.T_nutation == pytest.approx(period(plain) / root, rel=1e-15)
    t = np.linspace(-3, 3, 31)
    for mine, scaled in zip(plain.angles(t), other.angles(t / root), strict=True):
        np.testing.assert_allclose(mine, scaled, rtol=1e-15, atol=1e-15)


# Metamorphic tests


def generic_motions(count: int) -> list[tuple[Scene, Motion]]:
    rng = random.Random(33)
    scenes = [ordinary(rng) for _ in range(count)]
    return [(scene, solve(Top(**scene))) for scene in scenes]


def test_mirror_and_time_reversal() -> None:
    """r0, psidot0 -> -: spin and precession turn round.  All rates -> -: time runs backwards."""
    for scene, motion in generic_motions(10):
        t = np.linspace(-2, 2, 101) * period(motion)
        plain = motion.angles(t)
        mirrored = scene | {"r0": -scene["r0"], "psidot0": -scene["psidot0"]}
        mirror = solve(Top(**mirrored)).angles(t)
        reverse = solve(Top(**(mirrored | {"thetadot0": -scene["thetadot0"]}))).angles(-t)
        for mine, flipped, backwards, sign in zip(plain, mirror, reverse, (1, -1, -1), strict=True):
            np.testing.assert_allclose(sign * flipped, mine, rtol=4e-16, atol=4e-15)
            np.testing.assert_allclose(backwards, mine, rtol=4e-16, atol=4e-15)


def test_start_at_another_point_of_the_same_orbit() -> None:
    for scene, motion in generic_motions(10):
        t = np.linspace(-2, 2, 101) * period(motion)
        shift = 0.37 * period(motion)
        state = columns(motion, "theta phi psi thetadot psidot", np.array([shift, shift + 1]))
        theta, phi, psi, theta_rate, psi_rate = (float(column[0]) for column in state)
        later = {key: scene[key] for key in ("m", "A", "C", "s", "g", "r0")}
        again = solve(Top(**later, theta0_rad=theta, thetadot0=theta_rate, psidot0=psi_rate))
        whole, part = motion.angles(t + shift), again.angles(t)
        np.testing.assert_allclose(part.theta, whole.theta, atol=1e-12)
        np.testing.assert_allclose(part.phi + phi, whole.phi, atol=1e-12)
        np.testing.assert_allclose(part.psi + psi, whole.psi, atol=1e-12)


def test_units_of_time_mass_and_length() -> None:
    for scene, motion in generic_motions(6):
        t = np.linspace(-2, 2, 41) * period(motion)
        other = scene | {
            "m": scene["m"] * 8,
            "A": scene["A"] * 8 * 4,
            "C": scene["C"] * 8 * 4,
            "s": scene["s"] * 2,
            "g": scene["g"] * 2 / 16,
        }
        other |= {key: scene[key] / 4 for key in ("r0", "thetadot0", "psidot0")}
        for mine, scaled in zip(motion.angles(t), solve(Top(**other)).angles(4 * t), strict=True):
            np.testing.assert_array_equal(mine, scaled)


# Conserved quantities


@pytest.mark.parametrize("far", [0.0, 1e9])
def test_energy_and_momentum_from_the_samples(far: float) -> None:
    """Worst seen, near and 1e9 periods away: 10 and 2.3 eps of the terms they are made of."""
    for scene, motion in generic_motions(12):
        t = far * period(motion) + np.linspace(0, 3, 301) * period(motion)
        energy, momentum = columns(motion, "energy Lz", t)
        A, C, r0 = scene["A"], scene["C"], scene["r0"]
        swing = A * (scene["psidot0"] ** 2 + scene["thetadot0"] ** 2) / 2
        assert np.ptp(energy) <= 12 * 2.0**-52 * (swing + C * r0**2 / 2 + 1 + A)
        assert np.ptp(momentum) <= 4 * 2.0**-52 * (A * abs(scene["psidot0"]) + C * abs(r0) + A)


@pytest.mark.slow
def test_rates_are_the_derivatives_of_the_angles() -> None:
    """p, q, r and the three rates against the many-digit reference and (4,1)."""
    for scene, motion in generic_motions(10):
        reference = Reference(Top(**scene))
        t = np.linspace(-1.3, 2.1, 12) * period(motion)
        names = "t theta phi thetadot phidot psidot p q r u"
        for now, theta, phi, *rates, p, q, r, u in zip(*columns(motion, names, t), strict=True):
            exact = reference.at(float(now))
            assert rates == pytest.approx(list(map(float, exact[3:6])), rel=1e-13, abs=1e-13)
            across = rates[2] * math.sin(theta)
            assert p == pytest.approx(across * math.sin(phi) + rates[0] * math.cos(phi), abs=1e-12)
            assert q == pytest.approx(across * math.cos(phi) - rates[0] * math.sin(phi), abs=1e-12)
            assert r == scene["r0"]
            assert u == pytest.approx(math.cos(theta), abs=1e-15)


def test_axis_and_quaternion_are_one_attitude() -> None:
    """The third column of the rotation matrix; unit length; continuous in time."""
    for _, motion in generic_motions(8):
        t = np.linspace(-2, 2, 2001) * period(motion)
        *axis, w, x, y, z = columns(motion, "axis quaternion", t)
        matrix = 2 * (x * z + w * y), 2 * (y * z - w * x), 1 - 2 * (x * x + y * y)
        np.testing.assert_allclose(matrix, axis, atol=2e-15)
        np.testing.assert_allclose(w * w + x * x + y * y + z * z, 1, atol=1e-15)
        steps = np.abs(np.diff([w, x, y, z], axis=1)).max()
        assert steps < 0.2
        middle = t.size // 2
        assert max(abs(y[middle]), abs(z[middle])) < 1e-11  # phi = psi = 0 at t = 0


@pytest.mark.parametrize(
    "start",
    [
        {"theta0_deg": 0, "thetadot0": 1, "r0": 1},
        {"theta0_deg": 180, "thetadot0": -1, "r0": 1},
        {"theta0_deg": 0, "r0": 1},
        {"theta0_deg": 90, "r0": 0, "thetadot0": 1, "A": 2},
        {"theta0_deg": 90, "r0": 2, "psidot0": 0.5},
        {"theta0_deg": 60, "r0": 2, "g": 0, "psidot0": 0.5},
        {"theta0_deg": 30, "r0": 0},
    ],
)
def test_every_column_in_every_regime_is_a_number(start: dict[str, float]) -> None:
    motion = solve(Top(**(UNIT | start)))
    names = (
        "t theta phi psi dphi dpsi u thetadot phidot psidot p q r moment axis quaternion energy Lz"
    )
    values = columns(motion, names, np.linspace(-5, 5, 101))
    assert np.isfinite(values).all()
    assert np.ptp(values[-2]) < 2e-14
    assert np.ptp(values[-1]) < 1e-14


# Another integrator


def rotation_state(scene: Scene) -> list[float]:
    """Return the vertical in the body frame and p, q at the start (phi = 0)."""
    tilt = math.radians(scene["theta0_deg"])
    p = scene["thetadot0"]
    q = scene["psidot0"] * math.sin(tilt)
    return [0.0, math.sin(tilt), math.cos(tilt), p, q]


def by_heyoka(scene: Scene, times: Array) -> Array:
    """Integrate the vertical in the body frame and p, q by Taylor's method at 1e-16."""
    hy = pytest.importorskip("heyoka")
    state = hy.make_vars("gx", "gy", "gz", "p", "q")
    system = list(zip(state, euler_equations(scene, state), strict=True))
    integrator = hy.taylor_adaptive(system, rotation_state(scene), tol=1e-16)
    return np.asarray(integrator.propagate_grid(times)[-1])


def by_dop853(scene: Scene, times: Array) -> Array:
    """Integrate the vertical in the body frame and p, q by scipy's method, at its tightest."""
    from scipy.integrate import solve_ivp

    found = solve_ivp(
        lambda _, y: euler_equations(scene, y),
        (0.0, float(times[-1])),
        rotation_state(scene),
        "DOP853",
        times,
        rtol=3e-14,
        atol=1e-15,
    )
    return np.asarray(found.y.T)


def euler_equations(scene: Scene, state: Any) -> list[Any]:
    """Return the rates of the vertical in the body frame and of p, q (section 4)."""
    gx, gy, gz, p, q = state
    r0 = scene["r0"]
    ratio = (scene["A"] - scene["C"]) / scene["A"] * r0
    torque = scene["m"] * scene["g"] * scene["s"] / scene["A"]
    return [
        gy * r0 - gz * q,
        gz * p - gx * r0,
        gx * q - gy * p,
        ratio * q + torque * gy,
        -ratio * p - torque * gx,
    ]


@pytest.mark.slow
@pytest.mark.parametrize(
    ("integrate", "scenes", "bound"), [(by_heyoka, 100, 2e-11), (by_dop853, 4, 2e-10)]
)
def test_against_integrators_over_twenty_periods(
    integrate: Callable[[Scene, Array], Array], scenes: int, bound: float
) -> None:
    """Vertical and rates in the body frame; the error seen is the integrators' own."""
    rng = random.Random(100)
    for _ in range(scenes):
        scene = ordinary(rng)
        motion = solve(Top(**scene))
        t = np.linspace(0, 20, 41) * period(motion)
        theta, phi, p, q = columns(motion, "theta phi p q", t)
        found = integrate(scene, t[0] + np.arange(41) * (t[1] - t[0]))
        sine = np.sin(theta)
        mine = np.stack([sine * np.sin(phi), sine * np.cos(phi), np.cos(theta), p, q], axis=1)
        scale = 1 + abs(scene["r0"]) + abs(scene["psidot0"]) + abs(scene["thetadot0"])
        assert np.abs(mine - found).max() < bound * scale, scene


def test_errors_are_counted_by_the_one_definition() -> None:
    exact = Reference(Top()).at(0.25)
    angles = float(exact.theta), float(exact.phi), float(exact.psi)
    assert max(angle_units(angles, exact)) <= 0.5
    off = (angles[0] + 2.0**-40, angles[1], angles[2])
    assert angle_units(off, exact)[0] > 1000
    assert angle_units((math.nan, angles[1], angles[2]), exact)[0] == math.inf


def test_the_reference_agrees_with_the_papers_formulas() -> None:
    """Legendre's third integral about the bottom against the paper's series about the top."""
    for scene in ({}, {"r0": -20.0, "theta0_deg": 120.0}, {"r0": 1e4}):
        reference, one = Reference(Top(**scene)), oracle.Scene(**scene)
        for t in (0.3, -7.25, 1e6):
            for mine, other in zip(reference.at(t)[:3], oracle.angles(one, t), strict=True):
                assert abs(mine - other) < 1e-35


@pytest.mark.slow
def test_the_reference_agrees_with_itself_at_two_precisions() -> None:
    rng = random.Random(2)
    for name in STRATA:
        scene = judged_inputs(name, rng)
        low, high = Reference(Top(**scene), 60), Reference(Top(**scene), 90)
        t = 3.7 * float(high.T)
        for mine, other in zip(low.at(t)[:3], high.at(t)[:3], strict=True):
            assert abs(mine - other) < 1e-25


@pytest.mark.slow
def test_rates_and_attitude_far_away_are_as_exact_as_near() -> None:
    for _, motion in generic_motions(6):
        t = 1e9 * period(motion) + np.linspace(0, 1, 9) * period(motion)
        names = "t theta thetadot phidot psidot axis quaternion"
        reference = Reference(motion.top, 80)
        for now, theta, *values in zip(*columns(motion, names, t), strict=True):
            exact = reference.at(float(now))
            assert float(theta) == pytest.approx(float(exact.theta), abs=1e-15)
            assert values[:3] == pytest.approx(list(map(float, exact[3:6])), rel=1e-13, abs=1e-13)
            with mpmath.workdps(60):
                sine, cosine = mpmath.sin(exact.theta), mpmath.cos(exact.theta)
                axis = sine * mpmath.sin(exact.psi), -sine * mpmath.cos(exact.psi), cosine
                half = (exact.psi + exact.phi) / 2
                w = mpmath.cos(exact.theta / 2) * mpmath.cos(half)
            assert values[3:6] == pytest.approx(list(map(float, axis)), abs=2e-15)
            assert values[6] == pytest.approx(float(w), abs=2e-15)


def test_the_looping_sample_changes_the_sign_of_its_precession() -> None:
    motion = solve(Top(psidot0=-4))
    assert motion.path == "looping"
    (rate,) = columns(motion, "psidot", np.linspace(0, 1, 101) * period(motion))
    assert rate.min() < 0 < rate.max()


# Poles


@pytest.mark.parametrize("theta0", [0, 180])
@pytest.mark.parametrize("kick", [2.78, -0.5])
@pytest.mark.parametrize("r0", [-2.93, 0.0, 0.33, 2.0])
@pytest.mark.parametrize("g", [0.0, 1.0])
def test_a_kick_off_either_pole(theta0: float, kick: float, r0: float, g: float) -> None:
    """phi = psi = 0 at t = 0, so p is thetadot0, and it is continuous."""
    motion = solve(Top(**(UNIT | {"g": g}), r0=r0, theta0_deg=theta0, thetadot0=kick))
    p, q, axis_x = columns(motion, "p q axis", 1e-7 * np.array([-1.0, 0.0, 1.0]))[:3]
    np.testing.assert_allclose(p, kick, atol=1e-5)
    np.testing.assert_allclose(q, 0, atol=1e-5)
    np.testing.assert_allclose(axis_x, 0, atol=1e-12)


@pytest.mark.parametrize("kick", [2.0, -2.0])
def test_the_separatrix_from_the_bottom(kick: float) -> None:
    motion = solve(Top(**UNIT, r0=0, theta0_deg=180, thetadot0=kick))
    assert motion.regime is Regime.SEPARATRIX
    p, axis_x = columns(motion, "p axis", np.linspace(-1, 1, 5))[:2]
    assert np.sign(p).tolist() == [math.copysign(1, kick)] * 5
    np.testing.assert_allclose(axis_x, 0, atol=1e-15)


@pytest.mark.parametrize("r0", [1.0, -1.0])
@pytest.mark.parametrize("kick", [1.0, -1.0])
def test_the_separatrix_with_spin_against_an_integrator(r0: float, kick: float) -> None:
    """From the horizontal with psidot0 = b and thetadot0^2 = a - b^2, all of them integers."""
    scene = UNIT | {"r0": r0, "theta0_deg": 90, "psidot0": r0, "thetadot0": kick}
    motion = solve(Top(**scene))
    assert motion.regime is Regime.SEPARATRIX
    t = np.linspace(0, 3, 301)
    theta, phi, psi, p, q, theta_dot, psi_dot = columns(
        motion, "theta phi psi p q thetadot psidot", t
    )
    found = by_dop853(scene, t)
    sine = np.sin(theta)
    mine = np.stack([sine * np.sin(phi), sine * np.cos(phi), np.cos(theta), p, q], axis=1)
    assert np.abs(mine - found).max() < 1e-12
    for angle, rate in ((theta, theta_dot), (psi, psi_dot)):
        assert np.abs(np.gradient(angle, t, edge_order=2) - rate).max() < 1e-3


def test_sleeping_exactly_at_the_threshold_and_nothing_at_all() -> None:
    np.testing.assert_array_equal(solve(Top(**UNIT, r0=2, theta0_deg=0)).angles([1.0]).phi, [2.0])
    still = solve(Top(**(UNIT | {"g": 0}), r0=0, theta0_deg=30)).angles([1.0])
    assert (still.phi[0], still.psi[0]) == (0, 0)


def test_rates_keep_their_digits_next_to_the_pole_and_for_tiny_starts() -> None:
    for theta0 in (1e-15, 1e-22, 1e-30, 1e-150):
        motion = solve(Top(**UNIT, r0=3, theta0_deg=theta0, psidot0=1))
        assert (motion.precession_rate_start, motion.path) == (1, "looping")
    for psidot0 in (1e-25, -1e-40):
        motion = solve(Top(**UNIT, r0=1e12, theta0_deg=40, psidot0=psidot0))
        assert motion.precession_rate_start == psidot0
        assert motion.path == ("wavy" if psidot0 > 0 else "looping")
    for kick in (1e-18, 1e-22, 1e-200):
        motion = solve(Top(**UNIT, r0=1, theta0_deg=0, thetadot0=kick))
        assert motion.precession_rate_half == pytest.approx(2, rel=4e-16)


def test_torque_free_means_are_exact() -> None:
    """The cone of the axis does not enclose the vertical, so there is no mean precession."""
    motion = solve(Top(**(UNIT | {"g": 0}), r0=5, theta0_deg=60, thetadot0=0.5, psidot0=0.5))
    assert (motion.mean_precession_rate, motion.T_precession) == (0, None)


@pytest.mark.slow
def test_small_times_keep_their_digits_for_any_start() -> None:
    """Worst seen: 3.0 units."""
    rng = random.Random(8)
    for scene, motion in generic_motions(25):
        reference = Reference(Top(**scene))
        t = [period(motion) * 10 ** rng.uniform(-10, -2) for _ in range(8)]
        for now, theta, phi, psi in zip(t, *motion.angles(t), strict=True):
            angles = float(theta), float(phi), float(psi)
            assert max(angle_units(angles, reference.at(now))) <= 3


def test_wrapped_angles_stay_in_their_interval() -> None:
    motion = solve(Top(**(UNIT | {"g": 0}), r0=1, theta0_deg=40))
    around = [math.nextafter(math.pi, up) for up in (0, 9)] + [math.pi, -math.pi, 3 * math.pi]
    around += [-x for x in around]
    phi = motion.angles(around, wrap=True).phi
    assert (phi > -math.pi).all()
    assert (phi <= math.pi).all()
    assert motion.angles([3.0], wrap=True).phi[0] == 3.0


def test_a_quarter_value_only_for_starts_at_the_top() -> None:
    assert solve(Top(r0=100, psidot0=10)).u_quarter is None  # it starts at the bottom of a nutation
    assert solve(Top(thetadot0=1)).u_quarter is None
    assert solve(Top(psidot0=4)).u_quarter is not None
