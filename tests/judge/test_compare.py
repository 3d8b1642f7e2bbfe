"""The judge of trajectories: errors, drifts, frames, conventions, slips and verdicts."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
import pytest
from engines import Array, Body, dop853, rk4, semi_implicit_euler
from lagtop import Judgement, LagtopError, Top, compare, solve
from scipy.spatial.transform import Rotation

from lagrange_cli.inputs.seen import Conventions
from lagrange_cli.judge.alignment import Alignment
from lagrange_cli.judge.compare import Convergence, convergence, with_verdicts
from lagrange_cli.judge.deviations import MOST_KEPT, Kept
from lagrange_cli.judge.judgement import ReadTrajectory, judge

TOP = Top(thetadot0=1, psidot0=3)
T = np.linspace(0, 2, 201)
LOOP, STATES = dop853(Body.of(TOP), T)
Q, RATES = STATES[:, :4], STATES[:, 4:]
TURN = Rotation.from_quat(Q, scalar_first=True)
ANGLES = TURN.as_euler("ZXZ")[:, ::-1]


def scalar_first(turn: Rotation) -> Array:
    return np.asarray(turn.as_quat(scalar_first=True))


def about_z(angle: Any) -> Rotation:
    return Rotation.from_rotvec(np.multiply.outer(angle, [0.0, 0.0, 1.0]))


def most(value: float | None, bound: float) -> bool:
    assert value is not None
    return value < bound


# Trajectories that are right, in every form.


@pytest.mark.parametrize(
    "top",
    [
        Top(),
        Top(r0=-20, psidot0=3),
        Top(r0=0),
        Top(theta0_deg=120, thetadot0=-2, r0=5),
        Top(theta0_deg=0, r0=60),
        Top(theta0_deg=180, r0=30),
        Top(g=0, psidot0=4),
        Top(theta0_deg=1e-5, r0=60),
    ],
)
def test_an_integrator_is_fine(top: Top) -> None:
    """Worst seen: 9.8e-13 rad."""
    _, states = dop853(Body.of(top), T)
    judgement = compare(top, T, quaternion=states[:, :4], rates=states[:, 4:])
    assert judgement.verdict == "fine"
    assert most(judgement.attitude_error_max, 5e-12)
    assert most(judgement.energy_drift, 1e-12)
    assert most(judgement.Lz_drift, 1e-12)
    assert most(judgement.norm_drift, 1e-12)


FORMS: dict[str, dict[str, Any]] = {
    "quaternion": {"quaternion": Q},
    "not normalised": {"quaternion": Q * np.linspace(0.5, -2.2, 201)[:, np.newaxis]},
    "xyzw": {"quaternion": np.asarray(TURN.as_quat()), "quaternion_order": "xyzw"},
    "order that is proved": {"quaternion": np.asarray(TURN.as_quat()), "quaternion_order": None},
    "matrix": {"matrix": TURN.as_matrix()},
    "rotvec": {"rotvec": TURN.as_rotvec()},
    "xyz": {"euler": TURN.as_euler("xyz")},
    "XYZ": {"euler": TURN.as_euler("XYZ"), "euler_sequence": "XYZ"},
    "angles": dict(zip(("phi", "theta", "psi"), ANGLES.T, strict=True)),
}
PARTS: dict[str, dict[str, Any]] = {
    "axis": {"axis": TURN.apply([0, 0, 1])},
    "position": {"position": TURN.apply([0, 0, 4.0])},
    "theta": {"theta": ANGLES[:, 1]},
    "phi and psi": {"phi": ANGLES[:, 0], "psi": ANGLES[:, 2] + 2 * np.pi},
    "body rates": {"rates": RATES},
    "space rates": {"rates": TURN.apply(RATES), "rates_frame": "space"},
}


@pytest.mark.parametrize("form", [*FORMS, *PARTS])
def test_every_form_is_read(form: str) -> None:
    """Worst seen: 9.8e-13 rad."""
    judgement = compare(TOP, T, **(FORMS | PARTS)[form])
    assert judgement.verdict == "fine"
    assert most(judgement.error_max, 2e-12)
    assert (judgement.attitude_error_max is None) == (form in PARTS)
    assert judgement.quaternion_order == ("xyzw" if form == "order that is proved" else None)


@pytest.mark.parametrize(
    ("form", "known"),
    [
        ("axis", {"axis", "theta", "psi"}),
        ("position", {"axis", "theta", "psi"}),
        ("theta", {"theta"}),
        ("phi and psi", {"phi", "psi"}),
        ("body rates", {"rate"}),
    ],
)
def test_what_is_not_given_is_null(form: str, known: set[str]) -> None:
    record = compare(TOP, T, **PARTS[form]).record()
    errors = {key.removesuffix("_error_max") for key in record if key.endswith("_error_max")}
    assert {key for key in errors if record[f"{key}_error_max"] is not None} == known
    assert record["energy_drift"] is None
    assert record["Lz_drift"] is None


def test_the_distance_of_the_mass_centre_is_judged() -> None:
    position = TURN.apply([0, 0, 4.0])
    assert most(compare(TOP, T, position=position).norm_drift, 1e-12)
    assert compare(TOP, T, position=1.5 * position).norm_drift == pytest.approx(0.5)


def test_rates_of_the_angles_give_energy_and_momentum() -> None:
    exact = solve(TOP).table(T, ["thetadot", "phidot", "psidot"])
    rates = np.stack([exact[f"{angle}dot"] for angle in ("theta", "phi", "psi")], axis=1)
    judgement = compare(TOP, T, quaternion=Q, angle_rates=rates)
    assert most(judgement.energy_drift, 1e-11)
    assert most(judgement.Lz_drift, 1e-11)
    assert most(judgement.rate_error_max, 1e-8)
    assert not most(compare(TOP, T, quaternion=Q, angle_rates=1.1 * rates).energy_drift, 1e-3)


# Errors of known size.


@pytest.mark.parametrize("size", [1e-12, 1e-9, 1e-4, 0.3, 3.0])
def test_an_error_of_known_size_is_measured(size: float) -> None:
    """The trajectory itself is 9.8e-13 rad off."""
    spun = compare(TOP, T, quaternion=scalar_first(TURN * about_z(size)))
    turned = compare(TOP, T, quaternion=scalar_first(about_z(-size) * TURN))
    tilted = compare(TOP, T, theta=ANGLES[:, 1] - size)
    assert spun.attitude_error_max == pytest.approx(size, abs=2e-12)
    assert spun.phi_error_max == pytest.approx(size, abs=2e-12)
    assert turned.attitude_error_final == pytest.approx(size, abs=2e-12)
    assert turned.psi_error_max == pytest.approx(size, abs=2e-12)
    assert tilted.theta_error_max == pytest.approx(size, abs=2e-12)
    assert most(spun.psi_error_max, 2e-12)
    assert most(spun.axis_error_max, 2e-12)


def test_wrong_rates_of_a_right_attitude_are_not_fine() -> None:
    wrong = np.tile([7.0, 8.0, 9.0], (len(T), 1))
    judgement = compare(TOP, T, quaternion=Q, rates=wrong)
    assert judgement.verdict == "other rates"
    assert most(judgement.error_max, 1e-9)
    assert compare(TOP, T, quaternion=Q, rates=1.0001 * RATES).verdict == "fine"
    assert compare(TOP, T, quaternion=Q, rates=1.01 * RATES).verdict == "other rates"
    assert compare(TOP, T, quaternion=Q, rates=1.01 * RATES, max_error=0.02).verdict == "fine"


@pytest.mark.parametrize("rate", [1e-6, -0.1, 25.0])
def test_drift_is_separated_from_oscillation(rate: float) -> None:
    """The wobble's mean square about its line is computed here by polyfit."""
    wobble = 1e-3 * np.sin(7 * T)
    judgement = compare(TOP, T, phi=ANGLES[:, 0] + rate * T + wobble, theta=ANGLES[:, 1])
    slope, offset = np.polyfit(T, wobble, 1)
    rest = math.sqrt(np.mean((wobble - slope * T - offset) ** 2))
    period = solve(TOP).T_nutation
    assert judgement.period == period
    assert judgement.phi_drift == pytest.approx((rate + slope) * period, rel=1e-6)
    assert judgement.phi_rest == pytest.approx(rest, rel=1e-6)
    assert judgement.psi_drift is None


