"""The best fit of a recording, by least squares from the best of many starts.

The least squares descend from closed-form tops with the nutation of the recording, without the
known inputs that the recording determines.  If these agree, the fit is repeated with them.  If no
nutation is visible, or none is determined, a steady precession is fitted.  All of this is in units
of the nutation period.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..errors import DataError, arg
from ..top.inputs import all_replaced
from ..top.units import DEGREES, Units
from .checks import CHANCE, LARGEST, ROUNDING, Noise, Residuals
from .conditions import Comparison, compare, ties_of
from .known import START, Known, in_all_forms, scaled_known, time_power
from .measured import ANGLE_OF, LEAST_ROWS, Measured
from .minimum import MOST_ROWS, SURE, Minimum, converged, largest, minimum_at, slowest
from .nutation import nutating_outcome
from .outcome import Outcome
from .problem import Problem, Ties, problem_of
from .reasons import Kind
from .signals import (
    Signal,
    mean_rate,
    neighbour_noise,
    noise_of,
    oscillation_in,
    passes_pole,
    signals_in,
    step_between,
)
from .spins import FASTER, reversed_note
from .starts import best_starts, distinct
from .steady import steady_outcome

_STARTS = (12, 40)
"""Starts of the least squares, with and without a recorded tilt."""
_STAGES = ((60, 8, 1.0, 4), (250, 20, 0.1, 3))
"""Rows, steps, promised fall of chi^2 that ends them, and ends that are kept, by stage."""
_IN_PHASE = 0.7
"""Largest rms residual of the spin, in radians, of a motion that is in phase."""
_COMPARABLE = 5.0
"""Factor of the least chi^2 beyond which an end is dropped."""
_LIKELY = 16.0
"""Difference of -2 log(likelihood) below which two tops explain a recording equally well."""
_NEAREST = 3.0
"""Distance from a pole, over the noise of the tilt, in which spin and precession are not seen."""
_Noise = Mapping[str, Noise]


def best_fit(
    recording: Measured,
    known: Known,
    *,
    chance: float = CHANCE,
    units: Units = DEGREES,
    frequency: float | None = None,
) -> Outcome:
    """Return the fit of one recording, with numbers in some `units`.

    If spin and precession are recorded, psi may count in the other direction.  `chance` is the
    probability that noise fails a test.  The `frequency` of the nutation is by default that of the
    harmonics of the recording, which are of a slower one if it is aliased, or if rows are lost.
    Raises DataError for a recording that cannot be fitted.
    """
    for alone, needed in (("theta", "psidot0"), ("psi", "theta0")):
        if recording.angles.keys() == {alone} and needed not in all_replaced(known):
            when = ", 0 if the top is released from rest" * (alone == "theta")
            used = ", ".join(recording.source.source.used)
            shown = f"{alone} alone{f' (from {used})' * bool(used)}"
            raise DataError(f"{shown} does not determine a top: give {arg(needed)}{when}")
    signals = signals_in(recording)
    frequency, visible = (frequency, True) if frequency else oscillation_in(signals)
    lasts = frequency * recording.t[-1] >= 1
    noise = _noise(recording, signals)
    asked: dict[str, Any] = {"chance": chance, "units": units}
    outcome = steady_outcome(recording, known, signals, noise, frequency, **asked)
    if not (visible and lasts and outcome.failed):
        return outcome
    both = recording.kind == "angles" and {"psi", "phi"} <= recording.angles.keys()
    for form, of_form in _forms(recording, signals, noise):
        found = _nutation(form, known, frequency, of_form, asked, both=both)
        outcome = found or outcome
        if found and not any(x.kind < Kind.KNOWN for x in found.failed):
            break
    return outcome


def _noise(recording: Measured, signals: Mapping[str, Signal]) -> dict[str, Noise]:
    """Return what the data show of the noise of each channel."""
    smooth = {x: y.y for x, y in signals.items()}
    if "theta" in recording.angles:
        smooth["theta"] = recording.angles["theta"][np.isfinite(recording.angles["theta"])]
    ranges = {x: float(np.subtract(*np.quantile(y, (0.975, 0.025)))) for x, y in smooth.items()}
    if recording.kind != "angles":
        tilt, psi = (recording.angles[x][recording.present[0]] for x in ("theta", "psi"))
        axis = rotations.axis_of(rotations.of_angles(tilt, np.zeros_like(tilt), psi))
        noise = max(map(neighbour_noise, axis.T))
        both = {"theta": Noise(0.0, noise, ranges["theta"]), "across": Noise(0.0, noise)}
        return {x: both.get(x, Noise()) for x in recording.channels}
    found = {}
    for name in recording.channels:
        step = step_between(recording.angles[name][np.isfinite(recording.angles[name])])
        found[name] = Noise(step, neighbour_noise(smooth[name]), ranges[name])
    coarsest = max(x.step for x in found.values())
    return {x: y._replace(step=y.step or coarsest) for x, y in found.items()}


def _forms(
    recording: Measured, signals: Mapping[str, Signal], noise: _Noise
) -> Iterator[tuple[Measured, _Noise]]:
    """Yield the forms in which a recording is fitted, and their noise.

    Angles of an axis that may pass a pole are an axis or an attitude first: the noise of psi and
    phi grows without bound there, unless sigma says otherwise.  Else the rows next to the pole show
    neither.
    """
    angles = recording.angles
    if recording.kind == "angles" and "theta" in angles and passes_pole(signals["theta"]):
        if not recording.sigma and "psi" in angles:
            whole = replace(recording, kind="attitude" if "phi" in angles else "axis")
            yield whole, {x: noise[ANGLE_OF[x]] for x in whole.channels}
        is_seen = np.sin(angles["theta"]) > _NEAREST * noise["theta"][1]
        found = {x: y if x == "theta" else np.where(is_seen, y, np.nan) for x, y in angles.items()}
        if min(int(np.isfinite(y).sum()) for y in found.values()) >= LEAST_ROWS:
            recording = replace(recording, angles=found)
    yield recording, noise


def _nutation(
    recording: Measured,
    known: Known,
    frequency: float,
    noise: _Noise,
    asked: Mapping[str, Any],
    *,
    both: bool,
) -> Outcome | None:
    """Return the best fit of a nutation, with `both` directions of psi; None without a start.

    What is `asked` goes into the outcome.
    """
    scale, is_alone = 1 / frequency, len(recording.angles) == 1
    scaled = replace(recording, t=recording.t / scale)
    inputs, turn = scaled_known(known, scale), 2 * math.pi / scaled.frame if scaled.is_even else 0.0
    whole = in_all_forms({x: y for x, (y, _) in inputs.items()})
    start = {x: whole[x] for x in START if whole.has(x)}
    start |= {"r0": whole["r0"]} if "r0" in whole else {}
    floors = np.array([noise[x][0] / math.sqrt(12) + ROUNDING for x in recording.channels])
    ways = [scaled, scaled.mirrored][: 1 + both]
    for is_tied in [True] if is_alone else [False, True][: 1 + bool(inputs)]:
        ties = ties_of(inputs, None, spins="phi" in recording.angles) if is_tied else None
        minima = _minima(ways, floors, start if is_tied else {}, ties)
        best, rival, image = _chosen(minima, turn)
        if best is None:
            return None
        given = {} if is_tied else known
        best, all_rows = _refined(best, floors, turn), recording.t.size
        if rival and all_rows > MOST_ROWS:
            level = best.badness(all_rows) + _LIKELY
            rival = rival if _refined(rival, floors, turn).badness(all_rows) < level else None
        found = compare(best, given, scale, turn)
        if image and found.contradictions:
            other = compare(_refined(image, floors, turn), given, scale, turn)
            if not other.contradictions:
                found, image = other, best
                rival = rival if rival and other.vector.best.differs(rival) else None
        if not found.vector.best.unknown:
            break
    best = found.vector.best
    if is_tied:
        found.vector.known = {x: y for x, y in inputs.items() if x != "steady"}
    turns = abs(best.values["r0"]) / turn if turn and best.spins else 0.0
    is_sure = abs(best.values["b"]) > SURE * best.std("b")
    seen = "phi" in recording.angles and "r0" not in all_replaced(known)
    ratio, error = (x / (best.values["r0"] or math.inf) for x in (best.values["b"], best.std("b")))
    if recording.angles.keys() == {"theta", "phi"} and abs(ratio - 1) < 3 * error:
        found.notes.append(
            "C agrees with A, as it would if phi were the precession: if it is, name its column psi"
        )
    faster = abs(image.values["r0"]) / turn if image and turn else 0.0
    return nutating_outcome(
        found,
        replace(best.problem.recording, t=recording.t),
        scale,
        noise=noise,
        is_spin_known=not seen or (is_sure and turns < 0.5),
        is_even=bool(turn),
        rival=_shown(rival, scale) if rival else "",
        known=known,
        assumed=_assumed(found, faster, turns if seen else 0.0, turn / scale),
        is_spin_slow=not seen or turns < 1 / (1 + FASTER),
        **asked,
    )


def _refined(best: Minimum, floors: Array, turn: float) -> Minimum:
    """Return a minimum that has converged on all rows, with the slowest spin."""
    if not best.is_hopeless:
        factors = _widening(best, floors)
        best = converged(best.problem, best.x[np.newaxis], floors, factors, final=True)
    return slowest(best, turn)


def _minima(
    ways: Sequence[Measured], floors: Array, known: Mapping[str, float], ties: Ties | None
) -> list[Minimum]:
    """Return the minima of a recording that are about as good as the best.

    Each way, psi is counted in one direction.  None is refined if no motion of a top matches.
    """
    found: list[tuple[float, Problem, Array]] = []
    each = [signals_in(way) for way in ways]
    noise = ways[0].sigma or noise_of(each[0], 1.0, ways[0])
    sizes = np.maximum([noise[x] for x in ways[0].channels], floors)
    for way, signals in zip(ways, each, strict=True):
        count = _STARTS["theta" not in way.angles]
        states, zeros = best_starts(way, signals, sizes, known, count)
        problem, x = problem_of(way, sizes, states, zeros, ties)
        if not len(x):
            continue
        for rows, steps, gain, kept in _STAGES:
            few, x = _rephased(problem.thinned(rows), x)
            x, chi2 = few.solve(x, steps, gain, central=False)
            best = distinct(x, chi2, kept)
            problem, x, chi2 = replace(problem, first=few.first[best]), x[best], chi2[best]
        found += [(y, problem.at(i), x[i : i + 1]) for i, y in enumerate(chi2.tolist())]
    if not found:
        return []
    least, problem, x = min(found, key=lambda y: y[0])
    few = problem.thinned(_STAGES[-1][0])
    if largest(few, x) > LARGEST:
        return [replace(minimum_at(problem, x), is_hopeless=True)]
    return [converged(y, z, floors) for chi2, y, z in found if chi2 <= _COMPARABLE * least]


def _rephased(problem: Problem, x: Array) -> tuple[Problem, Array]:
    """Return the problem and parameters whose spin is right to a turn over the recording."""
    if not problem.spins:
        return problem, x
    one, x, first = problem.recording, x.copy(), problem.first.copy()
    rest = problem.residuals(x[:, np.newaxis])[:, 0, one.channels.index(one.spin_channel)]
    for i, y in enumerate(rest):
        seen = np.isfinite(y)
        if seen.any() and np.mean(y[seen] ** 2) > _IN_PHASE**2:
            rate = mean_rate(one.t[seen], y[seen], one.frame)
            x[i, problem.names.index("r0")] += rate
            first[i, 1] += np.angle(np.sum(np.exp(1j * (y[seen] - rate * one.t[seen]))))
    return replace(problem, first=first), x


def _widening(found: Minimum, floors: Array) -> Array:
    """Return the factors of standard deviations for noise that is correlated from row to row."""
    one, factors = found.problem.recording, []
    rows = found.problem.residuals(found.x[np.newaxis, np.newaxis])[0, 0]
    for y, x, step in zip(rows, one.present, floors * math.sqrt(12), strict=True):
        rest = Residuals(one.t[x], y[x], step)
        excess, chance = rest.structure(1.0) if rest.is_coarse else (1.0, 1.0)
        repeated = math.sqrt(excess) if chance < CHANCE else 1.0  # in each period, by an encoder
        factors.append(max(rest.widening(), repeated))
    return np.array(factors)


def _chosen(
    minima: Sequence[Minimum], turn: float
) -> tuple[Minimum | None, Minimum | None, Minimum | None]:
    """Return the best minimum, a rival that is another top, and its mirror image.

    Minima that differ by whole turns of the spin per row are one.  Of two directions of psi that
    explain the recording as well, the recorded one is taken, unless its spin is much faster.  A
    mirror image whose a or b has another size is a rival, too, unless its spin is much faster than
    one that is slow.
    """
    slow = [slowest(x, turn) for x in minima]
    levels = [x.badness() for x in slow]
    order = [i for i in np.argsort(levels).tolist() if levels[i] < min(levels) + _LIKELY]
    likely = [slow[i] for i in order]
    ways = [[x for x in likely if x.problem.recording.is_mirrored is way] for way in (False, True)]
    plain, turned = (abs(x[0].values["r0"]) if x else math.inf for x in ways)
    if turned * FASTER < plain:
        ways.reverse()
    best, image = (x[0] if x else None for x in ways)
    slow_spin = min(plain, turned)
    is_open = 2 * (1 + FASTER) * slow_spin >= turn
    others = [x for x in ways[1] if is_open or abs(x.values["r0"]) < FASTER * slow_spin]
    return best, next((x for x in ways[0] + others if best and x.differs(best)), None), image


def _shown(rival: Minimum, scale: float) -> str:
    """Return the numbers of another top in the units of the recording."""
    names = ["a", "b", *["r0"] * rival.spins]
    return ", ".join(f"{x} = {rival.values[x] * scale ** time_power(x):.6g}" for x in names)


def _assumed(found: Comparison, faster: float, turns: float, turn: float) -> list[str]:
    """Return what was assumed of the spin and of the direction of psi.

    The spin makes some turns per row, or `faster` ones if psi counts in the other direction.
    """
    notes = []
    if found.vector.best.problem.recording.is_mirrored:
        notes.append(reversed_note(faster))
    elif faster and turns > 1 / (1 + FASTER):
        notes.append(
            f"psi may count in the other direction, if the spin makes {faster:.2g} turns per row"
        )
    if turns > 0.5:
        how = "rate that C selects" if found.is_selected else "slowest possible rate"
        notes.append(
            "the spin exceeds half a turn per row: r0 is known only up to multiples of "
            f"{turn:.6g}; the {how} is reported"
        )
    return notes
