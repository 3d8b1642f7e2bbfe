"""The search for the causes of an error: each is corrected in turn, and the error computed."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from functools import partial
from itertools import combinations

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..errors import arg
from ..recordings.frames import alignment_of, frames_of, in_frames, turn_of
from ..recordings.misreadings import BACKWARDS, Misreading, misreadings
from ..recordings.options import Alignment
from ..recordings.recording import Recording
from ..top.top import Top
from .differences import ExactMotion, errors, sizes, start_of
from .engines import engines
from .mistakes import OPPOSITE, Cause, estimated, of_clock, other_tops, percent
from .numbers import Estimate

_EXPLAINS, _MOST = 0.1, 0.3
"""Largest share of the error that may remain if a cause explains it, and the largest error."""
_AS_GOOD, _COMPETES, _ROUNDING = 2.0, 3.0, 1e-9
"""Factors between the remaining errors of causes that explain as much, and a least error."""
_FEW, _SOME, _LEAST = 12, 300, 3
"""Rows on which causes are tried first and then, and the least number of rows."""
_STEP, _COUNT, _CLOCK = 0.3, 500, 0.02
"""Of clocks that are tried: by how much the motion turns from one to the next, in radians, their
number on each side, and how far their rate is from the estimated one."""
_NAMES, _SURE = 3, 1e-3
"""The most names for one error, and the residual below which an axis moves like that of a top."""
_UNTURNED, _SPIN = 1e-9, 12.0
"""The turn of the body's frame that is said, and that of the spin in which engines are compared."""


def likely_causes(
    exact: ExactMotion, run: Recording, limit: float, seen: Estimate | None
) -> list[Cause]:
    """Return the cause of an error, and others that leave as little, if there are any.

    A cause explains an error if it removes nine tenths.  Of those that bring the error below the
    limit, return the simplest that leaves about as little as the best.  If there is none, try two
    causes at once, each of which must remove nine tenths, then engines that move no top.  Otherwise
    return the causes that remove nine tenths and do not contradict the motion of the axis.
    """
    if np.isfinite(errors(exact, run.few(_SOME))[0]).sum() < _LEAST:
        return []
    search = _Search(exact, run, limit, seen)
    return next(filter(None, (search.best(*x) for x in search.groups())), [])


