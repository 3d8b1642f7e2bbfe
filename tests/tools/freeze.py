"""Write tests/frozen.json: what the program of commit eec8223 computes; not collected by pytest.

    cd a checkout of eec8223
    python /path/to/tests/tools/freeze.py > /path/to/tests/frozen.json

The file was written once, by another arithmetic than the one of today, and is never written again:
`tests/test_frozen.py` compares it with what the program computes now.  The scenes come from the
generators of that checkout, which may be gone here.  The file holds inputs only, never the names of
scenes.  Numbers of the record have 30 digits, columns 20, functions 25.
"""

from __future__ import annotations

import csv
import io
import json
import math
import random
import subprocess
import sys
import tempfile
import warnings
from collections.abc import Iterator
from decimal import Decimal, localcontext
from fractions import Fraction
from importlib import import_module
from pathlib import Path
from typing import Any

sys.path[:0] = [str(Path.cwd()), str(Path.cwd() / "tests")]

from lagtop import LagtopError, Motion, Top, sensitivities, solve  # noqa: E402

Scene = dict[str, Any]
SKIPPED = (
    *("roots_sum_squared", "roots_product_fourfold", "roots_gap_squared", "roots_gap"),
    *("u3_twice", "u2_twice"),
)
"""Single steps of section 8, which later versions may leave out."""
MODULI = ("0.5", "1e-20", "0.8", "0.999999999999", "0.99")
TOPS, DECIMALS, SWINGS = 300, 30, 50
TABLES, TIMES = 60, 8
HAIR = Fraction(1, 10**29)
"""Relative error of a number with 30 digits, rounded up."""


def random_scenes(kinds: dict[str, Any], count: int, seed: str) -> Iterator[Scene]:
    """Yield solvable scenes of each kind in turn, their inputs rounded to doubles."""
    found, draw = 0, 0
    while found < count:
        name = list(kinds)[found % len(kinds)]
        scene = {key: float(x) for key, x in kinds[name](random.Random(f"{seed} {draw}")).items()}
        draw += 1
        if is_solved(scene):
            found += 1
            yield scene


def is_solved(scene: Scene) -> bool:
    """Return whether a scene is accepted and has a record in the range of doubles."""
    try:
        solve(Top(**scene)).record(keys=["mean_spin_rate", "T_nutation", "precession_rate_half"])
    except LagtopError:
        return False
    return True


def all_scenes() -> list[Scene]:
    """Return the scenes of the records: named kinds, random ones, and other ways to give inputs."""
    kinds, named = import_module("exact_scenes").KINDS, import_module("scenes")
    rng = random.Random("other inputs")
    found: list[Scene] = [*named.EVERY_KIND.values(), *named.NAMED.values()]
    unit = named.UNIT
    for word in ("steady", "steady-fast"):
        found += [{"psidot0": word, "theta0_deg": x, "r0": r0} for x, r0 in ((30, 60), (120, 25))]
        found.append(unit | {"psidot0": word, "theta0_rad": 1.1, "r0": 2.5})
        found.append(unit | {"psidot0": word, "theta0_deg": 75, "r0": -rng.uniform(2, 9)})
    for _ in range(5):
        body = {key: rng.uniform(0.5, 2) for key in ("m", "s", "g")}
        body |= {"A_cm": rng.uniform(0.5, 2), "C": rng.uniform(0.05, 0.9)}
        start = {"theta0_deg": rng.uniform(1, 179), "psidot0": rng.uniform(-3, 3)}
        found.append(body | start | {"r0": rng.uniform(-6, 6), "thetadot0": rng.uniform(-1, 1)})
        found.append(body | start | {"phidot0": rng.uniform(-6, 6)})
        found.append(unit | start | {"phidot0": rng.uniform(-6, 6)})
        found.append({"theta0_rad": rng.uniform(0.01, 3.13), "phidot0": rng.uniform(20, 90)})
    for pole in (0, 180):
        found += [
            unit | {"theta0_deg": pole, "r0": r0, "thetadot0": x}
            for r0, x in ((0.25, 1e-9), (2, 0.5), (-3, -2), (1e-12, 1), (2, 0), (1.999, 0))
        ]
    found += [{"theta0_rad": x} for x in (1e-9, 0.5, 1.5707963267948966, 3.141592653589793)]
    found += [{"theta0_deg": 60, "r0": r0} for r0 in (1e-30, 1e-9, 1e9, 1e30)]
    found = [scene for scene in found if is_solved(scene)]
    return found + list(random_scenes(kinds, TOPS - len(found), "frozen"))


