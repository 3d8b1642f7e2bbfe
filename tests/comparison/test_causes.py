"""Right trajectories of every form are fine; planted mistakes are found and named.

`pytest tests/comparison -m ""` tries all of them.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from engines import Array, Body, dop853, rk4_step, semi_implicit, wxyz
from lagtop import Top, compare, solve
from mistakes import SCENES, mistakes_of, top_of
from mistakes import run as engine_run
from scipy.spatial.transform import Rotation

from lagrange_cli.comparison.engines import engines

TOPS = {name: top_of(SCENES[name]) for name in ("general", "dart", "disc")}
TOP = TOPS["general"]
T = np.linspace(0, 1, 201)
Given = dict[str, Any]


@cache
def run(name: str, mistake: str = "right", method: str = "DOP853") -> tuple[Rotation, Array]:
    """Return the attitude and the body rates that an engine computes with a mistake or none."""
    _, states = dop853(planted(SCENES[name])[mistake][1], T, 1e-10, method)
    return Rotation.from_quat(states[:, :4], scalar_first=True), states[:, 4:]


def planted(scene: dict[str, float]) -> dict[str, tuple[str, Any]]:
    """Return engines with mistakes by a short name, each with a part of the name of its cause."""
    found: dict[str, tuple[str, Any]] = {**mistakes_of(scene)}
    right, r0 = found["right"][1], scene["r0"]
    for unit, r in {"degrees": math.degrees(r0), "rpm": r0 * 30 / math.pi}.items():
        name = f"r0 in {unit} was taken as radians"
        found[name] = name, right._replace(rates=(*right.rates[:2], r))
    found["g is 981"] = "g is 981", right._replace(torque=right.torque * 981 / 9.81)
    return {key: x for key, x in found.items() if key == "right" or x[0][0] != "#"}


def attitude(turn: Rotation, **others: Any) -> Given:
    return {"quaternion": wxyz(turn), **others}


def framed(turn: Rotation, rows: Any) -> Given:
    """Return the attitude in other axes of space and body, right-handed or left-handed."""
    return attitude(Rotation.from_matrix(rows @ turn.as_matrix() @ np.transpose(rows)))


def angles(turn: Rotation, phi: float = 1, psi: float = 1) -> Given:
    precession, tilt, spin = turn.as_euler("ZXZ").T
    return {"theta": tilt, "phi": phi * spin, "psi": psi * precession}


FRAMES = {
    "up=y,left": [[1, 0, 0], [0, 0, 1], [0, 1, 0]],  # Unity
    "left": [[1, 0, 0], [0, -1, 0], [0, 0, 1]],  # Unreal
    "axis=y,up=y": [[1, 0, 0], [0, 0, 1], [0, -1, 0]],  # Godot
    "axis=-z,up=-z": [[1, 0, 0], [0, -1, 0], [0, 0, -1]],  # NED
}
"""The axes of engines in the coordinates of lagtop, by their words."""
_Y_UP = [[0, 1, 0], [0, 0, 1], [1, 0, 0]]
READINGS: dict[str, Callable[[Rotation, Array], Given]] = {
    "conjugate": lambda turn, _: attitude(turn.inv()),
    "the quaternion is xyzw and was read": lambda turn, _: {"quaternion": turn.as_quat()},
    "phi and psi are exchanged": lambda turn, _: dict(
        zip(("theta", "psi", "phi"), angles(turn).values(), strict=True)
    ),
    "theta is measured from the horizontal": lambda turn, _: (
        angles(turn) | {"theta": math.pi / 2 - angles(turn)["theta"]}
    ),
    "the Euler angles are in the sequence XYZ": lambda turn, _: {"euler": turn.as_euler("XYZ")},
    "phi is counted backwards": lambda turn, _: angles(turn, phi=-1),
    "psi is counted backwards": lambda turn, _: angles(turn, psi=-1),
    "rates are in the space frame": lambda turn, x: attitude(turn, rates=turn.apply(x)),
    "the rates are in degrees": lambda turn, rates: attitude(turn, rates=np.degrees(rates)),
    "degrees per unit of time": lambda _, rates: {"rates": np.degrees(rates)},
    "y is up and the figure axis is the body's y axis": lambda turn, _: framed(turn, _Y_UP),
    "left-handed with y up; or y is down": lambda turn, _: framed(turn, FRAMES["up=y,left"]),
    "left-handed with z up; or z is down": lambda turn, _: framed(turn, FRAMES["left"]),
    "phi starts at 57.3 degrees": lambda turn, _: attitude(turn * Rotation.from_euler("z", 1)),
    "the clock starts at 0.0123": lambda turn, _: attitude(turn, t=T + 0.0123),
    "rows are off by one: each holds the state of the next": lambda turn, _: attitude(
        turn[1:], t=T[:-1]
    ),
    "the state of the previous": lambda turn, _: attitude(turn[:-1], t=T[1:]),
    "time runs backwards": lambda turn, _: attitude(turn, t=-T),
    "t is in ms": lambda turn, _: attitude(turn, t=1000 * T),
    "t is in us": lambda turn, _: attitude(turn, t=1e6 * T),
    "t is in minutes": lambda turn, _: attitude(turn, t=T / 60),
    "t counts frames, 200 per second": lambda turn, _: attitude(turn, t=np.rint(200 * T)),
    "the unit of t is 1000 times": lambda turn, _: attitude(turn, t=T / 1000),
    "the clock is shifted by -0.125": lambda turn, _: attitude(turn[25:], t=T[:-25]),
    "the clock is 1.0 % fast": lambda turn, _: attitude(turn, t=1.01 * T),
}
"""What is given to `compare` with a mistake in it, by a part of the name of the mistake."""
SLOW = {"r0 in degrees was taken as radians", "inertia", "side"}
PLANTED = [name for name in (*planted(SCENES["general"]), *READINGS) if name != "right"]

FORMS: dict[str, Callable[[Rotation, Array], Given]] = {
    "quaternion": lambda turn, rates: attitude(turn, rates=rates),
    "float32": lambda turn, _: {"quaternion": wxyz(turn).astype(np.float32)},
    "4 digits": lambda turn, _: {"matrix": np.round(turn.as_matrix(), 4)},
    "6 digits": lambda turn, _: {"quaternion": np.round(-wxyz(turn), 6)},
    "angles": lambda turn, _: angles(turn),
    "axis": lambda turn, _: {"axis": turn.as_matrix()[:, :, 2]},
    "rotvec": lambda turn, _: {"rotvec": turn.as_rotvec()},
    "backwards": lambda turn, _: {"t": T[::-1], "quaternion": wxyz(turn)[::-1]},
    "irregular": lambda turn, _: {
        "t": np.delete(T, [1, 7, 8]),
        "euler": np.delete(turn.as_euler("xyz"), [1, 7, 8], axis=0),
    },
    "space": lambda turn, rates: {"rates": turn.apply(rates), "rates_frame": "space"},
}


@pytest.mark.parametrize("method", ["DOP853", "LSODA"])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("name", TOPS)
def test_a_right_trajectory_is_fine(name: str, form: str, method: str) -> None:
    given: Given = {"t": T} | FORMS[form](*run(name, method=method))
    assert compare(TOPS[name], **given).verdict == "fine"


def slow(name: str, is_slow: bool) -> Any:
    return pytest.param(name, marks=pytest.mark.slow) if is_slow else name


@pytest.mark.parametrize("name", [slow(x, x != "general") for x in TOPS])
@pytest.mark.parametrize("mistake", [slow(x, x in SLOW) for x in PLANTED])
def test_a_planted_mistake_is_named(name: str, mistake: str) -> None:
    wanted, engine = planted(SCENES[name]).get(mistake, (mistake, None))
    states = run(name, mistake if engine else "right")
    given: Given = {"t": T} | READINGS.get(mistake, FORMS["quaternion"])(*states)
    found = compare(TOPS[name], **given)
    assert found.verdict != "fine"
    assert wanted in str(found.cause)
    assert (found.cause_error or 0) < (1e-3 if engine and engine.rule else 1e-5)


def test_a_conjugate_in_the_other_order_is_named() -> None:
    turn, _ = run("general")
    found = compare(TOP, T, quaternion=turn.inv().as_quat(), quaternion_order="xyzw")
    assert (found.cause or "").startswith("the attitude is the conjugate")


IN_FRAMES = "A, C exchanged", "A + ms2", "g 10", "r0 in rpm was taken as radians"
LEFT = "the frame is left-handed with {} up".format
NAMES = {"up=y,left": LEFT("y"), "left": LEFT("z"), "axis=-z,up=-z": LEFT("z")}
NAMES["axis=y,up=y"] = "y is up and the figure axis is the body's y axis"


@pytest.mark.parametrize("mistake", [slow(x, x != "A, C exchanged") for x in IN_FRAMES])
@pytest.mark.parametrize("frame", [slow(x, x.endswith("left")) for x in FRAMES])
@pytest.mark.parametrize("how", ["psi", slow("clock", True), slow("frame", True)])
def test_two_causes_at_once_are_named(how: str, frame: str, mistake: str) -> None:
    """A mistake in a frame with other zeros, or in a frame that is not given.

    The remedy leaves the mistake alone.
    """
    turn, (wanted, _) = run("general", mistake)[0], planted(SCENES["general"])[mistake]
    turn = Rotation.from_euler("z", 20 * (how == "psi"), degrees=True) * turn
    given: Given = {"t": T + 10 * (how == "clock")} | framed(turn, FRAMES[frame])
    found = compare(TOP, **given, align="" if how == "frame" else frame)
    firsts = {"frame": NAMES[frame], "psi": "psi starts at ", "clock": "the clock starts at 10; "}
    assert firsts[how] in (found.cause or "")
    assert wanted in (found.cause or "")
    assert (found.explained, (found.cause_error or 1) < 1e-5) == ("most likely", True)
    remedy = (found.remedy or "").split(" or ")[0].removeprefix("align=")
    again = compare(TOP, **given, align=remedy)
    assert wanted in (again.cause or "")
    assert ";" not in (again.cause or "")


@pytest.mark.slow
@pytest.mark.parametrize(
    ("words", "frame", "mistake", "name"),
    [
        ("left", "left", "r0 sign", "r0 has the wrong sign (in a left-handed frame"),
        ("up=y,left", "left", "right", "the frame is left-handed with z up"),
        ("", "axis=-z,up=-z", "right", LEFT("z") + "; the clock starts at 10"),
    ],
)
def test_frames_are_named(words: str, frame: str, mistake: str, name: str) -> None:
    given: Given = framed(run("general", mistake)[0], FRAMES[frame])
    found = compare(TOP, T + 10 * ("clock" in name), **given, align=words)
    assert name in (found.cause or "")


@pytest.mark.parametrize("frame", ["up=y,left", "left"])
@pytest.mark.parametrize(("key", "count"), [("matrix", 2), ("axis", 1)])
def test_each_remedy_for_a_frame_works(key: str, count: int, frame: str) -> None:
    """A frame with z down turns both z axes, but an axis alone only once."""
    turn, rows = run("general")[0].as_matrix(), np.array(FRAMES[frame])
    given: Given = {key: rows @ turn @ rows.T if key == "matrix" else turn[:, :, 2] @ rows.T}
    words = (compare(TOP, T, **given).remedy or "").split(" or ")
    typed = [compare(TOP, T, **given, align=x.removeprefix("align=")) for x in words]
    assert [x.verdict for x in typed] == ["fine"] * count


def test_mirrored_motions_have_three_names() -> None:
    """Released from rest, a top with reversed spin moves as in a mirror."""
    top = Top(m=1.2, A=0.018, C=0.004, s=0.1, g=9.81, r0=60, theta0_deg=55)
    _, states = dop853(Body.of(top.replace(r0=-60)), T, 1e-10)
    turn = Rotation.from_quat(states[:, :4], scalar_first=True)
    found = compare(top, T, quaternion=wxyz(turn))
    names = "r0 has the wrong sign; or the frame is left-handed with z up; or z is down"
    assert (found.cause, found.verdict) == (names, "another top")
    assert found.remedy == "align=left,start or align=axis=-z,up=-z"
    assert compare(top, T, quaternion=wxyz(turn), align="left,start").verdict == "fine"
    turned = compare(top, T, quaternion=wxyz(turn * Rotation.from_euler("z", 1)))
    assert "r0 has the wrong sign" in (turned.cause or "")
    back = compare(top.replace(r0=-60), -T, quaternion=wxyz(turn))
    assert (back.cause or "").startswith("time runs backwards")


@pytest.mark.slow
def test_no_part_is_explained_by_what_spoils_the_attitude() -> None:
    """Rates that are forty-five times too large are like those of a top with r0 in degrees."""
    _, states = dop853(Body.of(TOP), T / 1e5, 1e-10)
    given: Given = {"t": T / 1e5, "rates": 45 * states[:, 4:]}
    names = "the rates are in degrees", "r0 in degrees was taken as radians"
    alone = compare(TOP, **given)
    assert all(name in (alone.cause or "") for name in names)
    seen = angles(Rotation.from_quat(states[:, :4], scalar_first=True))
    found = compare(TOP, **given, theta=seen["theta"], phi=seen["phi"])
    assert [name in (found.cause or "") for name in names] == [True, False]
    assert (found.error_max or 0.0) < 1e-9
    few = compare(TOP, given["t"], rates=20 * states[:, 4:])
    assert few.cause is None  # what remains is as large as the rates


def test_the_clock_is_off_by_several_periods() -> None:
    turn, _ = run("dart")
    found = compare(TOPS["dart"], T[:-99], quaternion=wxyz(turn[99:]))
    assert found.cause == "the clock is shifted by -0.495"


def test_degrees_that_are_less_than_a_turn_and_a_radian() -> None:
    """A tilt of 7 rad leans to the same side as a tilt of 7 - 2 pi rad."""
    name = "theta0 in degrees was taken as radians"
    _, states = dop853(planted(SCENES["general"] | {"theta0_deg": 7})["theta radians"][1], T, 1e-10)
    assert compare(TOP.replace(theta0_deg=7), T, quaternion=states[:, :4]).cause == name


def test_of_values_of_g_the_closest_is_named() -> None:
    """The digits hide 0.03 % of g from the limit, but not from the search."""
    turn, _ = run("general")
    found = compare(TOP.replace(g=10), T, quaternion=wxyz(turn).round(4), max_error=3e-3)
    assert found.cause == "g is 9.81 (or m or s is wrong by the same factor)"


@pytest.mark.slow
def test_two_causes_must_explain_more_than_one() -> None:
    """A spin and angles in wrong units, which cancel, imitate another precession of a fast top."""
    top = Top(m=0.03865, A=3.558e-4, C=2.711e-4, s=0.07512, g=9.81, r0=-234.8, theta0_deg=110)
    t = np.linspace(0, 0.47, 200)
    _, states = dop853(Body.of(top.replace(psidot0=-2.684)), t)
    found = compare(top, t, psi=angles(Rotation.from_quat(states[:, :4], scalar_first=True))["psi"])
    assert (found.verdict, found.cause) == ("drifts", None)


def test_no_cause_is_named_for_few_rows() -> None:
    """Two rows can be explained by too many causes."""
    late = wxyz(Rotation.from_euler("z", 1) * run("general")[0][:3])
    causes = [compare(TOP, T[:n], quaternion=late[:n]).cause for n in (2, 3)]
    assert causes == [None, "psi starts at 57.3 degrees"]


def test_two_causes_of_one_input_each_combine() -> None:
    """Of two wrong inputs, a reversed spin may be one."""
    _, states = dop853(Body.of(TOP.replace(r0=-40, g=2 * 9.81)), T, 1e-10)
    found = compare(TOP, T, quaternion=states[:, :4])
    assert found.cause == "gravity acts twice; r0 has the wrong sign"


@pytest.mark.parametrize(
    "reading", ["the quaternion is xyzw and was read", slow("conjugate", True)]
)
def test_a_misread_attitude_hides_no_wrong_input(reading: str) -> None:
    """The axis that is seen moves like that of a third top."""
    found = compare(TOP, T, **READINGS[reading](*run("general", "r0 rpm")))
    assert reading in (found.cause or "")
    assert "r0 in radians was taken as rpm" in (found.cause or "")


def test_numbers_of_what_is_in_no_row() -> None:
    """Damping, two wrong inputs, another start; times may decrease."""
    engine: Any = mistakes_of(SCENES["general"])["damping .05"][1]
    found = compare(TOP, T, quaternion=dop853(engine, T, 1e-10)[1][:, :4])
    assert (found.verdict, found.cause) == ("drifts", None)
    assert "the spin decays at the relative rate 0.05 per unit of time" in (found.numbers or "")
    assert (found.a_ratio, found.b_ratio) == pytest.approx((1, 1), abs=5e-3)
    other = TOP.replace(C=0.9 * 0.006, g=1.93 * 9.81, psidot0=9)
    seen = dop853(Body.of(other), T, 1e-10)[1][:, :4]
    for rows in (slice(None), slice(None, None, -1)):
        found = compare(TOP, T[rows], quaternion=seen[rows])
        assert (found.cause, found.numbers) == (
            None,
            "the motion is that of a top with a = 1.93 a_0, b = 0.9 b_0, r0 = r0_0; psidot0 is 9",
        )


@pytest.mark.parametrize(
    ("inputs", "said"),
    [({"psidot0": 1.4}, "psidot0 is 1.4"), ({"theta0_deg": 55.05}, "theta0 is 55.05 degrees")],
)
def test_a_small_change_of_the_start_is_said(inputs: dict[str, float], said: str) -> None:
    """Steps may be the reason, too: a method staggers rates."""
    seen = solve(TOP.replace(**inputs)).table(T, ["quaternion"])
    found = compare(TOP, T, quaternion=np.stack([*seen.values()], axis=1))
    assert f", but {said}: check the start, or use smaller steps" in (found.numbers or "")


def test_rounded_rows_that_are_close_show_the_motion() -> None:
    """From row to row the axis moves by less than a thousand units of the last digit."""
    t = np.linspace(0, 0.5, 200_001)
    seen = solve(TOP.replace(C=0.9 * 0.006, g=1.93 * 9.81)).table(t, ["axis"])
    found = compare(TOP, t, axis=np.stack([*seen.values()], axis=1).round(10))
    assert (found.a_ratio, found.b_ratio) == pytest.approx((1.93, 0.9), rel=5e-3)


def test_many_rows_of_the_first_time() -> None:
    """A recorder may repeat the first row until the top moves."""
    other = solve(TOP.replace(C=0.9 * 0.006, g=1.93 * 9.81))
    t = np.append(np.zeros(20), T)
    found = compare(TOP, t, quaternion=np.stack([*other.table(t, ["quaternion"]).values()], axis=1))
    assert (found.a_ratio, found.b_ratio) == pytest.approx((1.93, 0.9), rel=1e-3)


def test_rounded_times_are_named() -> None:
    """The times of a top that is not in the table are rounded, too: the numbers are not."""
    t = np.linspace(0, 0.9773, 201)
    other = TOP.replace(C=0.9 * 0.006, g=1.93 * 9.81)
    found = []
    for top in (TOP, other):
        q = np.stack([*solve(top).table(t, ["quaternion"]).values()], axis=1)
        found.append(compare(TOP, t.round(3), quaternion=q))
    assert (found[0].cause, found[0].verdict) == ("t is rounded", "drifts")
    assert (found[1].a_ratio, found[1].b_ratio) == pytest.approx((1.93, 0.9), rel=1e-3)


def test_engines_are_not_tried_over_thousands_of_swings() -> None:
    t = np.linspace(0, 1000, 60)
    swinging = Top(m=1587, A=180, C=9, s=4, g=981, r0=0, theta0_deg=150)
    assert all(np.isnan(x.at(t)["quaternion"]).all() for _, x in engines(solve(swinging)))


def test_channels_are_judged_apart() -> None:
    """Causes of the time and of the rates combine."""
    turn, rates = run("general")
    both = compare(TOP, 1e6 * T, quaternion=wxyz(turn), rates=np.degrees(rates))
    assert both.cause == "t is in us; the rates are in degrees per unit of time"


def test_a_clock_of_coarse_steps_is_named_before_inputs() -> None:
    t, rows = engine_run(mistakes_of(SCENES["general"])["right"][1], 0.33 / 40, 1, 1, rk4_step)
    found = compare(TOP, 1.01 * t, quaternion=rows, max_error=1e-4)
    assert (found.cause, found.explained) == ("the clock is 1.0 % fast", "partly")


@pytest.mark.parametrize(
    ("name", "mistake", "method"),
    [("general", "right", semi_implicit), ("toy", "C - 5 % + moon", rk4_step)],
)
def test_a_coarse_step_is_not_blamed_on_the_inputs(name: str, mistake: str, method: Any) -> None:
    """Nor is a top named in part whose nutation the rows do not show."""
    scene = SCENES[name]
    h = 0.33 / scene["r0"]
    t, rows = engine_run(mistakes_of(scene)[mistake][1], h, 1, 1, method)
    found = compare(top_of(scene), t, quaternion=rows)
    assert (found.cause, "use smaller steps" in (found.numbers or "")) == (None, True)


@pytest.mark.parametrize("h", [pytest.param(0.02, marks=pytest.mark.slow), 0.33])
def test_steps_of_an_engine_hide_no_rule_that_it_breaks(h: float) -> None:
    """Coarse steps move away from the equations soon."""
    engine = mistakes_of(SCENES["general"])["inertia"][1]
    method = semi_implicit if h < 0.1 else rk4_step
    t, rows = engine_run(engine, h / 40, 1, 1, method)
    assert compare(TOP, t, quaternion=rows).cause == "the inertia does not turn with the body"
