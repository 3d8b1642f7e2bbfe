"""The record against the paper's own formulas at 50 digits."""

from __future__ import annotations

import math
import random
from typing import Any, cast

import mpmath
import numpy as np
import oracle
import pytest
from scenes import EPS, NAMED, random_scene

from lagrange_cli import LagtopError, Top, solve
from lagrange_cli.motion.regime import Regime


def errors(scene: dict[str, float]) -> dict[str, float]:
    """Return the relative error of each number in eps."""
    motion, exact = solve(Top(**scene)), oracle.constants(oracle.Scene(**scene))
    with mpmath.workdps(60):
        return {
            key: float(abs(mpmath.mpf(getattr(motion, key)) / true - 1) / EPS) if true else 0.0
            for key, true in exact.items()
            if key != "precession_rate_start"
        }


@pytest.mark.parametrize("scene", NAMED.values(), ids=NAMED)
def test_every_number_is_the_nearest_double(scene: dict[str, float]) -> None:
    assert max(errors(scene).values()) <= 0.5


def test_random_scenes() -> None:
    rng = random.Random(1952)
    for scene in (random_scene(rng) for _ in range(60)):
        assert max(errors(scene).values()) <= 0.5, scene


def test_tilt_in_radians() -> None:
    exact = oracle.constants(oracle.Scene(theta0_deg=mpmath.mpf(0.05) * 180 / mpmath.pi))
    assert solve(Top(theta0_rad=0.05)).T_nutation == float(exact["T_nutation"])
    assert solve(Top(theta0_rad=math.pi)).theta_max_deg == 180
    assert solve(Top(theta0_rad=math.pi)).regime is Regime.REGULAR  # the double is not pi


def test_released_at_rest_means_zero_precession_rate() -> None:
    assert solve(Top()).precession_rate_start == 0.0


def test_one_ulp_across_the_threshold_of_sleeping() -> None:
    """lambda = 1: the formulas change sides, the numbers do not jump."""
    scene = {"m": 1, "A": 1, "C": 1, "s": 1, "g": 1, "theta0_deg": 1}
    below, at, above = (
        cast(dict[str, Any], solve(Top(**scene, r0=r0)).numbers())
        for r0 in (math.nextafter(2, 0), 2.0, math.nextafter(2, 3))
    )
    for key in at:
        step = abs(above[key] - below[key])
        assert step <= 300 * EPS * max(abs(at[key]), 1e-3), key


@pytest.mark.parametrize("scale", [1e-30, 1e30])
def test_change_of_units(scale: float) -> None:
    """Powers of two in length, mass and time only shift exponents."""
    unit = 2.0 ** round(math.log2(scale))
    plain = solve(Top())
    shifted = solve(
        Top(m=1587 * unit, A=39032 * unit**3, C=17458 * unit**3, s=4 * unit, g=981 * unit)
    )
    assert shifted.T_nutation == plain.T_nutation
    assert shifted.mean_precession_rate == plain.mean_precession_rate


@pytest.mark.parametrize(
    ("inputs", "regime"),
    [
        ({"g": 0}, Regime.TORQUE_FREE),
        ({"s": 0}, Regime.TORQUE_FREE),
        ({"theta0_deg": 0}, Regime.SLEEPING),
        ({"theta0_deg": 180}, Regime.HANGING),
        ({"r0": 0}, Regime.NO_SPIN),
    ],
)
def test_regimes_at_the_edge(inputs: dict[str, float], regime: Regime) -> None:
    motion = solve(Top(**inputs))
    assert motion.regime is regime
    assert all(value is None or math.isfinite(value) for value in motion.numbers().values())
    angles = motion.angles([-3.0, 0.0, 2.0])
    assert np.isfinite(angles).all()
    assert angles.phi[1] == 0
    assert angles.psi[1] == 0


def test_without_torque_the_period_follows_from_the_momentum() -> None:
    assert solve(Top(g=0.0)).T_nutation == pytest.approx(
        2 * math.pi * 39032 / (17458 * 50), rel=1e-15
    )


def test_no_spin_is_the_plane_pendulum() -> None:
    """K(sin(alpha/2)) for the amplitude alpha = 150 degrees of the swing about the bottom."""
    motion = solve(Top(r0=0, theta0_deg=30))
    with mpmath.workdps(40):
        amplitude = mpmath.radians(150)
        period = 4 * mpmath.ellipk(mpmath.sin(amplitude / 2) ** 2)
        period *= mpmath.sqrt(mpmath.mpf(39032) / (1587 * 981 * 4))
        rate = float(2 * mpmath.pi / period)
    assert motion.T_nutation == float(period / 2)  # from 150 to 150 on the other side
    assert motion.mean_spin_rate == motion.mean_precession_rate == rate


