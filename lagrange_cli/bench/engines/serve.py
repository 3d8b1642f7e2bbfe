"""What runs inside the process of an engine: builds the model once, then simulates on request."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from multiprocessing.connection import Connection
from typing import Any

import numpy as np

from ...arithmetic.types import Array
from .scaled_body import Body

Simulate = Callable[[Array], Array]
"""Runs from the start through growing times; returns a quaternion w, x, y, z for each."""

Build = Callable[[Body, str, Any], Simulate]
"""Makes the model of a body for a scheme and a setting."""


def serve(pipe: Connection, folder: str, module: str, order: tuple[Body, str, Any]) -> None:
    """Build the model of a module, then answer times by quaternions until nobody asks.

    The order is a body, a scheme and a setting.  The first answer is None.  A text in place of an
    answer is an error of the engine, and ends the process.  What the engine prints is lost; its
    files go to a folder.
    """
    os.chdir(folder)
    nowhere = os.open(os.devnull, os.O_WRONLY)
    for stream in (1, 2):
        os.dup2(nowhere, stream)
    with suppress(EOFError, BrokenPipeError):  # nobody asks any more
        try:
            build: Build = import_module(module).build
            simulate = build(*order)
            pipe.send(None)
            while True:
                pipe.send(np.asarray(simulate(pipe.recv())))
        except (EOFError, BrokenPipeError):
            raise
        except Exception as error:  # of any kind: it is the engine's, and the bench shows it
            first = str(error).strip().partition("\n")[0]
            pipe.send(f"{type(error).__name__}: {first}")


def stepped(
    body: Body,
    times: Array,
    steps_per_period: float,
    advance: Callable[[float, int], object],
    attitude: Callable[[], Any],
) -> Array:
    """Return the attitudes of an engine that `advance`s by a step so many times.

    Each gap between times takes equal steps, so that every time is hit.
    """
    rows, now = np.empty((times.size, 4)), 0.0
    for i, t in enumerate(times.tolist()):
        if count := body.steps(t - now, steps_per_period):
            advance((t - now) / count, count)
        rows[i], now = attitude(), t
    return rows