def drifts(step: float, rows_apart: int) -> Judgement:
    """Return the judgement of semi-implicit Euler steps, of which some rows are shown."""
    t, states = semi_implicit_euler(Body.of(TOP), step, 2)
    return compare(TOP, t[::rows_apart], quaternion=states[::rows_apart, :4])


def test_turns_that_cannot_be_counted_are_no_drift() -> None:
    """An engine that is soon lost: its rows are too far apart to count whole turns of psi."""
    dense, sparse = drifts(2e-3, 1), drifts(2e-3, 100)
    assert dense.psi_drift is not None
    assert abs(dense.psi_drift) > 5
    assert (sparse.psi_drift, sparse.psi_rest) == (None, None)
    assert (sparse.phi_drift, sparse.phi_rest) == (None, None)
    assert sparse.theta_drift == pytest.approx(dense.theta_drift, abs=0.1)
    assert sparse.psi_error_max is not None


@pytest.mark.parametrize(("jump", "counted"), [(1.9, True), (2.1, False), (-2.1, False)])
@pytest.mark.parametrize("first", [0.0, 3.0])
def test_an_error_may_change_by_two_radians_from_row_to_row(
    jump: float, counted: bool, first: float
) -> None:
    """A first row that is far off says nothing of turns; nor does a change over a whole turn."""
    exact = solve(TOP).table(T, ["psi"])["psi"]
    steps = np.where(np.arange(T.size) < 100, 0.0, jump)
    judgement = compare(TOP, T, psi=exact + first + steps)
    assert (judgement.psi_drift is not None) == counted
    grown = compare(TOP, T, psi=exact + first + 1.5 * np.arange(T.size))
    assert grown.psi_drift == pytest.approx(1.5 / T[1] * (grown.period or 0))


