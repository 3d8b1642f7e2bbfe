"""Rows of both reports again, by other code: equations of motion from A and C, and Arb's angles.

Errors agree within 5 %, and evaluations and steps exactly.
"""

from __future__ import annotations

import json
import math
import shlex
from collections.abc import Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import mpmath
import numpy as np
import pytest
from ball_judge import Judge
from conftest import Lagtop
from lagtop import Top, solve
from scipy.integrate import solve_ivp

from lagrange_cli.bench import peers

START = {"r0": 40.0, "theta0": 50.0, "thetadot0": -2.0, "psidot0": 3.0}
PERIODS, TIMES = 20.3, 21


class Body(NamedTuple):
    """A top whose motion is integrated here; the tilt is in degrees."""

    m: float
    A: float
    C: float
    s: float
    g: float
    r0: float
    theta0: float
    thetadot0: float = 0.0
    psidot0: float = 0.0

    @property
    def tilt(self) -> float:
        return math.radians(self.theta0)

    def euler_start(self) -> list[float]:
        return [self.tilt, self.thetadot0, 0.0, 0.0]

    def euler(self, _: float, state: Any) -> list[float]:
        """Lagrange's equation of the tilt, and the rates by the two constant momenta."""
        theta, rate, _, _ = state
        along = self.C * self.r0
        upward = self.A * self.psidot0 * math.sin(self.tilt) ** 2 + along * math.cos(self.tilt)
        psi = (upward - along * math.cos(theta)) / (self.A * math.sin(theta) ** 2)
        torque = self.A * psi**2 * math.cos(theta) - along * psi + self.m * self.g * self.s
        return [rate, torque * math.sin(theta) / self.A, self.r0 - psi * math.cos(theta), psi]

    def body_start(self) -> list[float]:
        half, across = self.tilt / 2, self.psidot0 * math.sin(self.tilt)
        return [self.thetadot0, across, math.cos(half), math.sin(half), 0.0, 0.0]

    def body(self, _: float, state: Any) -> list[float]:
        """Euler's equations about the body axes, and the rate of the quaternion."""
        p, q, w, x, y, z = state
        r, weight = self.r0, self.m * self.g * self.s
        return [
            ((self.A - self.C) * q * r + weight * 2 * (y * z + w * x)) / self.A,
            ((self.C - self.A) * p * r - weight * 2 * (x * z - w * y)) / self.A,
            (-x * p - y * q - z * r) / 2,
            (w * p + y * r - z * q) / 2,
            (w * q + z * p - x * r) / 2,
            (w * r + x * q - y * p) / 2,
        ]

    def drift(self, states: Any) -> list[float]:
        """The changes of energy and Lz in body axes, over the sums of their terms at the start."""
        p, q, w, x, y, z = np.column_stack([self.body_start(), states])
        up = 2 * (x * z - w * y), 2 * (y * z + w * x), w * w + z * z - x * x - y * y
        weight, swing = self.m * self.g * self.s, self.A * (p * p + q * q) / 2
        energy = swing + weight * up[2]
        Lz = self.A * (p * up[0] + q * up[1]) + self.C * self.r0 * up[2]
        sizes = (
            swing[0] + weight * (1 + abs(math.cos(self.tilt))) + self.C * self.r0**2 / 2,
            self.A * abs(self.psidot0) * math.sin(self.tilt) ** 2 + 2 * self.C * abs(self.r0),
        )
        changes = np.max(np.abs([energy - energy[0], Lz - Lz[0]]), axis=1)
        return [float(x) for x in changes / sizes]


class Run(NamedTuple):
    """States at the times, evaluations and steps of an integration."""

    states: Any
    evaluations: int
    steps: int


def scipy_run(method: str, slope: Any, start: Any, times: Any, tolerance: float) -> Run:
    def right_hand_side(t: float, state: Any) -> Any:
        return slope(t, state.tolist())

    flow = solve_ivp(
        right_hand_side,
        (0, times[-1]),
        start,
        method,
        dense_output=True,
        rtol=tolerance,
        atol=tolerance,
    )
    return Run(flow.sol(times), int(flow.nfev), flow.t.size - 1)