def decimal_scenes() -> list[Scene]:
    """Return scenes whose inputs are decimals of 20 digits."""
    found: list[Scene] = []
    kinds, rng = import_module("exact_scenes").KINDS, random.Random("decimals")
    names = [name for name in kinds if name not in ("nice numbers", "double cusp", "any spin")]
    while len(found) < DECIMALS:
        scene = kinds[names[len(found) % len(names)]](rng)
        longer: Scene = {}
        for key, x in scene.items():
            with localcontext(prec=20):
                value = Decimal(Fraction(x).numerator) / Decimal(Fraction(x).denominator)
                tail = Decimal(rng.randrange(10**5)).scaleb(value.adjusted() - 19)
                longer[key] = str(value + tail if value and x != int(x) else value)
        try:
            solve(top_of(longer)).record(digits=5)
        except LagtopError:
            continue
        found.append(longer)
    return found


def top_of(decimals: Scene) -> Top:
    """Return a top whose inputs are texts of decimals."""
    exact: Scene = {key: Fraction(x) for key, x in decimals.items()}
    return Top(**exact)


def record_of(motion: Motion, keys: list[str]) -> dict[str, Any]:
    """Return the entry of one top: inputs apart, the words and the numbers with 30 digits."""
    values = motion.record(digits=30, keys=keys)
    for key in keys:
        try:
            value = getattr(motion, key)
        except LagtopError:
            continue
        text = Fraction(values[key]) if values[key] is not None else None
        near = {text} if text is None else {float(text * (1 + x)) for x in (-HAIR, 0, HAIR)}
        assert value in near, (motion.top, key, value, values[key])
    words = [str(motion.regime), motion.path]
    return {"words": words, "numbers": [values[key] for key in keys]}


def options_of(scene: Scene) -> list[str]:
    """Return a scene as options of the command line, with all digits of its doubles."""
    names = {"theta0_deg": "theta0", "theta0_rad": "theta0", "A_cm": "A-cm"}
    options = ["--rad"] if "theta0_rad" in scene else []
    for key, x in scene.items():
        options += [f"--{names.get(key, key)}", x if isinstance(x, str) else f"{Decimal(x)}"]
    return options


def lines_of(*words: str) -> tuple[list[str], list[list[str]]]:
    """Return the header and the rows that a command prints as CSV."""
    command = [sys.executable, "-m", "lagrange_cli", *words, "--format", "csv"]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    assert done.returncode == 0, (words, done.stderr)
    header, *rows = csv.reader(io.StringIO(done.stdout))
    return header, rows


