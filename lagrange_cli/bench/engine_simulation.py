"""The process of an engine: the body that it simulates, and the server for its model.

The module imports little, because every engine starts it in a new process.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable
from contextlib import suppress
from multiprocessing.connection import Connection
from pkgutil import resolve_name
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array


class Body(NamedTuple):
    """A top with mass 1 and equatorial moment 1 about the pivot, in its initial state."""

    central: float
    """Equatorial moment about the mass centre, A - m s^2."""
    C: float
    s: float
    g: float
    attitude: tuple[float, float, float, float]
    """Quaternion w, x, y, z from body to space."""
    rates: tuple[float, float, float]
    """Angular velocity along body x, y, z."""
    period: float
    """Nutation period."""

    def steps(self, gap: float, per_period: float) -> int:
        """Return the number of equal steps in a gap, with at least `per_period` steps per period.

        A gap of a whole number of steps may be off by rounding.
        """
        return math.ceil(gap / self.period * per_period * (1 - 1e-9))

    def stepped(
        self,
        times: Array,
        steps_per_period: float,
        advance: Callable[[float, int], object],
        attitude: Callable[[], Any],
    ) -> Array:
        """Return the attitudes of an engine; `advance` makes a number of steps of a given length.

        Each gap between times is divided into equal steps, so that every time is hit.
        """
        rows, now = np.empty((times.size, 4)), 0.0
        for i, t in enumerate(times.tolist()):
            if count := self.steps(t - now, steps_per_period):
                advance((t - now) / count, count)
            rows[i], now = attitude(), t
        return rows


Simulate = Callable[[Array], Array]
"""A run from the start through increasing times; it returns a quaternion w, x, y, z for each."""

Build = Callable[[Body, str, Any], Simulate]
"""A function that makes the model of a body for a scheme and a setting."""


def serve(pipe: Connection, folder: str, model: str, order: tuple[Body, str, Any]) -> None:
    """Build a model, `module:function`, then answer times by quaternions until the pipe is closed.

    The order is a body, a scheme and a setting.  The first answer is None.  A text instead of an
    answer is an error of the engine, and ends the process.  Output of the engine is discarded, and
    its files go to a folder.
    """
    os.chdir(folder)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    with suppress(EOFError, BrokenPipeError):  # the pipe is closed
        try:
            build: Build = resolve_name(model)
            simulate = build(*order)
            pipe.send(None)
            while True:
                pipe.send(np.asarray(simulate(pipe.recv())))
        except (EOFError, BrokenPipeError):
            raise
        except Exception as error:  # of any kind: the bench shows errors of the engine
            first = str(error).strip().partition("\n")[0]
            pipe.send(f"{type(error).__name__}: {first}")