def rk4_run(slope: Any, start: Any, times: Any, longest: float) -> Run:
    """Equal steps of at most `longest` from each time to the next one."""
    state, now, steps, states = np.array(start), 0.0, 0, []
    for t in times:
        count = math.ceil((t - now) / longest * (1 - 1e-9))
        h = (t - now) / max(count, 1)
        for _ in range(count):
            a = np.array(slope(0.0, state.tolist()))
            b = np.array(slope(0.0, (state + h * a / 2).tolist()))
            c = np.array(slope(0.0, (state + h * b / 2).tolist()))
            d = np.array(slope(0.0, (state + h * c).tolist()))
            state = state + h * (a + 2 * b + 2 * c + d) / 6
        now, steps = t, steps + count
        states.append(state)
    return Run(np.transpose(states), 4 * steps, steps)


def top_of(inputs: dict[str, float]) -> Top:
    return Top(**{"theta0_deg" if key == "theta0" else key: x for key, x in inputs.items()})


def period_of(judge: Judge) -> float:
    found = judge.record["T_nutation"]
    assert found is not None
    return float(found)


def exact_angles(judge: Judge, times: Sequence[float]) -> list[list[Any]]:
    """Theta, phi and psi by Arb."""
    found = [judge.at(t) for t in times]
    with mpmath.workdps(40):
        return [[mpmath.mpf(x.mid().str(40, radius=False)) for x in state[:3]] for state in found]


def quaternion(theta: Any, phi: Any, psi: Any) -> list[Any]:
    plus, minus = (psi + phi) / 2, (psi - phi) / 2
    low, high = mpmath.cos(theta / 2), mpmath.sin(theta / 2)
    return [
        *(low * mpmath.cos(plus), high * mpmath.cos(minus)),
        *(high * mpmath.sin(minus), low * mpmath.sin(plus)),
    ]


def turn(parts: Sequence[Any], exact: Sequence[Any]) -> float:
    """The angle of the rotation between a quaternion, of any length, and exact angles."""
    size = mpmath.sqrt(sum(mpmath.mpf(x) ** 2 for x in parts))
    pairs = list(zip(parts, quaternion(*exact), strict=True))
    away = min(
        mpmath.sqrt(sum((mpmath.mpf(a) / size - sign * b) ** 2 for a, b in pairs))
        for sign in (1, -1)
    )
    return float(4 * mpmath.asin(away / 2))


def greatest(found: Any, exact: Any, *, whole: bool = True) -> float:
    """The greatest error of three angles; without whole turns if they are not counted."""
    errors = [float(x - y) for z in zip(found, exact, strict=True) for x, y in zip(*z, strict=True)]
    return max(abs(x if whole else math.remainder(x, math.tau)) for x in errors)


def angles_of(parts: Sequence[float]) -> tuple[float, float, float]:
    w, x, y, z = parts
    plus, minus = math.atan2(z, w), math.atan2(y, x)
    return 2 * math.atan2(math.hypot(x, y), math.hypot(w, z)), plus - minus, plus + minus


