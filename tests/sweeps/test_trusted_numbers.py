"""Every number of a sweep against that of `solve`, which has other formulas."""

from __future__ import annotations

import json
import math
import random
import re
from fractions import Fraction
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop, dicts
from lagtop import Motion, Top, solve, sweep
from scenes import EVERY_KIND, UNIT

from lagrange_cli.bench.hard_scenes import CORNERS, KINDS, in_doubles, nutating
from lagrange_cli.solver import keys as table
from lagrange_cli.solver.facts import Regime
from lagrange_cli.solver.keys import INPUT_KEYS, NUMBERS, TEXT_KEYS
from lagrange_cli.solver.record import remark_without_numbers
from lagrange_cli.sweeps import records
from lagrange_cli.sweeps.tops import top_arrays
from lagrange_cli.top.units import bare_name


def is_incomplete(name: str) -> bool:
    """Return whether a number depends on an incomplete integral, which sweeps leave to `solve`."""
    own = re.search(r"\b(half|quarter)\[", table.LINES[name].evaluated)
    return bool(own) or any(map(is_incomplete, table.needed(name)))


KEYS = [key for key in NUMBERS if not is_incomplete(bare_name(key))]
Scene = dict[str, Any]


def assert_trusted(scenes: list[Scene], least: int, **word: str) -> None:
    """Check all keys of tops, of which at least some have no error, against their bounds."""
    scenes = [{"thetadot0": 0.0, "psidot0": 0.0, **in_doubles(scene), **word} for scene in scenes]
    columns: Scene = {name: [scene[name] for scene in scenes] for name in scenes[0]} | word
    found = sweep(**columns, keys=[*TEXT_KEYS, "psidot0", *KEYS, "error"], radii=True)
    fine = [i for i, x in enumerate(found["error"]) if not x or "at least 5e-324" in x]
    assert len(fine) >= least
    for i in fine:
        scene, motion = scenes[i], solve(Top(**scenes[i]))
        remark = remark_without_numbers(motion.facts)
        assert [found[key][i] for key in TEXT_KEYS] == [motion.regime, motion.path, remark], scene
        for key in KEYS:
            value, bound = float(found[key][i]), float(found[f"{key}_radius"][i])
            if math.isnan(value):
                assert found["error"][i] or not motion.has(key), (key, scene)
                continue
            exact = motion.number(key, 25)
            assert exact is not None, (key, scene)
            error = abs(Fraction(str(exact.value)) - Fraction(value))
            assert error <= bound + 1e-24 * abs(value), (key, scene)
            size = 1 if NUMBERS[key].relative_to else abs(value)
            assert bound <= max(1e-13 * size, 1e-323), (key, scene)
        assert found["psidot0"][i] == pytest.approx(float(motion.top.psidot0), rel=1e-13)


USUAL = KINDS.keys() - {"near hanging"}
"""Kinds of which most tops have all numbers as doubles, and do not round to the vertical."""


