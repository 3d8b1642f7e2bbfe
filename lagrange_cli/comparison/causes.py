"""The search for the causes of an error: each is corrected in turn, and the error computed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cache, partial
from itertools import product

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError, arg
from ..files import rotations
from .differences import Alignment, ExactMotion, Run, angles_of, errors, sizes, start_of
from .mistakes import Cause, Undo, mistakes

EXPLAINS = 0.1
"""Largest share of the error that may remain if a cause explains it."""
_PART = 0.3
"""Largest error that may remain if a cause explains a part."""
_AS_GOOD, _ROUNDING = 2.0, 1e-9
"""Factor between the remaining errors of two causes, and least error, that make no difference."""
_FEW, _SOME, _LEAST = 12, 300, 3
"""Rows on which causes are tried first and then, and the least number of rows."""
_MOST_SHIFTS = 500
_NONE = Cause("")
_AXES = "z", "y", "x", "-z", "-y", "-x"
_FRAMES = [
    *(Alignment(x, x) for x in _AXES[:3]),
    *(Alignment(x, x, left=True) for x in _AXES[:3]),
    *(Alignment(y, x) for x, y in product(_AXES, repeat=2) if x != y),
]
"""All frames with lagtop's axes in another order or direction, the likeliest first.

A right-handed frame with z down is left-handed with z up, except for its zero angles.
"""


def likely_causes(exact: ExactMotion, run: Run, limit: float) -> list[Cause]:
    """Return the cause of an error, and another one that leaves as little, if there is one.

    A cause explains an error if it removes nine tenths.  Of those that bring the error below the
    limit, return the simplest that leaves about as little as the best.  If there is none, try two
    causes at once, each of which must remove nine tenths.  Otherwise return the best cause, which
    explains a part and spoils nothing.
    """
    search = _Search(exact, run, limit)
    if np.isfinite(search.errors(_NONE, _SOME)[0]).sum() < _LEAST:
        return []
    found = next(filter(None, (search.best(*x) for x in search.groups())), [])
    if len(found) == 1 and found[0].align and found[0].align[:3] != run.align[:3]:
        mirrored = search.aligned(search.mistakes, in_other=False)
        found = search.best([*found, *mirrored], limit)
    parts = (x for x in next(search.groups())[0] if not search.spoils(x))
    return found or search.best(parts, _PART)


class _Search:
    def __init__(self, exact: ExactMotion, run: Run, limit: float) -> None:
        self.run, self.given, self.limit = run, exact, limit
        self.mistakes = mistakes(exact.motion.top, run)
        self.tilt = cache(self._tilt)
        self.some = cache(lambda undo: (undo(run) if undo else run).few(_SOME))
        """Returns some rows of the trajectory as it was meant."""
        self.enough = min(EXPLAINS * self.error(_NONE, _SOME), _PART)

    def _tilt(self, undo: Undo | None, frame: Alignment) -> float:
        """Return the tilt of the first row, NaN if it is not known, infinity without a frame."""
        with suppress(LagtopError):  # a frame that needs more than is given
            seen = angles_of(self.some(undo).few(1)._replace(align=frame).observed())
            return float(seen.get("theta", [math.nan])[0])
        return math.inf

    def errors(self, cause: Cause, most: int = 0) -> Array:
        """Return the errors with a cause corrected, on at most `most` rows or on all."""
        run = self.some(cause.undo).few(most) if most else cause.undone(self.run)
        return errors(cause.exact or self.given, run._replace(align=cause.align or run.align))

    def error(self, cause: Cause, most: int = 0) -> float:
        """Return the greatest error without a cause, infinite if no row is finite."""
        worst = np.fmax.reduce(self.errors(cause, most), axis=None)
        return float(worst) if np.isfinite(worst) else math.inf

    def spoils(self, cause: Cause) -> bool:
        """Return whether the attitude, or the rates, are clearly worse without a cause."""
        after, before = (np.fmax.reduce(self.errors(x, _FEW), axis=1) for x in (cause, _NONE))
        return bool((after > np.fmax(2 * before, self.limit)).any())

    def best(self, causes: Iterable[Cause], limit: float) -> list[Cause]:
        """Return the simplest cause that leaves about as little as the best, and another one."""
        enough = min(self.enough, limit)
        found = [x for x in causes if self.error(x, _FEW) <= enough]
        found = [x._replace(error=self.error(x, _SOME)) for x in found]
        bound = max(_AS_GOOD * min((x.error for x in found), default=0.0), _ROUNDING)
        good = [x for x in found if x.error <= min(bound, enough)]
        others = [x for x in good if x[1:3] != good[0][1:3]]  # another mistake
        whole = [x._replace(error=self.error(x)) for x in [*good[:1], *others[:1]]]
        return [x for x in whole if x.error <= enough]

    def groups(self) -> Iterator[tuple[list[Cause], float]]:
        """Yield groups of causes, and the greatest error that each group may leave.

        A group is tried if the one before explains nothing.
        """
        tops = [x for x in self.mistakes if x.exact]
        early = 1 + self.mistakes.index(tops[0])
        same, other = (self.aligned([_NONE], in_other) for in_other in (False, True))
        yield [*same, *self.mistakes[:early], *other, *self.mistakes[early:]], self.limit
        if (self.errors(_NONE, _SOME)[0] > self.limit).any():  # not only the rates are wrong
            span, two = float(np.ptp(self.run.t)), min(EXPLAINS * self.enough, self.limit)
            near = max(self.given.motion.T_nutation or 0.0, 10 * span / self.run.t.size)
            yield self.shifts(near), self.limit
            yield self.shifts(span), self.limit
            yield self.aligned(self.mistakes, in_other=False), two
            yield self.aligned(self.mistakes, in_other=True), two
            yield [x.with_other(y) for x in self.mistakes if not x.exact for y in tops], two

    def aligned(self, causes: Iterable[Cause], in_other: bool) -> list[Cause]:
        """Return each cause with the alignments under which the first row has the exact tilt."""
        found, given = [], self.run.align
        frames = [x for x in _FRAMES if x[:3] != given[:3]] if in_other else [given]
        times = sorted({given.time, given.time or bool(self.run.t[0])})
        for cause in causes:
            run, exact = self.some(cause.undo).few(_FEW), cause.exact or self.given
            for time, start, frame in product(times, sorted({given.start, True}), frames):
                tilt = exact.at(run.t[:1] * (not time))["theta"][0]
                align = frame._replace(start=start, time=time)
                if align != given and not abs(self.tilt(cause.undo, frame) - tilt) > self.enough:
                    found.append(_named(align, exact, run).with_other(cause))
        return found

    def shifts(self, reach: float) -> list[Cause]:
        """Return the shift of the clock, at most about `reach`, that explains most."""
        few = self.run.few(20)
        if self.run.align.start:
            return []

        def error(shifts: Array) -> Array:
            rows = {key: np.tile(x, (shifts.size, 1)) for key, x in few.given.items()}
            rows["t"] -= np.repeat(shifts, few.t.size)[:, np.newaxis]
            found = np.fmax.reduce(errors(self.given, few._replace(given=rows)))
            return np.asarray(np.fmax.reduce(found.reshape(shifts.size, -1), axis=1))

        best, longest = 0.0, 0.3 / sizes(self.given.motion.top)[2]
        count = math.ceil(min(reach / longest, _MOST_SHIFTS))
        for step in longest / 10.0 ** np.arange(10):
            shifts = best + step * np.arange(-count, count + 1.0)
            best = float(shifts[np.argmin(np.nan_to_num(error(shifts), nan=np.inf))])
            count = 10
        return [Cause(f"the clock is shifted by {best:.5g}", partial(Run.timed, shift=best))]


def _named(align: Alignment, exact: ExactMotion, run: Run) -> Cause:
    given, words, names = run.align, [align], []
    if align[:3] == given[:3] and align.start and not given.start:
        seen = run._replace(align=align._replace(start=False)).observed()
        turns = np.asarray(start_of(seen, exact.at(seen.t)) or (0.0, 0.0))
        phi, psi = np.degrees(rotations.within_half_turn(turns))
        starts = {"psi": psi, "phi": phi}.items()
        names = [" and ".join(f"{x} starts at {y:.4g} degrees" for x, y in starts if abs(y) > 1e-3)]
    elif align[:3] != given[:3] and align.left:
        names = [f"the frame is left-handed with {align.up} up"]
        if run.few(1).observed().quaternion is not None:  # else the axis is not turned too
            words.append(Alignment(f"-{align.up}", f"-{align.up}", start=True, time=align.time))
            names[0] += f", or has {align.up} down"
    elif align[:3] != given[:3]:
        names = [f"{align.up} is up and the figure axis is the body's {align.axis} axis"]
    if align.time and not given.time:
        names.append(f"the clock starts at {run.t[0]:.10g}")
    remedy = " or ".join(arg("align", x) for x in words)
    return Cause("; ".join(filter(None, names)), align=align, remedy=remedy)
