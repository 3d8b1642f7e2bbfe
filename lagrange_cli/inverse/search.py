"""The best fit of a recording, by least squares from the best of many starts.

The starts are closed-form tops with the nutation of the recording.  Their residuals at some rows
select a few, from which the least squares converge, first without the known inputs that the
recording determines.  If these agree, the fit is repeated with them.  If no nutation is visible, or
none is determined, a steady precession is fitted.  All of this is in units of the nutation period.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from operator import itemgetter
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..errors import DataError, Message, arg
from ..top.inputs import all_replaced
from ..top.units import DEGREES, Units
from .checks import CHANCE, LARGEST, Noise, Residuals
from .known import (
    Known,
    compared,
    estimates,
    in_all_forms,
    scaled_known,
    selects_any,
    time_power,
    whole_turns,
)
from .measured import LEAST_ROWS, Measured
from .motions import STATE
from .nutation import nutating_outcome
from .outcome import Outcome
from .problem import STEPS, Minimum, Problem, mean_squares
from .reasons import Kind, Reason
from .signals import (
    Signal,
    binned,
    neighbour_noise,
    noise_of,
    oscillation_in,
    passes_pole,
    signals_in,
    step_between,
)
from .starts import starts
from .steady import steady_outcome

_FEW_ROWS, _ROWS = 12, 50
"""Rows at which all starts are compared, then the best."""
_KEPT, _BLOCK, _STARTS, _BLIND_STARTS = 1500, 2000, 20, 80
"""Starts that are scored at more rows, at once, and from which least squares begin, also if the
tilt is not recorded."""
_ROUNDS = ((60, 6, 5), (150, 12, 3), (300, 15, 3))
"""Rows and steps of the first least squares, and the number of ends that are kept, by round."""
_ALIKE = 0.02
"""Relative difference of a and b below which two starts are the same."""
_HOPELESS, _COMPARABLE, _LIKELY = 50.0, 5.0, 16.0
"""Mean square of weighted residuals that no top explains, the factor of chi^2 above the least one
beyond which a start is dropped, and the difference of -2 log(likelihood) below which two tops
explain a recording equally well."""
_COARSE, _FINE, _LEAST_BINS, _MOST_ROWS = 20, 40, 600, 3000
"""Bins per nutation period for the starts and for the fit, their least number, and the number of
rows up to which the fit uses all of them, and of those it uses if an angle leaps within bins."""
_SURE = 2.0
"""Standard deviations from which b has a sign, and r0 with it."""
_FASTER = 3.0
"""Ratio of spin rates from which the slower one tells the direction of psi."""
_LEAST_SIGMA = 1e-12
_NEAREST = 3.0
"""Distance from a pole, over the noise of the tilt, in which spin and precession are not seen."""
_Noise = Mapping[str, Noise]


class Data(NamedTuple):
    """A recording in units of its nutation period, and what is known of its noise."""

    recording: Measured
    coarse: Measured
    fine: Measured
    signals: Mapping[str, Signal]
    """The signals of the coarse recording."""
    sizes: Array
    """Standard deviations of the channels in one row."""
    floors: Array
    turn: float
    """2 pi per frame if whole turns of the spin are invisible, else 0."""

    @classmethod
    def of(cls, recording: Measured, floors: Array) -> Data:
        """Return the data of a recording in units of its nutation period."""
        signals, periods = signals_in(recording), float(recording.t[-1])
        most, few = (int(max(x * periods, _LEAST_BINS)) for x in (_COARSE, _FINE))
        coarse = binned(recording, signals, most)
        is_long = recording.t.size > max(_MOST_ROWS, 1.5 * few)
        fine = binned(recording, signals, few) if is_long else recording
        averaged = {x: y.averaged(most) for x, y in signals.items()}
        noise = noise_of(averaged, 1.0, coarse)
        sigma = recording.sigma or {x: y * math.sqrt(coarse.rows_per_bin) for x, y in noise.items()}
        sizes = np.maximum([sigma[x] for x in recording.channels], floors)
        turn = 2 * math.pi / recording.frame if recording.is_even else 0.0
        return cls(recording, coarse, fine, averaged, sizes, floors, turn)


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
        if recording.angles.keys() == {alone} and needed not in known:
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
    ranges = {x: float(np.subtract(*np.quantile(y.y, (0.975, 0.025)))) for x, y in signals.items()}
    if "theta" in recording.angles:
        tilt = recording.angles["theta"][np.isfinite(recording.angles["theta"])]
        ranges["theta"] = float(np.subtract(*np.quantile(tilt, (0.975, 0.025))))
    if recording.kind != "angles":
        tilt, psi = (recording.angles[x][recording.present[0]] for x in ("theta", "psi"))
        axis = rotations.axis_of(rotations.of_angles(tilt, np.zeros_like(tilt), psi))
        noise = max(map(neighbour_noise, axis.T))
        both = {"theta": Noise(0.0, noise, ranges["theta"]), "across": Noise(0.0, noise)}
        return {x: both.get(x, Noise()) for x in recording.channels}
    found = {}
    for name in recording.channels:
        values = recording.angles[name][np.isfinite(recording.angles[name])]
        smooth = values if name == "theta" else signals[name].y
        found[name] = Noise(step_between(values), neighbour_noise(smooth), ranges[name])
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
            alias = {"across": "psi", "along": "phi"}
            yield whole, {x: noise[alias.get(x, x)] for x in whole.channels}
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
    scale = 1 / frequency
    given, known = known, scaled_known(known, scale)
    floors = np.array([noise[x][0] / math.sqrt(12) + _LEAST_SIGMA for x in recording.channels])
    scaled = replace(recording, t=recording.t / scale)
    ways = [Data.of(x, floors) for x in (scaled, scaled.mirrored)[: 1 + both]]
    turn = ways[0].turn
    for is_free in (True, False)[: 1 + bool(known)]:
        found, rival, image = _chosen(_minima(ways, known, free=is_free), turn)
        if (
            (found and image)
            and _contradicts(found, known, turn)
            and not _contradicts(image, known, turn)
        ):
            found, image = image, found
            rival = rival if rival and found.differs(rival) else None
        if found is not None:
            way = ways[found.problem.recording.is_mirrored]
            factors, problem = _widening(found, way), found.problem
            if way.fine.rows_per_bin > 1 and not way.fine.present.all():  # bins hide leaps
                problem = problem.of(way.recording.thinned(_MOST_ROWS))
            if not found.is_hopeless:
                found = Minimum.of(problem, found.x, floors, factors, is_final=True)
            found = _slowest(found, turn)
            if not found.unknown:
                break
    if found is None:
        return None
    known = _usable(found, known, turn)
    notes, texts, distances = _against_known(found, known, turn, scale)
    if "C" in given.keys() - known.keys():
        notes.append("known C is not used: it does not show how many turns per row the spin makes")
    if found.problem.free and known and not texts:
        found = _constrained(found, known, turn, floors, factors)
    is_sure = abs(found.values["b"]) > _SURE * found.std("b")
    turns = abs(found.values["r0"]) / turn if turn and found.problem.spins else 0.0
    seen = "phi" in recording.angles and "r0" not in all_replaced(found.problem.known)
    ratio, error = (
        x / (found.values["r0"] or math.inf) for x in (found.values["b"], found.std("b"))
    )
    if recording.angles.keys() == {"theta", "phi"} and abs(ratio - 1) < 3 * error:
        notes.append(
            "C agrees with A, as it would if phi were the precession: if it is, name its column psi"
        )
    faster = abs(image.values["r0"]) / turn if image and turn else 0.0
    return nutating_outcome(
        found,
        replace(way.recording, t=recording.t),
        scale,
        noise,
        is_spin_known=not seen or (is_sure and turns < 0.5),
        is_even=bool(turn),
        rival=_shown(rival, scale) if rival else "",
        known=given,
        reasons=[Reason(Kind.KNOWN, x) for x in texts],
        assumed=_assumed(found, faster, turns if seen else 0.0, turn / scale),
        notes=notes,
        distances=distances,
        is_spin_slow=not seen or turns < 1 / (1 + _FASTER),
        **asked,
    )


def _shown(rival: Minimum, scale: float) -> str:
    """Return the numbers of another top in the units of the recording."""
    return ", ".join(
        f"{x} = {rival.values[x] * scale ** time_power(x):.6g}"
        for x in ("a", "b", "r0")
        if x in rival.problem.names
    )


def _assumed(found: Minimum, faster: float, turns: float, turn: float) -> list[str]:
    """Return what was assumed of the spin and of the direction of psi.

    The spin makes some turns per row, or `faster` ones if psi counts in the other direction.
    """
    notes = []
    if found.problem.recording.is_mirrored:
        note = "psi counts in the other direction: its sign was changed"
        other = f" (else the spin makes {faster:.2g} turns per row or more)"
        notes.append(note + other * bool(faster))
    elif faster and turns > 1 / (1 + _FASTER):
        notes.append(
            f"psi may count in the other direction, if the spin makes {faster:.2g} turns per row"
        )
    if turns > 0.5:
        how = "rate that C selects" if found.problem.is_tied else "slowest possible rate"
        notes.append(
            "the spin exceeds half a turn per row: r0 is known only up to multiples of "
            f"{turn:.6g}; the {how} is reported"
        )
    return notes


def _widening(found: Minimum, data: Data) -> Array:
    """Return the factors of standard deviations for noise that is correlated from row to row."""
    one = data.recording
    rows = found.problem.of(one).residuals(found.x[np.newaxis])[0]
    channels = zip(rows, one.present, data.floors * math.sqrt(12), strict=True)
    factors = []
    for y, x, step in channels:
        rest = Residuals(one.t[x], y[x], step)
        excess, chance = rest.structure(1.0) if rest.is_coarse else (1.0, 1.0)
        repeated = math.sqrt(excess) if chance < CHANCE else 1.0  # in each period, by an encoder
        factors.append(max(rest.widening(), repeated))
    return np.array(factors)


def _minima(ways: Sequence[Data], known: Known, *, free: bool) -> list[Minimum]:
    """Return the best minima that differ; none is refined if no motion of a top matches."""
    ends = [(0.0, *x) for x in _best_starts(ways, known, free=free)]
    for rows, steps, kept in _ROUNDS:
        found = {}
        for _, data, other, start in ends:
            problem, x = other.beside_pole(start)
            few = problem.thinned(rows)
            end, cost = few.solve(x, steps)
            if (phased := few.rephased(end)) is not end:
                end, cost = min((end, cost), few.solve(phased, steps), key=itemgetter(1))
            found[problem.recording.is_mirrored, f"{cost:.6g}"] = cost, data, problem, end
        order = sorted(found.values(), key=itemgetter(0))
        ends = order[:kept]
        kinds = {end[2].recording.is_mirrored for end in ends}  # directions of psi
        ends += [x for x in order if x[2].recording.is_mirrored not in kinds][:1]
    minima: list[Minimum] = []
    for cost, data, problem, end in ends:
        few = problem.thinned(rows)
        rms = np.sqrt(mean_squares(few.residuals(end[np.newaxis])))
        is_hopeless = rms.max() > LARGEST or 2 * cost > _HOPELESS * few.recording.present.sum()
        if is_hopeless and not minima:
            return [replace(Minimum.of(few, end, data.floors), is_hopeless=True)]
        if cost <= _COMPARABLE * ends[0][0]:
            minima.append(Minimum.of(problem.of(data.fine), end, data.floors))
    return minima


def _chosen(
    minima: Sequence[Minimum], turn: float
) -> tuple[Minimum | None, Minimum | None, Minimum | None]:
    """Return the best minimum, a rival that is another top, and its mirror image.

    Minima that differ by whole turns of the spin per row are one.  Of two directions of psi that
    explain the recording as well, the recorded one is taken, unless its spin is much faster.  A
    mirror image whose a or b has another size is a rival, too, unless its spin is much faster than
    one that is slow.
    """
    slow = sorted((_slowest(x, turn) for x in minima), key=lambda x: x.badness)
    likely = [x for x in slow if x.badness < slow[0].badness + _LIKELY]
    ways = [[x for x in likely if x.problem.recording.is_mirrored is way] for way in (False, True)]
    plain, turned = (abs(x[0].values["r0"]) if x else math.inf for x in ways)
    if turned * _FASTER < plain:
        ways.reverse()
    best, image = (x[0] if x else None for x in ways)
    slow_spin = min(plain, turned)
    is_open = 2 * (1 + _FASTER) * slow_spin >= turn
    others = [x for x in ways[1] if is_open or abs(x.values["r0"]) < _FASTER * slow_spin]
    return best, next((x for x in ways[0] + others if best and x.differs(best)), None), image


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


def _moment(v: Mapping[str, float]) -> float:
    """Return A from the values of a minimum, NaN if it is not determined."""
    return v.get("A", v.get("m", math.nan) * v.get("g", 1) * v.get("s", 1) * 2 / v["a"])


def _usable(found: Minimum, known: Known, turn: float) -> Known:
    """Return the known inputs without a C that does not select one of the spins that look alike."""
    v, names = found.values, found.problem.names
    is_spin_seen = turn and "r0" in names and "r0" not in all_replaced(known)
    if not is_spin_seen or "C" not in known:
        return known
    parts = [known["C"], known.get("A", (1.0, 0.0)), *((v[x], found.std(x)) for x in ("a", "b"))]
    spread = math.hypot(*(std / (value or 1e-300) for value, std in parts))
    turns = abs(v["b"] * _moment(v) / known["C"][0]) / turn
    return {x: y for x, y in known.items() if x != "C" or not selects_any(turns, spread)}


def _against_known(
    found: Minimum, known: Known, turn: float, scale: float
) -> tuple[list[str], list[str], dict[str, float]]:
    """Return notes on known inputs that agree, contradictions, and distances in sigmas.

    A minimum that is not free has pulled uncertain inputs away from their values.
    """
    problem = found.problem
    if problem.free:
        seen = {x: y for x, y in known.items() if x not in STATE or x not in problem.known}
        spins = "phi" in problem.recording.angles
        numbers = found.numbers(lambda x: estimates(seen, problem.values(x), turn, spins=spins))
        at = problem.values(found.x[np.newaxis])
        slowest = {x: float(y[0]) for x, y in estimates(seen, at, 0.0, spins=spins).items()}
    else:
        numbers, slowest = {x: (found.values[x], 0.0, 0.0) for x in problem.stds}, {}
    notes, texts, distances = [], [], {}
    for name, (value, std, _) in numbers.items():
        size = scale ** time_power(name)
        given, own = ((x * size, y * size) for x, y in (known[name], (value, std)))
        other = slowest[name] * size if name in slowest else None
        far, agrees, text = compared(name, given, own, known, other)
        if problem.free:
            distances[name] = far
        if not agrees:
            texts.append(text)
        elif problem.free:
            notes.append(text)
    if problem.free and "steady" in known:
        texts.append(
            Message(
                "known psidot0 = steady contradicts the recording, which nutates: "
                f"omit {arg('psidot0')}"
            )
        )
    return notes, texts, distances


def _contradicts(found: Minimum, known: Known, turn: float) -> bool:
    """Return whether known inputs contradict a minimum that was found without them."""
    found = _slowest(found, turn)
    known = _usable(found, known, turn)
    return bool(found.problem.free and _against_known(found, known, turn, 1.0)[1])


def _constrained(
    found: Minimum, known: Known, turn: float, floors: Array, factors: Array
) -> Minimum:
    """Return the minimum with all known inputs, from the one without them."""
    old, v = found.problem, found.values
    problem = Problem(old.recording, known, old.sizes, turns=old.turns, pole=old.pole)
    if turn and "r0" in old.names:
        wanted = v["r0"]
        start = {x: v[x] for x in ("psidot0", "theta0")}
        if (whole := in_all_forms({x: y for x, (y, _) in known.items()} | start)).has("r0"):
            wanted = float(whole["r0"])
        elif problem.is_tied:
            wanted = v["b"] * _moment(v) / known["C"][0]
        shift = whole_turns(v["r0"], wanted, turn)
        problem.turns += shift
        v["r0"] += shift
    x = np.array([problem.known.get(name, v.get(name, 0.0)) for name in problem.names])
    free, weights = old.names[: old.count], np.linalg.pinv(found.spread[: old.count])

    def apart(at: Array) -> Array:
        """Return distances from the minimum without known inputs, and from these."""
        values = problem.values(at)
        rest = np.stack([values[name] - v[name] for name in free], axis=-1)
        return np.column_stack([rest @ weights.T, *problem.priors(at)])

    x, _ = problem.solve(x, STEPS, apart)
    return Minimum.of(problem, x, floors, factors, is_final=True)


def _best_starts(
    ways: Sequence[Data], known: Known, *, free: bool
) -> list[tuple[Data, Problem, Array]]:
    """Return the best starts that differ; in each way psi is counted in one direction.

    Starts are scored by the logarithm of the noise that they leave.
    """
    tried: list[tuple[float, Data, Problem, Array]] = []
    most = _STARTS if "theta" in ways[0].signals else _BLIND_STARTS
    for data in ways:
        problem = Problem(data.coarse, known, data.sizes, free=free)
        fixed = problem.known
        states = starts(data.signals, fixed.get("theta0"))
        for name in fixed.keys() & {*STATE}:
            states[:, STATE.index(name)] = fixed[name]
        if "r0" in fixed or problem.is_even:  # r0 has the sign of b
            states = states[states[:, STATE.index("b")] * fixed.get("r0", 1.0) >= 0]
        for count in (_FEW_ROWS, _ROWS) if len(states) > _KEPT else (_ROWS,):
            few = problem.thinned(count)
            blocks = np.array_split(states, len(states) // _BLOCK + 1)
            found = [few.started(y, data.signals.get("phi")) for y in blocks]
            x, noise = (np.concatenate(y) for y in zip(*found, strict=True))
            order = np.argsort(noise)[:_KEPT]
            states = states[order]
        x, noise = x[order], noise[order]
        for _ in range(most):
            if not x.size or not np.isfinite(noise[0]):
                break
            tried.append((float(noise[0]), data, problem, x[0]))
            is_new = np.any(np.abs(x - x[0])[:, :2] > _ALIKE * np.abs(x[0, :2]), axis=1)
            x, noise = x[is_new], noise[is_new]
    best = sorted(tried, key=itemgetter(0))[:most]
    return [x[1:] for x in best]
