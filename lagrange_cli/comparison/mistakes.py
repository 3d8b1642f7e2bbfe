"""Causes of errors, and the table of mistakes: each row is another top."""

from __future__ import annotations

import math
from collections.abc import Iterator
from contextlib import suppress
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

from ..arithmetic import rotations
from ..errors import LagtopError
from ..recordings.misreadings import Misreading, misreadings
from ..recordings.options import Alignment
from ..recordings.recording import Recording
from ..solver.solve import solve
from ..top.top import Top
from .differences import ExactMotion
from .numbers import Estimate, a_and_b

_GRAVITY = "0", "9.8", "9.80665", "9.81", "10", "980", "980.665", "981"
_HALF = "the factor 1/2 is missing in the rate of the quaternion"
"""A row whose angular velocity is half of that of the attitude."""
Changes = dict[str, Any]
"""The inputs of another top, and turns of its motion (`space`, `body`, `spin`)."""


class Cause(NamedTuple):
    """A cause of errors: a misreading, an alignment, another top, or several of them."""

    name: str
    misreading: Misreading | None = None
    exact: ExactMotion | None = None
    """The motion of another top."""
    align: Alignment | None = None
    words: tuple[Alignment, ...] = ()
    """The alignments that may be typed."""
    error: float = math.inf
    """The greatest error without the cause."""

    @property
    def kind(self) -> str:
        """What it changes, as in `Misreading`; of another top, `top`."""
        return "top" if self.exact or not self.misreading else self.misreading.kind

    def undone(self, run: Recording) -> Recording:
        """Return the recording as it was meant."""
        run = self.misreading.undo(run) if self.misreading else run
        return run.read_as(align=self.align) if self.align else run

    def with_other(self, other: Cause) -> Cause:
        """Return a misreading or an alignment, and a cause of another kind, at once."""
        name = "; ".join(filter(None, (self.name, other.name)))
        first, second = self.misreading, other.misreading
        if first and second:
            remedy = " and ".join(filter(None, (first.remedy, second.remedy)))
            undo = partial(lambda x, y, run: y(x(run)), first.undo, second.undo)
            first = first._replace(undo=undo, remedy=remedy)
        return Cause(
            name,
            first or second,
            self.exact or other.exact,
            self.align or other.align,
            self.words or other.words,
        )


def written(run: Recording) -> list[Cause]:
    """Return the misreadings of a recording, the simplest first."""
    return [Cause(x.name, x) for x in misreadings(run)]


def clocks() -> Iterator[Cause]:
    """Yield steps of an engine that are longer or shorter than its times say."""
    for word, factor in (("twice", 2.0), ("half", 0.5)):
        name = f"a step of the engine is {word} as long as the times say"
        undo = partial(Recording.timed, factor=factor)
        yield Cause(name, Misreading(name, undo, kind="clock"))


def other_tops(top: Top, *, left: bool) -> list[Cause]:
    """Return the rows of the table that are tops other than this one.

    `left` says that the frame of the trajectory is left-handed.
    """
    found, numbers = [], top.inputs()
    plain = Top(**numbers)  # A and r0 do not depend on other inputs
    for name, changed in _inputs(top, left).items():
        turns = {key: changed.pop(key) for key in ("space", "body", "spin") if key in changed}
        rates = None
        if name == _HALF:
            twice = partial(Recording.changed, changes={"rates": lambda x: 2 * x})
            rates = Misreading(name, twice, kind="rates")
        with suppress(LagtopError):  # there is no such top
            other = plain.replace(**changed)
            if turns or other.inputs() != numbers:
                found.append(Cause(name, rates, ExactMotion(solve(other), **turns)))
    return found


def is_near(top: Top, clock: float, seen: Estimate, share: float) -> bool:
    """Return whether the axis of a top might move like that of a trajectory."""
    (a, b), axis = a_and_b(top), seen.axis
    a, b = a * clock**2, b * clock
    share += 3 * axis.residual
    is_near_a = abs(a - axis.a) <= share * max(a, axis.a) + axis.a_spread
    off = abs(abs(b) - abs(axis.b))
    return is_near_a and off <= share * max(abs(b), abs(axis.b)) + axis.b_spread


