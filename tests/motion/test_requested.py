"""Keys on request: where they are accepted, the worked example, and values midway.

`test_proved_numbers` and `test_cancellation` judge them as the nearest doubles.
"""

from __future__ import annotations

import subprocess
import sys
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import numpy as np
import pytest
from chrapan_top import ar
from conftest import Lagtop
from errata import FIGURES, round_alike, true_values
from lagtop import LagtopError, Top, solve, sweep
from scenes import UNIT

from lagrange_cli.motion.paper.requested import derivation_keys
from lagrange_cli.motion.record import KEYS, all_keys, record_keys, requested_keys

DIGITS = 40


def test_every_figure_of_section_8_is_in_the_derivation(lagtop: Lagtop) -> None:
    """To the digits printed, where the print is right; the others are the true ones."""
    header, cells = lagtop("solve", "--derivation", "--format", "csv").stdout.splitlines()
    assert header.split(",") == derivation_keys()
    steps, values = [ar.mpf(cell) for cell in cells.split(",")], true_values()
    assert header.startswith("m,A,C,s,g,r0,theta0_deg,a,")  # as section 8 begins
    assert cells.startswith("1587.0,39032.0,17458.0,4.0,981.0,50.0,30.0,319.0914")
    steps = steps[7:]
    assert len(steps) == len(FIGURES) == 30
    right = 0
    for figure in FIGURES:
        with ar.workdps(40):
            true = round_alike(figure.true(values), figure.text)
        assert true in {round_alike(step, figure.text) for step in steps}, figure.name
        right += true == figure.text
    assert right == 16


def test_the_derivation_is_a_table_of_every_step(lagtop: Lagtop) -> None:
    shown = lagtop("solve", "--derivation", "--rad").stdout
    assert max(map(len, shown.splitlines())) <= 80
    assert set(
        map(str, solve(Top()).record(radians=True, keys=derivation_keys(radians=True)).values())
    ) <= (set(shown.split()))
    lines = shown.splitlines()
    names = ("Inputs", "m   ", "ϑ0", "2mgs/A", "2 u3", "(7,2)")
    order = [next(i for i, line in enumerate(lines) if name in line) for name in names]
    assert order == sorted(order)


@pytest.mark.parametrize("options", ["--g 0", "--theta0 0", "--thetadot0 1", "--psidot0 2"])
def test_what_has_no_derivation_says_so(lagtop: Lagtop, options: str) -> None:
    found = lagtop("solve", "--derivation", *options.split())
    assert (found.exit_code, found.stdout) == (1, "")
    assert found.stderr.startswith("Error: --derivation must be of a top that nutates after")
    assert found.stderr.count("\n") == 1


def test_a_record_has_them_only_when_they_are_asked_for(lagtop: Lagtop) -> None:
    motion = solve(Top())
    assert not set(motion.record()) & set(requested_keys())
    assert motion.record(keys=["Lz", "a"]) == {"a": motion.a, "Lz": motion.Lz}
    assert motion.record(keys=["psi_half_rad"], radians=True) == {
        "psi_half_rad": pytest.approx(1.715080720900244, rel=1e-15)
    }
    assert lagtop("solve", "--get", "Lz").stdout == f"{motion.Lz}\n"
    digits = lagtop("solve", "--get", "phi_half_rad", "--rad", "--digits", "25")
    assert digits.exit_code == 0
    assert set(requested_keys()) <= set(dir(motion))


def test_undefined_quantities_are_none(lagtop: Lagtop) -> None:
    sleeping, pendulum = solve(Top(theta0_deg=0)), solve(Top(r0=0))
    assert sleeping.Lz == 872900.0
    assert sleeping.u2_criterion is sleeping.phi_half_deg is sleeping.roots_sum is None
    assert pendulum.phi_half_deg is pendulum.spin_rate_upper is None  # the lower pole
    assert pendulum.phi_period_deg == 180.0
    found = lagtop("solve", "--theta0", "0", "--get", "roots_sum")
    assert (found.exit_code, found.stdout) == (1, "")


