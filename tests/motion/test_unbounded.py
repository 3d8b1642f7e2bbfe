"""Unbounded enclosures ask for more digits, and raise no other exception.

Run it for more scenes: `python tests/motion/test_unbounded.py 10000`.
"""

from __future__ import annotations

import random
import sys
from fractions import Fraction
from typing import Any

import pytest
from lagtop import LagtopError, Top, solve

from lagrange_cli.arithmetic.ball import TooFewDigitsError
from lagrange_cli.motion.over_time.proved_table import ProvedTable
from lagrange_cli.motion.record import NUMBER_KEYS, requested_keys

LARGEST, SMALLEST = 100, -300
"""Exponents of the largest and the smallest inputs; moments of inertia are at least 1e-100."""
KEYS = (*NUMBER_KEYS, *requested_keys())
COLUMNS = ("theta", "phi", "psi", "phidot", "psidot", "p", "q", "quaternion_w", "dphi")


def any_exponents(rng: random.Random) -> dict[str, Any]:
    """Return inputs of any size, also next to the vertical."""

    def size(least: int = SMALLEST) -> Fraction:
        return Fraction(f"{rng.uniform(1, 10):.15f}e{rng.randint(least, LARGEST - 1)}")

    def rate() -> Fraction:
        return rng.choice([-1, 0, 1, 1]) * size()

    scene: dict[str, Any] = {name: size(-LARGEST) for name in ("m", "A", "s", "g")}
    scene["C"] = scene["A"] * Fraction(rng.uniform(0.01, 2))
    tilt = rng.choice(
        [Fraction(rng.uniform(0, 180)), 180 - size() % 180, 10 ** rng.uniform(-150, 2)]
    )
    return scene | {"r0": rate(), "theta0_deg": tilt, "thetadot0": rate(), "psidot0": rate()}


def tried(count: int, seed: int) -> tuple[int, int]:
    """Return how many enclosures and tables of random tops said something, and how many nothing.

    Raises whatever they raise but TooFewDigitsError.
    """
    rng, bounded, unbounded = random.Random(seed), 0, 0
    for _ in range(count):
        try:
            motion = solve(Top(**any_exponents(rng)))
        except LagtopError:
            continue
        for digits in (6, 20):
            for key in KEYS:
                try:
                    ball = motion.enclosure(key, digits)
                    said = ball is None or ball.radius.is_finite()
                except TooFewDigitsError:
                    said = False
                bounded, unbounded = bounded + said, unbounded + (not said)
            time = Fraction(rng.uniform(-10, 10)) * Fraction(10) ** rng.randint(SMALLEST, LARGEST)
            try:
                sample = ProvedTable(motion, ["t"]).sample(time, digits)
                for column in COLUMNS:
                    sample.column(column)
            except TooFewDigitsError:
                unbounded += 1
    return bounded, unbounded


@pytest.mark.parametrize(
    ("count", "seed"), [(8, 5), *(pytest.param(50, i, marks=pytest.mark.slow) for i in range(4))]
)
def test_enclosures_of_any_size_ask_for_more_digits_or_say_something(count: int, seed: int) -> None:
    bounded, unbounded = tried(count, seed)
    assert bounded > 10 * count
    assert unbounded > 10 * count


if __name__ == "__main__":
    print(tried(int(sys.argv[1]), 0))
