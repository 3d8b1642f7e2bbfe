"""`find`: inputs that give target values, checked by Chrapan's formulas in mpmath."""

from __future__ import annotations

import csv
import io
import json
import math
import random
from collections.abc import Callable
from pathlib import Path
from typing import Any

import mpmath
import numpy as np
import pint
import pytest
from ball_judge import Judge
from conftest import Lagtop, assert_one_line
from lagtop import LagtopError, MixedBodyWarning, Top, sensitivities, solve
from scipy.integrate import solve_ivp
from uncertainties import ufloat

from lagrange_cli.fits.find import find, number_slopes
from lagrange_cli.fits.implied_body import BODY_INPUTS, completed_body, determined_products
from lagrange_cli.fits.invert import invert
from lagrange_cli.fits.roots import crossing, middle, roots
from lagrange_cli.fits.search import Search, read_conditions
from lagrange_cli.inputs.ranges import parse_span


def numbers_of(**scene: float) -> dict[str, Any]:
    """Return the record of a top by the judge."""
    return Judge(Top(**scene).as_dict()).numbers()


@pytest.mark.parametrize(
    ("key", "wanted", "found"),
    [("T_precession", 2.0, 1), ("T_nutation", 0.45, 2), ("theta_max_deg", 90.0, 1)],
)
def test_no_neighbour_of_an_unknown_comes_nearer(key: str, wanted: float, found: int) -> None:
    motions = find([f"{key}={wanted}"], r0="10:200").motions
    assert len(motions) == found
    for motion in motions:
        r0 = float(motion.top.r0)
        near = [r0, math.nextafter(r0, 0), math.nextafter(r0, math.inf)]
        off = [abs(numbers_of(r0=x)[key] - wanted) for x in near]
        # half an ulp of the number is all that a comparison of doubles can see
        assert off[0] <= min(off) + math.ulp(wanted) / 2


@pytest.mark.parametrize(
    ("line", "message"),
    [
        ("--theta0 30:60 spin_rate_start=50", "every theta0_deg from 30 to 60 has"),
        ("--m 1:1e4 theta_min_deg=30", "every m from 1 to 10000 has theta_min_deg=30, which"),
        ("--theta0 1e-3:1 b=22.363701578192252", "every theta0_deg from 0.001 to 1 has b=22.3637"),
        ("--psidot0 -5:5 path=wavy r0=50", "every psidot0 from -5 to 5 has r0=50, which does"),
        (
            "--m 1000:2000 --g 900:1000 T_nutation=0.43 theta_min_deg=30",
            "the conditions do not determine m and g: many values give ",
        ),
        (
            "--r0 10:200 --m 1000:2000 --theta0 0 theta_min_deg=0 theta_max_deg=0",
            "the conditions do not determine r0 and m: many values give ",
        ),
    ],
)
def test_a_plateau_or_a_curve_is_no_list_of_solutions(
    line: str, message: str, lagtop: Lagtop
) -> None:
    assert_one_line(lagtop("find", *line.split()), 2, message)


def test_what_is_nearest_differs_from_what_is_wanted(lagtop: Lagtop) -> None:
    result = lagtop("find", "--psidot0", "1:2", "a=319.0914121746259")
    assert "nearest to a=319.0914121746259 is a = 319.09141217462593 at psidot0" in result.stderr


def test_a_pair_of_roots_between_two_points_is_found() -> None:
    least = min(find(["T_nutation=0.4525"], r0="10:200").motions, key=lambda x: float(x.top.r0))
    assert len(find(["T_nutation=0.4525"], r0="10:200", scan=7).motions) == 2
    assert 30 < float(least.top.r0) < 40


@pytest.mark.parametrize("key", ["nutation_rate_lower", "nutation_rate_upper"])
def test_steady_precession_is_found_where_the_nutation_only_touches_0(key: str) -> None:
    """The slow and the fast root of A cos(theta) x^2 - C r0 x + mgs = 0, by mpmath."""
    found = find([f"{key}=0"], r0=50, theta0_deg=60, psidot0="1:60").motions
    a, b, c = 39032 * mpmath.cos(mpmath.pi / 3), 17458 * 50, 1587 * 4 * 981
    exact = [(b + sign * mpmath.sqrt(b * b - 4 * a * c)) / (2 * a) for sign in (-1, 1)]
    assert [x.top.psidot0 for x in found] == pytest.approx([float(x) for x in exact], rel=1e-14)