def test_first_times_beyond_sizes() -> None:
    judgement = compare(TOP, T, theta=ANGLES[:, 1] + 0.9e-8 * 10 ** (5 * T))
    assert judgement.t_past_1e_6 == T[41]
    assert judgement.t_past_1e_3 == T[101]
    assert judgement.t_past_0_1 == T[141]
    assert judgement.t_past_1 == T[161]
    assert judgement.verdict == "drifts"


def test_drift_of_energy_and_norm_of_an_integrator() -> None:
    body = Body.of(TOP)
    t, states = rk4(body, 8e-3, 2)
    judgement = compare(TOP, t, quaternion=states[:, :4], rates=states[:, 4:])
    change = abs(body.energy(states) - body.energy(states)[0]).max()
    kinetic = body.energy(states)[0] - body.torque * math.cos(math.radians(30))
    assert judgement.energy_drift == pytest.approx(change / (kinetic + body.torque), rel=1e-6)
    norms = np.linalg.norm(states[:, :4], axis=1)
    assert judgement.norm_drift == pytest.approx(abs(norms - 1).max(), rel=1e-9)
    assert most(judgement.rate_error_final, 1)


@pytest.mark.parametrize(("tilt", "sign"), [(0, 1), (180, -1)])
def test_upright_and_hanging_tops_have_one_angle(tilt: int, sign: int) -> None:
    """Upright, a turn about the vertical is one of the spin; hanging, it is one against it."""
    top = Top(theta0_deg=tilt, r0=70)
    _, states = dop853(Body.of(top), T)
    turned = about_z(0.25) * Rotation.from_quat(states[:, :4], scalar_first=True) * about_z(-0.1)
    judgement = compare(top, T, quaternion=scalar_first(turned))
    assert judgement.phi_error_max == pytest.approx(0.15 if sign > 0 else 0.35, abs=1e-9)
    assert judgement.attitude_error_max == pytest.approx(judgement.phi_error_max, abs=1e-9)
    assert judgement.psi_error_max is None


