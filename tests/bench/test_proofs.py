"""`lagtop stability --certify`: proved bounds against the errors that the reference finds."""

from __future__ import annotations

import json
import math
from fractions import Fraction

import numpy as np
import pytest
from conftest import Lagtop
from lagtop import Top, solve
from scenes import UNIT

from lagrange_cli.arithmetic.ball import TooFewDigitsError
from lagrange_cli.arithmetic.balls import balls
from lagrange_cli.arithmetic.rounding import Settled
from lagrange_cli.bench import battery
from lagrange_cli.bench.battery import hard_scene
from lagrange_cli.bench.reference import Reference, angle_units, quaternion_units
from lagrange_cli.motion.over_time.proved_table import ProvedTable
from lagrange_cli.motion.record import NUMBER_KEYS
from lagrange_cli.motion.solve import Motion

START = {"r0": 40.0, "psidot0": 3.0, "thetadot0": 2.0}


@pytest.mark.slow
@pytest.mark.parametrize(
    "stratum", ["tiny tilt", "far times", "near separatrix", "units", "near a pole", "near steady"]
)
def test_bounds_are_the_errors_that_the_reference_finds(stratum: str) -> None:
    """Both judges see the same scene at the same times, and share no formula."""
    scene = hard_scene(stratum, 11, 0, 2)
    proved, found = battery.prove(scene), battery.judged_case(scene)
    assert found.key_ulps * (1 - 1e-12) <= proved.key_ulps  # which is rounded up to six digits
    assert proved.key_ulps <= found.key_ulps * (1 + 1e-5) + 1e-9
    assert proved.key_ulps <= 0.5
    for name in ("theta_units", "phi_units", "psi_units", "quaternion_units"):
        assert getattr(proved, name) == pytest.approx(getattr(found, name), rel=0.01, abs=0.01)
        assert getattr(proved, name) >= getattr(found, name) * (1 - 1e-12)


@pytest.mark.parametrize("t", [0.3, -1e3, 1e12])
def test_a_wrong_angle_is_seen(t: float) -> None:
    motion = solve(Top(**START))
    table = ProvedTable(motion, ("theta", "phi", "psi", "quaternion"), radians=True)
    values = [float(x.value) for x in table.row(Fraction(t))]
    right = battery.bounds_at(table, t, values)
    assert max(right) <= 0.5
    exact = Reference(Top(**START), 80).at(t)
    for i in range(7):
        wrong = [x + (1e-6 * max(1, abs(x)) if i == j else 0) for j, x in enumerate(values)]
        bounds = battery.bounds_at(table, t, wrong)
        errors = *angle_units(wrong[:3], exact), quaternion_units(wrong[3:], exact)
        assert [n for n in range(7) if bounds[n] != right[n]] == [i]
        assert bounds[i] == pytest.approx(errors[min(i, 3)], rel=1e-3)
    turned = [*values[:2], values[2] + 2 * math.pi, *values[3:]]
    assert battery.bounds_at(table, t, turned)[2] > 1e3
    assert battery.bounds_at(table, t, [math.nan] * 7) == [math.inf] * 7


def worst_bound(motion: Motion) -> tuple[float, str]:
    """Return the worst bound of a key, and the key."""
    return max((battery.key_bound(motion, key, getattr(motion, key)), key) for key in NUMBER_KEYS)


def test_a_key_one_double_off_is_seen() -> None:
    motion = solve(Top(**START))
    assert worst_bound(motion)[0] <= 0.5
    motion._doubles["K"] = Settled(math.nextafter(motion.K, np.inf), ())
    ulps, key = worst_bound(motion)
    assert key == "K"
    assert 0.5 < ulps < 1.5
    motion._doubles["K"] = None
    assert worst_bound(motion) == (math.inf, "K")


def test_a_gap_is_that_on_the_side_of_the_exact_value() -> None:
    """Next to 1 gaps are 2^-52 above and 2^-53 below."""
    third, ar = Fraction(1, 3) / 2**52, balls(60)
    assert battery.ulps(1.0, ar.convert(1 + third)) == pytest.approx(1 / 3, rel=1e-5)
    assert battery.ulps(1.0, ar.convert(1 - third)) == pytest.approx(2 / 3, rel=1e-5)
    wide = ar.convert(1 + third).enlarged(ar.convert(third / 100).greatest)
    with pytest.raises(TooFewDigitsError):
        battery.ulps(1.0, wide)


def test_a_bound_next_to_a_half_is_sharp() -> None:
    """Nearly a tie: a bound to six digits, 0.500001, would break the promise."""
    top = Top(
        A=0.5370460219079735,
        C=1.074092043815947,
        m=1,
        s=1,
        g=1,
        r0=-1.3645650635975366,
        theta0_deg=179.99999998137704,
    )
    bound = battery.key_bound(solve(top), "amplitude_deg", solve(top).amplitude_deg)
    assert bound == pytest.approx(0.5, abs=battery.KEY_CONTRACT - 0.5)


def test_a_tie_and_a_zero_are_judged_by_the_fraction() -> None:
    """Take a = 3 + 3 eps, midway between two doubles, and no spin."""
    motion = solve(Top(**UNIT | {"m": 1 + 2.0**-52, "s": 1.5, "r0": 0.0, "theta0_deg": 60.0}))
    ulps, key = worst_bound(motion)
    assert key == "a"
    assert ulps == pytest.approx(0.5, rel=1e-5)
    motion._doubles["spin_rate_half"] = Settled(5e-324, ())
    assert worst_bound(motion)[0] >= 1


def test_the_report_has_a_column_of_bounds(lagtop: Lagtop) -> None:
    options = ("stability", "--strata", "slow", "--samples", 1, "--certify")
    report = json.loads(lagtop(*options, "--format", "json").stdout)
    (row,) = report["rows"]
    units = [row[f"{name}_units"] for name in ("theta", "phi", "psi", "quaternion")]
    assert row["proved_units"] == max(units) <= 4
    assert row["error_5_rad"] is row["condition_rad"] is None
    assert "methods" not in report["conditions"]
    assert "every error is a proved upper bound" in report["conditions"]["reference"]
    assert " <= " in lagtop(*options).stdout


def test_a_broken_promise_is_told(lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(battery, "CONTRACT", 1e-3)
    result = lagtop("stability", "--strata", "slow", "--samples", 1, "--certify")
    assert result.exit_code == 1
    assert "Exceeded in: slow." in result.stdout
