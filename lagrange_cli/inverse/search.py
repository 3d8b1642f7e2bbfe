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
from .conditions import compare, ties_of
from .known import START, Known, in_all_forms, scaled_known, time_power
from .measured import ANGLE_OF, LEAST_ROWS, Measured
from .minimum import SURE, Minimum, converged, largest, minimum_at, slowest
from .nutation import nutating_outcome
from .outcome import Outcome
from .problem import Problem, Ties, problem_of
from .reasons import Kind, Reason
from .residuals import CHANCE, LARGEST, ROUNDING, Noise, Residuals
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
from .spins import FASTER, aliased_note, reversed_note, unsure_note
from .starts import best_starts, distinct
from .steady import steady_outcome

_STARTS = (12, 20)
"""Starts of the least squares, with and without a recorded tilt."""
_STAGES = ((60, 8, 1.0, 4), (250, 20, 0.1, 3))
"""Rows, steps, promised fall of chi^2 that ends them, and ends that are kept, by stage."""
_IN_PHASE = 0.7
"""Largest rms residual of the spin, in radians, of a motion that is in phase."""
_COMPARABLE = 2.0
"""Factor of the least chi^2 beyond which an end is dropped."""
_LIKELY = 16.0
"""Difference of -2 log(likelihood) below which two tops explain a recording equally well."""
_OPEN = 1 / 8
"""Turns of the spin per row from which psi may count in either direction."""
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

    `chance` is the probability that noise fails a test.  By default, the `frequency` of the
    nutation comes from the harmonics of the recording.  It is too low if the nutation is aliased,
    or if rows are lost.  Raises DataError for a recording that cannot be fitted.
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
    for form, of_form in _forms(recording, signals, noise):
        found = _directed(form, known, frequency, of_form, asked)
        outcome = found or outcome
        if found and all(x.kind >= Kind.KNOWN for x in found.wrong()):
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


def _directed(
    recording: Measured, known: Known, frequency: float, noise: _Noise, asked: Mapping[str, Any]
) -> Outcome | None:
    """Return the best fit of a nutation, of either direction of psi; None without a start.

    The other direction is tried if the fit has failed, or if the spin is so fast that another one
    looks alike.  It is taken if it explains the recording better, if its spin is much slower, or if
    it alone agrees with the known inputs.
    """
    plain = _nutation(recording, known, frequency, noise, asked)
    is_sure = recording.kind != "angles" or not {"psi", "phi"} <= recording.angles.keys()
    if is_sure or not plain or (plain.turns < _OPEN and not any(plain.wrong())):
        return plain
    image = _nutation(recording.mirrored, known, frequency, noise, asked)
    gain = plain.deviance(image) if image else -math.inf
    if not image or gain < -_LIKELY:
        return plain
    best, other = plain, image
    if gain > _LIKELY or image.turns * FASTER < plain.turns:
        best, other = image, plain
    is_alike = gain < _LIKELY
    kinds, of_other = ({x.kind for x in y.reasons} for y in (best, other))
    if is_alike and Kind.KNOWN in kinds and not of_other & {Kind.KNOWN, Kind.IMPOSSIBLE}:
        best, other = other, best
    notes, reasons = [*best.notes], [*best.reasons]
    if best is image:
        notes.insert(0, reversed_note(other.turns * is_alike))
    elif not best.is_spin_slow:
        notes.insert(0, unsure_note(other.turns))
    is_open = other.turns < FASTER * best.turns or min(best.turns, other.turns) >= _OPEN
    if is_alike and is_open and best.differs(other):
        reasons.append(_another_top({x: y.value for x, y in other.in_radians.items()}))
    return replace(best, notes=notes, reasons=reasons)


