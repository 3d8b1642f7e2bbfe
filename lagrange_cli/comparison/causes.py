"""The search for the causes of an error: each is tried by computing without it."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterable, Iterator
from functools import partial
from itertools import product

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..files import rotations
from ..solver.solve import solve
from .differences import Alignment, Exact, Run, errors, sizes, start_of
from .mistakes import BACKWARDS, Cause, mistakes

EXPLAINS = 0.1
"""Largest share of the error that may remain if a cause explains it."""
_AS_GOOD, _ROUNDING = 10.0, 1e-9
"""Factor between the remaining errors of two causes, and least error, that make no difference."""
_FEW, _SOME, _LEAST = 12, 300, 3
"""Rows on which causes are tried first and then, and the least number of rows."""
_MOST_SHIFTS = 500
_FRAMES = [
    *(Alignment(x, x) for x in "zyx"),
    *(Alignment(up=x, left=True) for x in "zyx"),
    *(Alignment(x, x) for x in ("-z", "-y", "-x")),
    *(Alignment(x, y) for x, y in product(["z", "y", "x", "-z", "-y", "-x"], repeat=2) if x != y),
]
"""All frames whose axes are those of lagtop in another order or direction, the likeliest first.

A left-handed frame is a right-handed one with all axes reversed, but for the zeros of its angles.
"""


def likely_causes(exact: Exact, run: Run, limit: float) -> list[Cause]:
    """Return the cause of an error, and another one that leaves as little, if there is one.

    A cause explains an error if it takes off nine tenths.  Of those that bring the error below the
    limit, return the simplest that leaves about as little as the best.  If there is none, try two
    causes at once.  Otherwise return the best cause, which explains a part.
    """
    if np.isfinite(errors(exact, run.few(_SOME))).sum() < _LEAST:
        return []
    search = Search(exact, run)
    alone = search.tried(search.single())
    for more in search.groups():
        found = search.best([*alone, *search.tried(more, limit)], limit)
        if len(found) == 1 and found[0].align and found[0].align.frame != run.align.frame:
            found = search.best([*found, *search.tried(search.with_zeros(), limit)], limit)
        if found:
            return found
    return search.best(alone)


class Search:
    """The search for the causes of the error of a trajectory."""

    def __init__(self, exact: Exact, run: Run) -> None:
        self.run, self.given = run, exact
        self.mistakes = mistakes(exact.top, run)
        self._tops: dict[str, Exact | None] = {str({}): exact}
        self._runs: dict[Callable[[Run], Run], Run] = {}
        self.enough = EXPLAINS * self.error(Cause(""), _SOME)

    def exact(self, cause: Cause) -> Exact | None:
        """Return the motion of the top with a cause, or None if there is no such top."""
        if (key := str(dict(cause.inputs))) not in self._tops:
            try:
                self._tops[key] = Exact(solve(self.given.top.replace(**cause.inputs)))
            except LagtopError:
                self._tops[key] = None
        return self._tops[key]

    def some(self, cause: Cause) -> Run:
        """Return some rows of the trajectory as it was meant."""
        if cause.meant not in self._runs:
            self._runs[cause.meant] = cause.meant(self.run).few(_SOME)
        return self._runs[cause.meant]

    def error(self, cause: Cause, most: int = 0) -> float:
        """Return the greatest error without a cause, on so many rows or on all.

        It is infinite if there is no such motion.
        """
        if (exact := self.exact(cause)) is None:
            return math.inf
        run = self.some(cause).few(most) if most else cause.meant(self.run)
        try:
            worst = errors(exact, run._replace(align=cause.align or run.align))
        except LagtopError:
            return math.inf
        return float(np.fmax.reduce(worst, initial=-1.0)) if np.isfinite(worst).any() else math.inf

    def tried(self, causes: Iterable[Cause], limit: float = math.inf) -> list[Cause]:
        """Return the causes that explain the error of some rows, with the error that remains."""
        enough = min(self.enough, limit)
        hopeful = [x for x in causes if self.error(x, _FEW) <= enough]
        found = [x._replace(error=self.error(x, _SOME)) for x in hopeful]
        return [x for x in found if x.error <= enough]

    def best(self, found: list[Cause], limit: float = math.inf) -> list[Cause]:
        """Return the simplest cause that leaves about as little as the best, and another one."""
        enough = min(self.enough, limit)
        found = [x for x in found if x.error <= enough]
        while found:
            bound = min(enough, max(_AS_GOOD * min(x.error for x in found), _ROUNDING))
            good = [x for x in found if x.error <= bound]
            mistake = good[0].meant, good[0].inputs
            others = [x for x in good if (x.meant, x.inputs) != mistake]
            whole = [x._replace(error=self.error(x)) for x in [good[0], *others[:1]]]
            if whole[0].error <= enough:
                return [x for x in whole if x.error <= enough]
            found.remove(good[0])
        return []

    def single(self) -> list[Cause]:
        """Return the single causes, the simplest first."""
        same, other = self.alignments(Cause(""))
        early = 1 + next(i for i, x in enumerate(self.mistakes) if x.inputs)
        return [*same, *self.mistakes[:early], *other, *self.mistakes[early:]]

    def groups(self) -> Iterator[list[Cause]]:
        """Yield groups of causes that are tried if no single cause explains the error.

        They are a shift of the clock, a mistake with other zeros of the angles and the clock, a
        mistake in another frame, two mistakes, and the reverse of time.
        """
        yield []
        yield self.shifts()
        yield self.with_zeros()
        yield [x.with_other(y) for y in self.mistakes for x in self.alignments(y)[1]]
        tops = [x for x in self.mistakes if x.inputs]
        yield [x.with_other(y) for x in self.mistakes if not x.inputs for y in tops]
        yield [BACKWARDS]

    def with_zeros(self) -> list[Cause]:
        """Return each mistake with other zeros of the angles and the clock."""
        return [x.with_other(y) for y in self.mistakes for x in self.alignments(y)[0]]

    def alignments(self, mistake: Cause) -> tuple[list[Cause], list[Cause]]:
        """Return other alignments in the frame that is given, and in other frames.

        Under each, the first row has the tilt of the exact motion, or its supplement.
        """
        exact, run = self.exact(mistake), self.some(mistake).few(_FEW)
        found: tuple[list[Cause], list[Cause]] = [], []
        given = run.align
        if exact is None:
            return found
        row = run._replace(align=Alignment(), undo=None).observed(slice(1))
        frames, cosines = [given], np.full((3, 3), np.nan)
        if row.quaternion is not None:
            frames += _FRAMES
            cosines = abs(rotations.rotated(row.quaternion, np.eye(3)))
        elif row.axis is not None:
            frames += [x for x in _FRAMES if x.axis in {"", "z"}]
            cosines[:] = abs(row.axis) / np.linalg.norm(row.axis)
        tilts = np.arccos(np.minimum(cosines, 1.0))
        for start, time in ((False, False), (True, False), (False, True), (True, True)):
            if (start and given.start) or (time and (given.time or not run.t[0])):
                continue
            t = run.t - run.t[0] * (time or given.time)
            tilt = np.arccos(abs(np.cos(exact.at(t)["theta"][0])))
            for frame in frames:
                align = frame._replace(start=start or given.start, time=time or given.time)
                off = tilts["xyz".index(frame.figure[-1]), "xyz".index(frame.up[-1])] - tilt
                twice = align.start and align.is_reversed  # the same as a left-handed frame
                known = frame.frame == given.frame and frame is not given
                if not (align == given or twice or known or abs(off) > self.enough):
                    found[frame is not given].append(self._cause(align, exact, run))
        return found

    def _cause(self, align: Alignment, exact: Exact, run: Run) -> Cause:
        """Return an alignment as a cause."""
        given, (up, figure, left) = run.align, align.frame
        words, names = [align], []
        if align.frame == given.frame and align.start and not given.start:
            seen = run._replace(align=align._replace(start=False)).observed()
            phi, psi = start_of(seen, exact.at(seen.t)) or (0.0, 0.0)
            angles = {"psi": math.degrees(psi), "phi": math.degrees(phi)}
            starts = [f"{x} starts at {y:.4g} degrees" for x, y in angles.items() if abs(y) > 1e-3]
            names.append(" and ".join(starts))
        elif align.frame != given.frame and (left or align.is_reversed):
            axis = up.lstrip("-")
            down = Alignment(f"-{axis}", f"-{axis}", start=True, time=align.time)
            words.append(down if left else down._replace(axis="", up=axis, left=True))
            names.append(f"the frame is left-handed with {axis} up, or has {axis} down")
        elif align.frame != given.frame:
            axes = [f"{up} is up"] * (up != given.up or given.left)
            axes += [f"the figure axis is the body's {figure} axis"] * (figure != given.figure)
            names.append(" and ".join(axes))
        if align.time and not given.time:
            names.append(f"the clock starts at {run.t[0]:.10g}")
        remedy = " or ".join(f"align={x}" for x in words)
        return Cause("; ".join(filter(None, names)), align=align, remedy=remedy)

    def shifts(self) -> list[Cause]:
        """Return the shift of the clock that explains most."""
        from scipy.optimize import minimize_scalar  # start-up

        exact, few, t = self.given, self.run.few(20), self.run.t
        if self.run.align.start:
            return []

        def error(shifts: float | Array) -> Array:
            rows = {key: np.tile(x, (np.size(shifts), 1)) for key, x in few.given.items()}
            rows["t"] -= np.repeat(shifts, len(few.given["t"]))[:, np.newaxis]
            found = errors(exact, few._replace(given=rows, missing=None))
            return np.asarray(np.fmax.reduce(found.reshape(np.size(shifts), -1), axis=1))

        step = 0.3 / sizes(exact.top)[2]
        reach = max(exact.motion.T_nutation or 0.0, 10 * abs(t[-1] - t[0]) / len(t))
        count = math.ceil(min(reach / step, _MOST_SHIFTS))
        near = step * np.arange(-count, count + 1.0)
        shifts = np.unique([near, t[0] + near])
        best = float(shifts[np.argmin(np.nan_to_num(error(shifts), nan=np.inf))])
        ends, options = (best - step, best + step), {"xatol": 1e-9 * step}
        found = minimize_scalar(
            lambda x: float(error(x)[0]), bounds=ends, method="bounded", options=options
        )
        shift = float(found.x)
        return [Cause(f"the clock is shifted by {shift:.5g}", partial(Run.timed, shift=shift))]