def test_a_number_that_comes_near_without_touching_is_not_found() -> None:
    """The greatest period is 0.452509: a millionth more is nowhere, a millionth less twice."""
    most = max(solve(Top(r0=r0)).T_nutation or 0 for r0 in np.linspace(37, 37.6, 401))
    assert find([f"T_nutation={most * (1 + 1e-6)}"], r0="10:200").motions == []
    assert len(find([f"T_nutation={most * (1 - 1e-6)}"], r0="10:200").motions) == 2


def test_touching_is_told_from_passing_by() -> None:
    x = np.linspace(1.0, 60.0, 1000)
    functions: list[tuple[list[float], Callable[[Any], Any]]] = [
        ([8.908452], lambda at: 0.3 * abs(at - 8.908452)),
        ([100 / 3], lambda at: -((at - 100 / 3) ** 2)),
        ([], lambda at: (at - 33.3) ** 2 + 1e-12),
    ]
    for places, function in functions:
        assert roots(function, x, function(x), 1.0) == pytest.approx(places, abs=1e-7)
    passed_by = roots(lambda at: 1e-12 + abs(at - 40.1), x, 1e-12 + np.abs(x - 40.1))
    assert passed_by == []


def test_a_leap_is_no_root() -> None:
    """The mean spin leaps by a turn per period where the axis starts to pass round a pole."""
    rates = [solve(Top(psidot0=x)).mean_spin_rate for x in (-11.98, -11.97)]
    assert all(math.isfinite(rate) for rate in rates)
    found = find(["mean_spin_rate=46"], psidot0="-40:40").motions
    assert all(abs(motion.mean_spin_rate - 46) < 1e-12 for motion in found)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("conditions", "unknowns"),
    [
        (["T_precession=0.8", "T_nutation=0.43"], {"r0": "10:200", "theta0_deg": "5:150"}),
        (
            ["mean_precession_rate=7", "T_nutation=0.5", "theta_max_deg=70"],
            {"r0": "30:70", "A": "3e4:6e4", "theta0_deg": "10:50"},
        ),
    ],
)
def test_several_unknowns(conditions: list[str], unknowns: dict[str, Any]) -> None:
    motions = find(conditions, **unknowns).motions
    assert motions
    for motion in motions:
        numbers = Judge(motion.top.as_dict()).numbers()
        for condition in conditions:
            key, _, wanted = condition.partition("=")
            assert float(numbers[key]) == pytest.approx(float(wanted), rel=5e-15)


def test_filters_and_bounds() -> None:
    both = find(["T_nutation=0.45"], r0="10:60").motions
    assert [x.theta_max_deg < 100 for x in both] == [False, True]
    assert find(["T_nutation=0.45", "theta_max<100"], r0="10:60").motions == both[1:]
    assert find(["T_nutation=0.45", "theta_max_deg>=100"], r0="10:60").motions == both[:1]
    assert find(["T_nutation=0.45", "path=looping"], r0="10:60").motions == []
    assert find(["T_nutation=0.45", "regime=regular"], r0="10:60").motions == both


@pytest.mark.parametrize(
    ("conditions", "unknowns", "message"),
    [
        (["T_nutation=0.4"], {}, "find needs 1 to 3 unknown inputs, each a .* such as 10:200, got"),
        (["T_nutation=0.4"], {"r0": "1:2", "scan": 2}, "scan must be 3 or more values"),
        ([], {"r0": "1:2"}, "find needs as many conditions"),
        (["T_nutation~3"], {"r0": "1:2"}, "a condition must be KEY=VALUE"),
        (["T_nutation=0.4", "path=straight"], {"r0": "1:2"}, "path= must be one of cusped"),
        (["T_nutation=nan"], {"r0": "1:2"}, "the value of T_nutation must be a finite"),
        (["T_nut=3"], {"r0": "1:2"}, "did you mean .T_nutation"),
        (["T_nutation=1"], {"r0": "2:1"}, "r0 must be a range whose first end is the smaller one"),
        (["T_nutation=1"], {"r0": "log:-1:1"}, "must have two ends of one sign"),
        (["T_nutation=1"], {"mass": "1:2"}, "mass"),
        (["T_nutation=1"], {"r0": "1:2", "m": [3]}, "m must be a real number"),
        (["T_nutation=1"], {"A": "1:2", "C": [3]}, "C must be a real number"),
        (["T_nutation=1"], {"r0": "1:2", "phidot0": 3}, "phidot0 and r0 are both given"),
        ({"T_precession": None}, {"r0": (10, 200)}, "T_precession must be a finite number"),
        ({"T_precession": 2}, {"r0": (10, 20, 30)}, "r0 must be a real number or a pair"),
        ({"T_precession": 2}, {"r0": (200, 10)}, "r0 must have its smaller end first"),
    ],
)
def test_bad_searches(conditions: Any, unknowns: dict[str, Any], message: str) -> None:
    with pytest.raises((LagtopError, TypeError), match=message):
        find(conditions, **unknowns)