@pytest.mark.parametrize(
    ("printed", "least", "most_off"),
    [
        ((-0.70828, 0.43878, 0.54573, 0.0894), 0, 1e-5),
        ((-0.70813, 0.43881, 0.54593, 0.089251), 3e-4, 6e-4),
        ((-0.70824157, 0.43878143, 0.54578152, 0.08937154), 5e-5, 2e-4),
    ],
)
def test_published_attitudes_of_the_heavy_top(
    printed: tuple[float, ...], least: float, most_off: float
) -> None:
    """EXUDYN's heavyTop.py prints them at t = 0.2: Runge-Kutta, generalised alpha, its own.

    The top of Bruels, Cardona and Arnold has its axis along y.
    """
    top = Top(m=15, A=15.234375, C=0.46875, s=1, g=9.81, r0=150, theta0_deg=90, psidot0=-4.61538)
    q = [(1, 0, 0, 0), printed]
    judgement = compare(top, [0, 0.2], quaternion=q, align=["axis=y", "start"])
    assert judgement.attitude_error_max is not None
    assert least <= judgement.attitude_error_max < most_off


# Frames.


@pytest.mark.parametrize("axis", ["x", "y", "z", "-x", "-y", "-z"])
def test_other_axes_of_the_body(axis: str) -> None:
    """The columns of a frame are the axes of ours in coordinates of the body of others."""
    sign, index = (-1 if axis.startswith("-") else 1), "xyz".index(axis[-1])
    figure = sign * np.eye(3)[index]
    side = np.eye(3)[(index + 1) % 3]
    frame = Rotation.from_matrix(np.stack([side, np.cross(figure, side), figure], axis=1))
    given = {"quaternion": scalar_first(TURN * frame.inv()), "rates": frame.apply(RATES)}
    judgement = compare(TOP, T, **given, align=[f"axis={axis}", "start"])
    assert most(judgement.attitude_error_max, 2e-12)
    assert most(judgement.rate_error_max, 1e-9)
    up = compare(TOP, T, quaternion=scalar_first(frame * TURN), align=[f"up={axis}", "start"])
    assert most(up.attitude_error_max, 2e-12)


@pytest.mark.parametrize("word", ["body", "space"])
def test_one_constant_rotation(word: str) -> None:
    other = Rotation.from_rotvec([0.3, -2, 1])
    turned = TURN * other if word == "body" else other * TURN
    assert compare(TOP, T, quaternion=scalar_first(turned)).verdict == "off from the start"
    judgement = compare(TOP, T, quaternion=scalar_first(turned), align=[word])
    assert most(judgement.attitude_error_max, 2e-12)


def test_angles_and_times_that_count_from_the_first_row() -> None:
    turned = scalar_first(about_z(1.0) * TURN * about_z(-2.5))
    shifted = compare(TOP, T + 17, quaternion=turned, align=["start", "time"])
    assert most(shifted.attitude_error_max, 2e-12)
    assert shifted.t is not None
    assert shifted.t[0] == 0
    parts = {"phi": ANGLES[:, 0] + 2, "psi": ANGLES[:, 2] - 1}
    assert most(compare(TOP, T, **parts, align=["start"]).error_max, 2e-12)
    axis = about_z(0.7).apply(TURN.apply([0, 0, 1]))
    assert most(compare(TOP, T, axis=axis, align=["start"]).error_max, 2e-12)


