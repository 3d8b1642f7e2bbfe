"""Causes of errors, and the table of mistakes: each row is another top."""

from __future__ import annotations

import math
from contextlib import suppress
from fractions import Fraction
from functools import partial
from typing import Any, NamedTuple

from ..arithmetic import rotations
from ..errors import LagtopError, joined
from ..recordings.misreadings import Misreading
from ..recordings.recording import Recording
from ..solver.solve import solve
from ..top.top import Top
from .differences import ExactMotion
from .numbers import Estimate

OPPOSITE = "r0 has the wrong sign"
"""The mistake that looks like a mirror image."""
_HALF = "the factor 1/2 is missing in the rate of the quaternion"
"""Rates are then half of those of the attitude."""
_ALIKE = 5e-3
"""Greatest relative difference of a and b between a trajectory and a top with estimated inputs."""
_GRAVITY = "0", "9.8", "9.80665", "9.81", "10", "980", "980.665", "981"


class Cause(NamedTuple):
    """What may be wrong with a trajectory: misreadings, another motion, or both."""

    name: str = ""
    misreadings: tuple[Misreading, ...] = ()
    exact: ExactMotion | None = None
    """The motion of another top, or of an engine."""
    error: float = math.inf
    """The greatest error if the cause is corrected."""

    def undone(self, run: Recording) -> Recording:
        """Return the recording as it was meant."""
        for x in self.misreadings:
            run = x.undo(run)
        return run

    @property
    def kinds(self) -> set[str]:
        """What it changes, as in `Misreading`; another motion is a `top`."""
        return {x.kind for x in self.misreadings} | ({"top"} if self.exact else set())

    @property
    def remedy(self) -> str:
        """The arguments that take it into account, marked; or else what to do, in words."""
        return joined(filter(None, (x.remedy for x in self.misreadings)), " and ").marked

    def is_top(self, limit: float) -> bool:
        """Return whether it is another top that leaves an error below a limit."""
        return "engine" not in self.kinds and self.exact is not None and self.error <= limit

    def with_other(self, other: Cause) -> Cause:
        """Return two causes of different kinds as one."""
        name = "; ".join(filter(None, (self.name, other.name)))
        return Cause(name, self.misreadings + other.misreadings, self.exact or other.exact)


def of_clock(name: str, **change: Any) -> Cause:
    """Return a clock with another unit or zero: what `Recording.timed` takes."""
    return Cause(name, (Misreading(name, partial(Recording.timed, **change), kind="clock"),))


def other_tops(top: Top, *, left: bool = False) -> list[Cause]:
    """Return the rows of the table that are tops other than this one.

    `left` says that the frame of the trajectory is left-handed.
    """
    found, numbers = [], top.inputs()
    plain = Top(**numbers)  # A and r0 do not depend on other inputs
    twice = partial(Recording.changed, changes={"rates": lambda x: 2 * x})
    for name, changed in _table(top, left).items():
        turns = {key: changed.pop(key) for key in ("space", "body", "spin") if key in changed}
        rates = (Misreading(name, twice, kind="rates"),) if name == _HALF else ()
        with suppress(LagtopError):  # there is no such top
            other = plain.replace(**changed)
            if turns or other.inputs() != numbers:
                found.append(Cause(name, rates, ExactMotion(solve(other), **turns)))
    return found


def estimated(top: Top, seen: Estimate) -> list[Cause]:
    """Return causes with one input of the top changed, so that its axis moves as the estimated."""
    found, inputs = [], top.inputs()
    for name, key, ratio in (
        ("m, g or s", "g", seen.a),
        ("C", "C", seen.b),
        ("A", "A", seen.b and 1 / seen.b),
        ("r0", "r0", seen.b),
    ):
        if not ratio or not 0 < ratio < math.inf:
            continue
        said = f"{percent(ratio)} {'larger' if ratio > 1 else 'smaller'} than given"
        said = said if 0.5 < ratio < 2 else f"wrong by a factor of {ratio:.4g}"
        with suppress(LagtopError):
            other = Top(**inputs | {key: inputs[key] * ratio})
            if seen.is_near(other, share=_ALIKE):
                found.append(Cause(f"{name} is {said}", exact=ExactMotion(solve(other))))
    return found


def percent(ratio: float) -> str:
    """Return how far a ratio is from 1."""
    off = 100 * abs(ratio - 1)
    return f"{off:.{1 if off > 0.99 else 3}f} %"


def _table(top: Top, left: bool) -> dict[str, dict[str, Any]]:
    """Return what is wrong, and the inputs as an engine has them, or turns of its motion."""
    A, C, r0, psidot = Fraction(top.A), Fraction(top.C), float(top.r0), float(top.psidot0)
    steiner = Fraction(top.m) * Fraction(top.s) ** 2
    tilt, rate = float(top.inputs(radians=True)["theta0_rad"]), float(top.thetadot0)
    folded = math.remainder(math.degrees(tilt), math.tau)
    half = rotations.about_z(math.pi)
    both = {"space": half, "body": half}
    over = {"space": rotations.product(rotations.HALF_TURN_X, half), "body": half}
    mirror = " (in a left-handed frame a positive turn is clockwise)" * left
    euler = "the gyroscopic term is left out"
    found: dict[str, dict[str, Any]] = {
        OPPOSITE + mirror: {"r0": -top.r0},
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
        "the spin r0 is about the vertical": {"r0": r0 * math.cos(tilt), "psidot0": psidot + r0},
        "psidot0 has the wrong sign": {"psidot0": -top.psidot0},
        "psidot0 is left out (as if it were 0)": {"psidot0": 0},
        "thetadot0 is left out (as if it were 0)": {"thetadot0": 0},
        "thetadot0 has the wrong sign": {"thetadot0": -rate},
        "theta0 in radians was taken as degrees": {"theta0_rad": math.radians(tilt)},
        "theta0 is doubled": {"theta0_rad": 2 * tilt},
        "theta0 is halved": {"theta0_rad": tilt / 2},
    }
    lying, factor = {"theta0_rad": math.pi / 2 - tilt}, "(or m or s is wrong by the same factor)"
    if rate:
        found["theta0 and its rate are measured from the horizontal"] = lying
    found |= {f"g is {g} {factor}": {"g": Fraction(g)} for g in _GRAVITY}
    return found | {
        "theta0 has the wrong sign": {"thetadot0": -rate, **both},
        "theta0 in degrees was taken as radians": {
            "theta0_rad": abs(folded),
            "thetadot0": math.copysign(rate, rate * folded),
            **(both if folded < 0 else {}),
        },
        "theta0 is measured from the horizontal": lying | {"thetadot0": -rate},
        "g points upwards": over
        | {"theta0_rad": math.pi - tilt, "psidot0": -psidot, "thetadot0": -rate},
        # A top with the same a and b, which need be no body: its spin differs by a constant rate.
        "A and C are exchanged": {
            "A": top.C,
            "C": top.C,
            "r0": r0 * A / C,
            "spin": r0 * (1 - A / C),
        },
        _HALF: {"A": A / 2, "C": (A + C) / 4}
        | {x: 2 * getattr(top, x) for x in ("r0", "thetadot0", "psidot0")},
    }