def _nutation(
    recording: Measured, known: Known, frequency: float, noise: _Noise, asked: Mapping[str, Any]
) -> Outcome | None:
    """Return the best fit of a nutation; None without a start.  What is `asked` goes into it.

    Known inputs take part in the search if the recording alone does not determine a top.
    """
    scale, is_alone = 1 / frequency, len(recording.angles) == 1
    scaled = replace(recording, t=recording.t / scale)
    inputs, turn = scaled_known(known, scale), 2 * math.pi / scaled.frame if scaled.is_even else 0.0
    whole = in_all_forms({x: y for x, (y, _) in inputs.items()})
    start = {x: whole[x] for x in START if whole.has(x)}
    start |= {"r0": whole["r0"]} if "r0" in whole else {}
    floors = np.array([noise[x][0] / math.sqrt(12) + ROUNDING for x in recording.channels])
    for is_tied in [True] if is_alone else [False, True][: 1 + bool(inputs)]:
        ties = ties_of(inputs, None, spins="phi" in recording.angles) if is_tied else None
        likely = _likely(_minima(scaled, floors, start if is_tied else {}, ties), turn)
        if not likely:
            return None
        best, rows = _refined(likely[0], floors, turn), recording.t.size
        level = best.badness(rows) + _LIKELY
        others = (_refined(x, floors, turn) for x in likely[1:] if best.differs(x))
        rival = next((x for x in others if best.differs(x) and x.badness(rows) < level), None)
        found = compare(best, {} if is_tied else known, scale, turn)
        is_told = start or found.vector.estimates(found.vector.z[np.newaxis])
        if not (found.vector.best.unknown and is_told):
            break
    best = found.vector.best
    if is_tied:
        found.vector.known = {x: y for x, y in inputs.items() if x != "steady"}
    sizes = {x: scale ** time_power(x) for x in ["a", "b", *["r0"] * best.spins]}
    rivals = [_another_top({x: rival.values[x] * y for x, y in sizes.items()})] if rival else []
    is_seen = "phi" in recording.angles and "r0" not in all_replaced(known)
    turns = abs(best.values["r0"]) / turn if turn and is_seen else 0.0
    is_sure = abs(best.values["b"]) > SURE * best.std("b")
    ratio, error = (x / (best.values["r0"] or math.inf) for x in (best.values["b"], best.std("b")))
    if recording.angles.keys() == {"theta", "phi"} and abs(ratio - 1) < 3 * error:
        found.notes.append(
            "C agrees with A, as it would if phi were the precession: if it is, name its column psi"
        )
    return nutating_outcome(
        found,
        recording,
        scale,
        noise=noise,
        is_spin_known=not is_seen or (is_sure and turns < 0.5),
        is_even=bool(turn),
        rivals=rivals,
        known=known,
        assumed=[aliased_note(turn / scale, is_selected=found.is_selected)] * (turns > 0.5),
        turns=turns,
        **asked,
    )


def _another_top(values: Mapping[str, float]) -> Reason:
    """Return the reason that a top with other a, b and r0 explains the recording as well."""
    shown = ", ".join(f"{x} = {values[x]:.6g}" for x in ("a", "b", "r0") if x in values)
    return Reason(Kind.OPEN, f"another top explains the recording as well: {shown}")


def _refined(best: Minimum, floors: Array, turn: float) -> Minimum:
    """Return a minimum that has converged on all rows, with the slowest spin."""
    if not best.is_hopeless:
        factors = _widening(best, floors)
        best = converged(best.problem, best.x[np.newaxis], floors, factors, final=True)
    return slowest(best, turn)


def _minima(
    recording: Measured, floors: Array, known: Mapping[str, float], ties: Ties | None
) -> list[Minimum]:
    """Return the minima of a recording, or one rough minimum if no motion of a top matches."""
    signals = signals_in(recording)
    noise = recording.sigma or noise_of(signals, 1.0, recording)
    sizes = np.maximum([noise[x] for x in recording.channels], floors)
    count = _STARTS["theta" not in recording.angles]
    states, zeros = best_starts(recording, signals, sizes, known, count)
    problem, x = problem_of(recording, sizes, states, zeros, ties)
    if not len(x):
        return []
    for rows, steps, gain, kept in _STAGES:
        few, x = _rephased(problem.thinned(rows), x)
        x, chi2 = few.solve(x, steps, gain, central=False)
        best = distinct(x, chi2, kept)
        problem, x, chi2 = replace(problem, first=few.first[best]), x[best], chi2[best]
    if not len(x):
        return []
    if largest(problem.at(0).thinned(rows), x[:1]) > LARGEST:
        return [replace(minimum_at(problem.at(0), x[:1]), is_hopeless=True)]
    ends = np.flatnonzero(chi2 <= _COMPARABLE * chi2[0]).tolist()
    return [converged(problem.at(i), x[i : i + 1], floors) for i in ends]


def _likely(minima: Sequence[Minimum], turn: float) -> list[Minimum]:
    """Return the minima that explain a recording about as well as the best, which comes first.

    Minima that differ by whole turns of the spin per row are alike: each gets the slowest spin.
    """
    slow = [slowest(x, turn) for x in minima]
    levels = [x.badness() for x in slow]
    order = np.argsort(levels).tolist()
    return [slow[i] for i in order if levels[i] < levels[order[0]] + _LIKELY]


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
