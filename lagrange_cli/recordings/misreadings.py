"""Misreadings of a recording: each with its name, what undoes it, and what to type."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from functools import partial
from typing import Any, NamedTuple

import numpy as np

from ..errors import arg
from ..names import ANGLES
from ..top.units import unit_of_text
from .clocks import even_times
from .options import OPTION_OF
from .recording import Recording

_UNITS = {x: float(unit_of_text(x).size) for x in ("ms", "us", "ns", "minutes", "s", "0.1 ms")}
_FRAME_RATES = (24, 25, 30, 48, 50, 60, 90, 100, 120, 200, 240, 250, 480, 500, 960)
_OTHER = {"wxyz": "xyzw", "xyzw": "wxyz", "body": "space", "space": "body"}
_RATES, _ANGLES = {"rates", "angle_rates"}, {*ANGLES, "euler"}
_TAKEN = "the angles are in {} and were taken as {}"
_NAME = "give their columns names such as theta_{}"
_FROM = "theta is measured from the {}"
BACKWARDS = "time runs backwards"
Undo = Callable[[Recording], Recording]
"""Returns a recording as it was meant."""


class Misreading(NamedTuple):
    """A mistake in the reading of a recording."""

    name: str
    undo: Undo
    remedy: str = ""
    """The argument that takes it into account, marked; or else what to do, in words."""
    kind: str = "attitude"
    """What it changes: the `clock`, the `rates`, the `attitude`, its `frame`, `scale` or
    `sense`, or the `rows`."""


def misreadings(recording: Recording) -> list[Misreading]:
    """Return what may have been misread in a recording, the simplest first."""
    backwards = Misreading(BACKWARDS, partial(Recording.timed, factor=-1.0), kind="sense")
    found = [*_of_clock(recording), *_of_conventions(recording), *_of_numbers(recording)]
    is_falling = recording.t[0] > recording.t[-1]
    return [backwards._replace(kind="clock"), *found] if is_falling else [*found, backwards]


def _of_clock(recording: Recording) -> Iterator[Misreading]:
    size, heading = recording.source.time_size, "write the unit into its heading: t [{}]"
    found = {x: (y / size, heading.format(x)) for x, y in _UNITS.items() if y != size}
    factors = {f"t is in {x}": y for x, y in found.items()}
    if recording.reading.dt is None and (recording.t == np.rint(recording.t)).all():
        frames = {x: f"t counts frames, {x} per second" for x in _FRAME_RATES}
        factors |= {name: (1 / x, arg("fps", x)) for x, name in frames.items()}
    step = "a step of the engine is {} as long as the times say".format
    factors |= {step("twice"): (2.0, ""), step("half"): (0.5, "")}
    for name, (factor, remedy) in factors.items():
        yield Misreading(name, partial(Recording.timed, factor=factor), remedy, "clock")
    if even_times(recording.t) is not None:
        yield Misreading("t is rounded", evenly_timed, "write it with more digits", "rows")


def _of_conventions(recording: Recording) -> Iterator[Misreading]:
    """Yield other values of the options."""
    for key, name in (
        ("quaternion", "the quaternion is {} and was read as {}"),
        ("rates", "the rates are in the {} frame"),
        ("euler", "the Euler angles are in the sequence {}"),
    ):
        option = OPTION_OF[key]
        if key in recording.given:
            now = getattr(recording.reading, option)
            then = _OTHER.get(now, now.swapcase())
            undo: Any = partial(Recording.read_as, **{option: then})
            kind = "sense" if key == "rates" else "attitude"
            yield Misreading(name.format(then, now), undo, arg(option, then), kind)
    if {"quaternion", "matrix", "rotvec", "euler"} & recording.given.keys():
        align = recording.align._replace(conjugate=not recording.align.conjugate)
        name = "the attitude is the conjugate, from space to body"
        undo = partial(Recording.read_as, align=align)
        yield Misreading(name, undo, arg("align", align), "frame")


def _of_numbers(recording: Recording) -> Iterator[Misreading]:
    """Yield other meanings of the numbers."""
    given, theta, scale = recording.given.keys(), {"theta"}, _scale(recording)
    up, elevated = partial(np.subtract, math.pi / 2), "elevation" in " ".join(recording.source.used)
    names = ("vertical", "theta") if elevated else ("horizontal", "elevation")
    for keys, change, kind, name, remedy in (
        (_RATES, np.radians, "rates", "the rates are in degrees per unit of time", ""),
        (_ANGLES, np.radians, "scale", _TAKEN.format("degrees", "radians"), _NAME.format("deg")),
        (_ANGLES, np.degrees, scale, _TAKEN.format("radians", "degrees"), _NAME.format("rad")),
        (theta, up, "attitude", _FROM.format(names[0]), f"name its column {names[1]}"),
        ({"psi"}, np.negative, "sense", "psi is counted backwards", ""),
        ({"phi"}, np.negative, "sense", "phi is counted backwards", ""),
    ):
        if given & keys:
            changes: Any = dict.fromkeys(keys, change)
            yield Misreading(name, partial(Recording.changed, changes=changes), remedy, kind)
    if {"phi", "psi"} <= given:
        remedy = "here phi is the spin and psi the precession"
        yield Misreading("phi and psi are exchanged", _exchanged, remedy)
    for word, later in (("next", slice(1, None)), ("previous", slice(0, -1))):
        name = f"rows are off by one: each holds the state of the {word} time"
        yield Misreading(name, partial(_moved, times=later), kind="rows")


def _scale(recording: Recording) -> str:
    """Return `attitude` if angles may be in radians, because they stay within a turn."""
    given = recording.given
    angles = [given[x] for x in ({"theta"} if "theta" in given else _ANGLES & given.keys())]
    is_possible = all(
        np.fmax.reduce(np.abs(np.degrees(x)), axis=None) <= 2 * math.pi for x in angles
    )
    return "attitude" if is_possible else "scale"


def evenly_timed(recording: Recording) -> Recording:
    """Return a recording at even times if its times are rounded."""
    even = even_times(recording.t)
    if even is None:
        return recording
    given = {**recording.given, "t": (even - even[0]).reshape(-1, 1)}
    return recording._replace(given=given, begins=float(even[0]))


def _exchanged(recording: Recording) -> Recording:
    given = recording.given
    return recording._replace(given={**given, "phi": given["psi"], "psi": given["phi"]})


def _moved(recording: Recording, times: slice) -> Recording:
    """Return the states with other times: the first, or the last, is left out."""
    states = slice(0, -1) if times.start else slice(1, None)
    given = {x: y[times if x == "t" else states] for x, y in recording.given.items()}
    return recording._replace(given=given)
