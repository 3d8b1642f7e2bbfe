"""Known inputs of a fit: conditions on a motion, which are compared with it and then obeyed.

The parameters of a motion that was fitted without known inputs, and the uncertain ones among these,
are one vector with one covariance.  What the recording and the other inputs give for a known input
is compared with it.  If all agree, the motion is fitted again so that it meets them, and the
covariance shrinks to the directions in which it goes on to do so, as in a Kalman filter.
"""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from ..arithmetic.types import Array
from ..errors import Message, arg
from ..top.inputs import replaced_by
from .known import (
    START,
    WEIGHT,
    Known,
    body_numbers,
    body_of,
    compared,
    in_all_forms,
    scaled_known,
    time_power,
)
from .problem import Ties

_EXACT = 1e-5
"""Standard deviation of an exact input, in units of the period, if the recording alone does not
determine it."""
_HELD = 0.01
"""Its standard deviation over that of what the recording gives for it."""
_MOST_TURNS = 10
"""Turns per row of the spin up to which a known C selects it among those that look alike."""
_SELECTS = 6.0
"""Standard deviations of the spin that C implies, in a turn per row, from which C selects it."""
_VAGUE = 0.5
"""Relative standard deviation of what the recording gives for an input of the body from which the
recording does not determine it."""
Values = Mapping[str, Any]
Function = Callable[[Array], Mapping[str, Array]]
"""Numbers of some vectors by name."""
Estimate = tuple[float, float, float]
"""A number, its standard deviation, and the one if known inputs are exact."""


@np.errstate(invalid="ignore")
def estimates(has: Values, v: Values, *, spins: bool) -> dict[str, Array]:
    """Return what a motion and the other known inputs give for known inputs.

    `has` holds the known inputs, and `spins` is true if the spin is recorded.  A value that no top
    has, such as the root of C < 0, is NaN.
    """
    seen = {x: v[x] for x in (*START, *["r0"] * spins)}
    body = body_of(has, v) | seen
    for name in ("A", "C"):
        others = {x: y for x, y in body.items() if x != name}
        if name in body and (name == "C" or others.keys() >= WEIGHT):
            found = body_numbers(v["a"] / 2, v["b"], others)
            seen |= {name: found[name]} if name in found else {}
    return {
        key: in_all_forms({x: y for x, y in has.items() if x != key} | seen)[key]
        for key in has
        if replaced_by(key) in seen
    }


def ties_of(known: Known, least: Mapping[str, float] | None, *, spins: bool) -> Ties:
    """Return the distances of a motion from known inputs, in standard deviations.

    Only those in `least` count if this is given: the standard deviations of exact ones.
    """
    has = {x: np.array(y) for x, (y, _) in known.items() if x != "steady"}

    def off(v: Values, has: Values) -> dict[str, Array]:
        found = estimates(has, v, spins=spins)
        return {x: y - has[x] for x, y in found.items() if least is None or x in least}

    def distances(v: dict[str, Array]) -> Array:
        found = off(v, has)
        squares: dict[str, Any] = {x: (least or {}).get(x, _EXACT) ** 2 for x in found}
        for name, value in has.items():
            if std := known[name][1]:
                moved = off(v, {**has, name: value + std})
                squares = {x: y + (moved[x] - found[x]) ** 2 for x, y in squares.items()}
        columns = [y / np.sqrt(squares[x]) + 0 * v["a"] for x, y in found.items()]
        return np.stack(columns, axis=-1) if columns else np.zeros((*v["a"].shape, 0))

    return distances


class Vector:
    """The parameters of a motion and the uncertain known inputs, with one covariance.

    The motion is a `Minimum`, or the `Means` of a steady precession.
    """

    def __init__(self, best: Any, known: Known) -> None:
        self.best, self.known = best, {x: y for x, y in known.items() if x != "steady"}
        self.uncertain = [x for x, (_, std) in self.known.items() if std]
        stds = [self.known[x][1] for x in self.uncertain]
        self.z = np.concatenate([best.x, [self.known[x][0] for x in self.uncertain]])
        count, axes = best.spread.shape
        self.spread = np.zeros((count + len(stds), axes + len(stds)))
        self.spread[:count, :axes], self.spread[count:, axes:] = best.spread, np.diag(stds)
        self.conditions = 0
        """The number of conditions that the motion obeys."""

    def motion(self, at: Array) -> dict[str, Array]:
        """Return the quantities of motions, shape (tries,)."""
        found: dict[str, Array] = self.best.quantities(at[:, : self.best.x.size], self.inputs(at))
        return found

    def inputs(self, at: Array) -> dict[str, Array]:
        """Return the known inputs, shape (tries,)."""
        has = {x: np.full(len(at), y) for x, (y, _) in self.known.items()}
        return has | {x: at[:, self.best.x.size + i] for i, x in enumerate(self.uncertain)}

    def body(self, at: Array) -> dict[str, Array]:
        """Return the inputs of the body and r0, shape (tries,), that known inputs determine."""
        return body_of(self.inputs(at), self.motion(at))

    def estimates(self, at: Array) -> dict[str, Array]:
        """Return what the motion and the other known inputs give for known inputs."""
        return estimates(self.inputs(at), self.motion(at), spins=self.best.spins)

    def off(self, names: Collection[str]) -> Function:
        """Return the function that compares some of these with the known inputs."""

        def found(at: Array) -> dict[str, Array]:
            has = self.inputs(at)
            return {x: y - has[x] for x, y in self.estimates(at).items() if x in names}

        return found

    def here(self, function: Function) -> dict[str, Any]:
        """Return numbers of the vector itself."""
        return {x: y[0] for x, y in function(self.z[np.newaxis]).items()}

    def slopes(self, function: Function, z: Array) -> Array:
        """Return the derivatives of functions, by a share of the standard deviations."""
        steps = np.maximum(1e-2 * np.linalg.norm(self.spread, axis=1), 1e-9 * (np.abs(z) + 1e-3))
        found = _stacked(function, np.concatenate([z + np.diag(steps), z - np.diag(steps)]))
        with np.errstate(invalid="ignore"):  # of numbers that are infinite
            return np.asarray((found[: z.size] - found[z.size :]).T / (2 * steps))

    def numbers(self, function: Function) -> dict[str, Estimate]:
        """Return finite functions of the vector, with standard deviations."""
        if not (names := [*function(self.z[np.newaxis])]):
            return {}
        rise = self.slopes(function, self.z) @ self.spread
        inputs, _ = np.linalg.qr(self.spread[self.best.x.size :].T)
        own = np.linalg.norm(rise - rise @ inputs @ inputs.T, axis=1)
        values, stds = _stacked(function, self.z[np.newaxis])[0], np.linalg.norm(rise, axis=1)
        found = zip(names, values.tolist(), stds.tolist(), own.tolist(), strict=True)
        return {x: (y, z, w) for x, y, z, w in found if np.isfinite([y, z, w]).all()}

    def conditioned(self, function: Function) -> None:
        """Move to the nearest vector at which functions vanish, and keep the spread along it."""
        at = self.z
        for _ in range(4):
            rise = self.slopes(function, at)
            gain = np.linalg.pinv(rise @ self.spread, rcond=1e-10)
            off = _stacked(function, at[np.newaxis])[0] - rise @ (at - self.z)
            at = self.z - self.spread @ gain @ off
        self.z, self.spread = at, self.spread - self.spread @ gain @ rise @ self.spread
        self.conditions = len(rise)