class _Search:
    def __init__(
        self, exact: ExactMotion, run: Recording, limit: float, seen: Estimate | None
    ) -> None:
        self.run, self.given, self.limit = run, exact, limit
        self.seen = seen if seen and seen.is_trusted else None
        self.top, self.rate = exact.motion.top, sizes(exact.motion.top)[2]
        self.tops = other_tops(self.top, left=run.align.left)
        self.written = [Cause(x.name, (x,)) for x in misreadings(run)]
        self.before = self.errors(Cause(), _SOME)

    def few(self, cause: Cause, most: int) -> Recording:
        """Return some rows of the trajectory as it was meant."""
        if cause.kinds & {"rows", "engine"}:
            return cause.undone(self.run).few(most)
        return cause.undone(self.run.few(most))

    def errors(self, cause: Cause, most: int = 0) -> Array:
        """Return the greatest error of the attitude and of the rates if a cause is corrected.

        At most `most` rows are compared, or all.  An error is infinite if no row is finite.
        """
        run = self.few(cause, most or len(self.run.t))
        found = np.fmax.reduce(errors(cause.exact or self.given, run), axis=1)
        return np.where(np.isfinite(found), found, math.inf)

    def error(self, cause: Cause, most: int = 0) -> float:
        """Return the greatest error if a cause is corrected."""
        return float(self.errors(cause, most).max())

    def agrees(self, cause: Cause, *, is_whole: bool = True) -> bool:
        """Return whether the axis of a cause's top moves like the one that is seen.

        It is another axis that is seen if the attitude was misread, or an engine moves no top.
        Only the whole cause may have a nutation that the rows do not show.
        """
        if not self.seen or cause.kinds & {"attitude", "engine"}:
            return True
        clock = float(np.ptp(self.few(cause, _SOME).t) / (np.ptp(self.run.t) or 1.0))
        top = (cause.exact or self.given).motion.top
        return self.seen.is_near(top, clock, hidden=is_whole)

    def best(self, causes: Iterable[Cause], limit: float) -> list[Cause]:
        """Return the simplest cause that leaves about as little as the best, and its rivals.

        A cause that leaves more than the limit of a trajectory has more rivals.
        """
        enough, is_whole = min(_EXPLAINS * self.before.max(), limit), limit <= self.limit
        agreed = (x for x in causes if self.agrees(x, is_whole=is_whole))
        found = [x for y in agreed for x in self.fitting(y, enough)]
        found = [x._replace(error=self.error(x, _SOME)) for x in found if not self.spoils(x)]
        rival = _AS_GOOD if is_whole else _COMPETES
        bound = max(rival * min((x.error for x in found), default=0.0), _ROUNDING)
        named: list[Cause] = []
        for x in found:
            if x.error <= min(bound, enough) and not any(y.name in x.name for y in named):
                named.append(x)
        if len(named) > _NAMES:
            named = named[:_NAMES] if is_whole else []
        if named:  # the others leave about as little
            named[0] = named[0]._replace(error=self.error(named[0]))
        return named if named and named[0].error <= enough else []

    def fitting(self, cause: Cause, enough: float) -> list[Cause]:
        """Return a cause if it leaves little, or its pairs with causes of the rates that do."""
        attitude, rates = self.errors(cause, _FEW)
        if max(attitude, rates) <= enough:
            return [cause]
        if self.before[0] <= self.limit or attitude > min(enough, self.limit):
            return []
        both = [cause.with_other(x) for x in self.written if x.kinds & {"rates", "sense"}]
        return [x for x in both if self.error(x, _FEW) <= enough]

    def groups(self) -> Iterator[tuple[Iterable[Cause], float]]:
        """Yield groups of causes, and the greatest error that each group may leave.

        A group is tried if the one before explains nothing.
        """
        none, sign = [Cause()], [x for x in self.tops if x.name.startswith(OPPOSITE)]
        units = [x for x in self.written if x.kinds & {"clock", "rates"}]
        others = [x for x in self.written if x not in units]
        singles = [*units, *self.tops, *others]
        first = [*self.placed(none), *units, *sign, *self.placed(sign)]
        yield [*first, *self.placed(none, in_other=True), *singles], self.limit
        inputs = estimated(self.top, self.seen) if self.seen else []
        inputs = [*self.rates_of_clock(), *inputs]
        if self.before[0] > self.limit:  # not only the rates are wrong
            yield inputs, self.limit
            yield self.shifts(), self.limit
            two = min(_EXPLAINS**2 * self.before.max(), self.limit)
            yield self.turned(), two
            reverse = other_tops(Top(**self.top.inputs() | {"r0": -self.top.r0}))
            both = [y._replace(name=f"{y.name}; {x.name}") for x in sign for y in reverse]
            singles = [*filter(self.agrees, singles)]
            yield [*both, *self.placed(singles), *self.placed(singles, in_other=True)], two
            parts = [*self.written, *self.tops]
            pairs = (x.with_other(y) for x, y in combinations(parts, 2) if not x.kinds & y.kinds)
            yield pairs, two
            yield self.engines()
        yield [x for x in [*self.placed(none), *singles] if x.name != BACKWARDS], _MOST
        yield inputs, _MOST

    def engines(self) -> tuple[list[Cause], float]:
        """Return engines that move no top, compared with the first rows, and their greatest error.

        Coarse steps soon move away from the equations.
        """
        end = self.run.t[0] + _SPIN / (abs(float(self.top.r0)) or 1e-300)
        first = self.run.read_as(t_max=end).within().few(4 * _SOME)
        seen, before = first.observed(), float(errors(self.given, first)[0].max())
        if seen.quaternion is None or not (np.diff(seen.t) > 0).all() or len(seen.t) < _FEW:
            return [], 0.0
        rows = Misreading("", lambda _: first, kind="engine")
        found = [Cause(name, (rows,), x) for name, x in engines(self.given.motion)]
        is_top = self.seen and self.seen.axis.residual < _SURE
        return found, min(_EXPLAINS * before, self.limit if is_top else _MOST)

    def spoils(self, cause: Cause) -> bool:
        """Return whether the attitude, or the rates, are clearly worse without a cause."""
        after, before = (self.errors(x, _FEW) for x in (cause, Cause()))
        return bool((after > np.fmax(2 * before, self.limit)).any())

    def placed(self, causes: Iterable[Cause], *, in_other: bool = False) -> list[Cause]:
        """Return each cause with other zeros of the angles or of the clock.

        The axes are the given ones, or else those in which the motion is seen.
        """
        found, given = list[Cause](), self.run.align
        for cause in causes:
            run, exact = self.few(cause, _SOME), cause.exact or self.given
            for time in sorted({given.time, given.time or bool(self.run.t[0])}):
                now = run.align._replace(time=time)
                axes = _seen_in(exact, run.read_as(align=now)) if in_other else [now]
                both = [x._replace(start=y) for x in axes for y in sorted({given.start, True})]
                found += [_framed(cause, exact, run, x) for x in both if x != run.align]
        return found

    def turned(self) -> list[Cause]:
        """Return frames of any direction, if the motion is seen in other ones."""
        seen = self.few(Cause(), _SOME).observed()
        space, body = frames_of(seen, self.given.at(seen.t)["quaternion"]) or (None, None)
        if space is None or body is None:
            return []
        turns = f"space is turned by {turn_of(space)}"
        if np.max(np.abs(body - np.eye(3))) > _UNTURNED:
            turns += f", and that of the body by {turn_of(body)}"
        name, undo = f"the frame of {turns}", partial(in_frames, space=space, body=body)
        return [Cause(name, (Misreading(name, undo),))]

    def rates_of_clock(self) -> list[Cause]:
        """Return the clock that is fast or slow by the estimated ratio."""
        ratio = self.seen and (self.seen.r0 or self.seen.b)
        if not ratio or not 0 < ratio < math.inf:
            return []
        span = float(np.ptp(self.run.t)) * ratio
        ratio = self.clock("factor", ratio, _STEP / (self.rate * span), _CLOCK * ratio)
        name = f"the clock is {percent(1 / ratio)} {'fast' if ratio < 1 else 'slow'}"
        if not 0.5 < ratio < 2:
            name = f"the unit of t is {ratio:.4g} times that of the rates"
        return [of_clock(name, factor=ratio)]

    def shifts(self) -> Iterator[Cause]:
        """Yield shifts of the clock that explain most: within about a period, and any."""
        span, period = float(np.ptp(self.run.t)), self.given.motion.T_nutation or 0.0
        for reach in (max(period, 10 * span / self.run.t.size), span):
            shift = self.clock("shift", 0.0, _STEP / self.rate, reach)
            yield of_clock(f"the clock is shifted by {shift:.5g}", shift=shift)

    def clock(self, change: str, best: float, step: float, reach: float) -> float:
        """Return the change of the clock that explains most, at most `reach` from a first one."""
        few, count = self.run.few(20), math.ceil(min(reach / step, _COUNT))
        for size in step / 10.0 ** np.arange(10):
            values = best + size * np.arange(-count, count + 1.0)
            rows = {key: np.tile(x, (values.size, 1)) for key, x in few.given.items()}
            times = np.concatenate([few.timed(**{change: x}).t for x in values])
            rows["t"] = times[:, np.newaxis] - few.begins
            found = np.fmax.reduce(errors(self.given, few._replace(given=rows)))
            worst = np.fmax.reduce(found.reshape(values.size, -1), axis=1)
            best, count = float(values[np.argmin(np.nan_to_num(worst, nan=np.inf))]), 10
        return best