@pytest.mark.parametrize("inputs", [{"theta0_deg": 0}, {"theta0_deg": 180, "thetadot0": 1}])
def test_no_precession_on_the_vertical(inputs: dict[str, float]) -> None:
    with pytest.raises(LagtopError, match="psidot0 must be 0 if the axis is vertical, got 1"):
        solve(Top(**inputs, psidot0=1.0))


@pytest.mark.parametrize(
    ("inputs", "message"),
    [
        ({"m": 0}, "m must be > 0, got 0.0"),
        ({"A": -1}, "A must be > 0, got -1.0"),
        ({"C": 0}, "C must be > 0"),
        ({"C": 78065}, r"C must be <= 2 A = 78064.0, got 78065.0 \(no rigid body has more\)"),
        ({"s": -4}, "s must be >= 0, got -4.0"),
        ({"g": -1}, "g must be >= 0"),
        ({"theta0_deg": 180.1}, r"theta0_deg must be in \[0, 180\], got 180.1"),
        ({"theta0_rad": 3.2}, r"theta0_rad must be in \[0, pi rad\], got 3.2"),
        ({"theta0_rad": 1, "theta0_deg": 1}, "leave one out"),
        ({"r0": math.nan}, "r0 must be finite, got nan"),
        ({"r0": math.inf}, "r0 must be finite, got inf"),
        ({"r0": "fast"}, "r0 must be a real number, got 'fast'"),
    ],
)
def test_guards(inputs: dict[str, Any], message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        Top(**inputs)


def test_numbers_out_of_range() -> None:
    with pytest.raises(LagtopError, match=r"m must be within 1e100 in size, got 1e\+300"):
        solve(Top(m=1e300))
    with pytest.raises(LagtopError, match="A must be >= 1e-100, got 1e-200"):
        solve(Top(A=1e-200, C=1e-200))
    with pytest.raises(LagtopError, match=r"T_nutation must be within 1\.8e308 in size"):
        _ = solve(Top(g=5e-324, s=1e-320, r0=0)).T_nutation
    assert solve(Top(g=5e-324, s=1e-320, r0=0)).k_prime < 1


def test_tops_can_be_copied_pickled_and_compared() -> None:
    import copy
    import pickle

    top = Top(theta0_rad=1.0, r0=3)
    assert copy.deepcopy(top) == pickle.loads(pickle.dumps(top)) == top
    assert pickle.loads(pickle.dumps(solve(top))) == solve(top)
    assert len({top, Top(theta0_rad=1.0, r0=3), Top()}) == 2


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("tilt", [1.0, 30.0, 90.0, 179.0])
def test_pseudo_regular_precession_in_numbers(sign: int, tilt: float) -> None:
    """The threshold is (C r0)^2 = 100 A m g s, to the last bit; the numbers are the oracle's."""
    unit = {"m": 1.0, "A": 1.0, "C": 1.0, "s": 1.0, "g": 1.0, "theta0_deg": tilt}
    assert solve(Top(**unit, r0=sign * math.nextafter(10.0, 0.0))).remark is None
    for r0 in (10.0, 400.0):
        constants = oracle.constants(oracle.Scene(**unit, r0=sign * r0))
        with mpmath.workdps(40):
            nods = mpmath.degrees(mpmath.acos(constants["u2"])) - tilt
            rate = mpmath.mpf(sign) / mpmath.mpf(r0)
            parts = int(mpmath.nint((constants["mean_precession_rate"] / rate - 1) * 10**6))
        period, where = float(constants["T_nutation"]), "within 1 ppm of"
        if parts:
            where = f"{abs(parts)} ppm {'below' if parts < 0 else 'above'}"
        assert abs(parts) < 10_300
        assert 0 < nods < 1.15
        assert solve(Top(**unit, r0=sign * r0)).remark == (
            f"pseudo-regular precession: nutates by {float(nods):.3g} deg in {period:.3g} time; "
            f"its mean is {where} mgs/(C r0) = {float(rate):.3g} rad/time"
        )


@pytest.mark.parametrize(
    "start", [{"r0": 50.0}, {"r0": 1000.0, "psidot0": 0.1}, {"r0": 1000.0, "g": 0.0}, {"r0": 0.0}]
)
def test_other_precessions_are_not_pseudo_regular(start: dict[str, float]) -> None:
    assert "pseudo" not in (solve(Top(**start)).remark or "")


def test_the_remark_is_in_radians_where_the_record_is() -> None:
    top = Top(r0=1000.0)
    keys = ["remark"]
    degrees, radians = (solve(top).record(radians=x, keys=keys)["remark"] for x in (False, True))
    nods, nods_in_radians = (float(text.split()[4]) for text in (degrees, radians))
    assert (" deg in " in degrees, " rad in " in radians) == (True, True)
    assert math.radians(nods) == pytest.approx(nods_in_radians, rel=0.01)


def test_an_unknown_key_is_refused() -> None:
    with pytest.raises(LagtopError, match=r"'T_nutatoin' \(did you mean 'T_nutation'\?\)"):
        solve(Top()).record(keys=["T_spin", "T_nutatoin"])