@pytest.mark.parametrize("tilt", [0, 180])
def test_the_start_on_a_pole(tilt: int) -> None:
    top = Top(theta0_deg=tilt, thetadot0=3)
    _, states = dop853(Body.of(top), T)
    turned = Rotation.from_quat(states[:, :4], scalar_first=True) * about_z(1.3)
    judgement = compare(top, T, quaternion=scalar_first(turned), align=["start"])
    assert most(judgement.attitude_error_max, 1e-10)


# Convergence, verdicts and slips.


def judged(top: Top, runs: list[tuple[Array, Array]], steps: list[float]) -> list[Judgement]:
    motion = solve(top)
    cases = []
    for t, states in runs:
        block = {"t": t[:, np.newaxis], "quaternion": states[:, :4]}
        given = ReadTrajectory([block], {}, Conventions("wxyz", radians=True), Alignment())
        cases.append(judge(motion, given))
    return with_verdicts(motion, cases, None, steps)[0]


@pytest.mark.parametrize(
    ("method", "steps", "order"),
    [(rk4, [4e-3, 2e-3, 1e-3], 4), (semi_implicit_euler, [2e-3, 1e-3, 5e-4], 1)],
)
def test_order_of_convergence(method: Any, steps: list[float], order: int) -> None:
    """All errors of the first-order method end beyond 1 rad: its order shows before."""
    rows = judged(Top(), [method(Body.of(Top()), h, 2) for h in steps], steps)
    assert rows[0].order == pytest.approx(order, abs=0.5)
    assert {row.verdict for row in rows} <= {"fine", "drifts"}
    assert [row.step for row in rows] == steps
    if order == 1:
        assert all(row.error_max is not None and row.error_max > 0.3 for row in rows)


def test_the_error_of_another_top_does_not_fall() -> None:
    steps = [4e-3, 2e-3]
    other = Top(A=39032 * 1.03)
    rows = judged(Top(), [rk4(Body.of(other), h, 1) for h in steps], steps)
    assert {row.verdict for row in rows} == {"another top"}
    assert all(row.explained_by is None for row in rows)
    found = convergence(rows)
    assert found is not None
    assert not found.falls


def test_a_small_error_that_does_not_fall_is_explained_too() -> None:
    top = Top(psidot0=1e-5)
    run = dop853(Body.of(top.replace(r0=50 + 1e-5 * math.cos(math.pi / 6))), T)
    rows = judged(top, [run, run], [1e-3, 1e-4])
    assert {(row.verdict, row.explained_by) for row in rows} == {
        ("another top", "r0 taken as phi'")
    }
    assert most(rows[0].error_max, 1e-4)


def test_rounding_need_not_fall() -> None:
    rows = judged(TOP, [(T, STATES), (T, STATES)], [1e-3, 1e-4])
    assert {row.verdict for row in rows} == {"fine"}


def test_numbers_with_six_decimals_are_not_another_top() -> None:
    runs = [(T, np.round(STATES, 6)), (T, np.round(STATES, 6))]
    rows = judged(TOP, runs, [1e-3, 1e-4])
    assert {row.verdict for row in rows} == {"fine"}
    assert rows[0].error_max is not None
    assert 1e-7 < rows[0].error_max < 1e-4
    found = convergence(rows)
    assert found is not None
    assert not found.falls


def converged(*pairs: tuple[float, float]) -> Convergence:
    """Return the convergence of trajectories with these steps and errors."""
    found = convergence([compare(TOP, T, theta=ANGLES[:, 1] + x, step=h) for h, x in pairs])
    assert found is not None
    return found


