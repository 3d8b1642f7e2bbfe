"""Advice after a failed fit: only remedies that another fit confirms."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from contextlib import suppress
from dataclasses import replace
from time import process_time

import numpy as np

from ..arithmetic.text import shortened
from ..errors import DataError, LagtopError, Message, arg
from ..recordings.frames import alignment_of, in_frames, own_frames, turn_of
from ..recordings.misreadings import misreadings
from ..recordings.options import Alignment
from ..top.inputs import BODY, replaced_by
from .checks import CHANCE
from .decay import decay_of
from .known import Known
from .measured import LEAST_ROWS, Measured, frames_of, measured
from .outcome import GOOD, STEADY, Outcome
from .reasons import WRONG, Kind, OtherReading
from .rows import likely_gap, with_gap
from .search import best_fit
from .signals import noise_of, oscillation_in, signals_in

_MEANINGS = {"up": "of the data points up", "axis": "is the figure axis"}
_ROWS = 250
"""Rows at which frames are compared before a fit."""
_AS_CALM = 0.01
"""Logarithm of the noise beside harmonics that another frame may have more."""
_CALMER = 0.1
"""Logarithm of the noise by which a part or windows must be calmer."""
_OUTLYING = 30.0
"""The same without outliers, over their share of the rows."""
_NOISY = 2.0
"""Residuals over the differences of neighbours from which other meanings of angles are tried."""
_AS_NOISY = 0.1
"""Logarithm of the usual residual, per channel, that another reading may have more."""
_SURE_GAP = 12.0
"""Fall of -2 log(likelihood) by lost rows, besides the cost of the search."""
_LEAVES = 6.0
"""Standard deviations beyond which a row leaves the motion of the first half."""
_HELD = 12
"""Least number of rows before a release."""
_RELEASED = 6.0
"""Standard deviations that show a release."""
_STILL = 3.5
"""Scatter of the rows before a release, over the noise of neighbours, above which they move."""
_BUDGET = 8.0
"""Seconds of the processor after which no further remedy is tried."""
_WINDOWS = (5, 10, 32, 64)
"""Numbers of windows to try if the spin may decay."""
_ROWS_PER_WINDOW = 24
"""Least number of rows in such a window."""
_FEW_PER_PERIOD = 8.0
"""Rows per nutation period from which an aliased nutation is unlikely."""
_FEW = 0.03
"""Largest share of rows that are outliers."""
_LEAST_TIMES = 0.25
"""Least share of times that differ."""
_WHOLE = 1e-4
"""Deviation of rounded times from whole units, in units."""
_ROUNDED = 0.6
"""Deviation of rounded times from even ones, in units."""
_LOST = 4.0
"""Standard deviations of a loss of spin if windows are not good."""
_STEADILY = 0.3
"""Least share of that loss in either half."""
_CLOSER = 0.3
"""Residual of the spin in a window over that of the whole recording."""


def hints(recording: Measured, known: Known, outcome: Outcome) -> Iterator[str]:
    """Yield what makes a failed fit good, the likeliest mistakes first, and then the usual ones."""
    body = {name: x for name, x in known.items() if replaced_by(name) in BODY}
    if len(recording.angles) == 1:  # of which a known start is a part
        body = dict(known)
    kinds = {x.kind for x in outcome.failed}
    if kinds & {Kind.PIVOT, Kind.ROWS} or not kinds & WRONG:  # which say what to do
        return
    until = process_time() + _BUDGET
    if (seen := np.unique(recording.t).size) < _LEAST_TIMES * recording.t.size:
        few = f"t has only {seen} values in {recording.t.size} rows: write it with more digits"
        yield OtherReading(few)
    even = evenly_timed(recording)
    if even is not None and _is_good(even, known, outcome, also=STEADY):
        even_rows = f"the rows are {even.frame:.6g} apart"
        yield OtherReading(f"t is rounded: write it with more digits ({even_rows})")
    is_far = any(x.rms > _NOISY * max(x.neighbours, x.step) for x in outcome.residuals.values())
    yield from _readings(recording, known, body, outcome, is_far=is_far, until=until)
    if process_time() < until and (aliased := _alias(recording, body, outcome)):
        yield OtherReading(aliased)
    noise, is_left = _calmness(recording), kinds != {Kind.MACHINE}  # rows may be left out
    wrong = {t for x in outcome.residuals.values() for t in x.t[x.outliers].tolist()}
    if is_left and 0 < len(wrong) <= _FEW * recording.t.size:
        rest = recording.rows(~np.isin(recording.t, [*wrong]))
        least = _OUTLYING * len(wrong) / recording.t.size
        if noise - _calmness(rest) > least and _is_good(rest, body, outcome):
            shown = ", ".join(f"{recording.t_start + t:.6g}" for t in sorted(wrong))
            yield OtherReading(f"leave out the rows at t = {shortened(shown)}")
    free = recording.part(slice(row := release(recording), None))
    if is_left and row and noise - _calmness(free) > _CALMER and _is_good(free, body, outcome):
        at = recording.t_start + float(recording.t[row])
        yield OtherReading(
            f"the top is held until about t = {at:.4g}: leave out the rows before the release"
        )
    is_alone = len(recording.angles) == 1  # its known start is that of the first window
    if not is_alone:
        yield from _decays(recording, body, outcome, noise, until)
    if process_time() < until:
        yield from gap(recording, body, outcome)
    if Kind.MACHINE in kinds:
        return
    start = [x for x in ("theta0", "psidot0") if x in known]
    short = ", and that the recording lasts for a period of the nutation"
    is_early = process_time() < until
    begins = _beginning(recording, body, outcome) if is_early else ""
    known_ones = "no known misreading" if is_early else "none of the misreadings that were tried"
    yield (
        f"{known_ones} explains it{begins}: check {', '.join([*start, 'columns'])}, units "
        f"and axes{short * (not outcome.inputs)}"
    )


def gap(recording: Measured, known: Known, outcome: Outcome) -> Iterator[str]:
    """Yield how many rows are lost, and where, if a fit with this gap is good and better."""
    if (found := likely_gap(recording)) is None:
        return
    row, count = found
    other = _tried(with_gap(recording, row, count), known)
    if other is None or other.verdict != GOOD:
        return
    gain = float(outcome.deviance(other)) - 2 * math.log(3 * recording.t.size)
    if gain > _SURE_GAP:
        at = recording.t_start + float(recording.t[row])
        rows = "1 row is" if count == 1 else f"{count} rows are"
        yield OtherReading(f"{rows} lost before t = {at:.6g}: write the times of the frames")


def _beginning(recording: Measured, known: Known, outcome: Outcome) -> str:
    """Return where the recording leaves the motion of its first half, in words, or empty."""
    half = recording.part(slice(0, recording.t.size // 2))
    found = _tried(half, known) if half.t.size >= 2 * LEAST_ROWS else None
    if found is None or found.verdict != GOOD or outcome.inputs is None:
        return ""
    rests = recording.residuals(*found.motion(recording.t))
    sizes = np.array([[x.rms] for x in found.residuals.values()])
    away = np.nanmax(np.abs(rests) / sizes, axis=0) > _LEAVES
    kept = np.convolve(away, np.ones(3), "valid") == 3
    if not kept.any():
        return ""
    at = recording.t_start + float(recording.t[np.argmax(kept)])
    return f"; the residuals begin at t = {at:.4g}"


def _is_good(recording: Measured, known: Known, outcome: Outcome, also: str = GOOD) -> bool:
    """Return whether a fit is good, and needs no faster spin or reversed angle.

    It must leave smaller residuals in most rows than the fit of the recording as it was read.
    """
    found = _tried(recording, known)
    if found is None or found.verdict not in {GOOD, also}:
        return False
    is_better = found.noisiness < outcome.noisiness + _AS_NOISY * len(found.residuals)
    return is_better and not found.recording.is_mirrored and found.is_spin_slow


def _tried(
    recording: Measured, known: Known, chance: float = CHANCE, *, frequency: float | None = None
) -> Outcome | None:
    """Return a fit, or None if the recording does not determine a top without other inputs."""
    try:
        return best_fit(recording, known, chance=chance, frequency=frequency)
    except DataError:
        return None


def evenly_timed(recording: Measured) -> Measured | None:
    """Return a recording at even times, if its times are these after rounding to some digits."""
    t = recording.t_start + recording.t
    sizes = (10.0**-k for k in range(9))
    unit = next((x for x in sizes if np.abs(t / x - np.round(t / x)).max() < _WHOLE), 0.0)
    frames = np.arange(t.size, dtype=float)
    for _ in range(4):
        step, start = np.polyfit(frames, recording.t, 1)
        off = np.abs(recording.t - start - step * frames)
        if unit / 10 < np.median(off) and off.max() < _ROUNDED * unit:
            return replace(recording, t=step * frames)
        frames = frames_of(recording.t, step)  # some are missing
    return None


def _readings(
    recording: Measured,
    known: Known,
    body: Known,
    outcome: Outcome,
    *,
    is_far: bool,
    until: float,
) -> Iterator[str]:
    """Yield the misreadings without which the fit is good, tried `until` some processor time.

    A reading is worth a fit if its nutation leaves no more noise beside harmonics.
    """
    calm = _calmness(recording.thinned(_ROWS)) + _AS_CALM
    is_angles = recording.kind == "angles"
    for row in misreadings(recording.source) if is_far or not is_angles else ():
        other = None
        if process_time() > until:
            return
        if row.kind in {"attitude", "frame"}:
            with suppress(DataError):  # such as a tilt beyond 180 degrees
                other = measured(row.undo(recording.source))
        if other is None or not (is_angles or _calmness(other.thinned(_ROWS)) < calm):
            continue
        if _is_good(other, known if is_angles else body, outcome):
            yield OtherReading(f"{row.name}: {row.remedy}")
    if not is_angles and recording.source.align.frame == Alignment().frame:
        yield from _frames(recording, body, outcome)


def _frames(recording: Measured, known: Known, outcome: Outcome) -> Iterator[str]:
    """Yield the frames in which a top explains the motion, or the opposite ones."""
    source = recording.source
    up, body = own_frames(source.observed()) or (np.eye(3), np.eye(3))
    for space in (up, up * [1, -1, -1]):
        align = alignment_of((space, body), left=False)
        other = source.read_as(align=align) if align else in_frames(source, space, body)
        if align == Alignment() or not _is_good(measured(other), known, outcome):
            continue
        if align is None:
            yield OtherReading(f"space is turned by {turn_of(space)}, the body by {turn_of(body)}")
            continue
        named = {"up": align.up, "axis": align.axis}
        words = [f"the {x} axis {_MEANINGS[key]}" for key, x in named.items() if x != "z"]
        opposite = ", or the marker is opposite to the centre of mass"
        is_opposite = align.up == "-z" and recording.kind == "axis"
        where = f"{' and '.join(words)}{opposite * is_opposite}: use {arg('align', align)}"
        aliased = _alias(recording, known, outcome)
        yield OtherReading(f"{where}{'; or ' * bool(aliased)}{aliased}")


def _alias(recording: Measured, known: Known, outcome: Outcome) -> str:
    """Return in words the faster nutation that explains the recording, or empty.

    If rows are few, it may look like the nutation in an opposite frame.
    """
    if not recording.is_even or outcome.frequency * recording.frame < 1 / _FEW_PER_PERIOD:
        return ""
    faster = _tried(recording, known, frequency=1 / recording.frame - outcome.frequency)
    if faster is None or faster.verdict != GOOD:
        return ""
    rows = 1 / (faster.frequency * recording.frame)
    return f"the nutation is aliased, with {rows:.3g} rows per period: record more than two"


def _calmness(recording: Measured) -> float:
    """Return the logarithm of the noise that harmonics of one frequency leave, over the angles."""
    signals = signals_in(recording)
    frequency, _ = oscillation_in(signals)
    return sum(math.log(x) for x in noise_of(signals, frequency, recording).values())


def release(recording: Measured) -> int:
    """Return the row in which a top that was held begins to move, or 0.

    The first rows of a top that is held differ only by noise.
    """
    rows = []
    for name, values in recording.angles.items():
        seen = np.flatnonzero(np.isfinite(values))
        if name == "phi" or seen.size <= _HELD:
            continue
        y = values[seen] if name == "theta" else np.unwrap(values[seen])
        noise = max(float(np.std(y[:_HELD])), 1e-9) * _RELEASED
        moves = np.flatnonzero(np.abs(y - y[:_HELD].mean()) > noise)
        held = y[: moves[0]] if moves.size else y
        if np.std(held) > _STILL * math.sqrt(np.mean(np.diff(held) ** 2) / 2) + 1e-9:
            return 0
        rows.append(int(seen[moves[0]]) if moves.size else values.size)
    row = min(rows, default=0)
    return row if _HELD < row < recording.t.size - 2 * _HELD else 0


def _decays(
    recording: Measured, known: Known, outcome: Outcome, noise: float, until: float
) -> Iterator[str]:
    """Yield the number of windows that are all good and show a decay, or a decay within windows."""
    counts, lost = [x for x in _WINDOWS if x * _ROWS_PER_WINDOW <= recording.t.size], ""
    for count in counts:
        if process_time() > until:
            break
        try:
            parts, fits = recording.windows(count), list[Outcome]()
        except LagtopError:  # of rows that are not even
            return
        three = [parts.pop(i) for i in (-1, count // 2, 0)][::-1]
        if noise - sum(map(_calmness, three)) / len(three) < _CALMER:
            continue
        for part in three:
            found = _tried(part, known, CHANCE / count)
            if found is None:
                return
            fits.append(found)
            if found.verdict != GOOD and (count != counts[-1] or not _is_closer(found, outcome)):
                break
        else:
            lost = _loss(fits) or lost
        if all(x.verdict == GOOD for x in fits):
            decay = decay_of(fits)
            if decay is None or decay.time is None:
                return
            others = (_tried(part, known, CHANCE / count) for part in parts)
            if all(found is not None and found.verdict == GOOD for found in others):
                yield Message(f"the spin decays: use {arg('window', count)}")
                return
    if lost:
        yield f"the spin decays: {lost}, and within each window"


def _is_closer(part: Outcome, whole: Outcome) -> bool:
    """Return whether a window shows the spin much better than the whole recording.

    If the spin is not recorded, the precession shows it.
    """
    spin = whole.recording.spin_channel
    key, names = ("r0", [spin]) if spin in whole.residuals else ("b", ["psi", "across"])
    rms = [(part.residuals[x].rms, whole.residuals[x].rms) for x in names if x in whole.residuals]
    return key in part.numbers and all(x <= _CLOSER * y for x, y in rms)


def _loss(fits: Sequence[Outcome]) -> str:
    """Return a steady loss of spin from window to window in words, if there is one."""
    name = "r0" if all("r0" in x.numbers for x in fits) else "b"
    first, middle, last = (x.numbers[name] for x in fits)
    lost = abs(first.value) - abs(last.value)
    if lost < _LOST * math.hypot(first.own_std, last.own_std):
        return ""
    is_steady = _STEADILY < (abs(first.value) - abs(middle.value)) / lost < 1 - _STEADILY
    return f"{name} falls from {first} to {last}" * is_steady
