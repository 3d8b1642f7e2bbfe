"""Monte Carlo propagation of uncertainties (GUM supplement 1), through `sweep`.

Inputs are normal.  A tilt beyond a pole is reflected at the pole.  Invalid samples,
such as s < 0, are counted and left out.
"""

from __future__ import annotations

import math
from collections import Counter
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.value import Stds
from ..motion.kinds import vertical_remark
from ..motion.quantity import unit_name
from ..motion.regime import Regime
from ..output.terminal import Progress, silent
from .records import sweep

QUANTILES = (2.5, 16.0, 50.0, 84.0, 97.5)
"""Quantiles in percent; the first and the last bound the interval that covers 95 %."""
SAMPLES_AT_ONCE = 1 << 14
"""Number of samples computed together."""
MOST_SAMPLES = 1_000_000
LEAST_SAMPLES = 100
COVERAGE = 1.959963984540054
"""Standard deviations on either side that cover 95 % of a normal distribution."""
HOLDS, OPEN, FAILS = "yes", "undecided", "no"
_MISSING = 1e-3
"""Share of samples without a key, beyond which linear propagation counts as failed."""
_HALF_TURN = {"theta0_deg": 180.0, "theta0_rad": math.pi}


class Spread(NamedTuple):
    """The distribution of one key."""

    key: str
    value: float
    first_order_std: float | None
    """First-order uncertainty; None if there is no derivative."""
    sampled_mean: float
    sampled_std: float
    q2_5: float
    q16: float
    q50: float
    q84: float
    q97_5: float
    first_order: str
    """Whether the first-order interval agrees with the sampled one."""
    samples: int
    """Number of samples that have the key."""

    @property
    def noise(self) -> float:
        """The standard error of the sampled mean; the other numbers have similar errors."""
        return self.sampled_std / math.sqrt(self.samples) if self.samples else math.nan


class Propagated(NamedTuple):
    """Distributions of the keys, and regimes of the samples."""

    spreads: Sequence[Spread]
    regimes: Mapping[str, float]
    """The share of the samples in each regime; invalid samples count as `no top`."""


def propagate(
    inputs: Mapping[str, float],
    stds: Stds,
    numbers: Mapping[str, tuple[float, float | None]],
    *,
    samples: int,
    seed: int | None = None,
    radians: bool = False,
    progress: Progress = silent,
) -> Propagated:
    """Return the distributions of keys of the record, and the regimes of the samples.

    `numbers` has the value and the first-order uncertainty of each key.  Raises LagtopError for an
    invalid number of samples or seed, and if no sample is a valid top.
    """
    if not LEAST_SAMPLES <= samples <= MOST_SAMPLES:
        limits = f"[{LEAST_SAMPLES}, {MOST_SAMPLES}]"
        raise LagtopError(f"samples must be in {limits}, got {samples}", "samples")
    if seed is not None and seed < 0:
        raise LagtopError(f"seed must be >= 0, got {seed}", "seed")
    rng = np.random.default_rng(seed)
    keys = [unit_name(key, radians=radians) for key in numbers]
    columns: dict[str, list[Array]] = {key: [] for key in keys}
    regimes: Counter[str] = Counter()
    for first in progress(
        range(0, samples, SAMPLES_AT_ONCE), "samples", samples, lambda _: SAMPLES_AT_ONCE
    ):
        count = min(SAMPLES_AT_ONCE, samples - first)
        drawn = _drawn(rng, inputs, stds, count)
        wanted = [*keys, "regime", "remark", "error"]
        tops: dict[str, Any] = {**inputs, **drawn}
        found = sweep(keys=wanted, radians=radians, **tops)
        regimes.update(map(_regime, found["regime"], found["remark"]))
        for key in keys:
            column = np.asarray(found[key], dtype=float)
            columns[key].append(column[~np.isnan(column)])
    shares = {name: count / samples for name, count in regimes.most_common()}
    spreads = [
        _spread(shown, np.sort(np.concatenate(columns[shown])), *numbers[key], samples)
        for key, shown in zip(numbers, keys, strict=True)
    ]
    return Propagated(spreads, shares)


def _drawn(
    rng: np.random.Generator, inputs: Mapping[str, float], stds: Stds, count: int
) -> dict[str, Array]:
    """Return samples of the uncertain inputs."""
    drawn = {name: np.zeros(count) for name in stds}
    for variance, shares in stds.sources:
        normal = rng.normal(0.0, math.sqrt(variance), count)
        for name, share in shares.items():
            drawn[name] += normal * float(share)
    drawn = {name: inputs[name] + stds[name] * x for name, x in drawn.items()}
    for name, half in _HALF_TURN.items():
        if name in drawn:
            drawn[name] = half - np.abs(half - np.abs(drawn[name]) % (2 * half))
    return drawn


def _regime(regime: str | None, remark: str | None) -> str:
    """Return the regime of a sample, with the stability of a sleeping top."""
    if regime is None:
        return "no top"
    if regime != Regime.SLEEPING:
        return regime
    stable = remark == vertical_remark(Regime.SLEEPING, stable=True)
    return f"{regime}, {'stable' if stable else 'unstable'}"


def _spread(key: str, ordered: Array, value: float, std: float | None, samples: int) -> Spread:
    count = int(ordered.size)
    if not count:
        ordered = np.full(1, math.nan)
    q2_5, q16, q50, q84, q97_5 = np.percentile(ordered, QUANTILES).tolist()
    lost = 1 - count / samples
    verdict = FAILS if std is None or lost > _MISSING else first_order_holds(ordered, value, std)
    mean, deviation = float(ordered.mean()), float(ordered.std())
    quantiles = q2_5, q16, q50, q84, q97_5
    return Spread(key, value, std, mean, deviation, *quantiles, verdict, samples=count)


def first_order_holds(ordered: Array, value: float, std: float) -> str:
    """Return whether the first-order 95 % interval agrees with that of ordered samples.

    Its ends may differ by half a unit of the first digit of the uncertainty (GUM supplement 1, 8.1,
    with one digit).  If the noise of the quantiles is too large to decide, the result is OPEN.
    """
    if not std:
        return HOLDS if ordered[0] == ordered[-1] else FAILS
    tolerance = 0.5 * 10.0 ** math.floor(math.log10(std))
    worst = []
    for percent, side in ((QUANTILES[0], -1), (QUANTILES[-1], 1)):
        part = percent / 100
        noise = math.sqrt(part * (1 - part) / ordered.size)
        low, end, high = np.quantile(ordered, np.clip([part - noise, part, part + noise], 0, 1))
        off = abs(value + side * COVERAGE * std - end)
        worst.append((off - (high - low), off + (high - low)))  # two standard errors
    if all(most <= tolerance for _, most in worst):
        return HOLDS
    return FAILS if any(least > tolerance for least, _ in worst) else OPEN