def test_steps_finer_than_the_best_do_not_count() -> None:
    """Rounding grows with the number of steps: 1e-9 at the step of 1e-5."""
    found = converged((1e-5, 1e-3), (1e-4, 1e-6), (1e-3, 1e-4), (1e-2, 1e-2))
    assert found.order == pytest.approx(2, abs=1e-3)
    assert convergence([compare(TOP, T, theta=ANGLES[:, 1], step=1e-2)]) is None


def test_two_methods_at_once_are_not_another_top() -> None:
    assert converged((1e-3, 1e-6), (1e-3, 1e-1), (2e-3, 1e-5), (2e-3, 2e-1)).falls


def explained(judgement: Judgement, name: str) -> bool:
    """Return whether a mistake is named, and leaves next to nothing if it is undone."""
    wrong = judgement.verdict in {"another top", "off from the start"}
    return (
        wrong and name in (judgement.explained_by or "") and most(judgement.explained_error, 1e-9)
    )


def tilted_by_radians() -> Body:
    """Return the top whose 30 degrees were taken as 30 radians: it leans to the other side."""
    rates = [1, 3 * math.sin(30), 50]
    return Body.of(TOP)._replace(state=np.array([math.cos(15), math.sin(15), 0, 0, *rates]))


SHIFT = 1587 * 16
TOPS: dict[str, Top] = {
    "A + m s^2": TOP.replace(A=39032 + SHIFT),
    "A - m s^2": TOP.replace(A=39032 - SHIFT),
    "r0 with the wrong sign": TOP.replace(r0=-50),
    "r0 in radians taken as degrees": TOP.replace(r0=50 * math.pi / 180),
    "r0 in turns a minute taken as radians": TOP.replace(r0=50 * 30 / math.pi),
    "psidot0 with the wrong sign": TOP.replace(psidot0=-3),
    "thetadot0 with the wrong sign": TOP.replace(thetadot0=-1),
    "r0 taken as phi'": TOP.replace(r0=50 + 3 * math.cos(math.pi / 6)),
    "phi' taken as r0": TOP.replace(r0=50 - 3 * math.cos(math.pi / 6)),
    "theta0 in radians taken as degrees": TOP.replace(theta0_deg=math.radians(30)),
    "g left out": TOP.replace(g=0),
}


BODIES = {name: Body.of(top) for name, top in TOPS.items()}
QUICK = {
    "theta0 in degrees taken as radians": tilted_by_radians(),
    "g upwards": Body.of(TOP, g=-981),
}


@pytest.mark.parametrize(
    "name", [*(pytest.param(name, marks=pytest.mark.slow) for name in BODIES), *QUICK]
)
def test_the_top_that_moved_is_named(name: str) -> None:
    _, states = dop853((BODIES | QUICK)[name], T)
    assert explained(compare(TOP, T, quaternion=states[:, :4]), name)


@pytest.mark.parametrize("A", [39032, 30000])
@pytest.mark.parametrize("form", ["body", "space", "attitude", "axis"])
def test_moments_that_were_exchanged_are_named(A: int, form: str) -> None:
    """The top that moved has C > 2A, or not; no rigid body has the former, but engines take it."""
    top = TOP.replace(A=A)
    _, states = dop853(Body.of(top)._replace(A=float(top.C), C=float(A)), T)
    turn = Rotation.from_quat(states[:, :4], scalar_first=True)
    given: dict[str, Any] = {"quaternion": states[:, :4], "rates": states[:, 4:]}
    if form == "space":
        given |= {"rates": turn.apply(states[:, 4:]), "rates_frame": "space"}
    if form == "attitude":
        del given["rates"]
    if form == "axis":
        given = {"axis": turn.apply([0, 0, 1])}
    assert explained(compare(top, T, **given), "A and C exchanged")