@pytest.mark.parametrize("tilt", [0.5, "0.1:1"])
def test_a_tilt_may_be_in_radians(tilt: Any) -> None:
    wanted = solve(Top(theta0_rad=0.5)).T_precession
    other: dict[str, Any] = {} if tilt == "0.1:1" else {"r0": "40:60"}
    motions = find([f"T_precession={wanted!r}"], theta0_rad=tilt, scan=20, **other).motions
    assert any(abs(float(x.top.r0) - 50) < 1e-9 for x in motions)
    assert any(abs(float(x.top.theta0_rad or 0) - 0.5) < 1e-9 for x in motions)


def test_inputs_that_were_not_given_are_said_where_find_is_called() -> None:
    with pytest.warns(MixedBodyWarning, match="A, C, s and g default to the worked") as said:
        find(["T_nutation=0.45"], m=1600, r0="10:60", scan=20)
    assert [x.filename for x in said] == [__file__]


LAB = ["--m", "0.35kg", "--A", "8.5e-4 kg m^2", "--C", "4e-4 kg m^2", "--s", "3cm"]
LAB += ["--g", "9.81 m/s^2", "--theta0", "60deg", "--r0", "1000:20000 rpm"]


@pytest.mark.parametrize(
    ("united", "plain"),
    [
        ("T_precession=5000ms", "T_precession=5"),
        ("mean_precession_rate=12rpm", f"mean_precession_rate={0.4 * math.pi}"),
        ("theta_max=1.1rad", f"theta_max={math.degrees(1.1)}"),
        ("discriminant=8e-4 1/ms^4", "discriminant=8e8"),
        ("b=200/s", "b=200"),
        ("Lz=0.06 kg m^2/s", "Lz=0.06"),
    ],
)
def test_conditions_with_units(united: str, plain: str, lagtop: Lagtop) -> None:
    found = [lagtop("find", *LAB, x, "--keys", "r0").stdout for x in (united, plain)]
    rates = [float(text.splitlines()[1]) for text in found]
    assert rates[0] == pytest.approx(rates[1], rel=1e-13)


@pytest.mark.parametrize(
    ("condition", "message"),
    [
        ("T_nutation=50rad", "T_nutation must have a unit as in 2s, got the unit 'rad'"),
        ("k=0.1s", "k must have no unit, got the unit 's'"),
        ("a=2/m", "a must have a unit as in '2 1/s²', got the unit '/m'"),
        ("r0_sleeping=3 Hz", "r0_sleeping must have a unit as in '50 rad/s' or 480rpm"),
    ],
)
def test_a_condition_in_a_wrong_unit(condition: str, message: str, lagtop: Lagtop) -> None:
    assert_one_line(lagtop("find", *LAB, condition), 2, message)


def test_a_unit_of_a_condition_needs_those_of_the_inputs(lagtop: Lagtop) -> None:
    words = ["find", "--r0", "10:200", "T_precession=500ms"]
    message = "--r0 must have a unit such as '50 rad/s' or 480rpm, as a time, a condition or"
    assert_one_line(lagtop(*words), 2, message)
    tilts = [
        lagtop("find", "--r0", "10:200", f"theta_max={x}").stdout for x in ("63deg", "0.175turn")
    ]
    assert tilts[0] == tilts[1] != ""
    seen = ["theta_min=3deg", "theta_max=6", "T_nutation=4ms", "mean_precession_rate=5000rpm"]
    found = lagtop("find", *seen, "--keys", "T_nutation,mean_precession_rate").stdout
    assert found.splitlines()[1].startswith("0.0040000000000000")


