"""Advice after a failed fit: only remedies that another fit confirms, within a budget."""

from __future__ import annotations

import math
from bisect import bisect_left
from collections.abc import Callable, Iterator
from contextlib import suppress
from dataclasses import replace
from functools import cached_property
from typing import Any

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.rotations import within_half_turn
from ..arithmetic.text import shortened
from ..arithmetic.types import Array
from ..errors import DataError, LagtopError, arg
from ..names import ANGLES
from ..recordings.frames import alignment_of, in_frames, own_frames, refined, turn_of
from ..recordings.misreadings import evenly_timed, misreadings
from ..recordings.options import Alignment
from ..top.inputs import BODY, replaced_by
from .decay import decay_of
from .known import Known
from .measured import LEAST_ROWS, Measured, measured
from .neighbours import DECAY, LOST, SLOWING, lost_text
from .outcome import GOOD, STEADY, Outcome
from .reasons import NEEDS_ADVICE, SAY_WHAT_TO_DO, Kind, Reason
from .residuals import CHANCE
from .rows import calmness, release, with_gap
from .search import best_fit
from .signals import mean_rate

_BUDGET = 8.0
"""Cost of the fits that are tried; a fit of the cost 1 takes about 0.5 s."""
_SHORT = 0.7
"""Cost of a fit of few rows with a tilt."""
_LONG = 1500
"""Number of rows that adds 1 to the cost, or 2 if both directions of psi are tried."""
_WITHOUT_TILT = 3.0
"""Cost of a fit that has to find the tilt."""
_LEAST_COST = (0.15, 0.5)
"""Least cost of a window over that of the whole, with and without a recorded tilt."""
_ROWS = 250
"""Rows at which frames are compared before a fit."""
_REFINED = 3
"""Times that frames which are no axes are refined by the motion that is found in them."""
_AS_CALM = 0.01
"""Logarithm of the noise beside harmonics that another frame may have more."""
_AS_NOISY = 0.1
"""Logarithm of the usual residual, per channel, that another reading may have more."""
_MOST_LOST = 3
"""Rows that are lost at once at most."""
_SURE_GAP = 12.0
"""Fall of -2 log(likelihood) by lost rows, besides the cost of the search."""
_LEAVES = 6.0
"""Standard deviations beyond which a row leaves the motion of the first half."""
_WINDOWS = (3, 5, 10, 20, 32, 64)
"""Numbers of windows that are tried."""
_ROWS_PER_WINDOW = 24
"""Least number of rows in such a window."""
_FEW_PER_PERIOD = 8.0
"""Rows per nutation period from which an aliased nutation is unlikely."""
_FEW = 0.15
"""Largest share of rows that are outliers."""
_ROUNDS = 3
"""Largest number of fits without outliers, each of which may show further outliers."""
_ALIKE = 0.3
"""Largest scatter of an angle, in radians, after its half turns are corrected."""
_LEAST_TIMES = 0.25
"""Least share of times that differ."""
_CLOSER = 0.3
"""Residual of the spin in a window over that of the whole recording."""


