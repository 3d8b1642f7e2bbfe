"""`python tests/benchmark.py`: cost of a sample as ratios, all in one run on one thread.

Peers: the floor sin + cos + 3 arctan2, scipy.special's ellipj + 2 elliprj, heyoka's dense output.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from functools import partial

import numpy as np

from lagrange_cli import Top, solve
from lagrange_cli.angles import BLOCK
from lagrange_cli.closed_forms import CLOSED_FORMS
from lagrange_cli.elliptic.twofold import Array
from lagrange_cli.integrators import integrators

COUNT = 1_000_000
STARTS: dict[str, dict[str, float]] = {
    "worked example": {},
    "fast (trigonometric series)": {"r0": 200},
    "general start": {"psidot0": 3, "thetadot0": 2},
}


def nanoseconds(work: Callable[[], object], count: int = COUNT) -> float:
    """Least of seven runs after a warm-up, per sample."""
    work()
    best = float("inf")
    for _ in range(7):
        begun = time.perf_counter()
        work()
        best = min(best, time.perf_counter() - begun)
    return best / count * 1e9


def floor(t: Array) -> None:
    for first in range(0, t.size, BLOCK):
        x = t[first : first + BLOCK]
        np.sin(x), np.cos(x)
        for _ in range(3):
            np.arctan2(x, 1.5)


def main() -> None:
    rng = np.random.default_rng(0)
    t = np.sort(rng.uniform(0, 100, COUNT))
    t[0] = 0.0
    by_legendre = CLOSED_FORMS["scipy.special"].prepare(Top(), "double")
    by_taylor = integrators(60)["Taylor-euler"].prepare(Top(), 1e-16)
    least = nanoseconds(lambda: floor(t))
    rows = {
        "sin + cos + 3 arctan2": least,
        "scipy.special, ellipj + 2 elliprj": nanoseconds(partial(by_legendre, t)),
        "heyoka, dense output over 233 periods": nanoseconds(partial(by_taylor, t)),
    }
    for name, start in STARTS.items():
        sampler = solve(Top(**start)).sampler()
        rows[f"lagtop, {name}"] = nanoseconds(partial(sampler.angles, t))
        rows[f"lagtop, {name}, 1e9 s away"] = nanoseconds(partial(sampler.angles, t + 1e9))
        rows[f"lagtop, {name}, wrapped"] = nanoseconds(partial(sampler.angles, t, wrap=True))
    for name, cost in rows.items():
        print(f"{name:55} {cost:8.1f} ns  {cost / least:6.2f} x floor")


if __name__ == "__main__":
    main()