def test_ranges_with_units(lagtop: Lagtop, tmp_path: Path) -> None:
    wanted = ("T_nutation=0.45", "--scan", 20, "--keys", "r0")
    plain = lagtop("find", "--r0", "10:60", *wanted)
    scene = tmp_path / "units.toml"
    scene.write_text('m = "1587 g"\nA = "39032 g cm^2"\nC = "17458 g cm^2"\ns = "4 cm"\n')
    united = lagtop("find", scene, "--g", "9.81 m/s^2", "--r0", "600:3600 deg/s", *wanted)
    assert united.exit_code == 0, united.stderr
    rates = [list(map(float, x.stdout.split()[1:])) for x in (plain, united)]
    assert rates[1] == pytest.approx([x for x in rates[0] if 10.4 < x < 63], rel=1e-12)
    assert rates[1]
    bare = lagtop("find", scene, "--g", "9.81 m/s^2", "--r0", "10:60", *wanted)
    assert_one_line(bare, 2, "--r0 must have a unit such as")


def test_the_command_writes_records(lagtop: Lagtop) -> None:
    options = ("find", "--r0", "10:60", "T_nutation=0.45")
    rows = list(csv.DictReader(io.StringIO(lagtop(*options).stdout)))
    objects = json.loads(lagtop(*options, "--format", "json").stdout)
    assert [float(row["r0"]) for row in rows] == [x["r0"] for x in objects]
    assert [x["T_nutation"] for x in objects] == [0.45, 0.45]
    assert list(rows[0]) == [*solve(Top()).record()]
    assert "at 1000 values" in lagtop(*options).stderr
    finer = lagtop(*options, "--scan", "5000", "--keys", "r0")
    assert "at 5000 values" in finer.stderr
    found = map(float, finer.stdout.split()[1:])
    assert list(found) == pytest.approx([x["r0"] for x in objects], rel=1e-14)  # ties of a few bits


def test_where_there_is_none_the_nearest_is_named(lagtop: Lagtop) -> None:
    result = lagtop("find", "--r0", "10:60", "T_nutation=0.46")
    assert_one_line(result, 1, "no top found: nearest to T_nutation=0.46 is T_nutation = 0.452509")
    result = lagtop("find", "--A", "1:2", "T_nutation=1")
    assert_one_line(result, 1, "no top found: no top of the scan has T_nutation=1 (C must be <= 2")


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ("--r0 200:10 T_nutation=1", 2, "--r0 must be a range whose first end"),
        ("--r0 1:2 T_nutation=1 --scan 2", 2, "--scan must be 3 or more values"),
        ("none.toml --r0 1:2 T_nutation=1", 65, "none.toml: No such file"),
        ("none.scene --r0 1:2 T_nutation=0.5", 65, "none.scene: No such file"),
        ("a=b/none.toml --r0 1:2 T_nutation=0.5", 65, "a=b/none.toml: No such file"),
        ("a.toml b.toml", 2, "use one scene, not a.toml and b.toml"),
        ("theta_min=3", 2, "without an unknown input, such as r0 = 10:200, the conditions must be"),
        (
            "--theta0 20 theta_min=3",
            2,
            "no input is unknown: give a range, such as --theta0 10:200",
        ),
    ],
)
def test_bad_commands(lagtop: Lagtop, words: str, code: int, message: str) -> None:
    assert_one_line(lagtop("find", *words.split()), code, message)


SEEN_KEYS = ("theta_min_deg", "theta_max_deg", "T_nutation", "mean_precession_rate")


def seen_of(**scene: float) -> tuple[list[str], float, float]:
    """Return what is seen of a top released from rest, and its a and b, by the judge."""
    numbers = numbers_of(**scene)
    seen = [f"{name}={float(numbers[name])!r}" for name in SEEN_KEYS]
    return seen, float(numbers["a"]), float(numbers["b"])


