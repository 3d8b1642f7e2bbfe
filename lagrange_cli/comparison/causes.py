"""The search for the causes of an error: each is corrected in turn, and the error computed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import partial

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..errors import arg
from ..recordings.frames import alignment_of, frames_of, in_frames, turn_of
from ..recordings.misreadings import BACKWARDS, Misreading
from ..recordings.options import Alignment
from ..recordings.recording import Recording
from .differences import ExactMotion, errors, sizes, start_of
from .engines import engine_errors
from .mistakes import Cause, clocks, estimated_tops, is_near, other_tops, written
from .numbers import Estimate

EXPLAINS = 0.1
"""Largest share of the error that may remain if a cause explains it."""
_PART = 0.3
"""Largest error that may remain if a cause explains most of it."""
_AS_GOOD, _COMPETES, _ROUNDING = 2.0, 3.0, 1e-9
"""Factors between the remaining errors of causes that explain as much, and a least error."""
_SURE = 1e-3
"""Relative residual of an axis below which it moves like that of a top."""
_CLOSE, _ALIKE, _NEAR = 0.02, 0.005, 0.1
"""Relative differences of a and b between a trajectory and a top: one that explains most of it, one
that makes an estimated top needless, and one of a pair that is tried."""
_FEW, _SOME, _LEAST = 12, 300, 3
"""Rows on which causes are tried first and then, and the least number of rows."""
_MOST_SHIFTS, _MOST_NAMES = 500, 3
_NONE = Cause("")
_UNTURNED = 1e-9
_RATES, _UNITS = {"rates", "angle_rates"}, {"clock", "rates"}


def likely_causes(
    exact: ExactMotion, run: Recording, limit: float, seen: Estimate | None
) -> list[Cause]:
    """Return the cause of an error, and others that leave as little, if there are any.

    A cause explains an error if it removes nine tenths.  Of those that bring the error below the
    limit, return the simplest that leaves about as little as the best.  If there is none, try two
    causes at once, each of which must remove nine tenths, and causes of the attitude and of the
    rates one by one.  Otherwise return the causes that remove nine tenths.
    """
    search = _Search(exact, run, limit, seen)
    if np.isfinite(search.errors(_NONE, _SOME)[0]).sum() < _LEAST:
        return []
    found = search.whole() or search.by_channel()
    if len(found) == 1 and found[0].align and found[0].align.frame != run.align.frame:
        mirrored = search.aligned(search.mistakes, in_other=False)
        found = search.best([*found, *mirrored], limit)
    return found or search.engines() or search.partial()


def remedy_of(cause: Cause, exact: ExactMotion, run: Recording, limit: float) -> str:
    """Return the arguments that take a cause into account, each tried as it is printed."""
    other = cause.misreading
    also = other.remedy if other and not (cause.align and other.kind == "frame") else ""
    enough, exact = max(limit, _AS_GOOD * cause.error), cause.exact or exact

    def works(align: Alignment) -> bool:
        few = cause._replace(align=align).undone(run).few(_SOME)
        return bool(np.fmax.reduce(errors(exact, few), axis=None) <= enough)

    words = [arg("align", x) for x in cause.words if works(x)]
    return " or ".join(" and ".join(filter(None, (x, also))) for x in words or [""])


class _Search:
    def __init__(
        self, exact: ExactMotion, run: Recording, limit: float, seen: Estimate | None
    ) -> None:
        self.run, self.given, self.limit = run, exact, limit
        self.seen = seen if seen and seen.axis.residual < _PART else None
        self.top = exact.motion.top
        self.written = written(run)
        self.kept: dict[int, tuple[Misreading | None, Recording]] = {}
        self.tops = other_tops(self.top, left=run.align.left)
        units = [x for x in self.written if x.kind in _UNITS]
        others = [x for x in self.written if x.kind not in _UNITS]
        spin = [x for x in self.tops if x.name.startswith("r0 has")]
        self.early, self.late = [*units, *clocks(), *spin], [*self.tops, *others]
        self.mistakes = [*self.early, *self.late]
        self.enough = min(EXPLAINS * self.error(_NONE, _SOME), _PART)
        is_named = any(self.agrees(x, _ALIKE) for x in self.tops)
        trusted = seen if seen and seen.is_trusted and not is_named else None
        self.estimated = [*estimated_tops(self.top, trusted)] if trusted else []

    def agrees(self, cause: Cause, share: float = _CLOSE) -> bool:
        """Return whether the axis of a cause's top moves like the one that is seen."""
        if not self.seen or not self.seen.is_trusted:
            return True
        clock = float(np.ptp(self.some(cause.misreading).t) / (np.ptp(self.run.t) or 1.0))
        return is_near((cause.exact or self.given).motion.top, clock, self.seen, share)

    def some(self, misreading: Misreading | None) -> Recording:
        """Return some rows of the trajectory as it was meant."""
        if (key := id(misreading)) not in self.kept:
            run = self.run
            if misreading is None:
                run = run.few(_SOME)
            elif misreading.kind == "rows":
                run = misreading.undo(run).few(_SOME)
            else:
                run = misreading.undo(run.few(_SOME))
            self.kept[key] = misreading, run
        return self.kept[key][1]

    def errors(self, cause: Cause, most: int = 0) -> Array:
        """Return the errors with a cause corrected, on at most `most` rows or on all."""
        if not most:
            return errors(cause.exact or self.given, cause.undone(self.run))
        run = self.some(cause.misreading).few(most)
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

    def whole(self) -> list[Cause]:
        """Return the causes that bring the error below the limit."""
        return next(filter(None, (self.best(*x) for x in self.groups())), [])

    def groups(self) -> Iterator[tuple[list[Cause], float]]:
        """Yield groups of causes, and the greatest error that each group may leave.

        A group is tried if the one before explains nothing.
        """
        same, other = (self.aligned([_NONE], in_other) for in_other in (False, True))
        yield [*same, *self.early, *other, *self.late], self.limit
        if not (self.errors(_NONE, _SOME)[0] > self.limit).any():
            return  # only the rates are wrong
        yield self.estimated, self.limit
        span, two = float(np.ptp(self.run.t)), min(EXPLAINS * self.enough, self.limit)
        near = max(self.given.motion.T_nutation or 0.0, 10 * span / self.run.t.size)
        yield self.shifts(near), self.limit
        yield self.shifts(span), self.limit
        yield self.turned(), two
        yield [y for x in (False, True) for y in self.aligned(self.mistakes, x)], two
        firsts = [x for x in self.mistakes if not x.exact]
        both = [(x, y) for i, x in enumerate(firsts) for y in [*firsts[i + 1 :], *self.tops]]
        pairs = (x.with_other(y) for x, y in both if x.kind != y.kind)
        yield [x for x in pairs if self.agrees(x, _NEAR)], two

    def by_channel(self) -> list[Cause]:
        """Return a cause of the attitude, with one of the rates."""
        given = {x: y for x, y in self.run.given.items() if x not in _RATES}
        if len(given) == len(self.run.given) or not given.keys() - {"t", "missing"}:
            return []
        bare = _Search(self.given, self.run._replace(given=given), self.limit, self.seen)
        of_rates = [x for x in self.written if x.kind != "clock"]
        wrong = bare.whole() if bare.error(_NONE, _SOME) > self.limit else []
        return self.best([x.with_other(y) for x in wrong for y in of_rates], self.limit)[:1]

    def engines(self) -> list[Cause]:
        """Return the engine that moves no top and explains the first rows."""
        seen = self.run.few(4 * _SOME).observed()
        t, turns = seen.t, seen.quaternion
        is_whole = turns is not None and np.isfinite(turns).all() and (np.diff(t) > 0).all()
        if turns is None or not is_whole or t.size < _FEW:
            return []
        most = self.limit if self.seen and self.seen.axis.residual < _SURE else math.inf
        found = [
            Cause(name, error=error)
            for name, error, right in engine_errors(self.top, t, turns)
            if error <= min(EXPLAINS * right, most) and right > self.limit
        ]
        return sorted(found, key=lambda x: x.error)[:1]

    def partial(self) -> list[Cause]:
        """Return the causes that remove nine tenths of the error, but do not contradict a and b."""
        causes = [*self.aligned([_NONE], in_other=False), *self.mistakes, *self.estimated]
        found = [x for x in causes if x.name != BACKWARDS and self.agrees(x)]
        found = [x for x in found if self.error(x, _FEW) <= self.enough and not self.spoils(x)]
        found = [*{x.name: x for x in reversed(found)}.values()][::-1]  # the first of each name
        found = [x._replace(error=self.error(x)) for x in found]
        most = min(self.enough, _COMPETES * min((x.error for x in found), default=0.0))
        found = [x for x in found if x.error <= most]
        return found if len(found) <= _MOST_NAMES else []

    def aligned(self, causes: Iterable[Cause], in_other: bool) -> list[Cause]:
        """Return each cause with other zeros of the angles or of the clock, perhaps in other axes.

        The axes are those in which the motion is seen.
        """
        found, given = [], self.run.align
        for cause in causes:
            run, exact = self.some(cause.misreading), cause.exact or self.given
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
        turns = f"space is turned by {turn_of(space)}"
        if np.max(np.abs(body - np.eye(3))) > _UNTURNED:
            turns += f", and that of the body by {turn_of(body)}"
        name, undo = f"the frame of {turns}", partial(in_frames, space=space, body=body)
        return [Cause(name, Misreading(name, undo))]

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
        name, undo = f"the clock is shifted by {best:.5g}", partial(Recording.timed, shift=best)
        return [Cause(name, Misreading(name, undo, kind="clock"))]


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
    return Cause("; ".join(filter(None, names)), align=align, words=tuple(words))