def function_commands() -> Iterator[list[str]]:
    """Yield the commands of `jacobi` and `eta`, about 1,000 cells."""
    every = ["--functions", "am,theta,zeta,omega,pi"]
    for modulus in MODULI:
        for value, u in (("0.7", "0.3,-1.7,1e6"), ("0.45i", "K/2,3K,0.3K")):
            yield ["jacobi", "--k", modulus, "--param", value, *every, f"--u={u}"]
    for way, x in (("--k-prime", "1e-30"), ("--k-prime", "0.3"), ("--nome", "0.2")):
        yield ["jacobi", way, x, "--param", "0.3", *every, "--u=0.3,1.9"]
    for modulus in ("0.8i", "3i", "1.25", "1.0000001", "1e-10i", "0.6"):
        yield ["jacobi", "--k", modulus, "--functions", "am,theta,zeta", "--u=0.2+0.5i,-0.9,0.3i"]
    for modulus in ("0", "1"):
        yield ["jacobi", "--k", modulus, "--u=0.2+0.5i,-0.9,0.3i"]
    for modulus in ("0.6", "0.95"):
        yield ["jacobi", "--k", modulus, *every, "--param", "0.2+0.3i", "--u=0.4+0.1i,-1.1"]
    for way, x in (("--k", "0.8"), ("--k-prime", "1e-40"), ("--nome", "1e-5"), ("--k", "0.8i")):
        yield ["jacobi", way, x]
    yield ["jacobi", "--k", "1.25"]
    yield ["jacobi", "--k", "0.99", "--phi=0.3,1.2,-2,15", "--rad"]
    band = ["--delta", "0.6", "--delta-star=-0.5"]
    for roots in (
        ["--p", "0.1", "--q", "1.4"],
        ["--p", "3", "--q", "1"],
        ["--p", "0.2", "--q", "0.7i"],
    ):
        yield ["eta", *band, *roots]
        yield [
            "eta",
            *band,
            *roots,
            "--tau=0,0.7,-2.5,9",
            "--columns",
            "eta,etadot,h1,theta,xi_prime",
        ]
    for gap in (["--gap-above", "0.424"], ["--gap-below", "1e-9"], []):
        yield [
            "eta",
            *band,
            *gap,
            "--tau=0.3,5",
            "--columns",
            "eta,etadot,h1,theta,xi_prime",
            "--g",
            "319",
        ]


def functions() -> list[dict[str, Any]]:
    """Return the cells of `jacobi` and `eta` by command, each column under its heading."""
    found = []
    for asked in function_commands():
        words = [*asked, "--digits", "25"]
        header, rows = lines_of(*words)
        found.append(
            {"command": words, "columns": dict(zip(header, zip(*rows, strict=True), strict=True))}
        )
    return found


def times_of(motion: Motion, rng: random.Random) -> list[float]:
    """Return times at 0, at quarters of a period and their neighbours, far away and before 0."""
    top, period = motion.top, motion.T_nutation
    if period is None:
        rate = max(abs(float(x)) for x in (motion.b, motion.a**0.5, top.r0, top.psidot0, 1e-3))
        return [0.0, *(rng.uniform(-9, 9) / rate for _ in range(TIMES - 1))]
    half = (rng.randrange(8) + 0.5) * period
    times = [
        *(math.nextafter(half, 0), half, math.nextafter(half, math.inf)),
        rng.choice([-1, 1]) * (rng.randrange(9) + 0.25) * period,
        -math.nextafter(period * rng.randrange(1, 9), rng.choice([0, math.inf])),
        rng.choice([-1, 1]) * rng.uniform(0.5e3, 2e3) * period,
        rng.choice([-1, 1]) * rng.uniform(0.5e9, 2e9) * period,
        *(rng.uniform(-1, 1) * period for _ in range(2)),
        math.nextafter(half + 1000 * period, rng.choice([0, math.inf])),
        (10**9 + rng.choice([0, 0.5, 0.25])) * period,
    ]
    return [0.0, *rng.sample(times, TIMES - 1)]


def table_rows(scene: Scene, times: list[Decimal], names: list[str], digits: int) -> dict[str, Any]:
    """Return the columns of `lagtop table` at some times, by their names without units."""
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "times"
        path.write_text("".join(f"{t}\n" for t in times))
        words = ["table", *options_of(scene), "--times", str(path), "--columns", ",".join(names)]
        header, rows = lines_of(*words, "--digits", str(digits))
    bare = [name.removesuffix("_deg").removesuffix("_rad") for name in header]
    return dict(zip(bare, zip(*rows, strict=True), strict=True))