Y_UP = Rotation.from_matrix(np.eye(3)[[1, 2, 0]])
"""Brings z to y, as in game engines."""
DOWN = Rotation.from_rotvec([math.pi, 0, 0])
READINGS: dict[str, dict[str, Any]] = {
    "conjugate": {"quaternion": Q * [1, -1, -1, -1]},
    "was read as wxyz": {"quaternion": np.asarray(TURN.as_quat())},
    "was read as xyzw": {"quaternion": Q, "quaternion_order": "xyzw"},
    "phi and psi are exchanged": {"phi": ANGLES[:, 2], "psi": ANGLES[:, 0], "theta": ANGLES[:, 1]},
    "other frame": {"rates": TURN.apply(RATES)},
    "taken as radians": {"theta": np.degrees(ANGLES[:, 1])},
    "--align start": {"quaternion": scalar_first(about_z(1) * TURN)},
    "axis=y,start": {"quaternion": scalar_first(TURN * Rotation.from_matrix(np.eye(3)[[2, 0, 1]]))},
    "up=-z,start": {"quaternion": scalar_first(Rotation.from_rotvec([math.pi, 0, 0]) * TURN)},
    "axis=y,up=y,start": {"quaternion": scalar_first(Y_UP * TURN * Y_UP.inv())},
    "axis=x,up=x,start": {"quaternion": scalar_first(Y_UP.inv() * TURN * Y_UP)},
    "axis=-z,up=-z,start": {"quaternion": scalar_first(DOWN * TURN * DOWN)},
}


@pytest.mark.parametrize("name", READINGS)
def test_the_wrong_reading_is_named(name: str) -> None:
    assert explained(compare(TOP, T, **READINGS[name]), name)


@pytest.mark.parametrize("bad", [math.nan, math.inf, -math.inf])
@pytest.mark.parametrize("form", ["quaternion", "matrix", "xyz", "rotvec"])
def test_a_trajectory_is_lost_where_it_is_not_finite(bad: float, form: str) -> None:
    given: dict[str, Any] = {key: np.array(x) for key, x in FORMS[form].items()}
    for values in given.values():
        values[120:] = bad
    judgement = compare(TOP, T, **given)
    assert (judgement.verdict, judgement.lost_at) == ("lost", T[120])
    assert most(judgement.attitude_error_max, 2e-12)


def test_a_quaternion_of_length_0_is_lost() -> None:
    q = Q.copy()
    q[7] = 0
    assert compare(TOP, T, quaternion=q).lost_at == T[7]
    nothing = compare(TOP, T, quaternion=0 * Q)
    assert (nothing.verdict, nothing.lost_at, nothing.error_max) == ("lost", 0, None)


def test_frames_come_from_the_first_row_that_is_finite() -> None:
    q = scalar_first(about_z(1) * TURN)
    q[:3] = math.nan
    judgement = compare(TOP, T, quaternion=q, align=["start"])
    assert judgement.lost_at == 0
    assert most(judgement.error_max, 2e-12)


@pytest.mark.parametrize(("size", "word"), [(9e-4, "fine"), (2e-3, "off from the start")])
def test_a_first_row_beyond_the_limit(size: float, word: str) -> None:
    assert compare(TOP, T, theta=ANGLES[:, 1] + size).verdict == word
    assert compare(TOP, T, theta=ANGLES[:, 1] + size, max_error=0.1).verdict == "fine"


def test_masked_numbers_are_missing() -> None:
    theta = np.ma.masked_array(ANGLES[:, 1], T > 1)
    assert compare(TOP, T, theta=theta).lost_at == T[101]


def test_one_row() -> None:
    judgement = compare(TOP, 0.3, quaternion=Q[30])
    assert (judgement.rows, judgement.verdict, judgement.phi_drift) == (1, "fine", None)


def test_times_may_go_backwards() -> None:
    back = solve(TOP).table(-T, ["theta"])["theta"]
    assert compare(TOP, -T, theta=back).verdict == "fine"


# Streams.


