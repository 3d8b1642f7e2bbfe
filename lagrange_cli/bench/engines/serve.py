"""What runs inside the process of an engine: builds the model once, then simulates on request."""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable
from functools import partial
from typing import IO, Any

import numpy as np

from ...arithmetic.types import Array
from .body import Body
from .wire import receive, send

Simulate = Callable[[Array], Array]
"""Runs from the start through growing times; returns a quaternion w, x, y, z for each."""

Build = Callable[[Body, str, Any], Simulate]
"""Makes the model of a body for a scheme and a setting."""


def serve(build: Build) -> None:
    """Answer requests on standard input until it ends.

    The first is the body, the scheme and the setting; each further one is times, answered by
    quaternions.  What the engine prints goes to standard error.
    """
    answers = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)
    requests = sys.stdin.buffer
    order = json.loads(receive(requests))
    simulates: list[Simulate] = []

    def prepare() -> bytes:
        simulates.append(build(Body(*order["body"]), order["scheme"], order["setting"]))
        return b""

    def run(times: bytes) -> bytes:
        return simulates[0](np.frombuffer(times)).tobytes()

    go_on = _answer(answers, prepare)
    while go_on:
        try:
            go_on = _answer(answers, partial(run, receive(requests)))
        except EOFError:
            return


def _answer(answers: IO[bytes], work: Callable[[], bytes]) -> bool:
    """Send what the work gives, or why it failed; return whether it gave anything."""
    try:
        payload = work()
    except Exception as error:  # of any kind: it is the engine's, and is told to the bench
        send(answers, error=f"{type(error).__name__}: {str(error).strip().partition(chr(10))[0]}")
        return False
    send(answers, payload)
    return True


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
