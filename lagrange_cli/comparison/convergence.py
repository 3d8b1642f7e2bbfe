"""How the error of a method depends on its step."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..top.top import Top
from .numbers import Estimate, sentences

LOST_PHASE, ROUNDING = 0.3, 1e-8
"""Errors beyond which no order can be measured, and below which an error need not fall."""
LEAST_ORDER = 0.5
"""Least order of a method that converges."""
_RISES, _SPREAD, _PLATEAU = 1.2, 1.0, 0.5
"""Ratio of errors above which a finer step is worse; greatest spread of one method's orders; share
of the least error that remains at step 0 if the error has a plateau."""
_OTHER, _PHASES = 5e-3, 1.0
"""Relative difference of another top's parameters; largest errors from which e0 follows."""
_ORDERS = np.arange(0.5, 8.01, 0.05)


class Convergence(NamedTuple):
    """The dependence of the error on the step."""

    errors: Sequence[float]
    """Greatest error of each trajectory, up to the time at which the first one loses the phase."""
    sentence: str
    order: float | None = None
    """Fitted exponent; None if there are fewer than two errors to fit, or no single order."""
    converges: bool = True
    """Whether the error falls with the step, or no error needs to fall."""


def convergence(runs: Sequence[tuple[float, Array, Array]], limit: float) -> Convergence | None:
    """Return how the errors of runs (step, t, errors) fall with the step, None for fewer than two.

    The order is fitted to the greatest errors up to the time at which the first one exceeds 0.3
    rad, other than at its start, but over two rows at least.  Rounding errors are left out, because
    they grow with finer steps.  If the orders between neighbours differ by more than 1, there is no
    single order.
    """
    if len({h for h, _, _ in runs}) < 2:
        return None
    curves = [(abs(t - t[0]), np.fmax.accumulate(np.nan_to_num(x, nan=np.inf))) for _, t, x in runs]
    lost = [int(np.searchsorted(error, LOST_PHASE)) for _, error in curves]
    until = min((t[i - 1] for i, (t, _) in zip(lost, curves, strict=True) if i), default=np.inf)
    until = max(until, *(t[:2].max() for t, _ in curves))
    errors = [float(error[np.searchsorted(t, until, "right") - 1]) for t, error in curves]
    steps = [h for h, _, _ in runs]
    ends = [error[-1] for _, error in curves]
    step, error, end = np.array(sorted(zip(steps, errors, ends, strict=True))).T
    rises = (error[:-1] > _RISES * error[1:]) & (error[:-1] > ROUNDING)
    if rises.any():
        i = int(np.argmax(rises))
        said = f"The error rises from {error[i + 1]:.1e} to {error[i]:.1e} as the step falls from"
        said += f" {step[i + 1]:g} to {step[i]:g}: the order of the step sizes is wrong, the method"
        said += " varies, or the trajectory is of a different top."
        return Convergence(errors, said, converges=False)
    shown = end if end.max() < _PHASES else error
    plateau, tends = _plateau(step, shown)
    if plateau > max(limit, _PLATEAU * shown[0]) and end[-1] > _RISES * plateau:
        said = f"The error falls to {plateau:.1e} as the step falls to 0 (order {tends:.2f})"
        said += ": this is the motion of another top, or the engine has another equation."
        return Convergence(errors, said, tends, converges=False)
    if error[0] >= ROUNDING and error[1] < error[0] * (step[1] / step[0]) ** LEAST_ORDER:
        is_fine = max(errors) <= limit
        why = ["this is the motion of another top", "the numbers may have been rounded"][is_fine]
        said = f"The error does not fall with the step: {why}."
        return Convergence(errors, said, converges=min(errors) <= limit)
    usable = (error >= ROUNDING) & (error < LOST_PHASE)
    if len({*step[usable]}) < 2:
        usable = (error > 0) & (error < LOST_PHASE) & (np.arange(len(step)) >= error.argmin())
    x, y = np.log(step[usable]), np.log(error[usable])
    order = float(np.polyfit(x, y, 1)[0]) if len({*x}) > 1 else None
    if order is None or np.ptp(np.diff(y) / np.diff(x)) > _SPREAD or order < LEAST_ORDER:
        said = "The error falls with the step, but shows no single order of convergence"
        said += ": the errors are too small or too large, or the method varies."
        return Convergence(errors, said)
    said = f"The error falls with the step; the order of convergence is {order:.2f}."
    return Convergence(errors, said, order)


def _plateau(step: Array, error: Array) -> tuple[float, float]:
    """Return e0 and p of the errors e0 + c h^p that fit best, 0 for fewer than three."""
    if len({*step}) < 3 or not error.min() > 0:
        return 0.0, 1.0
    best = np.inf, 0.0, 1.0
    for order in _ORDERS:
        matrix = np.stack([1 / error, (step / step[-1]) ** order / error], axis=1)
        found = np.linalg.lstsq(matrix, np.ones(len(step)), rcond=None)[0]
        rest = float(np.linalg.norm(matrix @ found - 1))
        if found.min() >= 0 and rest < best[0]:
            best = rest, float(found[0]), float(order)
    return best[1:]


def named_at_step_0(
    top: Top, found: Convergence, steps: Sequence[float], estimates: Sequence[Estimate | None]
) -> Convergence:
    """Return a convergence with the motion at step 0, if that is another one than the top's.

    The estimates of the two finest steps tend to it with the order of the errors.  It is another
    motion if it differs by more than its distance from the finest step suggests.
    """
    known = {h: x for h, x in zip(steps, estimates, strict=True) if x and x.is_trusted}
    if len(known) < 2:
        return found
    fine, coarse = sorted(known)[:2]
    share = 1 / ((coarse / fine) ** (found.order or 1.0) - 1)
    last, before = known[fine]._asdict(), known[coarse]._asdict()
    at_0, is_other = dict[str, Any](), False
    for name, right in {"a": 1.0, "b": 1.0, "r0": 1.0, "decay": 0.0}.items():
        if last[name] is not None and before[name] is not None:
            at_0[name] = last[name] + (moved := share * (last[name] - before[name]))
            least = max(_OTHER, 3 * known[fine].axis.residual)
            least /= last["span"] if name == "decay" else 1.0
            is_other |= abs(at_0[name] - right) > max(least, 2 * abs(moved))
    if not is_other:
        return found
    said = "; ".join(sentences(top, known[fine]._replace(**at_0)))
    return found._replace(sentence=f"{found.sentence} At step 0, {said}.", converges=False)