@pytest.mark.parametrize("seed", range(8))
def test_turning_points_give_a_and_b(seed: int) -> None:
    rng = random.Random(seed)
    r0 = rng.choice((-1, 1)) * rng.uniform(5, 120)
    seen, a, b = seen_of(r0=r0, theta0_deg=rng.uniform(10, 150))
    found = invert(seen)
    best = min(found, key=lambda x: abs(x.a - a) + abs(x.b - b))
    # the worst of 300 such tops was off by 6e-13: a small nutation says little about k
    assert best.a == pytest.approx(a, rel=1e-11)
    assert best.b == pytest.approx(b, rel=1e-11)


@pytest.mark.parametrize(
    "inputs",
    [
        {"r0": 200.0},
        {"r0": 20_000.0},
        {"m": 1, "A": 1, "C": 0.21, "s": 1, "g": 5.38, "r0": 1.15, "theta0_deg": 154.8}
        | {"thetadot0": -1.3, "psidot0": 2.6},
    ],
)
def test_turning_points_of_fast_tops_and_of_slow_ones(inputs: dict[str, float]) -> None:
    """Here k^2 is near 0 or near its end; both ends of the scan were left out.

    A swing of 1e-4 degrees has lost six digits.
    """
    seen = solve(Top(**inputs))
    motions = invert([f"{key}={getattr(seen, key)!r}" for key in SEEN_KEYS])
    assert any(
        x.a == pytest.approx(seen.a, rel=1e-9) and x.b == pytest.approx(seen.b, rel=1e-9)
        for x in motions
    )


def test_turning_points_of_a_top_that_started_moving() -> None:
    """Judged by Euler's equations in theta and psi, integrated by scipy."""
    a, b, theta, psi_rate = 200.0, -15.0, 0.7, 4.0
    momentum = psi_rate * math.sin(theta) ** 2 + b * math.cos(theta)

    def precession(u: float) -> float:
        return (momentum - b * u) / (1 - u * u)

    def slope(_: float, state: np.ndarray) -> list[float]:
        u, sine = math.cos(state[0]), math.sin(state[0])
        rate = precession(u)
        return [state[1], a / 2 * sine + rate * rate * u * sine - b * rate * sine, rate]

    def turns(_: float, state: np.ndarray) -> float:
        return float(state[1])

    run = solve_ivp(slope, (0, 3), [theta, 0, 0], "DOP853", rtol=1e-12, atol=1e-12, events=turns)
    times, states = run.t_events[0], run.y_events[0]
    start = 0 if times[0] > 1e-9 else 1
    period = times[start + 2] - times[start]
    tilts = sorted(np.degrees(states[start : start + 2, 0]))
    rate = (states[start + 2, 2] - states[start, 2]) / period
    seen = [f"theta_min={tilts[0]}", f"theta_max={tilts[1]}", f"T_nutation={period}"]
    found = invert([*seen, f"mean_precession_rate={rate}"])
    assert min(abs(x.a - a) + abs(x.b - b) for x in found) < 1e-7


def test_the_spin_gives_the_moments() -> None:
    numbers, (seen, _, _) = numbers_of(), seen_of()
    known = {"m": 1587.0, "g": 981.0, "s": 4.0}
    (motion,) = invert([*seen, f"mean_spin_rate={float(numbers['mean_spin_rate'])!r}"], known=known)
    assert float(motion.top.A) == pytest.approx(39032, rel=1e-11)
    assert float(motion.top.C) == pytest.approx(17458, rel=1e-11)
    assert float(motion.top.r0) == pytest.approx(50, rel=1e-11)


@pytest.mark.parametrize("known", [(), ("g",), ("m", "g", "A"), ("C",), ("C", "A"), BODY_INPUTS])
@pytest.mark.parametrize("spins", [False, True])
def test_the_body_that_is_made_moves_as_seen(known: tuple[str, ...], spins: bool) -> None:
    true = {"m": 1.587, "A": 3.9e-3, "C": 1.7e-3, "s": 0.04, "g": 9.81, "r0": -50.0}
    a = 2 * true["m"] * true["g"] * true["s"] / true["A"]
    b = true["C"] * true["r0"] / true["A"]
    given = {name: true[name] for name in known}
    seen = {"a": a, "b": b} | ({"r0": true["r0"]} if spins and "r0" not in known else {})
    told = determined_products(seen, given)
    body = completed_body(seen, given)
    assert body["C"] <= 2 * body["A"]
    assert 2 * body["m"] * body["g"] * body["s"] / body["A"] == pytest.approx(a, rel=1e-13)
    assert body["C"] * body["r0"] / body["A"] == pytest.approx(b, rel=1e-13)
    for product in told:
        value = math.prod(true[name] ** float(n) for name, n in product.powers.items())
        assert product.value == pytest.approx(value, rel=1e-13)


