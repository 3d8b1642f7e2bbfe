"""Twelve strata of hard scenes against the many-digit reference; a fixed subset of the battery.

The whole battery (200 scenes a stratum, four times each from 1e-9 to 1e12 periods) was run by
`python tests/test_strata.py 200`; its worst cases are the bounds here.
"""

from __future__ import annotations

import random
import sys

import mpmath
import pytest
from strata import STRATA, Scene, times

from lagrange_cli import Top, solve
from lagrange_cli.accuracy import EPS, Reference, angle_units

Worst = tuple[float, str, Scene]


def angle_error(scene: Scene, rng: random.Random) -> Worst:
    """Worst of the three angles over four times, in units."""
    motion, reference = solve(Top(**scene)), Reference(Top(**scene), 80)
    worst: Worst = (0.0, "", scene)
    chosen = times(rng, float(motion.T_nutation or 1), 4)
    for t, *angles in zip(chosen, *motion.angles(chosen), strict=True):
        theta, phi, psi = map(float, angles)
        for name, error in zip(
            ("theta", "phi", "psi"), angle_units((theta, phi, psi), reference.at(t)), strict=True
        ):
            worst = max(worst, (error, f"{name} at t = {t!r}", scene), key=lambda case: case[0])
    return worst


def record_error(scene: Scene) -> Worst:
    """Worst key of the record in eps, by the rules of the contract."""
    motion = solve(Top(**scene))
    worst: Worst = (0.0, "", scene)
    with mpmath.workdps(80):
        for key, exact in Reference(Top(**scene), 80).record().items():
            scale = 1 if key in ("u1", "u2") else abs(exact)
            error = float(abs(mpmath.mpf(getattr(motion, key)) - exact) / (EPS * (scale or 1e-99)))
            worst = max(worst, (error, key, scene), key=lambda case: case[0])
    return worst


def battery(stratum: str, count: int) -> tuple[Worst, Worst]:
    """The worst angle and the worst key of so many scenes."""
    rng = random.Random(f"lagtop {stratum}")
    scenes = [STRATA[stratum](rng) for _ in range(count)]
    return (
        max((angle_error(scene, rng) for scene in scenes), key=lambda case: case[0]),
        max(map(record_error, scenes), key=lambda case: case[0]),
    )


@pytest.mark.parametrize("stratum", STRATA)
def test_stratum(stratum: str) -> None:
    angles, keys = battery(stratum, 5)
    assert angles[0] <= 2.7, angles
    assert keys[0] <= 0.5, keys


if __name__ == "__main__":
    for name in STRATA:
        print(name, *battery(name, int(sys.argv[1])), sep="\n  ", flush=True)