def _stacked(function: Function, at: Array) -> Array:
    return np.stack([y + np.zeros(len(at)) for y in function(at).values()], axis=-1)


@dataclass
class Comparison:
    """A motion with known inputs, which it obeys unless they contradict it."""

    vector: Vector
    notes: list[str] = field(default_factory=list)
    """On known inputs that agree, or are not used."""
    contradictions: list[str] = field(default_factory=list)
    distances: dict[str, float] = field(default_factory=dict)
    """Distances of known inputs from what the recording gives, in standard deviations."""
    free: dict[str, float] = field(default_factory=dict)
    """Standard deviations of a, b and the start without known inputs."""
    is_selected: bool = False
    """Whether a known C selects the spin."""


def compare(best: Any, known: Known, scale: float, turn: float) -> Comparison:
    """Return a motion that was found without known inputs, with all that they say.

    Known inputs are in units of the recording, of which the unit of time of the motion is `scale`.
    If whole turns of the spin per row are invisible, `turn` is their rate, else 0.
    """
    vector, slowest = Vector(best, scaled_known(known, scale)), dict[str, Estimate]()
    found, given = Comparison(vector), vector.numbers(vector.estimates)
    found.free = {x: std for x, (_, std, _) in vector.numbers(vector.motion).items()}
    if turn and best.spins:
        shift, is_sure = _shift(vector, turn)
        if not is_sure:
            given = {x: y for x, y in given.items() if replaced_by(x) != "C"}
            unused = "known C is not used: it does not show how many turns per row the spin makes"
            found.notes.append(unused)
        if shift:
            vector, slowest = Vector(best.turned(shift), vector.known), given
            found.vector, given, found.is_selected = vector, vector.numbers(vector.estimates), True
    for name, (value, std, _) in given.items():
        if replaced_by(name) not in START and std > _VAGUE * abs(value):
            continue
        size = scale ** time_power(name)
        other = slowest[name][0] * size if name in slowest else None
        text = compared(name, known[name], (value * size, std * size), known, other)
        found.distances[name] = text[0]
        (found.notes if text[1] else found.contradictions).append(text[2])
    if "steady" in known:
        steady = "known psidot0 = steady contradicts the recording, which nutates: omit "
        found.contradictions.append(Message(steady + arg("psidot0")))
    if given and not found.contradictions:
        off = vector.off(given)
        least = {x: _HELD * std + 1e-12 for x, (_, std, _) in vector.numbers(off).items()}
        ties = ties_of(vector.known, least, spins=best.spins)
        found.vector = Vector(vector.best.tied(ties), vector.known)
        found.vector.conditioned(found.vector.off(given))
    return found


def _shift(vector: Vector, turn: float) -> tuple[float, bool]:
    """Return the whole turns per row to the r0 that known inputs imply, 0 if they imply none.

    Without a known spin, a C selects one of the spins that look alike if b is known well enough:
    if not, the second value is false.
    """

    def implied(at: Array) -> dict[str, Array]:
        body, v = vector.body(at), vector.motion(at)
        found = body if "r0" in body else body_numbers(v["a"] / 2, v["b"], body)
        return {x: found[x] for x in ("r0",) if x in found}

    value, std, _ = vector.numbers(implied).get("r0", (0.0, 0.0, 0.0))
    if "r0" not in vector.here(vector.body):
        if not value or abs(value) > _MOST_TURNS * turn:
            return 0.0, True
        if abs(value) > turn / 2 and std * _SELECTS > turn:
            return 0.0, False
    return turn * round((value - vector.here(vector.motion)["r0"]) / turn), True
