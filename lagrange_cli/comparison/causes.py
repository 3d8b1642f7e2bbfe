"""The search for the causes of an error: each is tried by computing without it."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from functools import cache, partial
from itertools import product

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..files import rotations
from .differences import Alignment, Exact, Run, angles_of, blocks, errors, sizes, start_of
from .mistakes import BACKWARDS, Cause, Undo, mistakes

EXPLAINS = 0.1
"""Largest share of the error that may remain if a cause explains it."""
_PART = 0.3
"""Largest error that may remain if a cause explains a part."""
_AS_GOOD, _ROUNDING = 10.0, 1e-9
"""Factor between the remaining errors of two causes, and least error, that make no difference."""
_FEW, _SOME, _LEAST = 12, 300, 3
"""Rows on which causes are tried first and then, and the least number of rows."""
_MOST_SHIFTS = 500
_AXES = "z", "y", "x", "-z", "-y", "-x"
_FRAMES = [
    *(Alignment(x, x) for x in _AXES[:3]),
    *(Alignment(x, x, left=True) for x in _AXES[:3]),
    *(Alignment(x, x) for x in _AXES[3:]),
    *(Alignment(y, x) for x, y in product(_AXES, repeat=2) if x != y),
]
"""All frames whose axes are those of lagtop in another order or direction, the likeliest first.