def estimated_tops(top: Top, seen: Estimate) -> Iterator[Cause]:
    """Yield tops with one input changed as the estimate says."""
    inputs = top.inputs()
    for name, key, ratio in (
        ("m, g or s", "g", seen.a),
        ("C", "C", seen.b),
        ("A", "A", seen.b and 1 / seen.b),
        ("r0", "r0", seen.b),
    ):
        if not ratio or not 0 < ratio < math.inf:
            continue
        percent = 100 * abs(ratio - 1)
        said = f"{percent:.{1 if percent > 0.99 else 3}f} % {'more' if ratio > 1 else 'less'}"
        said = said if 0.5 < ratio < 2 else f"wrong by a factor of {ratio:.4g}"
        with suppress(LagtopError):
            other = Top(**inputs | {key: inputs[key] * ratio})
            yield Cause(f"{name} is {said}", exact=ExactMotion(solve(other)))


def _inputs(top: Top, left: bool) -> dict[str, Changes]:
    """Return the table: what is wrong, and the inputs as an engine has them."""
    A, C, r0, psidot = Fraction(top.A), Fraction(top.C), float(top.r0), float(top.psidot0)
    steiner = Fraction(top.m) * Fraction(top.s) ** 2
    tilt, rate = float(top.inputs(radians=True)["theta0_rad"]), float(top.thetadot0)
    mirror = " (in a left-handed frame a positive turn is clockwise)" * left
    folded, ratio = math.remainder(math.degrees(tilt), math.tau), A / C
    half = rotations.about_z(math.pi)
    both: Changes = {"space": half, "body": half}
    over: Changes = {"space": rotations.product(rotations.HALF_TURN_X, half), "body": half}
    over |= {"theta0_rad": math.pi - tilt, "psidot0": -psidot, "thetadot0": -rate}
    euler = "the gyroscopic term is left out"
    return {
        f"r0 has the wrong sign{mirror}": {"r0": -top.r0},
        f"{euler} of Euler's equations (as if C = A)": {"C": top.A},
        f"{euler} about the centre of mass, as engines do (as if C = A - m s^2)": {
            "C": A - steiner
        },
        "the gyroscopic term has the wrong sign (as if C = 2A - C)": {"C": 2 * A - C},
        "the gyroscopic term is halved (as if C = (A + C)/2)": {"C": (A + C) / 2},
        "gravity acts twice": {"g": 2 * top.g},
        "gravity is halved": {"g": top.g / 2},
        "g is that of the Moon": {"g": Fraction(162) if top.g > 100 else Fraction(162, 100)},
        "A about the pivot was taken as A about the centre of mass (A + m s^2)": {"A": A + steiner},
        "A about the centre of mass was taken as A about the pivot (A - m s^2)": {"A": A - steiner},
        "r0 in radians was taken as degrees": {"r0": math.radians(r0)},
        "r0 in degrees was taken as radians": {"r0": math.degrees(r0)},
        "r0 in radians was taken as rpm": {"r0": r0 * math.pi / 30},
        "r0 in rpm was taken as radians": {"r0": r0 * 30 / math.pi},
        "r0 was taken as the gimbal's rate phi'": {"r0": r0 + psidot * math.cos(tilt)},
        "the spin r0 is about the vertical": {
            "r0": r0 * math.cos(tilt),
            "psidot0": psidot + r0,
        },
        "psidot0 has the wrong sign": {"psidot0": -top.psidot0},
        "psidot0 is left out (as if it were 0)": {"psidot0": 0},
        "thetadot0 is left out (as if it were 0)": {"thetadot0": 0},
        "thetadot0 has the wrong sign": {"thetadot0": -rate},
        "theta0 in radians was taken as degrees": {"theta0_rad": math.radians(tilt)},
        "theta0 is doubled": {"theta0_rad": 2 * tilt},
        "theta0 is halved": {"theta0_rad": tilt / 2},
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
        "theta0 and its rate are measured from the horizontal": {
            "theta0_rad": math.pi / 2 - tilt,
        },
        "g points upwards": over,
        # A top with the same a and b, which need be no body: its spin differs by a constant rate.
        "A and C are exchanged": {
            "A": top.C,
            "C": top.C,
            "r0": Fraction(top.r0) * ratio,
            "spin": float(Fraction(top.r0) * (1 - ratio)),
        },
        _HALF: {"A": A / 2, "C": (A + C) / 4}
        | {x: 2 * getattr(top, x) for x in ("r0", "thetadot0", "psidot0")},
    }