def cells_of(scene: Scene, names: list[str]) -> dict[str, Any]:
    """Return the cells of one top over time with 20 digits, and the tolerance of each double.

    The tolerance is 4 units for angles and the quaternion and 8 for other columns.  A unit is
    2^-52 (max(size, |x|) + |tau dx/dt|), where tau is the time to the nearest whole period.  The
    size is 1 for angles, cosines and the quaternion, the largest rate for rates, and the sum of
    its terms for the energy and the momentum.
    """
    motion = solve(Top(**scene))
    top, period = motion.top, motion.T_nutation
    times = times_of(motion, random.Random(str(scene)))
    with localcontext(prec=1200):
        exact = [Decimal(t) for t in times]
        step = Decimal("1e-40") * Decimal(period or max(map(abs, times)))
        three = [x for t in exact for x in (t - step, t, t + step)]
        wide = table_rows(scene, three, [name for name in COLUMNS if name != "t"], 100)
        whole = Decimal(period or 0)
        tau = [abs(t - (t / whole).to_integral_value() * whole) if whole else abs(t) for t in exact]
    computed = motion.table(times, names)
    cells: dict[str, list[str]] = {}
    tolerances: dict[str, list[float]] = {}
    for name in names:
        unit = "theta0_rad" not in scene and name in ANGLES
        cells[name] = list(table_rows(scene, exact, [name], 20)[name])
        tolerances[name] = []
        for i, text in enumerate(cells[name]):
            before, here, after = (
                {key: Fraction(values[3 * i + j]) for key, values in wide.items()} for j in range(3)
            )
            slope = abs(after[name] - before[name]) / (2 * Fraction(step))
            radian = RADIAN if unit else 1
            rates = max(abs(here[key]) for key in RATES)
            size: Any = 1
            if name in RATES:
                size = rates
            elif name == "energy":
                size = abs(here["energy"]) + 2 * abs(
                    Fraction(top.m) * Fraction(top.g) * Fraction(top.s)
                )
            elif name == "Lz":
                spin = abs(Fraction(top.C) * Fraction(top.r0))
                size = abs(here["Lz"] - spin * here["u"]) + spin
            elif name == "moment":
                size = abs(Fraction(top.m) * Fraction(top.g) * Fraction(top.s))
            value = Fraction(text) * radian
            one = max(abs(value), size) + Fraction(tau[i]) * slope * radian
            units = 4 if name in ANGLES or name.startswith("quaternion") else 8
            tolerance = float(f"{float(units * one) * 2.0**-52:.2e}")
            tolerances[name].append(tolerance)
            error = abs(Fraction(float(computed[name][i])) - value)
            share = float(error / Fraction(tolerance)) if tolerance else float(error > 0)
            WORST[name] = max(WORST.get(name, (0.0, "", 0.0)), (share, str(scene), times[i]))
    return {"top": scene, "times": times, "cells": cells, "tolerances": tolerances}


RADIAN = Fraction("0.0174532925199432957692369076848861271344287188854172545609719144")
ANGLES = ("theta", "phi", "psi", "dphi", "dpsi")
RATES = ("thetadot", "phidot", "psidot", "p", "q", "r")
COLUMNS = [
    *("t", *ANGLES, "u", *RATES, "moment", "axis_x", "axis_y", "axis_z"),
    *(f"quaternion_{x}" for x in "wxyz"),
    *("energy", "Lz"),
]
WORST: dict[str, Any] = {}