def _seen_in(exact: ExactMotion, run: Recording) -> list[Alignment]:
    """Return the other axes in which an exact motion is seen, none if it is seen in no axes."""
    now = run.align
    plain = Alignment(conjugate=now.conjugate, time=now.time)
    seen = run.read_as(align=plain).observed()
    frames = frames_of(seen, exact.at(seen.t)["quaternion"])
    axes = dict.fromkeys(alignment_of(frames, left=x) for x in (True, False)) if frames else {}
    found = [plain._replace(up=x.up, axis=x.axis, left=x.left) for x in axes if x]
    return [x for x in found if x.frame != now.frame]


def _framed(cause: Cause, exact: ExactMotion, run: Recording, align: Alignment) -> Cause:
    """Return a cause of a trajectory in another alignment."""
    given, names = run.align, []
    if align.left and align.frame != given.frame:
        names = [f"the frame is left-handed with {align.up} up"]
    elif align.frame != given.frame and align.up == align.axis == f"-{align.up[1:]}":
        names = [f"{align.up[1:]} is down"]
    elif align.frame != given.frame:
        names = [f"{align.up} is up and the figure axis is the body's {align.axis} axis"]
    elif align.start and not given.start:
        seen = run.read_as(align=align._replace(start=False)).observed()
        turns = np.asarray(start_of(seen, exact.at(seen.t)) or (0.0, 0.0))
        phi, psi = np.degrees(rotations.within_half_turn(turns))
        least, starts = 1e-4 * (abs(phi) + abs(psi)), {"psi": psi, "phi": phi}.items()
        names = [
            " and ".join(f"{x} starts at {y:.4g} degrees" for x, y in starts if abs(y) > least)
        ]
    if align.time and not given.time:
        names.append(f"the clock starts at {run.t[0]:.10g}")
    name = "; ".join(filter(None, [*names, cause.name]))
    other = Misreading(name, partial(Recording.read_as, align=align), arg("align", align), "frame")
    kept = tuple(x for x in cause.misreadings if x.kind != "frame")
    return Cause(name, (*kept, other), cause.exact)