@pytest.mark.parametrize("count", [8, pytest.param(40, marks=pytest.mark.slow)])
@pytest.mark.parametrize("kind", KINDS | CORNERS)
def test_every_key_is_within_its_bound(kind: str, count: int) -> None:
    rng, make = random.Random(f"trusted {kind}"), (KINDS | CORNERS)[kind]
    assert_trusted([make(rng) for _ in range(count)], count // 2 if kind in USUAL else 1)


EXAMPLE = {name: float(getattr(Top(), name)) for name in ("m", "A", "C", "s", "g")}
UPRIGHT = 2 * math.sqrt(39032 * 1587 * 4 * 981) / 39032
"""The rate at the bottom of a pendulum that just reaches the top."""
WHIRLS, STIFF = random.Random(4), random.Random("stiff")
CANCELLING: dict[str, list[Scene]] = {
    "over the lower pole from next to the upper one": [
        EXAMPLE | {"r0": 0, "theta0_deg": tilt, "psidot0": 1}
        for tilt in (1e-9, 1e-12, 1e-30, 1e-100)
    ],
    # the mean precession goes as 1/thetadot0^2 where the parts are of the size 1
    "mean rates": [
        UNIT | {"r0": 1, "theta0_deg": 60, "thetadot0": rate} for rate in (1e3, 1e4, 1e5, 1e8, 1e20)
    ],
    # released next to the upper pole, b^2/2 is nearly a u0
    "the largest root": [
        EXAMPLE | {"theta0_deg": tilt, "r0": 2 * math.sqrt(39032 * 1587 * 4 * 981) / 17458 * more}
        for tilt in (0.3, 1e-3, 1e-6)
        for more in (1 + 1e-4, 1 + 1e-8, 1 - 1e-8)
    ],
    "pendulums next to the separatrix": [
        EXAMPLE | {"r0": 0, "theta0_deg": tilt, "thetadot0": UPRIGHT * sin * (1 + off)}
        for tilt, sin in ((60, 0.5), (180 - 1e-9, 1.0))
        for off in (-1e-3, 1e-7, -1e-12, 3e-15)
    ],
    # parts that cancel are computed in pairs of doubles; the worst error seen is 0.5 eps
    "mean rates in pairs of doubles": [
        EXAMPLE
        | {"theta0_deg": 30, "r0": WHIRLS.uniform(-5, 5), "thetadot0": WHIRLS.uniform(5, 300)}
        for _ in range(30)
    ],
    # among them a spin rate far below its parts: gaps good to 2^-38 would put it 31 eps off
    "stiff tops": [nutating("stiff", STIFF) for _ in range(25)],
    "elementary theory": [
        *(EXAMPLE | x for x in EVERY_KIND.values() if "theta0_deg" in x),
        *(UNIT | {"theta0_deg": 90, "r0": r0} for r0 in (0, 2, -2)),
        *(UNIT | {"theta0_deg": 90, "r0": 1, "psidot0": -1, "C": 2, "g": g} for g in (0, 1)),
        UNIT | {"theta0_deg": 60, "r0": -1, "psidot0": 2 / 3},
        UNIT | {"theta0_deg": 30, "r0": 1},
    ],
    "a cosine": [
        EXAMPLE | {"theta0_deg": tilt, "r0": r0}
        for tilt, r0 in ((90, 1e10), (90.5, 50), (89.5, 50))
    ],
    "sizes beyond 1e30": [
        {**dict.fromkeys("mAC", 1e-40), "s": 1, "g": 1, "r0": 50, "theta0_deg": 30}
    ],
    "the least spin of the remark": [
        UNIT | {"r0": r0, "theta0_deg": 30} for r0 in (10.0, math.nextafter(10.0, 0.0), -1e9)
    ],
    "a start at u2": [
        EXAMPLE | {"r0": 50, "psidot0": 14.268273570855769, "theta0_deg": 73.92162879062151}
    ],
    "next to the vertical": [EXAMPLE | {"r0": r0, "theta0_deg": 1e-100} for r0 in (50, 1e70)],
    "a tilt in radians": [
        EXAMPLE | {"r0": 50, "theta0_rad": tilt, "thetadot0": rate}
        for tilt, rate in ((0.0, 0.0), (3.141592, -2.0))
    ],
}


@pytest.mark.parametrize("name", CANCELLING)
def test_numbers_whose_parts_cancel(name: str) -> None:
    assert_trusted(CANCELLING[name], len(CANCELLING[name]))


RATES = random.Random("steady")
STEADY: list[Scene] = [
    *(EXAMPLE | {"r0": RATES.gauss(0, 90), "theta0_deg": RATES.uniform(0, 180)} for _ in range(40)),
    # sums that cancel: next to the least r0, at 90 degrees, and a spin rate of 0
    *(EXAMPLE | {"r0": 52.5611 + x, "theta0_deg": 30} for x in (1e-3, 1e-4, 5e-5)),
    *(EXAMPLE | {"r0": 50, "theta0_deg": tilt} for tilt in (90, 90 - 1e-10, 90 + 1e-14)),
    *(UNIT | {"r0": 0, "theta0_deg": 120}, UNIT | {"r0": 3, "C": 1.0, "theta0_deg": 60}),
]


@pytest.mark.parametrize("word", ["steady", "steady-fast"])
def test_steady_tops(word: str) -> None:
    assert_trusted(STEADY, len(STEADY) // 2, psidot0=word)


@pytest.mark.parametrize("body", [(1.0, 1.0, 1.0, 1.0, 1.0), (2.0, 3.0, 0.5, 4.0, 9.81)])
def test_tops_at_the_threshold_of_sleeping_go_one_by_one(body: tuple[float, ...]) -> None:
    """Where (C r0)^2 = 4 A m g s nearly, lambda - 1 has lost its digits."""
    m, A, C, s, g = body
    r0 = 2 * math.sqrt(A * m * g * s) / C * np.array([0.9, 1 - 1e-15, 1.0, 1 + 1e-15, 1.1, -1.0])
    fixed = {"m": m, "A": A, "C": C, "s": s, "g": g, "theta0_deg": 10, "thetadot0": 0, "psidot0": 0}
    regimes = top_arrays(fixed | {"r0": r0}, r0.size).groups().values()
    assert np.any(list(regimes), axis=0).tolist() == [True, False, False, False, True, False]


@pytest.mark.parametrize("start", ["next to the pole", "next to the separatrix", "over the pole"])
def test_most_hard_starts_are_computed_as_arrays(start: str, monkeypatch: Any) -> None:
    """Bounds of errors that are too wide would leave most of these tops to `solve`."""
    rng = np.random.default_rng(5)

    def power(low: float, high: float, signs: tuple[int, ...] = (-1, 1)) -> Any:
        return rng.choice(signs, 400) * 10 ** rng.uniform(low, high, 400)

    given = {name: power(-1, 1, (1,)) for name in ("m", "A", "s", "g")}
    given |= {"C": given["A"] * rng.uniform(0.1, 1.9, 400), "r0": power(0, 2)}
    given |= {"theta0_deg": power(-7, 0, (1,)), "thetadot0": power(-12, 2)}
    given["psidot0"] = power(-10, 2)
    if start != "next to the pole":  # psi' = b/(1 + u), theta'^2 = (1 - u) (a - b psi')
        tilt, b = rng.uniform(60, 120, 400), rng.uniform(0.1, 1, 400)
        u = np.cos(np.radians(tilt))
        off = power(-12, -4) if start == "next to the separatrix" else 0.0  # but for rounding
        given = UNIT | {"r0": b, "theta0_deg": tilt, "psidot0": b / (1 + u) * (1 + off)}
        given["thetadot0"] = np.sqrt((1 - u) * (2 - b * b / (1 + u))) * (1 + power(-12, -4))
    calls = []

    def counted(top: Top) -> Motion:
        calls.append(top)
        return solve(top)

    monkeypatch.setattr(records, "solve", counted)
    columns: Any = {name: np.broadcast_to(x, 400) for name, x in given.items()}
    rates = ["T_nutation", "mean_spin_rate", "mean_precession_rate"]
    sweep(**columns, keys=rates if start == "over the pole" else None)
    assert len(calls) < 40
    assert_trusted([{name: float(x[i]) for name, x in columns.items()} for i in range(25)], 25)


def test_neighbours_in_a_block_change_no_bit() -> None:
    """Some tops need more steps of the iterations than others."""
    rng = random.Random("neighbours")
    scenes = [in_doubles(make(rng)) for make in KINDS.values()]
    scenes += [in_doubles(KINDS[kind](rng)) | {"thetadot0": 0, "psidot0": 0} for kind in KINDS]
    scenes = [{"thetadot0": 0, "psidot0": 0} | x for x in scenes if "theta0_deg" in x]
    keys = [*TEXT_KEYS, *KEYS, "error"]
    columns: Scene = {name: [scene[name] for scene in scenes] for name in scenes[0]}
    block = sweep(**columns, keys=keys, radii=True)
    for i, scene in enumerate(scenes):
        alone = sweep(**scene, keys=keys, radii=True)
        for key, column in block.items():
            np.testing.assert_array_equal(column[i], alone[key], err_msg=f"{key} of {scene}")


def test_no_ordinary_top_is_solved_by_itself(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(records, "solve", None)
    rng = np.random.default_rng(2)
    start: Any = {"r0": rng.uniform(-99, 99, 2000), "theta0_deg": rng.uniform(1, 179, 2000)}
    for rates in (0.0, rng.uniform(-5, 5, 2000)):
        found = sweep(**start, psidot0=rates, keys=["regime", "path", *KEYS])
        assert not np.isnan(found["stability_factor"]).any()
        texts = [*found["regime"], *found["path"]]  # of the same object: memory
        assert len({*map(id, texts)}) == len({*texts})
    ends = UPRIGHT * np.sin(np.radians(start["theta0_deg"]) / 2)
    for rate in (ends * (1 + 10 ** rng.uniform(-12, 1, 2000)), ends * rng.uniform(-1, 1, 2000)):
        found = sweep(**start | {"r0": 0.0}, thetadot0=rate, keys=[*KEYS])
        assert not np.isnan(found["T_nutation"]).any()
    fast = start | {"r0": rng.uniform(57, 99, 2000)}
    for word in ("steady", "steady-fast"):
        assert not np.isnan(sweep(**fast, psidot0=word, keys=["T_spin", "u3"])["T_spin"]).any()
    turned = sweep(r0=[40.0, 60.0], theta0_rad=1.0, radians=True, keys=["comodular_angle_rad"])
    modular = sweep(r0=[40.0, 60.0], theta0_rad=1.0, radians=True, keys=["modular_angle_rad"])
    total = turned["comodular_angle_rad"] + modular["modular_angle_rad"]
    assert total == pytest.approx(np.full(2, math.pi / 2), rel=1e-15)


def test_a_line_is_all_that_a_key_needs(monkeypatch: pytest.MonkeyPatch, lagtop: Lagtop) -> None:
    """In every regime, for one top and for many, and in every command that takes a key."""
    name = "ratio"
    line = NUMBERS["k_squared"]._replace(formula="T_nutation/T_nutation_elementary", only="")
    line = line._replace(evaluated=line.formula, symbol="ratio", meaning="a new number")
    monkeypatch.setitem(NUMBERS, name, line)
    monkeypatch.setitem(table.LINES, name, line)
    monkeypatch.setattr(table, "FURTHER_KEYS", [*table.FURTHER_KEYS, name])
    tops = [
        Top(**{x: y for x, y in scene.items() if y is not None}) for scene in EVERY_KIND.values()
    ]
    motions = [solve(top) for top in tops]
    assert {motion.regime for motion in motions} == {*Regime}
    exact = [motion.record(keys=[name])[name] for motion in motions]
    for motion, x in zip(motions, exact, strict=True):
        assert (x is None) == (motion.T_nutation is None or not motion.top.r0), motion
        why = {"sleeping": "undefined in the regime", "no spin": "defined only if r0 is not 0"}
        assert x is not None or motion.absence(name).startswith(why.get(motion.regime, ""))
    columns: Scene = {x: [motion.record(keys=[x])[x] for motion in motions] for x in INPUT_KEYS}
    found = sweep(**columns, keys=[name, "error"])
    assert not any(found["error"])
    wanted = [math.nan if x is None else x for x in exact]
    assert found[name] == pytest.approx(wanted, rel=1e-13, nan_ok=True)
    ratio = solve(Top()).record(keys=[name])[name]
    assert "a new number" in lagtop("explain", name).stdout
    assert json.loads(lagtop("solve", "--get", name, "--format", "json").stdout) == {name: ratio}
    top, *_ = dicts(lagtop("find", "--r0", "40:60", f"ratio={ratio}", "--keys", "r0").stdout)
    assert float(top["r0"]) == pytest.approx(50, rel=1e-12)
