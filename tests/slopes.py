"""Derivatives by the judge in ball arithmetic: differences over a step of 2^-120 to either side."""

from __future__ import annotations

from collections.abc import Callable
from fractions import Fraction
from itertools import pairwise
from typing import TypeVar

from balls.angles import State
from balls.requested import Requested
from balls.scene import Undecided, arb_bits, scene_from
from flint import arb
from lagtop import LagtopError, Top, solve

BITS, STEP = 600, Fraction(1, 2**120)

T = TypeVar("T")


def judge_of(top: Top) -> Requested:
    """Return the judge's motion of a top, to be asked within `BITS`."""
    return Requested(scene_from(top.as_dict()), Fraction(top.A), Fraction(top.C))


class Slopes:
    """Derivatives of one top, from its own values and those a step to either side."""

    def __init__(self, top: Top) -> None:
        self.top = top
        self._records: dict[Top, dict[str, arb | None]] = {}
        self._motions: dict[Top, Requested] = {}

    def of_key(self, name: str, key: str) -> tuple[float, float] | None:
        """Return both differences of a key, on an edge one of them twice.

        None says that the key is missing on a side, or undecided.
        """

        def value(top: Top) -> arb | None:
            if top not in self._records:
                self._records[top] = judge_of(top).record()
            return self._records[top].get(key)

        return self._differences(name, value)

    def of_angle(self, name: str, angle: str, t: float) -> tuple[float, float] | None:
        """Return both differences of an angle at a time."""

        def value(top: Top) -> arb | None:
            if top not in self._motions:
                self._motions[top] = judge_of(top)
            state: State = self._motions[top].at(Fraction(t))
            found: arb = getattr(state, angle)
            return found

        return self._differences(name, value)

    def _differences(
        self, name: str, value: Callable[[Top], arb | None]
    ) -> tuple[float, float] | None:
        centre = Fraction(getattr(self.top, name))
        step = STEP * (abs(centre) or 1)
        with arb_bits(BITS):
            values: list[arb] = []
            for side in (-1, 0, 1):
                top = self._beside(name, centre + side * step) if side else self.top
                try:
                    found = value(top or self.top)
                except Undecided:
                    found = None
                if found is None:
                    return None
                values.append(found)
            over = arb(step.denominator) / step.numerator
            behind, ahead = (float(((y - x) * over).mid()) for x, y in pairwise(values))
            edges = [self._beside(name, centre + side * step) is None for side in (-1, 1)]
            return (ahead if edges[0] else behind), (behind if edges[1] else ahead)

    def _beside(self, name: str, value: Fraction) -> Top | None:
        try:
            top = self.top.replace(**{name: value})
            solve(top)
        except LagtopError:
            return None
        return top
