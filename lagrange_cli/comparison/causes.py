"""The search for the causes of an error: each is corrected in turn, and the error computed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import cache, partial

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..errors import arg
from ..recordings.frames import alignment_of, frames_of, in_frames, turn_of
from ..recordings.options import Alignment
from ..recordings.recording import Recording
from .differences import ExactMotion, errors, sizes, start_of
from .mistakes import Cause, mistakes

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


def likely_causes(exact: ExactMotion, run: Recording, limit: float) -> list[Cause]:
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
    if len(found) == 1 and found[0].align and found[0].align.frame != run.align.frame:
        mirrored = search.aligned(search.mistakes, in_other=False)
        found = search.best([*found, *mirrored], limit)
    parts = (x for x in next(search.groups())[0] if not search.spoils(x))
    return found or search.best(parts, _PART)


class _Search:
    def __init__(self, exact: ExactMotion, run: Recording, limit: float) -> None:
        self.run, self.given, self.limit = run, exact, limit
        self.mistakes = mistakes(exact.motion.top, run)
        self.some = cache(lambda undo: (undo(run) if undo else run).few(_SOME))
        """Returns some rows of the trajectory as it was meant."""
        self.enough = min(EXPLAINS * self.error(_NONE, _SOME), _PART)

    def errors(self, cause: Cause, most: int = 0) -> Array:
        """Return the errors with a cause corrected, on at most `most` rows or on all."""
        run = self.some(cause.undo).few(most) if most else cause.undone(self.run)
        return errors(cause.exact or self.given, run.read_as(align=cause.align or run.align))

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
            yield self.turned(), two
            yield self.aligned(self.mistakes, in_other=False), two
            yield self.aligned(self.mistakes, in_other=True), two
            yield [x.with_other(y) for x in self.mistakes if not x.exact for y in tops], two

    def aligned(self, causes: Iterable[Cause], in_other: bool) -> list[Cause]:
        """Return each cause with other zeros of the angles or of the clock, perhaps in other axes.

        The axes are those in which the motion is seen.
        """
        found, given = [], self.run.align
        for cause in causes:
            run, exact = self.some(cause.undo), cause.exact or self.given
            for time in sorted({given.time, given.time or bool(self.run.t[0])}):
                align: Alignment | None = run.align._replace(time=time)
                if in_other:
                    align = _seen_in(exact, run.read_as(align=align))
                if align and in_other is (align.frame != run.align.frame):
                    both = [align._replace(start=x) for x in sorted({given.start, True})]
                    few = run.few(_FEW)
                    found += [_named(x, exact, few).with_other(cause) for x in both if x != given]
        return found

    def turned(self) -> list[Cause]:
        """Return frames of any direction, if the motion is seen in other ones."""
        seen = self.some(None).observed()
        space, body = frames_of(seen, self.given.at(seen.t)["quaternion"]) or (None, None)
        if space is None or body is None:
            return []
        turns = f"space is turned by {turn_of(space)}, and that of the body by {turn_of(body)}"
        return [Cause(f"the frame of {turns}", partial(in_frames, space=space, body=body))]

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
        return [Cause(f"the clock is shifted by {best:.5g}", partial(Recording.timed, shift=best))]


def _seen_in(exact: ExactMotion, run: Recording) -> Alignment | None:
    """Return the axes in which an exact motion is seen, None if they are no axes."""
    now = run.align
    plain = Alignment(conjugate=now.conjugate, time=now.time)
    seen = run.read_as(align=plain).observed()
    frames = frames_of(seen, exact.at(seen.t)["quaternion"])
    axes = frames and alignment_of(frames)
    return axes and plain._replace(up=axes.up, axis=axes.axis, left=axes.left)


def _named(align: Alignment, exact: ExactMotion, run: Recording) -> Cause:
    given, words, names = run.align, [align], []
    if align.frame == given.frame and align.start and not given.start:
        seen = run.read_as(align=align._replace(start=False)).observed()
        turns = np.asarray(start_of(seen, exact.at(seen.t)) or (0.0, 0.0))
        phi, psi = np.degrees(rotations.within_half_turn(turns))
        starts = {"psi": psi, "phi": phi}.items()
        names = [" and ".join(f"{x} starts at {y:.4g} degrees" for x, y in starts if abs(y) > 1e-3)]
    elif align.frame != given.frame and align.left:
        names = [f"the frame is left-handed with {align.up} up"]
        if run.few(1).observed().quaternion is not None:  # else the axis is not turned too
            words.append(Alignment(f"-{align.up}", f"-{align.up}", start=True, time=align.time))
            names[0] += f", or has {align.up} down"
    elif align.frame != given.frame:
        names = [f"{align.up} is up and the figure axis is the body's {align.axis} axis"]
    if align.time and not given.time:
        names.append(f"the clock starts at {run.t[0]:.10g}")
    remedy = " or ".join(arg("align", x) for x in words)
    return Cause("; ".join(filter(None, names)), align=align, remedy=remedy)