A left-handed frame is a right-handed one with all axes reversed, but for the zeros of its angles.
"""


def likely_causes(exact: Exact, run: Run, limit: float) -> list[Cause]:
    """Return the cause of an error, and another one that leaves as little, if there is one.

    A cause explains an error if it takes off nine tenths.  Of those that bring the error below the
    limit, return the simplest that leaves about as little as the best.  If there is none, try two
    causes at once.  Otherwise return the best cause, which explains a part and
    spoils nothing.
    """
    if np.isfinite(errors(exact, run.few(_SOME))).sum() < _LEAST:
        return []
    search = _Search(exact, run)
    found = next(filter(None, (search.best(x, limit) for x in search.groups())), [])
    if len(found) == 1 and found[0].align and found[0].align[:3] != run.align[:3]:
        found = search.best([*found, *search.pairs(in_other=False)], limit)
    parts = (x for x in next(search.groups()) if not search.spoils(x, limit))
    return found or search.best(parts, _PART)


class _Search:
    """The search for the causes of the error of a trajectory."""

    def __init__(self, exact: Exact, run: Run) -> None:
        self.run, self.given = run, exact
        self.mistakes = mistakes(exact.top, run)
        self.some, self.tilt = cache(self._some), cache(self._tilt)
        self.enough = EXPLAINS * self.error(Cause(""), _SOME)

    def _some(self, undo: Undo | None) -> Run:
        """Return some rows of the trajectory as it was meant."""
        return (undo(self.run) if undo else self.run).few(_SOME)

    def _tilt(self, undo: Undo | None, frame: Alignment) -> float:
        """Return the tilt of the first row, NaN if it is not known, infinity without a frame."""
        with suppress(LagtopError):  # a frame that needs more than is given
            seen = angles_of(self.some(undo).few(1)._replace(align=frame).observed())
            return float(seen.get("theta", [math.nan])[0])
        return math.inf

    def error(self, cause: Cause, most: int = 0) -> float:
        """Return the greatest error without a cause, on so many rows or on all.

        It is infinite if no row is finite.
        """
        run = self.some(cause.undo).few(most) if most else cause.undone(self.run)
        worst = errors(cause.exact or self.given, run._replace(align=cause.align or run.align))
        return float(np.fmax.reduce(worst)) if np.isfinite(worst).any() else math.inf

    def spoils(self, cause: Cause, limit: float) -> bool:
        """Return whether the attitude, or the rates, are clearly worse without a cause."""

        def greatest(cause: Cause) -> Array:
            run = self.some(cause.undo).few(_FEW)._replace(align=cause.align or self.run.align)
            found = next(blocks(cause.exact or self.given, run))
            both = [found["error"], found.get("rates", found["error"])]
            return np.asarray(np.fmax.reduce(both, axis=1))

        return bool((greatest(cause) > np.fmax(2 * greatest(Cause("")), limit)).any())

    def best(self, causes: Iterable[Cause], limit: float) -> list[Cause]:
        """Return the simplest cause that leaves about as little as the best, and another one."""
        enough = min(self.enough, limit)
        hopeful = [x for x in causes if self.error(x, _FEW) <= enough]
        found = [x._replace(error=self.error(x, _SOME)) for x in hopeful]
        while found := [x for x in found if x.error <= enough]:
            bound = max(_AS_GOOD * min(x.error for x in found), _ROUNDING)
            good = [x for x in found if x.error <= bound]
            others = [x for x in good if x[1:3] != good[0][1:3]]  # another mistake
            whole = [x._replace(error=self.error(x)) for x in [good[0], *others[:1]]]
            if whole[0].error <= enough:
                return [x for x in whole if x.error <= enough]
            found.remove(good[0])
        return []

    def groups(self) -> Iterator[list[Cause]]:
        """Yield groups of causes; each group is tried if the one before explains nothing.

        They are single causes, a shift of the clock, a mistake with other zeros of the angles and
        the clock, a mistake in another frame, two mistakes, and the reverse of time.
        """
        early = 1 + next(i for i, x in enumerate(self.mistakes) if x.exact)
        same, other = (self.alignments(Cause(""), in_other) for in_other in (False, True))
        yield [*same, *self.mistakes[:early], *other, *self.mistakes[early:]]
        yield self.shifts()
        yield self.pairs(in_other=False)
        yield self.pairs(in_other=True)
        tops = [x for x in self.mistakes if x.exact]
        yield [x.with_other(y) for x in self.mistakes if not x.exact for y in tops]
        yield [BACKWARDS]

    def pairs(self, *, in_other: bool) -> list[Cause]:
        """Return each mistake with other zeros of the angles and the clock, or in other frames."""
        return [x.with_other(y) for y in self.mistakes for x in self.alignments(y, in_other)]

    def alignments(self, mistake: Cause, in_other: bool) -> Iterator[Cause]:
        """Yield other alignments in the given frame, or in other frames.

        Under each, the first row has the tilt of the exact motion.
        """
        exact, undo, given = mistake.exact or self.given, mistake.undo, self.run.align
        run, t = self.some(undo).few(_FEW), self.some(undo).t[:1]
        times, starts = {given.time, given.time or bool(t[0])}, {given.start, True}
        frames = dict.fromkeys([Alignment(*given[:3]), *_FRAMES])
        for time, start, frame in product(sorted(times), sorted(starts), frames):
            align = frame._replace(start=start, time=time)
            twice = in_other and start and _is_reversed(align)  # the same as a left-handed one
            if (frame[:3] != given[:3]) == in_other and align != given and not twice:
                tilt = exact.at(t - t * time)["theta"][0]
                if not abs(self.tilt(undo, frame) - tilt) > self.enough:
                    yield _named(align, exact, run)

    def shifts(self) -> list[Cause]:
        """Return the shift of the clock that explains most."""
        from scipy.optimize import minimize_scalar  # start-up

        exact, few = self.given, self.run.few(20)
        if self.run.align.start:
            return []

        def error(shifts: Array) -> Array:
            rows = {key: np.tile(x, (shifts.size, 1)) for key, x in few.given.items()}
            rows["t"] -= np.repeat(shifts, few.t.size)[:, np.newaxis]
            found = errors(exact, few._replace(given=rows, missing=None))
            return np.asarray(np.fmax.reduce(found.reshape(shifts.size, -1), axis=1))

        step = 0.3 / sizes(exact.top)[2]
        reach = max(exact.motion.T_nutation or 0.0, 10 * np.ptp(self.run.t) / self.run.t.size)
        count = math.ceil(min(reach / step, _MOST_SHIFTS))
        shifts = step * np.arange(-count, count + 1.0)
        best = float(shifts[np.argmin(np.nan_to_num(error(shifts), nan=np.inf))])
        ends, options = (best - step, best + step), {"xatol": 1e-9 * step}
        found = minimize_scalar(
            lambda x: float(error(np.array([x]))[0]), bounds=ends, method="bounded", options=options
        )
        shift = float(found.x)
        return [Cause(f"the clock is shifted by {shift:.5g}", partial(Run.timed, shift=shift))]


def _is_reversed(align: Alignment) -> bool:
    """Return whether the frames are right-handed and have the same axis down, as NED has z."""
    return not align.left and align.up.startswith("-") and align.axis == align.up


def _named(align: Alignment, exact: Exact, run: Run) -> Cause:
    """Return an alignment as a cause."""
    given, words, names = run.align, [align], []
    if align[:3] == given[:3] and align.start and not given.start:
        seen = run._replace(align=align._replace(start=False)).observed()
        turns = np.asarray(start_of(seen, exact.at(seen.t)) or (0.0, 0.0))
        phi, psi = np.degrees(rotations.within_half_turn(turns))
        starts = {"psi": psi, "phi": phi}.items()
        names = [" and ".join(f"{x} starts at {y:.4g} degrees" for x, y in starts if abs(y) > 1e-3)]
    elif align[:3] != given[:3] and (align.left or _is_reversed(align)):
        axis = align.up.lstrip("-")
        down = f"-{axis}" if align.left else axis
        words.append(Alignment(down, down, not align.left, start=True, time=align.time))
        names = [f"the frame is left-handed with {axis} up, or has {axis} down"]
    elif align[:3] != given[:3]:
        axes = [f"{align.up} is up"] * (align.up != given.up or given.left)
        axes += [f"the figure axis is the body's {align.axis} axis"] * (align.axis != given.axis)
        names = [" and ".join(axes)]
    if align.time and not given.time:
        names.append(f"the clock starts at {run.t[0]:.10g}")
    remedy = " or ".join(f"align={x}" for x in words)
    return Cause("; ".join(filter(None, names)), align=align, remedy=remedy)
