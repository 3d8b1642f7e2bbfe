"""Trajectories of every form, errors of known size, frames, verdicts, order of convergence."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from engines import Array, Body, dop853, euler_step, rk4, rk4_step, stepped, wxyz
from lagtop import Comparison, Top, compare, solve
from scipy.spatial.transform import Rotation

from lagrange_cli.comparison.compare import compared
from lagrange_cli.comparison.convergence import Convergence, convergence
from lagrange_cli.recordings.options import Reading
from lagrange_cli.recordings.recording import Recording
from lagrange_cli.top.units import RADIANS

TOP = Top(thetadot0=1, psidot0=3)
T = np.linspace(0, 2, 201)
ROWS = np.sort([*range(201), 5, 6])
_, STATES = dop853(Body.of(TOP), T)
Q, RATES = STATES[:, :4], STATES[:, 4:]
TURN = Rotation.from_quat(Q, scalar_first=True)
PHI, THETA, PSI = TURN.as_euler("ZXZ")[:, ::-1].T


def about_z(angle: Any) -> Rotation:
    return Rotation.from_rotvec(np.multiply.outer(angle, [0.0, 0.0, 1.0]))


STARTS: list[dict[str, float]] = [{"r0": 0}, {"theta0_deg": 120, "thetadot0": -2, "r0": 5}]
STARTS += [{"theta0_deg": 0, "r0": 60}, {"theta0_deg": 180, "r0": 30}, {"g": 0, "psidot0": 4}]


@pytest.mark.parametrize("inputs", STARTS)
def test_an_integrator_is_fine(inputs: dict[str, float]) -> None:
    """Worst seen: 9.8e-13 rad."""
    top = Top(**inputs)
    _, states = dop853(Body.of(top), T)
    found = compare(top, T, quaternion=states[:, :4], rates=states[:, 4:])
    assert found.verdict == "fine"
    assert (found.attitude_error_max or 0) < 5e-12
    assert None not in (drifts := (found.energy_drift, found.Lz_drift, found.norm_error))
    assert max(x or 0 for x in drifts) < 1e-12


def test_keys_of_quantities_that_are_not_given_are_none() -> None:
    for given, known in (
        ({"euler": TURN.as_euler("XYZ"), "euler_sequence": "XYZ"}, "attitude axis theta phi psi"),
        ({"position": TURN.apply([0, 0, 4.0])}, "axis theta psi"),
        ({"phi": PHI, "psi": PSI + 2 * np.pi}, "phi psi"),
        ({"rates": RATES}, "rates"),
    ):
        found = compare(TOP, T, **given)
        assert (found.error_max or 0) < 2e-12  # worst seen: 9.8e-13 rad
        errors = [key for key, x in found.record().items() if "_error_" in key and x is not None]
        assert " ".join(x.removesuffix("_error_max") for x in errors) == known
    at_rest = compare(Top(r0=0, g=0), 0, rates=[[0.25, 0, 0]])
    assert at_rest.rates_error_max == 0.25


@pytest.mark.parametrize("size", [1e-12, 1e-4, 3.0])
def test_an_error_of_known_size_is_measured(size: float) -> None:
    """The trajectory itself is 9.8e-13 rad off."""
    spun = compare(TOP, T, quaternion=wxyz(TURN * about_z(size)), max_error=4)
    turned = compare(TOP, T, quaternion=-2 * wxyz(about_z(-size) * TURN), max_error=4)
    tilted = compare(TOP, T, theta=THETA - size, max_error=1e-3)
    found = spun.attitude_error_max, spun.phi_error_max, turned.error_final, turned.psi_error_max
    assert (*found, tilted.theta_error_max) == pytest.approx([size] * 5, abs=2e-12)
    assert max(spun.psi_error_max or 0, spun.axis_error_max or 0) < 2e-12
    assert (tilted.verdict == "fine") == (size < 1e-3)
    assert (spun.cause, turned.cause) == (None, None)  # no cause is sought below the limit
    assert compare(TOP, T, theta=THETA - size, max_error=3.1).verdict == "fine"


@pytest.mark.slow
def test_wrong_rates_of_a_right_attitude_are_not_fine() -> None:
    found = compare(TOP, T, quaternion=Q, rates=RATES * np.linspace(1, 1.01, 201)[:, np.newaxis])
    assert (found.verdict, found.cause) == ("drifts", None)
    assert (found.error_max or 0) < 1e-11
    fall = math.sqrt(float(TOP.m * TOP.g * TOP.s / TOP.A))
    size = math.hypot(1, 3 * math.sin(math.pi / 6)) + 50 + fall
    off = np.linalg.norm(RATES[-1]) * 0.01 / size
    assert found.rates_error_max == pytest.approx(off, rel=0.01)
    assert compare(TOP, T, quaternion=Q, rates=1.0001 * RATES).verdict == "fine"
    start = compare(TOP, T[:2], quaternion=Q[:2], rates=1.01 * RATES[:2])
    assert start.verdict == "off from the start"
    assert compare(TOP, T, rates=1.01 * RATES).cause is None


@pytest.mark.parametrize("rate", [1e-6, -0.1, 25.0])
def test_drift_is_separated_from_oscillation(rate: float) -> None:
    wobble = 1e-3 * np.sin(7 * T)
    found = compare(TOP, T, phi=PHI + rate * T + wobble, theta=THETA, max_error=4)
    assert found.phi_drift == pytest.approx(rate + np.polyfit(T, wobble, 1)[0], rel=1e-6)
    last = math.remainder(rate * T[-1] + wobble[-1], 2 * math.pi)
    assert found.error_final == pytest.approx(abs(last), rel=1e-6)
    assert (found.psi_drift, found.rows) == (None, 201)
    assert compare(TOP, T, phi=PHI + 2.1 * (T > 1), max_error=4).phi_drift is None


def test_drift_of_energy_momentum_and_norm_of_an_integrator() -> None:
    body = Body.of(TOP)
    t, states = rk4(body, 8e-3, 2)
    found = compare(TOP, t, quaternion=states[:, :4], rates=states[:, 4:], max_error=4)
    energy, moments = body.energy(states), np.array([body.A, body.A, body.C])
    kinetic = energy[0] - body.torque * math.cos(math.radians(30))
    change = abs(energy - energy[0]).max()
    assert found.energy_drift == pytest.approx(change / (kinetic + body.torque), rel=1e-6)
    up = Rotation.from_quat(states[:, :4], scalar_first=True).inv().apply([0, 0, 1])
    Lz = (up * moments * states[:, 4:]).sum(axis=1)
    across = body.A * math.hypot(1, 3 * math.sin(math.pi / 6))
    size = math.hypot(across, body.C * 50) + math.sqrt(body.A * body.torque)
    assert found.Lz_drift == pytest.approx(abs(Lz - Lz[0]).max() / size, rel=1e-6)
    norms = np.linalg.norm(states[:, :4], axis=1)
    assert found.norm_error == pytest.approx(abs(norms - 1).max(), rel=1e-9)
    far = TURN.apply([0, 0, 600.0])  # a marker, in other units
    assert compare(TOP, T, position=far).verdict == "fine"
    slips = compare(TOP, T, position=far * (1 + T[:, np.newaxis] / 4))
    assert (slips.verdict, slips.cause) == ("drifts", None)
    assert slips.pivot_slip == pytest.approx(0.5)
    at_pivot = compare(TOP, T, position=far * T[:, np.newaxis])
    assert (at_pivot.pivot_slip, at_pivot.verdict) == (None, "lost")


@pytest.mark.parametrize(("tilt", "off"), [(0, 0.15), (180, 0.35)])
def test_upright_and_hanging_tops_have_one_angle(tilt: int, off: float) -> None:
    """Upright, a turn about the vertical is one of the spin; hanging, it is one against it."""
    top = Top(theta0_deg=tilt, r0=70)
    _, states = dop853(Body.of(top), T)
    turned = about_z(0.25) * Rotation.from_quat(states[:, :4], scalar_first=True) * about_z(-0.1)
    found = compare(top, T, quaternion=wxyz(turned))
    assert found.phi_error_max == pytest.approx(off, abs=1e-9)
    assert found.attitude_error_max == pytest.approx(off, abs=1e-9)
    assert found.psi_error_max is None
    assert compare(top, T, quaternion=wxyz(turned), align=["start"]).verdict == "fine"


def figure(axis: str) -> Any:
    """Return our axes in the coordinates of a frame whose figure axis is another one."""
    sign, index = (-1 if axis.startswith("-") else 1), "xyz".index(axis[-1])
    third, first = sign * np.eye(3)[index], np.eye(3)[(index + 1) % 3]
    return np.stack([first, np.cross(third, first), third], axis=1)


OURS = np.eye(3)
LEFT = {"z": np.diag([1.0, -1, 1]), "y": OURS[[0, 2, 1]], "x": OURS[[2, 1, 0]]}


@pytest.mark.parametrize(
    ("words", "space", "body"),
    [
        *((f"axis={x}", OURS, figure(x)) for x in ("x", "y", "-x", "-y", "-z")),
        *((f"up={x}", figure(x), OURS) for x in ("x", "y", "-x", "-y", "-z")),
        *((f"up={x},left", mirror, mirror) for x, mirror in LEFT.items()),
    ],
)
def test_other_frames(words: str, space: Any, body: Any) -> None:
    """Rates are mirrored as angular momentum is: they turn the other way round."""
    seen = space @ TURN.as_matrix() @ body.T
    own = {"body": RATES @ body.T, "space": TURN.apply(RATES) @ space.T}
    for frame, rates in own.items():
        how: dict[str, Any] = {"rates_frame": frame, "align": f"{words},start"}
        given = {"matrix": seen, "rates": np.linalg.det(body) * rates}
        found = compare(TOP, T, **given, **how)
        of_rates = found.rates_error_max or 0, found.energy_drift or 0
        assert max(found.error_max or 0, *of_rates) < 2e-12
    if not words.startswith("axis"):
        axis = compare(TOP, T, axis=seen @ body @ OURS[2], align=f"{words},start")
        assert (axis.error_max or 0) < 2e-12


def test_zeros_that_count_from_the_first_row() -> None:
    turned = wxyz(about_z(1.0) * TURN * about_z(-2.5))
    turned[:3] = math.nan
    found = compare(TOP, T + 17, quaternion=turned, align=["start", "time"])
    assert (found.lost_at, found.verdict) == (0, "lost")
    assert (found.error_max or 0) < 2e-12
    for turn, zero in ((1.0, 57.3), (4.0, -130.8)):  # less than half a turn
        late = compare(TOP, T + 17, quaternion=wxyz(about_z(turn) * TURN), align=["time"])
        assert (late.cause, late.remedy) == (f"psi starts at {zero} degrees", "align=start,time")
    tiny = compare(TOP, T, quaternion=wxyz(about_z(1e-6) * TURN), max_error=1e-8)
    assert tiny.cause == "psi starts at 5.73e-05 degrees"
    assert compare(TOP, T + 17, quaternion=wxyz(TURN), align="time, start").verdict == "fine"
    parts = {"phi": PHI + 2, "psi": PSI - 1}
    assert (compare(TOP, T, **parts, align=["start"]).error_max or 0) < 2e-12
    axis = about_z(0.7).apply(TURN.apply([0, 0, 1]))
    assert (compare(TOP, T, axis=axis, align=["start"]).error_max or 0) < 2e-12


def with_steps(
    runs: list[tuple[Array, Array]], steps: list[float]
) -> tuple[list[Comparison], Convergence]:
    given = [
        {"t": t[:, np.newaxis], "quaternion": y[:, :4], "missing": 0 * y[:, :1]} for t, y in runs
    ]
    reading = Reading(units=RADIANS)
    rows, found = compared(solve(TOP), [Recording(x, reading) for x in given], 1e-3, steps)
    assert found
    return rows, found


@pytest.mark.parametrize(
    ("method", "steps", "order"),
    [(rk4_step, [8e-3, 4e-3, 2e-3], 4), (euler_step, [4e-3, 2e-3, 1e-3], 1)],
)
def test_order_of_convergence(method: Any, steps: list[float], order: int) -> None:
    """All errors of the first-order method end beyond 0.3 rad: its order shows before."""
    rows, _ = with_steps([stepped(Body.of(TOP), h, 1, method) for h in steps], steps)
    assert rows[0].order == pytest.approx(order, abs=0.5)
    assert {row.verdict for row in rows} <= {"fine", "drifts"}
    assert [(row.step, row.cause) for row in rows] == [(step, None) for step in steps]


def test_a_step_that_loses_the_phase_at_once() -> None:
    """The errors are compared at a time that all trajectories have, not at their start."""
    steps = (0.1, 0.9), (0.05, 0.18), (0.025, 0.03)
    times = [np.arange(0, 1, h) for h, _ in steps]
    rows = zip(steps, times, strict=True)
    found = convergence([(h, t, x * t / h) for (h, x), t in rows], 1e-3)
    assert found
    assert found.errors == pytest.approx([0.9, 0.36, 0.12])
    assert found.converges


@pytest.mark.parametrize(
    ("inputs", "end", "cause"),
    [
        pytest.param({"A": 39032 * 1.03}, 1, "", marks=pytest.mark.slow),
        pytest.param({"psidot0": -3}, 0.5, "psidot0 has the wrong sign", marks=pytest.mark.slow),
        ({"r0": -50}, 0.5, "r0 has the wrong sign"),
    ],
)
def test_the_error_of_another_top_does_not_fall(inputs: Any, end: float, cause: str) -> None:
    runs = [rk4(Body.of(TOP.replace(**inputs)), h, end) for h in (4e-3, 2e-3)]
    rows, found = with_steps([(t[::25], y[::25]) for t, y in runs], [4e-3, 2e-3])
    assert [bool(row.cause) for row in rows] == [bool(cause)] * 2
    assert all((row.cause or "").startswith(cause) and row.verdict != "drifts" for row in rows)
    assert not found.converges


def test_rows_that_are_not_finite() -> None:
    for bad in (math.nan, math.inf):
        found = compare(TOP, T, quaternion=np.where(T[:, np.newaxis] < 1.2, Q, bad))
        assert (found.verdict, found.lost_at, found.error_final) == ("lost", T[120], None)
    nothing = compare(TOP, T, quaternion=0 * Q)
    assert (nothing.verdict, nothing.lost_at, nothing.error_max) == ("lost", 0, None)
    one = compare(TOP, 0.3, theta=THETA[30] + 1)
    assert (one.rows, one.theta_drift, one.cause) == (1, None, None)


def test_missing_numbers_and_repeated_times() -> None:
    """A masked number is missing: the other rows, and the other numbers of its row, count."""
    masked = np.ma.masked_array(THETA, T > 1)
    found = compare(TOP, T, theta=masked, phi=PHI)
    assert (found.verdict, found.lost_at, found.rows_missing) == ("fine", None, 100)
    rates = np.ma.masked_array(RATES, np.zeros(RATES.shape, bool))
    rates[0, 1] = np.ma.masked
    found = compare(TOP, np.sort([*T, *T[5:7]]), quaternion=wxyz(TURN[ROWS]), rates=rates[ROWS])
    assert (found.verdict, found.rows_missing) == ("fine", 1)
    assert np.isfinite(found.error).all()  # the attitude counts in the row without a rate
    assert (found.energy_drift or 1) < 1e-12
    assert compare(TOP, T * 1e-310, theta=THETA[0] + 0 * T).verdict == "fine"


def test_starts_on_the_vertical() -> None:
    """The first row off the vertical shows the azimuth."""
    for tilt in (0, 180):
        top = Top(theta0_deg=tilt, thetadot0=4, r0=6)
        _, states = dop853(Body.of(top), T)
        turned = about_z(1.2) * Rotation.from_quat(states[:, :4], scalar_first=True) * about_z(0.7)
        found = compare(top, T, quaternion=wxyz(turned), align="start")
        assert (found.error_max or 1) < 1e-9
        assert compare(top, T, quaternion=wxyz(turned)).remedy == "align=start"