@pytest.mark.slow
@pytest.mark.parametrize("rows", [1, 7, 100])
def test_blocks_make_no_difference(rows: int) -> None:
    """The fit adds up other sums: it agrees to 1e-9 of itself."""
    angle = 3 * T + 0.1 * np.sin(T)
    q = scalar_first(TURN * about_z(angle))
    block = {"t": T[:, np.newaxis], "quaternion": q, "rates": RATES}
    pieces = [{key: x[i : i + rows] for key, x in block.items()} for i in range(0, 201, rows)]
    conventions = Conventions("wxyz", radians=True)
    whole, parts = (
        judge(solve(TOP), ReadTrajectory(blocks, {}, conventions, Alignment())).judgement
        for blocks in ([block], pieces)
    )
    for key, value in whole.record().items():
        other = getattr(parts, key)
        assert other == value or other == pytest.approx(value, rel=1e-9, abs=1e-12), key


@pytest.mark.parametrize("block", [1, 1000, 50_000])
def test_rows_that_are_kept_are_spread_evenly(block: int) -> None:
    kept, count = Kept(), 20_000 if block == 1 else 50_000
    for start in range(0, count, block):
        kept.add({"t": np.arange(start, min(start + block, count), dtype=float)})
    t = kept.rows()["t"]
    assert MOST_KEPT / 2 <= len(t) <= MOST_KEPT
    assert set(np.diff(t)) == {kept.stride}


# Bad arguments.


@pytest.mark.parametrize(
    ("arguments", "message"),
    [
        ({}, "compare must be given an attitude"),
        ({"quaternion": Q[:5]}, r"quaternion must be real numbers of shape \(201, 4\)"),
        ({"angle_rates": RATES}, "angle_rates must come with an attitude or a part of it"),
        ({"theta": ["1"] * 201}, r"theta must be real numbers, got \['1'"),
        ({"theta": T > 1}, r"theta must be real numbers, got array\(\[False"),
        ({"theta": 1j * T}, r"theta must be real numbers, got array\(\[0.*j"),
        ({"quaternion": Q, "quaternion_order": "zyxw"}, "quaternion_order must be wxyz or xyzw"),
        ({"quaternion": Q, "euler_sequence": "xxz"}, "euler_sequence must be three axes"),
        ({"quaternion": Q, "euler_sequence": "xYz"}, "euler_sequence must be three axes"),
        ({"quaternion": Q, "rates_frame": "world"}, "rates_frame must be body or space"),
        ({"quaternion": Q, "align": ["axis"]}, "align must be among axis=y"),
        ({"quaternion": Q, "align": ["up=w"]}, "align must be among axis=y"),
        ({"quaternion": Q, "align": "start"}, "align must be a list of words"),
        ({"quaternion": Q, "align": ["body", "space"]}, "align takes one of start, body and space"),
        ({"theta": ANGLES[:, 1], "align": ["body"]}, "align body needs the whole attitude"),
        ({"axis": PARTS["axis"]["axis"], "align": ["up=y", "axis=x"]}, "align axis=x needs the"),
        ({"theta": ANGLES[:, 1], "align": ["up=y", "start"]}, "align up=y needs the axis or the"),
        ({"quaternion": Q * math.nan, "quaternion_order": None}, "the first row does not prove"),
        (
            {"quaternion": Q, "quaternion_order": None, "align": ["body"]},
            "the first row does not prove the order of the quaternion",
        ),
    ],
)
def test_bad_arguments(arguments: dict[str, Any], message: str) -> None:
    with pytest.raises(LagtopError, match=message):
        compare(TOP, T, **arguments)


@pytest.mark.parametrize("t", [[0, 1, 0.5], [0.25, 0, 0.5], [0, 1, 1], [0, math.nan, 1], []])
def test_bad_times(t: list[float]) -> None:
    with pytest.raises(LagtopError, match="t must"):
        compare(TOP, t, theta=np.zeros(len(t)))


def test_a_motion_that_is_solved_already_will_do() -> None:
    assert compare(solve(TOP), T, quaternion=Q).verdict == "fine"
