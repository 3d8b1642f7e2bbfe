"""Right trajectories of every form are fine; planted mistakes are found and named.

`python tests/compare/test_causes.py` tries all of them and prints what fails.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from functools import cache
from typing import Any

import numpy as np
import pytest
from engines import Array, Body, dop853
from lagtop import Top, compare
from scipy.spatial.transform import Rotation

SLIM = Top(m=0.35, A=8.5e-4, C=4e-4, s=0.03, g=9.81, r0=90, theta0_deg=40, thetadot0=1, psidot0=3)
TOY = Top(m=1.2, A=0.018, C=0.004, s=0.1, g=9.81, r0=60, theta0_deg=55, thetadot0=-0.5, psidot0=1)
DISC = Top(m=0.5, A=4e-3, C=2.5e-3, s=0.07, g=9.81, r0=-40, theta0_deg=75, thetadot0=1, psidot0=-2)
TOPS = {"slim": SLIM, "toy": TOY, "disc": DISC}
T = np.linspace(0, 1, 201)
TO_Y = np.array([[0.0, 1, 0], [0, 0, 1], [1, 0, 0]])
"""From frames with z up to frames with y up."""
UNITY, UNREAL = np.array([[1.0, 0, 0], [0, 0, 1], [0, 1, 0]]), np.diag([1.0, -1, 1])
"""From right-handed frames with z up to left-handed frames."""


@cache
def _run(A: float, C: float, torque: float, state: bytes, method: str) -> tuple[Rotation, Array]:
    _, states = dop853(Body(A, C, torque, np.frombuffer(state)), T, 1e-10, method)
    return Rotation.from_quat(states[:, :4], scalar_first=True), states[:, 4:]


def run(body: Body, method: str = "DOP853") -> tuple[Rotation, Array]:
    """Return attitude and body rates of an engine."""
    return _run(*body[:3], body.state.tobytes(), method)


def quaternion(turn: Rotation) -> Array:
    return np.asarray(turn.as_quat(scalar_first=True))


def about_z(angle: float) -> Rotation:
    return Rotation.from_euler("z", angle)


def angles(top: Top) -> tuple[Array, Array, Array]:
    """Return tilt, spin and precession of the right trajectory."""
    psi, theta, phi = run(Body.of(top))[0].as_euler("ZXZ").T
    return theta, phi, psi


# Planted mistakes: functions from the intended top to the arguments of `compare`.

Plant = Callable[[Top], dict[str, Any]]


def of_body(change: Callable[[Body, Top], Body]) -> Plant:
    """Plant the trajectory of another body."""

    def plant(top: Top) -> dict[str, Any]:
        turn, rates = run(change(Body.of(top), top))
        return {"quaternion": quaternion(turn), "rates": rates}

    return plant


def of_top(**changes: Callable[[Top], Any]) -> Plant:
    """Plant the trajectory of a top with other inputs."""
    return of_body(lambda _, top: Body.of(top.replace(**{x: of(top) for x, of in changes.items()})))


def started(r0: float = 1.0, tilt: Callable[[float], float] = lambda x: x) -> Plant:
    """Plant the trajectory of a top with another spin or another tilt at the start."""

    def change(body: Body, top: Top) -> Body:
        angle = tilt(math.radians(float(top.theta0_deg or 0)))
        rates = [float(top.thetadot0), float(top.psidot0) * math.sin(angle), float(top.r0) * r0]
        state = np.array([math.cos(angle / 2), math.sin(angle / 2), 0, 0, *rates])
        return body._replace(state=state)

    return of_body(change)


def of_turn(change: Callable[[Rotation], Rotation]) -> Plant:
    """Plant the right trajectory with another attitude."""
    return lambda top: {"quaternion": quaternion(change(run(Body.of(top))[0]))}


def of_frames(axes: Array) -> Plant:
    """Plant the right trajectory in other axes of space and body, right-handed or left-handed."""
    return of_turn(lambda x: Rotation.from_matrix(axes @ x.as_matrix() @ axes.T))


def of_angles(change: Callable[[Array, Array, Array], tuple[Array, Array, Array]]) -> Plant:
    """Plant the right trajectory with other angles."""
    return lambda top: dict(zip(("theta", "phi", "psi"), change(*angles(top)), strict=True))


def of_times(change: Callable[[Array, Array], tuple[Array, Array]]) -> Plant:
    """Plant the right trajectory with other times, or rows."""

    def plant(top: Top) -> dict[str, Any]:
        t, q = change(T, quaternion(run(Body.of(top))[0]))
        return {"t": t, "quaternion": q}

    return plant


def backwards(top: Top) -> dict[str, Any]:
    """Plant the motion before the start."""
    rates = {"r0": -top.r0, "thetadot0": -top.thetadot0, "psidot0": -top.psidot0}
    body = Body.of(top.replace(**rates))  # its mirror image runs forwards
    turn, _ = run(body)
    return {"quaternion": quaternion(turn)}


def in_space(top: Top) -> dict[str, Any]:
    turn, rates = run(Body.of(top))
    return {"quaternion": quaternion(turn), "rates": turn.apply(rates)}


PLANTED: dict[str, tuple[Plant, str]] = {
    "no gyroscopic term": (of_body(lambda x, _: x._replace(C=x.A)), "gyroscopic term"),
    "moments exchanged": (of_body(lambda x, _: x._replace(A=x.C, C=x.A)), "A and C are exchanged"),
    "A about the centre": (of_top(A=lambda x: x.A - x.m * x.s**2), "A - m s^2"),
    "A about the pivot": (of_top(A=lambda x: x.A + x.m * x.s**2), "A + m s^2"),
    "-r0": (started(-1), "r0 has the wrong sign"),
    "r0 as degrees": (started(math.pi / 180), "r0 in radians was taken as degrees"),
    "r0 in degrees": (started(180 / math.pi), "r0 in degrees was taken as radians"),
    "r0 as rpm": (started(math.pi / 30), "r0 in radians was taken as rpm"),
    "r0 in rpm": (started(30 / math.pi), "r0 in rpm was taken as radians"),
    "r0 as phi'": (
        of_top(r0=lambda x: x.r0 + x.psidot0 * math.cos(math.radians(float(x.theta0_deg or 0)))),
        "r0 was taken as the gimbal's rate",
    ),
    "-psidot0": (of_top(psidot0=lambda x: -x.psidot0), "psidot0 has the wrong sign"),
    "-thetadot0": (of_top(thetadot0=lambda x: -x.thetadot0), "thetadot0 has the wrong sign"),
    "-theta0": (started(tilt=lambda x: -x), "theta0 has the wrong sign"),
    "theta0 as degrees": (started(tilt=math.radians), "theta0 in radians was taken as degrees"),
    "theta0 in degrees": (started(tilt=math.degrees), "theta0 in degrees was taken as radians"),
    "no gravity": (of_body(lambda x, _: x._replace(torque=0.0)), "g is 0"),
    "gravity upwards": (of_body(lambda x, _: x._replace(torque=-x.torque)), "g points upwards"),
    "g in cm": (of_body(lambda x, _: x._replace(torque=100 * x.torque)), "g is 981"),
    "conjugate": (of_turn(lambda x: x.inv()), "conjugate"),
    "xyzw": (
        lambda top: {"quaternion": run(Body.of(top))[0].as_quat()},
        "the quaternion is xyzw and was read as wxyz",
    ),
    "phi and psi": (of_angles(lambda theta, phi, psi: (theta, psi, phi)), "phi and psi are exch"),
    "-phi": (of_angles(lambda theta, phi, psi: (theta, -phi, psi)), "phi is counted backwards"),
    "-psi": (of_angles(lambda theta, phi, psi: (theta, phi, -psi)), "psi is counted backwards"),
    "rates in space": (in_space, "--rates-frame space"),
    "y axes": (of_frames(TO_Y), "--align axis=y,up=y"),
    "Unity": (of_frames(UNITY), "--align up=y,left"),
    "Unreal": (of_frames(UNREAL), "--align left"),
    "clock": (of_times(lambda t, q: (t + 0.0123, q)), "the clock is shifted by 0.0123"),
    "next row": (
        of_times(lambda t, q: (t[:-1], q[1:])),
        "rows are off by one: each holds the stat",
    ),
    "previous row": (of_times(lambda t, q: (t[1:], q[:-1])), "of the previous time"),
    "reversed time": (of_times(lambda t, q: (-t, q)), "time runs backwards"),
}
"""Thirty mistakes: what is planted, and a part of the name."""

OTHERS: dict[str, Plant] = {
    "C 2 % off": of_body(lambda x, _: x._replace(C=1.02 * x.C)),
    "m 2 % off": of_body(lambda x, _: x._replace(torque=1.02 * x.torque)),
    "a fast clock": of_times(lambda t, q: (1.01 * t, q)),
}
"""Mistakes that are not in the list, so that no cause may be named."""

FORMS: dict[str, Callable[[Rotation, Array], dict[str, Any]]] = {
    "quaternion": lambda turn, rates: {"quaternion": quaternion(turn), "rates": rates},
    "float32": lambda turn, _: {"quaternion": quaternion(turn).astype(np.float32)},
    "4 digits": lambda turn, _: {"matrix": np.round(turn.as_matrix(), 4)},
    "6 digits": lambda turn, _: {"quaternion": np.round(-quaternion(turn), 6)},
    "angles": lambda turn, _: dict(
        zip(("psi", "theta", "phi"), turn.as_euler("ZXZ").T, strict=True)
    ),
    "axis": lambda turn, _: {"axis": turn.as_matrix()[:, :, 2]},
    "rotvec": lambda turn, _: {"rotvec": turn.as_rotvec()},
    "backwards": lambda turn, _: {"t": T[::-1], "quaternion": quaternion(turn)[::-1]},
    "irregular": lambda turn, _: {"t": T[::7] + 0, "quaternion": quaternion(turn)[::7]},
    "rates in space": lambda turn, rates: {
        "quaternion": quaternion(turn),
        "rates": turn.apply(rates),
        "rates_frame": "space",
    },
}


def result(top: Top, given: dict[str, Any]) -> Any:
    t = given.pop("t", T)
    return compare(top, t, **given)


@pytest.mark.parametrize("method", ["DOP853", "LSODA"])
@pytest.mark.parametrize("form", FORMS)
@pytest.mark.parametrize("top", TOPS)
def test_a_right_trajectory_is_fine(top: str, form: str, method: str) -> None:
    found = result(TOPS[top], FORMS[form](*run(Body.of(TOPS[top]), method)))
    assert found.verdict == "fine"


@pytest.mark.parametrize("mistake", PLANTED)
@pytest.mark.parametrize("top", TOPS)
def test_a_planted_mistake_is_named(top: str, mistake: str) -> None:
    plant, name = PLANTED[mistake]
    found = result(TOPS[top], plant(TOPS[top]))
    assert found.verdict != "fine"
    assert name in (found.cause or "")


@pytest.mark.parametrize("mistake", OTHERS)
@pytest.mark.parametrize("top", TOPS)
def test_no_cause_is_named_wrongly(top: str, mistake: str) -> None:
    found = result(TOPS[top], OTHERS[mistake](TOPS[top]))
    assert found.verdict != "fine"
    assert found.cause is None


if __name__ == "__main__":
    raise SystemExit(pytest.main([__file__, "-q", "-m", ""]))