def test_sweeps_take_them_from_solve(lagtop: Lagtop) -> None:
    keys = ["r0", "Lz", "T_nutation", "psi_half_deg", "error"]
    columns = sweep(r0=[20.0, 0.0, np.nan, -50.0], theta0_deg=30.0, keys=keys)
    for i, r0 in ((0, 20.0), (1, 0.0), (3, -50.0)):
        motion = solve(Top(r0=r0))
        assert columns["Lz"][i] == motion.Lz
        assert columns["psi_half_deg"][i] == motion.psi_half_deg or r0 == 0
    assert np.isnan(columns["psi_half_deg"][1])
    assert columns["error"][2].startswith("r0 must be")
    assert np.isnan(columns["Lz"][2])
    assert lagtop("sweep", "--r0", "20,30", "--keys", "Lz").stdout.count("\n") == 3
    with pytest.raises(LagtopError, match=r"keys must be among .* got 'L_z' \(did you mean 'Lz'"):
        sweep(r0=[1.0], keys=["L_z"])


@pytest.mark.parametrize(
    ("keys", "message"),
    [
        ([], "keys must be among .*, got an empty list"),
        (["a", "a"], "keys must not repeat a name, got 'a' twice"),
        (["Lz", "Lz"], "keys must not repeat a name, got 'Lz' twice"),
        ([["a"]], r"keys must be among .*, got \['a'\]"),
    ],
)
def test_keys_of_a_record_are_checked(keys: Any, message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        solve(Top()).record(keys=keys)


def test_explain_lists_them(lagtop: Lagtop) -> None:
    shown = lagtop("explain", "--format", "csv").stdout
    assert all(f"\n{key}," in shown for key in requested_keys())
    assert [*record_keys(), *requested_keys()] == all_keys()


def test_a_record_loads_none_of_their_modules() -> None:
    code = (
        "import sys; from lagtop import Top, solve; solve(Top()).record();"
        "names = 'requested', 'sections', 'rational_keys';"
        "print([x for x in sys.modules if x.endswith(names)])"
    )
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, check=True, text=True)
    assert done.stdout == "[]\n"


def test_each_input_is_in_the_group_of_inputs_under_its_symbol() -> None:
    tilted = {"theta0_deg": "ϑ0", "thetadot0": "ϑ'0", "psidot0": "ψ'0"}
    for name in Top().inputs():
        assert (KEYS[name].group, KEYS[name].symbol) == ("Inputs", tilted.get(name, name))


def roots_of(top: Top) -> tuple[Any, ...]:
    """Return r0, a, b, beta and the cosines u0, u1, u2, u3 (4,9) of a top by mpmath."""
    m, A, C, s, g, r0, psi_rate, tilt = (
        mpmath.mpf(Fraction(x).numerator) / Fraction(x).denominator
        for x in (top.m, top.A, top.C, top.s, top.g, top.r0, top.psidot0, top.theta0_deg or 0)
    )
    u0, a, b = mpmath.cos(mpmath.radians(tilt)), 2 * m * g * s / A, C * r0 / A
    alpha, beta = psi_rate**2 * (1 - u0**2) + a * u0, psi_rate * (1 - u0**2) + b * u0
    cubic = [alpha - beta**2, 2 * beta * b - a, -(alpha + b**2), a]
    roots = mpmath.polyroots(cubic, maxsteps=500, extraprec=500, asc=True)
    u2, u1, u3 = sorted(map(mpmath.re, roots))
    return r0, a, b, beta, u0, u1, u2, u3


@pytest.mark.parametrize(
    ("digits", "start"),
    [
        (25, {"m": "6.1257618979", "r0": "-6.12503416216992490065616490725", "theta0_deg": "90"}),
        (29, {"m": "4.25236727481388732678245406", "r0": "3.06253935984645", "theta0_deg": "60"}),
        (33, {"m": "1", "r0": "-1.187574955665079", "psidot0": "2.375635389420887"}),
        (34, {"m": "0.5138390658540719239501518846797", "A": "2", "C": "2", "r0": "10"}),
        (7, {"m": "0.0253125", "r0": "0.225", "theta0_deg": "72", "psidot0": "0.225"}),
        (26, {"m": "0.551276429441219585934403405", "g": "10", "r0": "-10", "theta0_deg": "45"}),
    ],
)
def test_polynomials_in_the_upper_root_may_be_midway(digits: int, start: dict[str, str]) -> None:
    """No number of digits tells a tie: the fraction does; the roots are those of mpmath."""
    psi_rates = {25: "-1.0", 29: "4.0", 34: "-3"}
    given: dict[str, Any] = (
        UNIT | {"theta0_deg": "60", "psidot0": psi_rates.get(digits, "0")} | start
    )
    top = Top(**{name: Fraction(x) for name, x in given.items()})
    found = solve(top).record(digits=digits, keys=["f_slope_u1", "u2_criterion", "discriminant"])
    with mpmath.workdps(120):
        _, a, *_, u1, u2, u3 = roots_of(top)
        right = {
            "f_slope_u1": -a * (u1 - u2) * (u3 - u1),
            "u2_criterion": a * u2 * u3,
            "discriminant": (a * (u3 - u2)) ** 2,
        }
        for key, text in found.items():
            half = mpmath.mpf(10) ** (Decimal(text).adjusted() + 1 - digits) / 2
            assert abs(mpmath.mpf(text) - right[key]) <= half * (1 + mpmath.mpf(10) ** -40), key


