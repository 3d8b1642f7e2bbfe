"""Mistakes of engines and students, in the notation of a trajectory or in the inputs of a top."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator, Mapping
from contextlib import suppress
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError, arg
from ..files import rotations
from ..files.observed import ORDERS
from ..names import ANGLES
from ..solver.solve import solve
from ..top.top import Top
from .differences import Alignment, ExactMotion, Run

_GRAVITY = "0", "9.8", "9.80665", "9.81", "10", "980", "980.665", "981"
_UNITS = {"ms": 1e-3, "us": 1e-6, "ns": 1e-9, "minutes": 60.0}
_FRAME_RATES = (24, 25, 30, 48, 50, 60, 90, 100, 120, 200, 240, 250, 480, 500, 960)
Undo = Callable[[Run], Run]
"""Returns a trajectory as it was meant."""


class Cause(NamedTuple):
    """A cause of errors: an alignment, a way of writing, other inputs, or two of them."""

    name: str
    undo: Undo | None = None
    """Corrects the trajectory."""
    exact: ExactMotion | None = None
    """The motion of the other inputs."""
    align: Alignment | None = None
    remedy: str = ""
    """The arguments of `compare` that take the cause into account, marked."""
    error: float = math.inf
    """The greatest error without the cause."""

    def undone(self, run: Run) -> Run:
        """Return the trajectory as it was meant."""
        return self.undo(run) if self.undo else run

    def with_other(self, other: Cause) -> Cause:
        """Return an alignment or a way of writing, and a cause of another kind, at once."""
        name = "; ".join(filter(None, (self.name, other.name)))
        remedy = " and ".join(filter(None, (self.remedy, other.remedy)))
        return Cause(name, self.undo or other.undo, other.exact, self.align, remedy)


def mistakes(top: Top, run: Run) -> list[Cause]:
    """Return all mistakes, the simplest first."""
    backwards = Cause("time runs backwards", partial(Run.timed, factor=-1.0))
    others = [*_of_units(run), *_of_inputs(top, run), *_of_writing(run)]
    return [backwards, *others] if run.t[0] > run.t[-1] else [*others, backwards]


def _changed(changes: Mapping[str, Callable[[Array], Array]], run: Run) -> Run:
    return run._replace(given={x: changes.get(x, np.asarray)(y) for x, y in run.given.items()})


def _of_units(run: Run) -> Iterator[Cause]:
    factors = {f"t is in {x}": y for x, y in _UNITS.items()}
    if (run.t == np.rint(run.t)).all():
        factors |= {f"t counts frames, {x} per second": 1 / x for x in _FRAME_RATES}
    for name, factor in factors.items():
        yield Cause(name, partial(Run.timed, factor=factor))
    if {"rates", "angle_rates"} & run.given.keys():
        undo = partial(_changed, dict.fromkeys(("rates", "angle_rates"), np.radians))
        yield Cause("the rates are in degrees per unit of time", undo)


def _of_inputs(top: Top, run: Run) -> Iterator[Cause]:
    A, C, r0 = Fraction(top.A), Fraction(top.C), float(top.r0)
    steiner = Fraction(top.m) * Fraction(top.s) ** 2
    tilt, rate = float(top.inputs(radians=True)["theta0_rad"]), float(top.thetadot0)
    left = " (in a left-handed frame a positive turn is clockwise)" * run.align.left
    folded, ratio = math.remainder(math.degrees(tilt), math.tau), A / C
    half = rotations.about_z(math.pi)
    both: dict[str, Any] = {"space": half, "body": half}
    over: dict[str, Any] = {"space": rotations.product(rotations.HALF_TURN_X, half), "body": half}
    over |= {"theta0_rad": math.pi - tilt, "psidot0": -top.psidot0, "thetadot0": -rate}
    inputs: dict[str, dict[str, Any]] = {
        f"r0 has the wrong sign{left}": {"r0": -top.r0},
        "the gyroscopic term is left out of Euler's equations (as if C = A)": {"C": top.A},
        "the gyroscopic term has the wrong sign (as if C = 2A - C)": {"C": 2 * A - C},
        "the gyroscopic term is halved (as if C = (A + C)/2)": {"C": (A + C) / 2},
        "A about the pivot was taken as A about the centre of mass (A + m s^2)": {"A": A + steiner},
        "A about the centre of mass was taken as A about the pivot (A - m s^2)": {"A": A - steiner},
        "r0 in radians was taken as degrees": {"r0": math.radians(r0)},
        "r0 in degrees was taken as radians": {"r0": math.degrees(r0)},
        "r0 in radians was taken as rpm": {"r0": r0 * math.pi / 30},
        "r0 in rpm was taken as radians": {"r0": r0 * 30 / math.pi},
        "r0 was taken as the gimbal's rate phi'": {"r0": r0 + float(top.psidot0) * math.cos(tilt)},
        "psidot0 has the wrong sign": {"psidot0": -top.psidot0},
        "psidot0 is left out (as if it were 0)": {"psidot0": 0},
        "thetadot0 is left out (as if it were 0)": {"thetadot0": 0},
        "thetadot0 has the wrong sign": {"thetadot0": -rate},
        "theta0 in radians was taken as degrees": {"theta0_rad": math.radians(tilt)},
        **{
            f"g is {g} (or m or s is wrong by the same factor)": {"g": Fraction(g)}
            for g in _GRAVITY
        },
        "theta0 has the wrong sign": {"thetadot0": -rate} | both,
        "theta0 in degrees was taken as radians": {
            "theta0_rad": abs(folded),
            "thetadot0": math.copysign(rate, rate * folded),
            **(both if folded < 0 else {}),
        },
        "theta0 is measured from the horizontal": {
            "theta0_rad": math.pi / 2 - tilt,
            "thetadot0": -rate,
        },
        "g points upwards": over,
        # A top with the same a and b, which need be no body: its spin differs by a constant rate.
        "A and C are exchanged": {
            "A": top.C,
            "C": top.C,
            "r0": Fraction(top.r0) * ratio,
            "spin": float(Fraction(top.r0) * (1 - ratio)),
        },
    }
    for name, changed in inputs.items():
        turns = {key: changed.pop(key) for key in ("space", "body", "spin") if key in changed}
        with suppress(LagtopError):  # there is no such top
            yield Cause(name, exact=ExactMotion(solve(top.replace(**changed)), **turns))
    faster = {x: 2 * getattr(top, x) for x in ("r0", "thetadot0", "psidot0")}
    with suppress(LagtopError):
        twice = ExactMotion(solve(top.replace(A=A / 2, C=(A + C) / 4, **faster)))
        undo = partial(_changed, {"rates": lambda x: 2 * x})
        yield Cause("the factor 1/2 is missing in the rate of the quaternion", undo, twice)


def _of_writing(run: Run) -> Iterator[Cause]:
    how, order = run.conventions, run.conventions.quaternion or ORDERS[0]
    other = dict(zip([*ORDERS, "body", "space"], [*ORDERS[::-1], "space", "body"], strict=True))
    for key, given, name, now in (
        ("quaternion", "quaternion_order", "the quaternion is {} and was read as {}", order),
        ("rates", "rates_frame", "the rates are in the frame of {}", how.rates),
        ("euler", "euler_sequence", "the Euler angles are in the sequence {}", how.euler),
    ):
        if key in run.given:
            then = other.get(now, now.swapcase())
            meant: dict[str, Any] = {key: then}
            undo = partial(Run._replace, conventions=how._replace(**meant))
            yield Cause(name.format(then, now), undo, remedy=arg(given, then))
    flipped = np.array([1.0 if x == "w" else -1.0 for x in order])
    unit = np.radians if how.radians else np.degrees
    changes: dict[str, dict[str, Callable[[Array], Array]]] = {
        "the attitude is the conjugate, from space to body": {
            "quaternion": lambda q: q * flipped,
            "matrix": lambda rows: rows.reshape(-1, 3, 3).transpose(0, 2, 1).reshape(-1, 9),
            "rotvec": np.negative,
        },
        "angles in degrees were taken as radians, or the reverse": dict.fromkeys(
            (*ANGLES, "euler"), unit
        ),
        "theta is measured from the horizontal": {"theta": lambda x: math.pi / 2 - x},
        "psi is counted backwards": {"psi": np.negative},
        "phi is counted backwards": {"phi": np.negative},
    }
    for name, changed in changes.items():
        if changed.keys() & run.given.keys():
            yield Cause(name, partial(_changed, changed))
    if {"phi", "psi"} <= run.given.keys():
        yield Cause("phi and psi are exchanged", _exchanged)
    for word, later in (("next", slice(1, None)), ("previous", slice(0, -1))):
        moved = partial(_moved, times=later)
        yield Cause(f"rows are off by one: each holds the state of the {word} time", moved)


def _exchanged(run: Run) -> Run:
    return run._replace(given={**run.given, "phi": run.given["psi"], "psi": run.given["phi"]})


def _moved(run: Run, times: slice) -> Run:
    """Return a trajectory with the states of other times: the first, or the last, is left out."""
    states = slice(0, -1) if times.start else slice(1, None)
    return run._replace(given={x: y[times if x == "t" else states] for x, y in run.given.items()})