class Advice:
    """The search for what makes a failed fit good, the likeliest mistakes first.

    Some fits of the recording `again` have been made before.
    """

    def __init__(self, recording: Measured, known: Known, outcome: Outcome, again: int = 0) -> None:
        self.recording, self.known, self.outcome = recording, known, outcome
        self.kinds = outcome.kinds
        self.body = {name: x for name, x in known.items() if replaced_by(name) in BODY}
        if len(recording.angles) == 1:  # of which a known start is a part
            self.body = dict(known)
        has_no_tilt = "theta" not in recording.angles
        tries_both = recording.kind == "angles" and {"phi", "psi"} <= recording.angles.keys()
        self.cost = _SHORT + recording.t.size / _LONG * (1 + tries_both)
        self.cost *= _WITHOUT_TILT if has_no_tilt else 1.0
        self.least = _LEAST_COST[has_no_tilt]
        self.left, self.is_early = _BUDGET - again * self.cost, True
        self.windows: dict[tuple[int, int], Outcome | None] = {}

    def reasons(self) -> Iterator[Reason]:
        """Yield advice, the best first."""
        if Kind.OPEN in self.kinds:
            yield from self._texts(self._names)
        if self.kinds & SAY_WHAT_TO_DO or not self.kinds & NEEDS_ADVICE:
            return
        shown, first = self.outcome.shown, next(iter(self.outcome.shown), "")
        is_lost, is_machine = first == LOST, Kind.MACHINE in self.kinds
        is_step = not is_lost and first != "" and shown[first].one.row > 0
        is_read = not is_step and self.kinds != {Kind.MACHINE}  # a misreading leaves more
        if is_lost:
            yield from self.gap()
        if is_read:
            yield from self._texts(self._parts, self._half_turns)
        if SLOWING & shown.keys() or not is_machine:
            yield from self._windows()
        if not is_lost:
            yield from self.gap()
        if not is_step:
            yield from self._texts(self._times)
        if is_read:
            yield from self._texts(self._meanings, self._frames, self._aliased)
        if is_lost or not is_machine:
            yield from self._last()

    @staticmethod
    def _texts(*each: Callable[[], Iterator[str]]) -> Iterator[Reason]:
        """Yield each text as the reason that another reading explains the recording."""
        for texts in each:
            yield from (Reason(Kind.READING, x) for x in texts())

    def _fit(self, recording: Measured, known: Known | None = None, **how: Any) -> Outcome | None:
        """Return a fit, None if it costs too much, or if it needs more numbers or inputs."""
        if not recording.has_numbers:
            return None
        cost = self.cost * max(recording.t.size / self.recording.t.size, self.least)
        self.is_early &= cost <= self.left
        if cost > self.left:
            return None
        self.left -= cost
        with suppress(DataError):
            return best_fit(recording, self.body if known is None else known, **how)
        return None

    def _is_good(self, recording: Measured, known: Known | None = None, also: str = GOOD) -> bool:
        """Return whether a fit is good, and needs no faster spin or reversed angle.

        It must leave smaller residuals in most rows than the fit of the recording as it was read.
        """
        return self._is_better(self._fit(recording, known), also)

    def _is_better(self, found: Outcome | None, also: str = GOOD) -> bool:
        if found is None or found.verdict not in {GOOD, also}:
            return False
        most = self.outcome.noisiness + _AS_NOISY * len(found.residuals)
        return found.noisiness < most and not found.recording.is_mirrored and found.is_spin_slow

    def _times(self) -> Iterator[str]:
        """Yield that times have too few digits."""
        recording = self.recording
        if (seen := np.unique(recording.t).size) < _LEAST_TIMES * recording.t.size:
            yield f"t has only {seen} values in {recording.t.size} rows: write it with more digits"
        for row in misreadings(recording.source):
            if row.undo is evenly_timed:
                even = replace(measured(row.undo(recording.source)), sigma=recording.sigma)
                if self._is_good(even, self.known, also=STEADY):
                    yield f"{row.name}: {row.remedy} (the rows are {even.frame:.6g} apart)"

    def _names(self) -> Iterator[str]:
        """Yield that phi may be the precession, as in most books, if the fit is then good."""
        recording = self.recording
        if recording.angles.keys() == {"theta", "phi"} and self._is_good(recording.exchanged):
            yield "phi may be the precession, as in most books: name its column psi"

    def _meanings(self) -> Iterator[str]:
        """Yield the misreadings without which the fit is good.

        A reading of an axis is worth a fit if harmonics leave no more noise.
        """
        recording, is_angles = self.recording, self.recording.kind == "angles"
        calm = 0.0 if is_angles else calmness(recording.thinned(_ROWS)) + _AS_CALM
        for row in misreadings(recording.source):
            other = None
            if row.kind in {"attitude", "frame"}:
                with suppress(DataError):  # such as a tilt beyond 180 degrees
                    other = measured(row.undo(recording.source))
            if other is None or not (is_angles or calmness(other.thinned(_ROWS)) < calm):
                continue
            if self._is_good(other, self.known if is_angles else self.body):
                yield f"{row.name}: {row.remedy}"

    def _frames(self) -> Iterator[str]:
        """Yield the frames in which a top explains the motion, or the opposite ones."""
        source = self.recording.source
        if self.recording.kind == "angles" or source.align.frame != Alignment().frame:
            return
        meanings = {"up": "of the data points up", "axis": "is the figure axis"}
        seen = source.observed()
        frames = own_frames(seen)
        up, figure = frames or (np.eye(3), np.eye(3))
        y_up = np.eye(3)[:, [2, 0, 1]]  # the commonest, if noise hides the vertical
        for near in (up, up * [1, -1, -1], *[y_up] * (frames is None)):
            space, body = near, figure
            align = alignment_of((space, body), left=False)
            if align == Alignment():
                continue
            other = source.read_as(align=align) if align else in_frames(source, space, body)
            found = self._fit(measured(other))
            for _ in range(0 if align else _REFINED):
                if found is None or not found.failed or Kind.MOTION in found.kinds:
                    break
                exact = rotations.of_angles(*found.motion(seen.t - found.recording.t_start))
                space, body = refined((space, body), seen, exact)
                found = self._fit(measured(in_frames(source, space, body)))
            if not self._is_better(found):
                continue
            if align is None:
                yield f"space is turned by {turn_of(space)}, the body by {turn_of(body)}"
                continue
            named = {"up": align.up, "axis": align.axis}
            words = " and ".join(
                f"the {x} axis {meanings[y]}" for y, x in named.items() if x != "z"
            )
            if align.up == "-z" and self.recording.kind == "axis":
                words += ", or the marker is opposite to the centre of mass"
            aliased = "".join(f"; or {x}" for x in self._aliased())
            yield f"{words}: use {arg('align', align)}{aliased}"

    def _aliased(self) -> Iterator[str]:
        """Yield the faster nutation that explains the recording.

        If rows are few, it may look like the nutation in an opposite frame.
        """
        recording, frequency = self.recording, self.outcome.frequency
        if not recording.is_even or frequency * recording.frame < 1 / _FEW_PER_PERIOD:
            return
        faster = self._fit(recording, frequency=1 / recording.frame - frequency)
        if faster is not None and faster.verdict == GOOD:
            rows = 1 / (faster.frequency * recording.frame)
            yield f"the nutation is aliased, with {rows:.3g} rows per period: record more than two"

    def _parts(self) -> Iterator[str]:
        """Yield which rows to leave out for a good fit: rows before a release, or outliers."""
        recording, found = self.recording, self.outcome
        if row := release(recording):
            free = recording.part(slice(row, None))
            if self._is_good(free):
                held = f"the top is held until about t = {free.t_start:.4g}"
                yield f"{held}: leave out the rows before the release"
        kept = np.ones(recording.t.size, bool)
        for _ in range(_ROUNDS):
            far = [x.t[x.beyond(_LEAVES)] for x in found.residuals.values()]
            wrong = np.isin(found.recording.t, np.concatenate(far))
            kept[np.flatnonzero(kept)[wrong]] = False
            if not wrong.any() or np.mean(kept) < 1 - _FEW:
                return
            if not (others := self._fit(recording.rows(kept))):
                return
            if self._is_better(found := others):
                rows, t = np.flatnonzero(~kept), recording.t_start + recording.t
                runs = np.split(rows, np.flatnonzero(np.diff(rows) > 1) + 1)
                ends = [dict.fromkeys(t[[x[0], x[-1]]].tolist()) for x in runs]
                shown = ", ".join(" to ".join(f"{y:.6g}" for y in x) for x in ends)
                yield f"leave out the rows at t = {shortened(shown)}"
                return

    def _half_turns(self) -> Iterator[str]:
        """Yield in how many rows spin or precession is half a turn off, because marks look alike.

        Twice the angle has no such jumps: it shows by how much they have changed the mean rate.
        """
        recording, motion = self.recording, self.outcome.motion(self.recording.t)
        for name in sorted({"phi", "psi"} & {*recording.channels}):
            angle = recording.angles[name]
            off, seen = angle - motion[ANGLES.index(name)], np.isfinite(angle)
            t, twice = recording.t[seen], 2 * off[seen]
            rate = mean_rate(t, twice, recording.frame)
            phase = np.angle(np.sum(np.exp(1j * (twice - rate * t))))
            off = within_half_turn(off - (rate * recording.t + phase) / 2)
            wrong = np.abs(off) > math.pi / 2
            if not wrong.any() or np.std((off - wrong * np.copysign(math.pi, off))[seen]) > _ALIKE:
                continue
            fixed = angle - wrong * math.pi
            if self._is_good(replace(recording, angles={**recording.angles, name: fixed})):
                at = recording.t_start + float(recording.t[wrong][0])
                where = (
                    f"{name} is half a turn off in {wrong.sum()} rows, the first at t = {at:.6g}"
                )
                yield f"{where}, as if two marks look alike: correct these rows"

    def _windows(self) -> Iterator[Reason]:
        """Yield the least number of windows that are all good and show a decay.

        If there is none, yield the loss of spin through the shortest windows.  In a window, a decay
        of the phase is as many times less significant as the window is shorter to the power of 2.5.
        """
        recording, decay = self.recording, self.outcome.shown.get(DECAY)
        least = (decay.size / decay.std / 2) ** 0.4 if decay else 0.0
        counts = [x for x in _WINDOWS if least <= x <= recording.t.size / _ROWS_PER_WINDOW]
        if not counts or len(recording.angles) == 1:  # whose known start is of the first window
            return
        start = bisect_left(counts, True, key=lambda x: self._are_good(x, *_ends(x)))
        for count in counts[start:]:
            seen = decay_of([x for i in _ends(count) if (x := self._window(count, i))])
            if seen and seen.time is not None and self._are_good(count, *range(count)):
                yield Reason(Kind.WINDOWS, f"the spin decays: use {arg('window', count)}")
                return
        fits = [x for i in _ends(counts[-1]) if (x := self._window(counts[-1], i))]
        if len(fits) == 3 and all(x.verdict == GOOD or self._is_closer(x) for x in fits):
            seen = decay_of(fits, is_good=False)
            numbers = [x.numbers[seen.quantity] for x in fits] if seen else []
            sizes = [-abs(x.value) for x in numbers]
            if seen and seen.time is not None and sizes == sorted(sizes):
                lost = f"{seen.quantity} falls from {numbers[0]} to {numbers[2]}"
                yield Reason(Kind.WINDOWS, f"the spin decays: {lost}, and within each window")

    def _window(self, count: int, number: int) -> Outcome | None:
        """Return the fit of one of some windows, None if rows are uneven or it costs too much."""
        if (count, number) not in self.windows:
            with suppress(LagtopError):
                part = self.recording.windows(count)[number]
                self.windows[count, number] = self._fit(part, chance=CHANCE / count)
        return self.windows.get((count, number))

    def _are_good(self, count: int, *numbers: int) -> bool:
        """Return whether some windows are good."""
        return all((x := self._window(count, i)) and x.verdict == GOOD for i in numbers)

    def _is_closer(self, part: Outcome) -> bool:
        """Return whether a window shows the spin much better than the whole recording.

        If the spin is not recorded, the precession shows it.
        """
        whole = self.outcome
        spin = whole.recording.spin_channel
        key, names = ("r0", [spin]) if spin in whole.residuals else ("b", ["psi", "across"])
        seen = [x for x in names if x in whole.residuals]
        rms = [(part.residuals[x].rms, whole.residuals[x].rms) for x in seen]
        return key in part.numbers and all(x <= _CLOSER * y for x, y in rms)

    @cached_property
    def _halves(self) -> list[Outcome]:
        """Nutating fits of the first half and of the second."""
        middle, fits = self.recording.t.size // 2, list[Outcome | None]()
        if middle >= LEAST_ROWS:
            halves = (self.recording.part(x) for x in (slice(middle), slice(middle, None)))
            fits = [self._fit(x) for x in halves]
        return [x for x in fits if x is not None and x.inputs is not None]

    def _off(self, half: Outcome, frames: int = 0) -> Array:
        """Return all rows minus the motion of a half, some frames late, over its residuals."""
        recording = self.recording.mirrored if half.recording.is_mirrored else self.recording
        t = recording.t + recording.t_start - half.recording.t_start + frames * recording.frame
        sizes = np.array([[x.rms] for x in half.residuals.values()])
        return np.asarray(recording.residuals(*half.motion(t)) / sizes)

    def lost_rows(self) -> tuple[int, int]:
        """Return the row before which rows are lost, and how many, by the motion of a half."""
        best = 0.0, 0, 0
        for half in self._halves:
            is_first = half.recording.t_start == self.recording.t_start
            way = 1 if is_first else -1  # later rows are late, or earlier ones are early
            each = [
                np.fmin(np.abs(self._off(half, way * x)), _LEAVES) for x in range(_MOST_LOST + 1)
            ]
            chi2 = np.stack([np.nansum(x**2, axis=0) for x in each])
            gains = chi2[0] - chi2
            before = np.cumsum(gains, axis=1) - gains
            sums = gains.sum(axis=1, keepdims=True) - before if is_first else before
            count, row = np.unravel_index(np.argmax(sums), sums.shape)
            best = max(best, (float(sums.max()), int(row), int(count)))
        return best[1:] if best[0] > _LEAVES**2 else (0, 0)

    def gap(self) -> Iterator[Reason]:
        """Yield how many rows are lost, and where, if a fit with this gap is good and better."""
        recording, shown = self.recording, self.outcome.shown
        late = self.outcome.late or shown.get(LOST)
        if not recording.is_even:
            return
        row, count = (late.one.row, round(late.size)) if late else self.lost_rows()
        other = self._fit(with_gap(recording, row, count)) if row and count > 0 else None
        if other is None or other.verdict != GOOD:
            return
        gain = float(self.outcome.deviance(other)) - 2 * math.log(3 * recording.t.size)
        others = [] if next(iter(shown), "") == LOST else [x.score for x in shown.values()]
        if gain > max([_SURE_GAP, *others]):
            text = f"{lost_text(recording, row, count)}: write the times of the frames"
            yield Reason(Kind.ROWS, text)

    def _last(self) -> Iterator[Reason]:
        """Yield where the recording leaves the motion of its first half, and what to check."""
        recording, begins = self.recording, ""
        first = next(iter(self._halves), None)
        if first and first.verdict == GOOD and first.recording.t_start == recording.t_start:
            away = np.nanmax(np.abs(self._off(first)), axis=0) > _LEAVES
            kept = np.convolve(away, np.ones(3), "valid") == 3
            row = int(np.argmax(kept))
            rest = recording.part(slice(row, None))
            if row and rest.t.size >= 2 * LEAST_ROWS and self._is_good(rest):
                again = f"another motion begins at t = {rest.t_start:.4g}"
                parts = f"fit both parts with {arg('t_max')} and {arg('t_min')}"
                yield Reason(Kind.READING, f"{again}: {parts}")
            begins = f"; large residuals begin at t = {rest.t_start:.4g}" * bool(kept.any())
        known = (
            "no known misreading" if self.is_early else "none of the misreadings that were tried"
        )
        start = [x for x in ("theta0", "psidot0") if x in self.known]
        short = ", and that the recording lasts for a period of the nutation"
        check = f"check {', '.join([*start, 'columns'])}, units and axes"
        text = f"{known} explains it{begins}: {check}{short * (not self.outcome.inputs)}"
        yield Reason(Kind.CHECK, text)


def _ends(count: int) -> tuple[int, int, int]:
    """Return the numbers of the first, a middle and the last window."""
    return 0, count // 2, count - 1