@pytest.mark.parametrize(
    ("digits", "key", "start"),
    [
        (12, "roots_gap_squared", {"m": "0.5", "A": "2", "g": "2", "r0": "-0.25"}),
        (6, "roots_gap_squared", {"m": "1.8", "r0": "1.5", "theta0_deg": "120"}),
        (5, "roots_product_fourfold", {"m": "2", "A": "3", "C": "4.5", "g": "2", "r0": "-3"}),
        (8, "roots_product", {"m": "2", "A": "3", "C": "0.75", "g": "4", "r0": "-1"}),
        (5, "u3_twice", {"m": "189/4120", "r0": "189/1648", "theta0_deg": "120"}),
        (5, "spin_rate_half", {"m": "555/896", "r0": "185/224", "theta0_deg": "90"}),
        (6, "spin_rate_half", {"m": "81/40960", "C": "0.5", "r0": "-9/64"}),
        (6, "precession_rate_half", {"m": "27/8192", "C": "1.5", "r0": "3/64", "psidot0": "15/64"}),
    ],
)
def test_numbers_of_rational_roots_may_be_midway(
    digits: int, key: str, start: dict[str, str]
) -> None:
    """No number of digits tells a tie.  The roots are those of mpmath, and u(T/2) by cn^2/dn^2."""
    tilt = {"theta0_deg": "90" if "A" in start and "C" not in start else "60"}
    given = UNIT | tilt | {"psidot0": "0"} | start
    top = Top(**{name: Fraction(x) for name, x in given.items()})
    text = solve(top).record(digits=digits, keys=[key])[key]
    with mpmath.workdps(120):
        r0, _, b, beta, u0, u1, u2, u3 = roots_of(top)
        sn2, k2 = (u0 - u2) / (u1 - u2), (u1 - u2) / (u3 - u2)
        u = u2 + (u1 - u2) * (1 - sn2) / (1 - k2 * sn2)
        turn = (beta - b * u) / (1 - u**2)
        right = {
            "roots_product": u2 * u3,
            "roots_product_fourfold": -4 * u2 * u3,
            "roots_gap_squared": (u3 - u2) ** 2,
            "u3_twice": 2 * u3,
            "precession_rate_half": turn,
            "spin_rate_half": r0 - u * turn,
        }[key]
        half = mpmath.mpf(10) ** (Decimal(text).adjusted() + 1 - digits) / 2
        assert abs(abs(mpmath.mpf(text) - right) / half - 1) < mpmath.mpf(10) ** -40


def test_numbers_at_irrational_cosines_may_be_midway() -> None:
    """Worked out by hand: (alpha + b^2)^2 without torque, 2a squared and psi' without spin."""
    free = UNIT | {"g": 0, "C": 2, "r0": -3.5, "theta0_deg": 30, "psidot0": -1, "thetadot0": -8}
    assert solve(Top(**free)).record(digits=8, keys=["discriminant"]) == {
        "discriminant": "12825.562"  # 64.25 + 49, squared: 12825.5625
    }
    plane = UNIT | {"m": 49 / 512, "r0": 0, "theta0_deg": 165, "thetadot0": 7 / 16}
    assert solve(Top(**plane)).record(digits=13, keys=["discriminant"]) == {
        "discriminant": "0.1465454101562"  # 4 (49/256)^2 = 0.14654541015625
    }
    still = UNIT | {"g": 0, "r0": 0, "theta0_deg": 126, "psidot0": 15 / 64, "thetadot0": 35 / 32}
    assert solve(Top(**still)).record(digits=5, keys=["precession_rate_half"]) == {
        "precession_rate_half": "0.23438"  # 15/64 = 0.234375
    }