SEEN = ["theta_min=30", "theta_max=60", "T_nutation=0.4", "mean_precession_rate=5"]
TURNED = ["theta_min=60", "theta_max=30", *SEEN[2:]]


def test_known_inputs_do_not_change_the_motion() -> None:
    (motion,) = invert(SEEN, known={"r0": 50.0})
    assert motion.mean_precession_rate == pytest.approx(5, rel=1e-12)


@pytest.mark.parametrize(
    ("seen", "options", "message"),
    [
        (SEEN, {"known": {"A": 2.0, "r0": 3.0}}, r"with A = 2, r0 = 3 .* 0 < C/A <= 2, got C/A ="),
        (SEEN, {"known": {"r0": 0.0}}, "r0 must not be 0"),
        (SEEN, {"known": {"r0": -50.0}}, "no top with this nutation .* and has r0 = -50"),
        (SEEN, {"known": {"g": 0.0}}, "g must not be 0"),
        (
            SEEN,
            {"known": {"A": 2.0, "C": 1.0, "r0": 3.0}},
            "A = 2, C = 1, r0 = 3 must agree with the motion: leave one of them out",
        ),
        (TURNED, {}, "theta_min < theta_max < 180 degrees, got 60 and 30"),
        (TURNED, {"radians": True}, "theta_min < theta_max < pi, got 60 and 30"),
    ],
)
def test_motions_that_no_top_has(seen: list[str], options: Any, message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        invert(seen, **options)


@pytest.mark.parametrize(
    ("seen", "known", "names"),
    [
        ({"a": 100.0, "b": 20.0}, {"g": 9.81, "A": 0.004}, ["C*r0", "m*s"]),
        ({"a": 100.0, "b": 20.0, "r0": 50.0}, {"g": 9.81, "m": 1.5}, ["C/A", "r0", "s/A"]),
    ],
)
def test_what_cannot_be_told_apart_is_named(seen: Any, known: Any, names: list[str]) -> None:
    assert [x.name for x in determined_products(seen, known)] == names


@pytest.mark.parametrize("off", [-12, 12])
def test_a_root_is_corrected_in_its_last_bits(monkeypatch: pytest.MonkeyPatch, off: int) -> None:
    exact = math.sqrt(2)
    wrong = exact + off * math.ulp(exact)
    monkeypatch.setattr("lagrange_cli.fits.roots.crossing", lambda *_: wrong)
    x = np.array([1.0, 2.0])
    assert roots(lambda at: at - exact, x, x - exact) == [exact]
    assert roots(lambda at: exact - at, x, exact - x) == [exact]


@pytest.mark.parametrize("radians", [False, True])
def test_slopes_are_the_exact_derivatives(radians: bool) -> None:
    conditions = read_conditions(["theta_max=1", "mean_spin_rate=1"], radians=radians)
    tilt = ("theta0_rad", "1:2") if radians else ("theta0_deg", "60:80")
    spans = {"r0": parse_span("30:60"), tilt[0]: parse_span(tilt[1])}
    search = Search({"psidot0": 3.0}, spans, conditions, radians)
    point = np.array([45.0, 1.3 if radians else 70.0])
    keys = [key.replace("_rad", "_deg") for key in search.keys]
    exact = sensitivities(search.top(point.tolist()), keys).derivatives
    unit = [math.radians(1) if radians else 1.0, 1.0]
    for row, key, scale in zip(number_slopes(search, point), keys, unit, strict=True):
        wanted = [exact[key][name] * scale for name in spans]
        assert row == pytest.approx(wanted, rel=1e-8)


@pytest.mark.parametrize(
    ("function", "low", "high", "root"),
    [
        (lambda x: x**3 - 2, 0.0, 5.0, 2 ** (1 / 3)),
        (lambda x: math.exp(x) - 1e5, -10.0, 40.0, math.log(1e5)),
        (lambda x: 1 / x - 1e-3, 1e-5, 1e9, 1000.0),
        (lambda x: (x - 1.25) ** 5, 0.0, 100.0, 1.25),
        (lambda x: math.copysign(1.0, x - 7) * abs(x - 7) ** 0.1, 0.0, 100.0, 7.0),
        (lambda x: math.copysign(1.0, x - 1e-300), -50.0, 60.0, 1e-300),
    ],
)
def test_a_sign_change_is_found_to_the_last_bits(
    function: Callable[[float], float], low: float, high: float, root: float
) -> None:
    calls = []

    def counted(x: float) -> float:
        calls.append(x)
        return function(x)

    found = crossing(counted, (low, function(low)), (high, function(high)))
    assert found == pytest.approx(root, rel=1e-15, abs=0)
    assert len(calls) <= 64


def test_the_middle_is_counted_in_doubles() -> None:
    assert middle(-50.0, 50.0) == 0
    assert middle(1.0, 4.0) == 2
    assert middle(0.0, 1e-323) == 5e-324
    assert middle(1.0, math.nextafter(1.0, 2)) == 1
    assert middle(-3.0, -2.0) == -2.5


def test_a_leap_at_zero_is_no_root(lagtop: Lagtop) -> None:
    """Halving the distance to 0 does not end: there are 1074 powers of two."""
    result = lagtop("find", *"--r0=-50:60 --theta0 60 mean_spin_rate=0".split())
    assert_one_line(result, 1, "no top found: nearest to mean_spin_rate=0 is mean_spin_rate = -")


def test_a_leap_at_zero_hides_no_root() -> None:
    (motion,) = find(["mean_precession_rate=-11.5"], r0="-60:60", theta0_deg=120).motions
    numbers = Judge(motion.top.as_dict()).numbers()
    assert float(numbers["mean_precession_rate"]) == pytest.approx(-11.5)


@pytest.mark.parametrize(("relation", "holds"), [("<", 1), ("<=", 3), (">", 4), (">=", 6)])
def test_bounds_hold_or_not(relation: str, holds: int) -> None:
    """Each bit of `holds` is for a number below the limit, on it and above it."""
    (condition,) = read_conditions([f"r0{relation}2"])
    found = [condition.holds({"r0": x}) for x in (1.0, 2.0, 3.0, None)]
    assert found == [*(bool(holds & bit) for bit in (1, 2, 4)), False]


def test_numbers_and_pairs_are_conditions_and_ranges() -> None:
    found = find({"T_precession": 2.0}, r0=(10, 200), theta0_deg=30)
    assert found.motions == find(["T_precession=2"], r0="10:200", theta0_deg=30).motions
    assert found["T_precession"] == pytest.approx([2.0], rel=1e-15)
    assert found["r0"].tolist() == [motion.top.r0 for motion in found.motions]
    assert found.to_pandas().regime.tolist() == ["regular"]
    looping = find({"T_nutation": 0.45, "path": "looping"}, r0=(10, 60))
    assert looping.motions == []
    assert len(looping["r0"]) == 0


def test_quantities_are_conditions_of_the_known_inputs() -> None:
    unit: Any = pint.UnitRegistry()
    body = {"m": "1587 g", "A": "39032 g cm^2", "C": "17458 g cm^2", "s": "4 cm", "g": "981 cm/s^2"}
    known = {name: unit.Quantity(text) for name, text in body.items()}
    found = find({"T_precession": 2.0}, r0=unit.Quantity((100, 1900), "rpm"), **known)
    period = {"T_precession": unit.Quantity(2000.0, "ms")}
    same = find(period, r0=unit.Quantity((100, 1900), "rpm"), **known)
    assert same["r0"].tolist() == pytest.approx(found["r0"].tolist(), rel=1e-14)
    expected = find({"T_precession": 2.0}, r0=(10, 200))
    assert found["r0"] == pytest.approx(expected["r0"], rel=1e-12)
    assert found["m"].tolist() == [1.587]
    tilted = find(
        {"T_precession": 2.0}, r0="100:1900 rpm", theta0_deg=unit.Quantity("0.5 rad"), **known
    )
    assert tilted["theta0_deg"] == pytest.approx([math.degrees(0.5)], rel=1e-15)
    known["r0"] = ufloat(50, 1)
    with pytest.raises(LagtopError, match="r0 must have a unit"):
        find({"T_precession": 2.0}, theta0_deg=(10, 20), **known)