def tables(scenes: list[Scene]) -> list[dict[str, Any]]:
    """Return cells of the three angles, or of one angle and four other columns, of many tops."""
    others = [name for name in COLUMNS if name not in ("t", "theta", "phi", "psi")]
    found: list[dict[str, Any]] = []
    for i, scene in enumerate(scenes):
        turn = [others[(4 * i + j) % len(others)] for j in range(4)]
        names = (
            ["theta", "phi", "psi"] if i % 3 == 0 else [("theta", "phi", "psi")[i % 9 // 3], *turn]
        )
        if len(found) == TABLES:
            break
        try:
            found.append(cells_of(scene, names))
        except (LagtopError, AssertionError) as error:
            print("left out:", scene, str(error)[:300], file=sys.stderr)
    return found


def slopes(scenes: list[Scene]) -> list[dict[str, Any]]:
    """Return the derivatives of all numbers of some records by all inputs."""
    found = []
    for scene in scenes:
        derivatives = sensitivities(Top(**scene)).derivatives
        rows = {
            key: {name: None if math.isnan(x) else x for name, x in row.items()}
            for key, row in derivatives.items()
        }
        found.append({"top": scene, "derivatives": rows})
    return found


def uncertain(rng: random.Random) -> Iterator[list[str]]:
    """Yield the options of tops with uncertain inputs."""
    yield ["--r0", "477(2) rpm", "--theta0", "30(1)"]
    yield ["--r0", "50(2)", "--theta0", "30(1)"]
    yield ["--A-cm", "13640(20)", "--m", "1587(3)", "--phidot0", "50(1)", "--psidot0", "3(1)"]
    yield ["--theta0", "60(1)", "--r0", "60(1)", "--psidot0", "steady"]
    yield ["--theta0", "0.5(1)", "--r0", "45(1)", "--rad"]
    for i in range(15):
        body = ["--m", "1.5(1)", "--A", "2.0(1)", "--C", f"{rng.uniform(0.5, 2):.3f}(5)"]
        body += ["--s", "1.0(2)", "--g", "9.81(1)", "--theta0", f"{rng.uniform(20, 150):.2f}(30)"]
        start = [f"--r0={rng.uniform(-9, 9):.3f}(20)"]
        if i % 3:
            start += [f"--psidot0={rng.uniform(-4, 4):.3f}(30)"]
        if i % 3 > 1:
            start += [f"--thetadot0={rng.uniform(-2, 2):.3f}(20)"]
        yield [*body, *start]


def deviations() -> list[dict[str, Any]]:
    """Return the standard deviations of the numbers of records with uncertain inputs."""
    found = []
    for options in uncertain(random.Random("uncertain")):
        command = [sys.executable, "-m", "lagrange_cli", "solve", *options, "--format", "json"]
        record = json.loads(subprocess.run(command, capture_output=True, check=True).stdout)
        stds = {key: x for key, x in record.items() if key.endswith("_std")}
        found.append({"command": options, "stds": stds})
    return found


def main() -> None:
    """Write the file, one entry per line."""
    warnings.simplefilter("ignore")
    record = import_module("lagrange_cli.motion.record")
    keys = [key for key in [*record.NUMBER_KEYS, *record.requested_keys()] if key not in SKIPPED]
    scenes, rng = all_scenes(), random.Random("choice")
    records = [{"top": x} | record_of(solve(Top(**x)), keys) for x in scenes]
    records += [{"top": x} | record_of(solve(top_of(x)), keys) for x in decimal_scenes()]
    rad_keys = [key.replace("_deg", "_rad") for key in keys if key.endswith("_deg")]
    for entry in rng.sample(records[:TOPS], SWINGS):
        found = solve(Top(**entry["top"])).record(digits=30, radians=True, keys=rad_keys)
        entry["radians"] = list(found.values())
    mixed = rng.sample(scenes, len(scenes))
    named = import_module("scenes")
    kinds = [
        *("steady", "separatrix", "cusp", "sleeping", "hanging", "over the top", "torque-free"),
        *("pendulum", "from the upper pole", "without torque from the lower pole"),
    ]
    bent = [named.EVERY_KIND[kind] for kind in kinds]
    plain = [x for x in scenes[-80:] if x.get("thetadot0") and "theta0_deg" in x][:4]
    lists = {
        "records": records,
        "tables": tables([x for x in mixed if not x.keys() & {"A_cm", "phidot0"}]),
        "functions": functions(),
        "derivatives": slopes([{}, *plain, *bent]),
        "deviations": deviations(),
    }
    for name, worst in sorted(WORST.items()):
        print(name, worst, file=sys.stderr)
    print('{"keys": ' + json.dumps(keys) + ",")
    print(f'"radian_keys": {json.dumps(rad_keys)},')
    parts = [
        f'"{name}": [\n' + ",\n".join(json.dumps(x, separators=(",", ":")) for x in entries) + "]"
        for name, entries in lists.items()
    ]
    print(",\n".join(parts) + "}")


if __name__ == "__main__":
    main()