@pytest.mark.slow
def test_rows_of_bench(lagtop: Lagtop) -> None:
    names = "lagtop,RK4-euler,RK45-euler,RK45-quaternion,DOP853-quaternion,DOP853-euler"
    options = [word for key, x in START.items() for word in (f"--{key}", x)]
    line = ["bench", *options, "--n", TIMES, "--methods", names, "--format", "json"]
    report = json.loads(lagtop(*line).stdout)
    rows = {(row["method"], row["setting"]): row for row in report["rows"]}
    body, judge = Body(1587, 39032, 17458, 4, 981, **START), Judge(top_of(START).as_dict())
    end, period = float(report["conditions"]["times"].split()[4]), period_of(judge)
    assert end == pytest.approx(PERIODS * period, rel=1e-15)
    times = np.linspace(0, end, TIMES)
    exact = exact_angles(judge, times.tolist())
    euler, turning = (body.euler, body.euler_start()), (body.body, body.body_start())
    runs = {
        ("RK4-euler", 200): rk4_run(*euler, times, period / 200),
        ("RK45-euler", 1e-5): scipy_run("RK45", *euler, times, 1e-5),
        ("RK45-quaternion", 1e-7): scipy_run("RK45", *turning, times, 1e-7),
        ("DOP853-quaternion", 1e-7): scipy_run("DOP853", *turning, times, 1e-7),
        ("DOP853-euler", 1e-10): scipy_run("DOP853", *euler, times, 1e-10),
    }
    for key, run in runs.items():
        whole = key[0].endswith("euler")
        found = run.states[[0, 2, 3]].T if whole else [angles_of(x) for x in run.states[2:].T]
        error = greatest(found, exact, whole=whole)
        assert rows[key]["error_rad"] == pytest.approx(error, rel=0.05), key
        assert (rows[key]["evaluations"], rows[key]["steps"]) == run[1:]
    with mpmath.workdps(40):
        ours = greatest(np.transpose(solve(top_of(START)).angles(times)).tolist(), exact)
    assert rows["lagtop", "double"]["error_rad"] == pytest.approx(ours, rel=0.05)


@pytest.mark.slow
@pytest.mark.parametrize("stratum", ["generic", "half periods"])
def test_rows_of_stability(stratum: str, lagtop: Lagtop, monkeypatch: pytest.MonkeyPatch) -> None:
    """Inputs are those of the command line below the table.

    DOP853 at its tightest is at its rounding, so its errors agree to 20 % only.  Radau takes
    differences for its Jacobian, so that rounding changes its evaluations.  Evaluations alone limit
    a run here, because its 60 s would end it early on a loaded machine.
    """
    monkeypatch.setattr(peers, "SECONDS", 6000.0)
    report = json.loads(lagtop("stability", "--strata", stratum, "--format", "json").stdout)
    rows = {row["method"].removesuffix("-quaternion"): row for row in report["rows"]}
    words = shlex.split(rows["lagtop"]["worst_case"], comments=True)
    given = {key[2:]: x for key, x in pairwise(words)}
    inputs = {name: float(given[name]) for name in Body._fields if name in given}
    body, judge = Body(**inputs), Judge(top_of(inputs).as_dict())
    period, turning = period_of(judge), (body.body, body.body_start())
    spans = {5: np.geomspace(0.1, 5, 9)[1:] * period, 100: np.geomspace(5, 100, 9)[1:] * period}
    exact = {span: exact_angles(judge, times.tolist()) for span, times in spans.items()}
    errors: dict[int, float] = {}
    with mpmath.workdps(40):
        for span, times in spans.items():
            angles = np.transpose(solve(top_of(inputs)).angles(times)).tolist()
            pairs = zip([quaternion(*map(mpmath.mpf, x)) for x in angles], exact[span], strict=True)
            errors[span] = max([*errors.values(), *(turn(x, y) for x, y in pairs)])
            assert rows["lagtop"][f"error_{span}_rad"] == pytest.approx(errors[span], rel=0.05)
        runs = {
            ("RK4", 5): rk4_run(*turning, spans[5], period / 800),
            ("Radau", 5): scipy_run("Radau", *turning, spans[5], 1e-7),
            ("Radau", 100): scipy_run("Radau", *turning, spans[100], 1e-7),
            ("DOP853", 100): scipy_run("DOP853", *turning, spans[100], 3e-14),
        }
        for (name, span), run in runs.items():
            row = rows[name]
            error = max(turn(x, y) for x, y in zip(run.states[2:].T, exact[span], strict=True))
            bound = 0.2 if name == "DOP853" else 0.05
            assert row[f"error_{span}_rad"] == pytest.approx(error, rel=bound), name
            if (name, span) != ("Radau", 5):  # its row has the work of the longer run
                bound = 0.02 if name == "Radau" else 0
                assert row["evaluations"] == pytest.approx(run.evaluations, rel=bound, abs=0)
            if name == "RK4" or (name, span) == ("Radau", 100):
                assert [row["energy"], row["Lz"]] == pytest.approx(body.drift(run.states), rel=0.05)
