"""What to try after a failed fit: only what another fit confirms."""

from __future__ import annotations

import math
from collections.abc import Iterator

import numpy as np

from .checks import CHANCE
from .decay import decay_of
from .known import Known
from .outcome import GOOD, Outcome
from .recording import Recording, reoriented
from .search import best_fit
from .signals import noise_of, oscillation_in, signals_in

_AXES = ("x", "y", "-x", "-y", "-z")
_ROWS = 250
"""Rows at which axes are compared."""
_CALMER = 0.7
"""Noise of harmonics in another frame, over that in the given one, from which a fit is tried."""
_HELD, _RELEASED = 12, 6.0
"""Least number of rows before a release, and the standard deviations that show it."""
_WINDOWS = (12, 32)
"""Numbers of windows to try if the spin may decay."""
_ROWS_PER_WINDOW, _PERIODS_PER_WINDOW = 24, 1.5
_BODY = ("m", "g", "s", "A", "A_cm", "C")


def hints(recording: Recording, known: Known, outcome: Outcome) -> list[str]:
    """Return what to try after a failed fit, if another fit confirms it."""
    if outcome.contradictions:
        return []
    if outcome.misfits:
        return [next(_tried(recording, known, outcome), "check columns, units and axes")]
    body = {name: x for name, x in known.items() if name in _BODY}
    return [*_frames(recording, body)] if recording.kind != "angles" else []


def _tried(recording: Recording, known: Known, outcome: Outcome) -> Iterator[str]:
    """Yield what makes the fit good, the likeliest mistakes first."""
    body = {name: x for name, x in known.items() if name in _BODY}
    if recording.kind != "angles":
        yield from _frames(recording, body)
    if (row := _release(recording)) and _is_good(recording.part(slice(row, None)), body):
        at = recording.t_start + float(recording.t[row])
        yield f"the top is held until about t = {at:.4g}: cut the rows before the release"
    both = recording.kind == "angles" and {"phi", "psi"} <= recording.angles.keys()
    if both and _is_good(recording.exchanged, known):
        yield "phi and psi are exchanged: here phi is the spin and psi the precession"
    yield from _decays(recording, body, outcome.frequency)


def _is_good(recording: Recording, known: Known, chance: float = CHANCE) -> bool:
    """Return whether a fit is good and needs no faster spin or reversed angle."""
    found = best_fit(recording, known, chance=chance)
    return found.verdict == GOOD and not found.recording.is_mirrored and found.is_spin_slow


def _frames(recording: Recording, known: Known) -> Iterator[str]:
    """Yield the axis of space or of the body in whose frame the motion is that of a top."""
    few = recording.rows(np.unique(np.linspace(0, recording.t.size - 1, _ROWS).astype(int)))
    tried = [("up", x) for x in _AXES]
    tried += [("axis", x) for x in _AXES] * (recording.kind == "attitude")
    noise = {one: _calmness(reoriented(few, **dict([one]))) for one in tried}
    best = min(noise, key=lambda one: noise[one])
    is_calmer = noise[best] < _calmness(few) + len(few.angles) * math.log(_CALMER)
    for word, axis in [*[best] * is_calmer, ("up", "-z")]:
        if _is_good(reoriented(recording, **{word: axis}), known):
            what = f"axis of the data points up: use align up={axis}"
            if word == "axis":
                what = f"axis is the figure axis: use align axis={axis}"
            yield f"the {axis} {what}"


def _calmness(recording: Recording) -> float:
    """Return the logarithm of the noise that harmonics of one frequency leave, over the angles."""
    signals = signals_in(recording)
    frequency, _ = oscillation_in(signals)
    return sum(math.log(x) for x in noise_of(signals, frequency, recording).values())


def _release(recording: Recording) -> int:
    """Return the row in which a top that was held begins to move, or 0."""
    rows = []
    for name, values in recording.angles.items():
        y = values if name == "theta" else np.unwrap(values)
        if name == "phi" or not np.isfinite(y).all():
            continue
        head = y[:_HELD]
        noise = max(float(np.std(head)), 1e-9) * _RELEASED
        moves = np.flatnonzero(np.abs(y - head.mean()) > noise)
        rows.append(int(moves[0]) if moves.size else y.size)
    row = min(rows, default=0)
    return row if _HELD < row < recording.t.size - 2 * _HELD else 0


def _decays(recording: Recording, known: Known, frequency: float) -> Iterator[str]:
    """Yield the number of windows that are good and show a decay."""
    for count in _WINDOWS:
        enough = count * _ROWS_PER_WINDOW < recording.t.size
        if not enough or frequency * recording.t[-1] < count * _PERIODS_PER_WINDOW:
            return
        parts, fits = recording.windows(count), list[Outcome]()
        for i in (0, count - 1, count // 2):
            fits.append(best_fit(parts[i], known, chance=CHANCE / count))
            if fits[-1].verdict != GOOD:
                break
        else:
            if (decay := decay_of(fits)) and decay.time:
                yield f"the spin decays: use window {count}"
            return
