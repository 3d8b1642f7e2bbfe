"""Causes of errors: misreadings of a recording, and mistakes in the inputs of a top."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

from ..arithmetic import rotations
from ..errors import LagtopError
from ..recordings.misreadings import Undo, misreadings
from ..recordings.options import Alignment
from ..recordings.recording import Recording
from ..solver.solve import solve
from ..top.top import Top
from .differences import ExactMotion

_GRAVITY = "0", "9.8", "9.80665", "9.81", "10", "980", "980.665", "981"


class Cause(NamedTuple):
    """A cause of errors: an alignment, a way of writing, other inputs, or two of them."""

    name: str
    undo: Undo | None = None
    """Corrects the recording."""
    exact: ExactMotion | None = None
    """The motion of the other inputs."""
    align: Alignment | None = None
    remedy: str = ""
    """The arguments of `compare` that take the cause into account, marked."""
    error: float = math.inf
    """The greatest error without the cause."""
    of_frame: bool = False
    """Whether the remedy is an alignment."""

    def undone(self, run: Recording) -> Recording:
        """Return the recording as it was meant."""
        return self.undo(run) if self.undo else run

    def with_other(self, other: Cause) -> Cause:
        """Return an alignment or a way of writing, and a cause of another kind, at once."""
        name = "; ".join(filter(None, (self.name, other.name)))
        is_part = self.align is not None and other.of_frame
        both = self.remedy, "" if is_part else other.remedy
        remedy = " and ".join(filter(None, both))
        return Cause(name, self.undo or other.undo, other.exact, self.align, remedy)


def mistakes(top: Top, run: Recording) -> list[Cause]:
    """Return all mistakes, the simplest first."""
    written = [
        (x.kind, Cause(x.name, x.undo, remedy=x.remedy, of_frame=x.kind == "frame"))
        for x in misreadings(run)
    ]
    units = [x for kind, x in written if kind in {"clock", "rates"}]
    others = [x for kind, x in written if kind not in {"clock", "rates"}]
    return [*units, *other_tops(top, run), *others]


def other_tops(top: Top, run: Recording) -> Iterator[Cause]:
    """Yield mistakes in the inputs, each with the motion that follows from it."""
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
        undo = partial(Recording.changed, changes={"rates": lambda x: 2 * x})
        yield Cause("the factor 1/2 is missing in the rate of the quaternion", undo, twice)
