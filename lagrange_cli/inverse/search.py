"""The best fit of a recording, by least squares from the best of many starts.

The starts are closed-form tops with the nutation of the recording.  Their residuals at some rows
select a few, from which the least squares converge, first without the known inputs that the
recording determines.  If these agree, the fit is repeated with them.  If no nutation is visible, or
none is determined, a steady precession is fitted.  All of this is in units of the nutation period.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import DataError
from .checks import CHANCE, Residuals
from .known import Known, estimates, scaled_known, time_power
from .motions import STATE
from .nutation import nutating_outcome
from .outcome import FAILED, Number, Outcome
from .problem import STEPS, Minimum, Problem
from .recording import Recording
from .signals import (
    Signal,
    binned,
    neighbour_noise,
    noise_of,
    oscillation_in,
    signals_in,
    step_between,
)
from .starts import starts
from .steady import steady_outcome

_FEW_ROWS, _ROWS, _MANY_ROWS = 12, 50, 300
"""Rows at which all starts are compared, then the best, and rows of the first steps."""
_KEPT, _BLOCK = 1500, 2000
_STARTS, _FIRST_STEPS, _FINISHED = 20, 12, 3
"""Starts of the least squares, their first steps, and the number of those that converge."""
_ALIKE = 0.02
"""Relative difference of a and b below which two starts are the same."""
_COMPARABLE, _LIKELY = 50.0, 16.0
"""Factor of chi^2 above the least one, beyond which a start is dropped, and the difference of
-2 log(likelihood) below which two tops explain a recording equally well."""
_COARSE, _FINE, _LEAST_BINS, _MOST_ROWS = 20, 40, 600, 3000
"""Bins per nutation period for the starts and for the fit, their least number, and the number of
rows up to which the fit uses all of them."""
_SURE = 2.0
"""Standard deviations from which b has a sign, and r0 with it."""
_FASTER = 3.0
"""Ratio of spin rates from which the slower one tells the direction of psi."""
_CONTRADICTS = 3.0
"""Standard deviations from which a known input contradicts the recording."""
_LEAST_SIGMA = 1e-12
_Ways = Sequence[tuple[Recording, Mapping[str, Signal]]]


class Data(NamedTuple):
    """A recording in units of its nutation period, and what is known of its noise."""

    recording: Recording
    coarse: Recording
    fine: Recording
    signals: Mapping[str, Signal]
    """The signals of the coarse recording."""
    sizes: Array
    """Standard deviations of the channels in one row."""
    floors: Array
    turn: float
    """2 pi per frame if whole turns of the spin are invisible, else 0."""

    @classmethod
    def of(cls, one: Recording, signals: Mapping[str, Signal], scale: float, floors: Array) -> Data:
        """Return a recording in units of `scale`."""
        recording = replace(one, t=one.t / scale)
        signals = {x: y._replace(t=y.t / scale, rate=y.rate * scale) for x, y in signals.items()}
        periods = float(recording.t[-1])
        most = int(max(_COARSE * periods, _LEAST_BINS))
        coarse, few = binned(recording, signals, most), int(max(_FINE * periods, _LEAST_BINS))
        is_long = recording.t.size > max(_MOST_ROWS, 1.5 * few)
        fine = binned(recording, signals, few) if is_long else recording
        averaged = {x: y.averaged(most) for x, y in signals.items()}
        sigma = recording.sigma or {
            x: y * math.sqrt(coarse.rows_per_bin)
            for x, y in noise_of(averaged, 1.0, coarse).items()
        }
        sizes = np.maximum([sigma[x] for x in recording.channels], floors)
        turn = 2 * math.pi / recording.frame if recording.is_even else 0.0
        return cls(recording, coarse, fine, averaged, sizes, floors, turn)

    @property
    def mirrored(self) -> Data:
        """The same with psi counted in the other direction."""
        signals = {
            x: y._replace(y=-y.y, rate=-y.rate) if x == "psi" else y
            for x, y in self.signals.items()
        }
        return self._replace(
            recording=self.recording.mirrored,
            coarse=self.coarse.mirrored,
            fine=self.fine.mirrored,
            signals=signals,
        )


def best_fit(
    recording: Recording,
    known: Known,
    *,
    radians: bool = False,
    chance: float = CHANCE,
) -> Outcome:
    """Return the fit of one recording.

    If spin and precession are recorded, psi may count in the other direction.  `chance` is the
    probability that noise fails a test.  Raises DataError for a recording that cannot be fitted.
    """
    for alone, needed in (("theta", "psidot0"), ("psi", "theta0")):
        if recording.angles.keys() == {alone} and needed not in known:
            when = ", 0 if the top is released from rest" * (alone == "theta")
            raise DataError(f"{alone} alone does not determine a top: give {needed}{when}")
    signals = signals_in(recording)
    frequency, visible = oscillation_in(signals)
    lasts = frequency * recording.t[-1] >= 1
    noise = _noise(recording, signals)
    steady = steady_outcome(recording, known, signals, noise, frequency, radians=radians)
    steady.chance, outcome = chance, steady
    is_steady = not steady.failures()
    if (
        visible
        and lasts
        and not (is_steady and any(x.is_coarse for x in steady.residuals.values()))
    ):
        found = _nutation(recording, known, signals, frequency, noise, radians=radians)
        if found is not None:
            found.chance = chance
            failed = found.faults or found.misfits
            outcome = steady if failed and is_steady else found
    low = outcome.chi2_bounds[0]
    if outcome.chi2_dof is not None and outcome.chi2_dof < low:
        shown = f"{outcome.chi2_dof:.3g} is below {low:.3g}"
        outcome.notes.append(f"chi2/dof = {shown}: the noise is below sigma")
    widest = max(rest.widening(chance) for rest in outcome.residuals.values())
    if widest > 1 and outcome.verdict != FAILED:
        outcome.notes.append(
            "the residuals correlate from row to row (smoothed data, or an encoder): standard "
            f"deviations are {widest:.2g} times as large"
        )
    if outcome.failures() and visible and not lasts:
        outcome.hints.append("a recording must last for a period of the nutation")
    return outcome


def _noise(recording: Recording, signals: Mapping[str, Signal]) -> dict[str, tuple[float, float]]:
    """Return the step between values, and the noise of neighbours, of each channel."""
    if recording.kind != "angles":
        return dict.fromkeys(recording.channels, (0.0, math.inf))
    found = {}
    for name in recording.channels:
        values = recording.angles[name][np.isfinite(recording.angles[name])]
        smooth = values if name == "theta" else signals[name].y
        found[name] = step_between(values), neighbour_noise(smooth)
    coarsest = max(step for step, _ in found.values())
    return {x: (step or coarsest, noise) for x, (step, noise) in found.items()}


def _nutation(
    recording: Recording,
    known: Known,
    signals: Mapping[str, Signal],
    frequency: float,
    noise: Mapping[str, tuple[float, float]],
    *,
    radians: bool,
) -> Outcome | None:
    """Return the best fit of a nutation; None without a start."""
    scale = 1 / frequency
    given, known = known, scaled_known(known, scale)
    floors = np.array([noise[x][0] / math.sqrt(12) + _LEAST_SIGMA for x in recording.channels])
    data = Data.of(recording, signals, scale, floors)
    both = recording.kind == "angles" and {"psi", "phi"} <= recording.angles.keys()
    ways = [data, data.mirrored][: 1 + both]
    minima = _minima(ways, known, frequency_free=True)
    found, rival, other = _chosen(minima, data)
    if known and (found is None or found.unknown):
        minima = _minima(ways, known, frequency_free=False)
        found, rival, other = _chosen(minima, data)
    if found is None:
        return None
    way = data if not found.problem.recording.is_mirrored else ways[-1]
    factors = _widening(found, way)
    if np.any(factors > 1):
        found = Minimum.of(found.problem, found.x, floors, factors)
        found = _slowest(found, data.turn)
    pairs, texts, distances = _compared(found, known, data.turn, scale)
    if found.problem.free and known and not texts:
        found = _constrained(found, known, data.turn, floors, factors)
    is_sure = abs(found.values["b"]) > _SURE * found.std("b")
    turns = abs(found.values["r0"]) / data.turn if data.turn and found.problem.spins else 0.0
    seen = "phi" in recording.angles and not {"r0", "phidot0"} & found.problem.known.keys()
    result = nutating_outcome(
        found,
        replace(way.recording, t=recording.t),
        scale,
        noise,
        radians=radians,
        is_spin_known=not seen or (is_sure and turns < 0.5),
        is_even=bool(data.turn),
    )
    result.known, result.contradictions, result.distances = given, texts, distances
    result.notes += pairs
    if rival:
        shown = ", ".join(
            f"{x} = {rival.values[x] * scale ** time_power(x):.6g}"
            for x in ("a", "b", "r0")
            if x in rival.problem.names
        )
        result.faults.insert(0, f"another top explains the recording as well: {shown}")
    result.is_spin_slow = not seen or turns < 1 / (1 + _FASTER)
    result.notes[:0] = _assumed(found, other, turns if seen else 0.0, data.turn / scale, scale)
    return result


def _assumed(
    found: Minimum, other: Minimum | None, turns: float, turn: float, scale: float
) -> list[str]:
    """Return what was assumed of the spin and of the direction of psi."""
    notes = []
    faster = f"{abs(other.values['r0']) / (turn * scale):.2g}" if other and turn else ""
    if found.problem.recording.is_mirrored:
        note = "psi counts in the other direction: its sign was changed"
        notes.append(note + f" (else the spin makes {faster} turns per row or more)" * bool(faster))
    elif faster and turns > 1 / (1 + _FASTER):
        notes.append(
            f"psi may count in the other direction, if the spin makes {faster} turns per row"
        )
    if turns > 0.5:
        notes.append(
            f"the spin exceeds half a turn per row: r0 is known up to multiples of {turn:.6g}, and "
            "is the slowest possible rate"
        )
    return notes


def _widening(found: Minimum, data: Data) -> Array:
    """Return the factors of standard deviations for noise that is correlated from row to row."""
    problem = found.problem.of(data.recording)
    rows = problem.residuals(found.x[np.newaxis])[0]
    steps = data.floors * math.sqrt(12)
    t, present = data.recording.t, data.recording.present
    return np.array(
        [
            Residuals(t[is_in], y[is_in], step).widening()
            for y, is_in, step in zip(rows, present, steps, strict=True)
        ]
    )


def _minima(ways: Sequence[Data], known: Known, *, frequency_free: bool) -> list[Minimum]:
    """Return the best minima that differ."""
    begun: dict[Any, tuple[float, Data, Problem, Array]] = {}
    for data, problem, x in _best_starts(ways, known, free=frequency_free):
        few = problem.thinned(_MANY_ROWS)
        end, cost = few.solve(x, _FIRST_STEPS)
        if (phased := few.rephased(end)) is not end:
            end, cost = min((end, cost), few.solve(phased, _FIRST_STEPS), key=itemgetter(1))
        key = problem.recording.is_mirrored, f"{cost:.6g}"
        begun[key] = cost, data, problem, end  # each minimum once
    ends = sorted(begun.values(), key=itemgetter(0))[:_FINISHED]
    return [
        Minimum.of(problem.of(data.fine), end, data.floors)
        for cost, data, problem, end in ends
        if cost <= _COMPARABLE * ends[0][0]
    ]


def _chosen(
    minima: Sequence[Minimum], data: Data
) -> tuple[Minimum | None, Minimum | None, Minimum | None]:
    """Return the best minimum, a rival that is another top, and its mirror image.

    Minima that differ by whole turns of the spin per row are one.  Of two directions of psi that
    explain the recording as well, the recorded one is taken, unless its spin is much faster.
    """
    if not minima:
        return None, None, None
    slow = sorted((_slowest(x, data.turn) for x in minima), key=lambda x: x.badness)
    likely = [x for x in slow if x.badness < slow[0].badness + _LIKELY]
    best, image = likely[0], None
    for one in likely[1:]:
        if one.problem.recording.is_mirrored is not best.problem.recording.is_mirrored:
            plain, turned = (one, best) if best.problem.recording.is_mirrored else (best, one)
            is_turned = abs(turned.values["r0"]) * _FASTER < abs(plain.values["r0"])
            best, image = (turned, plain) if is_turned else (plain, turned)
            break
    mirrored = best.problem.recording.is_mirrored
    rivals = [
        x
        for x in likely
        if x.problem.recording.is_mirrored is mirrored and x is not best and x.differs(best)
    ]
    return best, rivals[0] if rivals else None, image


def _slowest(found: Minimum, turn: float) -> Minimum:
    """Return a minimum with the slowest spin of a rigid body that looks alike in the rows."""
    if not turn or "r0" not in found.problem.names or found.problem.is_tied:
        return found
    v, std = found.values, found.std("b")
    rates = v["r0"] + turn * np.arange(-3, 4)
    if abs(v["b"]) > _SURE * std:
        low, high = (v["b"] - 2 * math.copysign(std, v["b"])) / rates, v["b"] / rates
        rates = rates[(high > 0) & (low <= 2)]
    rate = float(rates[np.argmin(np.abs(rates))]) if rates.size else v["r0"]
    return found.turned(rate - v["r0"]) if rate != v["r0"] else found


def _compared(
    found: Minimum, known: Known, turn: float, scale: float
) -> tuple[list[str], list[str], dict[str, float]]:
    """Return notes on known inputs that agree, contradictions, and distances in sigmas."""
    if not found.problem.free:
        return [], _pulled(found, scale), {}
    fixed = {x for x in found.problem.known if x in STATE}
    seen = {x: y for x, y in known.items() if x not in fixed}
    numbers = found.numbers(
        lambda x: (
            estimates(seen, found.problem.values(x), turn, spins="r0" in found.problem.names)
            or {"": np.zeros(len(x))}
        )
    )
    notes, texts, distances = [], [], {}
    for name, (value, std, _) in numbers.items():
        if not name:
            continue
        given, spread = known[name]
        size = scale ** time_power(name) * (180 / math.pi if name == "theta0" else 1)
        far = abs(given - value) / max(math.hypot(std, spread), 1e-9 * abs(value))
        distances[name] = far
        unit = " deg" * (name == "theta0")
        shown = f"known {name} = {_text(given * size, spread * size)}{unit}"
        own = f"{_text(value * size, std * size)}{unit}"
        if far > _CONTRADICTS:
            others = [x for x in ("m", "g", "s", "A", "A_cm", "r0") if x in known and x != name]
            others = others if name in {"A", "A_cm", "C"} else []
            check = f", or check {', '.join(others)}" * bool(others)
            text = f"{shown} contradicts the recording, which gives {own}, {far:.3g} sigma apart"
            texts.append(f"{text}: omit {name}{check}")
        else:
            notes.append(f"{shown} agrees with the recording, which gives {own}: {far:.1f} sigma")
    if "steady" in known:
        texts.append(
            "known psidot0 = steady contradicts the recording, which nutates: omit psidot0"
        )
    return notes, texts, distances


def _pulled(found: Minimum, scale: float) -> list[str]:
    """Return contradictions of uncertain inputs that a fit has pulled away from their values."""
    texts = []
    for name, std in found.problem.stds.items():
        given, value = found.problem.known[name], found.values[name]
        if abs(value - given) > _CONTRADICTS * std:
            size = scale ** time_power(name)
            texts.append(
                f"known {name} = {_text(given * size, std * size)} contradicts the recording, "
                f"which gives {_text(value * size, found.std(name) * size)}: omit {name}"
            )
    return texts


def _text(value: float, std: float) -> str:
    return str(Number(value, std, "")) if std else f"{value:.6g}"


def _constrained(
    found: Minimum, known: Known, turn: float, floors: Array, factors: Array
) -> Minimum:
    """Return the minimum with all known inputs, from the one without them."""
    old, v = found.problem, found.values
    problem = Problem(old.recording, known, old.sizes, turns=old.turns)
    moment = v.get("A", v.get("m", math.nan) * v.get("g", 1) * v.get("s", 1) * 2 / v["a"])
    if turn and "r0" in old.names:
        wanted = v["r0"]
        if "r0" in known:
            wanted = known["r0"][0]
        elif "phidot0" in known:
            wanted = known["phidot0"][0] + v["psidot0"] * math.cos(v["theta0"])
        elif problem.is_tied:
            wanted = v["b"] * moment / known["C"][0]
        shift = turn * round((wanted - v["r0"]) / turn)
        problem.turns += shift
        v["r0"] += shift
    x = np.array([problem.known.get(name, v.get(name, 0.0)) for name in problem.names])
    free, weights = old.names[: old.count], np.linalg.pinv(found.spread[: old.count])

    def apart(at: Array) -> Array:
        """Return distances from the minimum without known inputs, and from these."""
        values = problem.values(at)
        rest = np.stack([values[name] - v[name] for name in free], axis=-1)
        return np.column_stack([rest @ weights.T, *problem.priors(at)])

    return Minimum.of(problem, problem.solve(x, STEPS, apart)[0], floors, factors)


def _best_starts(
    ways: Sequence[Data], known: Known, *, free: bool
) -> list[tuple[Data, Problem, Array]]:
    """Return the best starts that differ; in each way psi is counted in one direction.

    Starts are scored by the logarithm of the noise that they leave.
    """
    tried: list[tuple[float, Data, Problem, Array]] = []
    for data in ways:
        problem = Problem(data.coarse, known, data.sizes, free=free)
        fixed = problem.known
        states = starts(data.signals, 1.0, fixed.get("theta0"))
        for name in fixed.keys() & {*STATE}:
            states[:, STATE.index(name)] = fixed[name]
        if "r0" in fixed or problem.is_even:  # r0 has the sign of b
            states = states[states[:, STATE.index("b")] * fixed.get("r0", 1.0) >= 0]
        spin, order = data.signals.get("phi"), np.arange(0)
        for count in (_FEW_ROWS, _ROWS) if len(states) > _KEPT else (_ROWS,):
            few = problem.thinned(count)
            blocks = np.array_split(states, len(states) // _BLOCK + 1)
            x = np.concatenate([few.parameters_of(y, spin, 1.0) for y in blocks])
            score = np.concatenate([few.noise(y) for y in np.array_split(x, len(blocks))])
            order = np.argsort(score)[:_KEPT]
            states = states[order]
        tried += zip(
            score[order].tolist(),
            [data] * len(order),
            [problem] * len(order),
            x[order],
            strict=True,
        )
    kept: list[tuple[Data, Problem, Array]] = []
    for size, data, problem, x in sorted(tried, key=itemgetter(0)):
        near = _ALIKE * (np.abs(x[:2]) + 1e-300)
        is_new = all(p is not problem or np.any(np.abs(x - y)[:2] > near) for _, p, y in kept)
        if is_new and len(kept) < _STARTS and math.isfinite(size):
            kept.append((data, problem, x))
    return kept
