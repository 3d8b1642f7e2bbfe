"""Least squares from many starts at once, along bent valleys.

The method of Levenberg and Marquardt with the geodesic acceleration of Transtrum and Sethna,
Phys. Rev. E 83, 036701 (2011): a step follows the valley of chi^2 to second order, because one more
evaluation shows how the valley bends.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from ..arithmetic.types import Array

_STEP = 1e-6
"""Step of central differences over 1 + |x|; forward ones take a tenth."""
_PROBE = 0.1
"""Part of a step after which its bend is measured."""
_BENT = 0.75
"""Largest bend of a step, over the step."""
_TRIED = np.array([0.01, 0.3, 10.0])
"""Factors of the damping that are tried in each step."""
GAIN = 1e-3
"""Fall of chi^2 that a Gauss-Newton step promises at most at a minimum (twice the decrement)."""
_STUCK = 1e-2
"""Fall of chi^2 by a step over the promised fall, below which chi^2 has kinks or is flat."""
_SMALL = 0.1
"""Promised fall of chi^2 that ends a fit of very many numbers."""
Function = Callable[[Array, Any], Array]
"""Residuals of some tries, shape (starts, tries, numbers), from their parameters, shape (starts,
tries, parameters), and the numbers of the starts."""
Settled = Callable[[Array, Any], tuple[Array, Array]]
"""The same, with changed parameters before them, of which the linear ones are the best."""


def slopes(function: Function, x: Array, who: Any, *, central: bool) -> tuple[Array, Array]:
    """Return residuals at parameters of the shape (starts, parameters), and their derivatives."""
    here, count = x[:, np.newaxis], x.shape[-1]
    sizes = _STEP * (1 if central else 0.1) * (1 + np.abs(x))
    steps = sizes[..., np.newaxis] * np.eye(count)
    found = function(np.concatenate([here, here + steps, here - steps][: 2 + central], axis=1), who)
    below = found[:, count + 1 :] if central else found[:, :1]
    rise = (found[:, 1 : count + 1] - below).transpose(0, 2, 1)
    return found[:, 0], rise / ((1 + central) * sizes[:, np.newaxis])


def descended(
    function: Function,
    x: Array,
    steps: int,
    *,
    gain: float = GAIN,
    central: bool = True,
    settled: Settled | None = None,
) -> tuple[Array, Array]:
    """Return the least squares near each start, shape (starts, parameters), and their chi^2."""
    x, damping, who = x.copy(), np.full(len(x), 1e-2), np.arange(len(x))
    least, eye = np.full(len(x), np.inf), np.eye(x.shape[-1])
    for _ in range(steps):
        at = x[who]
        rest, rise = slopes(function, at, who, central=central)
        chi2, scale = np.sum(rest**2, axis=-1), np.linalg.norm(rise, axis=1) + 1e-12
        rise = rise / scale[:, np.newaxis]
        tried = np.clip(damping[who, np.newaxis] * _TRIED, 1e-12, 1e12)
        gram = rise.transpose(0, 2, 1) @ rise
        held = gram[:, np.newaxis] + tried[..., np.newaxis, np.newaxis] * eye

        def undoing(change: Array, held: Array = held, rise: Array = rise) -> Array:
            """Return the damped steps, in units of the scale, that undo changes."""
            return np.asarray(-np.linalg.solve(held, (change @ rise)[..., np.newaxis])[..., 0])

        speed = undoing(np.repeat(rest[:, np.newaxis], _TRIED.size, axis=1))
        along = function(at[:, np.newaxis] + _PROBE * speed / scale[:, np.newaxis], who)
        straight = speed @ rise.transpose(0, 2, 1)
        bend = undoing(((along - rest[:, np.newaxis]) / _PROBE - straight) / _PROBE)
        bend[2 * np.linalg.norm(bend, axis=-1) > _BENT * np.linalg.norm(speed, axis=-1)] = 0
        ends = at[:, np.newaxis] + (speed + bend) / scale[:, np.newaxis]
        ends, left = settled(ends, who) if settled else (ends, function(ends, who))
        found = np.sum(left**2, axis=-1)
        rows, best = np.arange(len(at)), np.argmin(found, axis=1)
        better = found[rows, best] < chi2
        x[who] = np.where(better[:, np.newaxis], ends[rows, best], at)
        damping[who] = np.where(better, tried[rows, best], damping[who] * 100)
        least[who] = np.where(better, found[rows, best], chi2)
        down = (rest[:, np.newaxis] @ rise)[:, 0]
        newton = np.linalg.solve(gram + 1e-13 * eye, down[..., np.newaxis])[..., 0]
        is_stuck = better & (chi2 - least[who] < _STUCK * gain)
        who = who[(np.sum(down * newton, axis=-1) > gain) & (damping[who] < 1e8) & ~is_stuck]
        if not who.size:
            break
    return x, least


def polished(function: Function, x: Array, steps: int) -> Array:
    """Return the least squares of very many numbers near those of some, shape (1, parameters).

    Steps of Gauss and Newton keep the slopes of the first, unless chi^2 grows.
    """
    who = np.zeros(1, int)
    rest, rise = slopes(function, x, who, central=False)
    inverse = np.linalg.pinv(rise[0].T @ rise[0], hermitian=True)
    best, chi2, least = x, float(np.sum(rest**2)), np.inf
    while chi2 < least:
        best, least, down = x, chi2, rest[0] @ rise[0]
        if down @ inverse @ down < _SMALL:
            return x
        x = x - inverse @ down
        rest = function(x[:, np.newaxis], who)[:, 0]
        chi2 = float(np.sum(rest**2))
    return descended(function, best, steps, gain=_SMALL, central=False)[0]
