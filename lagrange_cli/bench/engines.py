"""Physics engines, each in a separate process that is started, queried, and killed if it hangs.

Another engine, or another scheme, is one entry in FAMILIES.
"""

from __future__ import annotations

import math
import multiprocessing
import textwrap
import weakref
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from multiprocessing.context import SpawnProcess
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from ..arithmetic.types import Array
from ..inputs.top import Top
from ..motion.solve import solve
from ..sweeps.jobs import interrupts_blocked, safe_path
from .engine_simulation import Body, serve
from .integrators import problem_of, quaternion_angles
from .method import AngleFunction, FailedError, Method, NotApplicableError

SECONDS_TO_START = 60.0
"""Time limit for the import of an engine, in seconds."""
LONGEST_ERROR = 80
"""Number of characters shown of an error of an engine."""
STEPS = [50, 200, 800, 3200]
MANY_STEPS = [200, 800, 3200, 12800]
"""Steps per nutation period of schemes with a fixed step; more for schemes of order 1."""
MODELS = f"{__package__}.engine_models"
IMPORTS = {"drake": "pydrake"}
"""Modules whose names differ from those of their packages."""


class EngineProcess:
    """A process that runs one model; it ends with this object.

    Files of the engine, such as a log, go to a temporary directory.
    """

    def __init__(self, model: str, body: Body, scheme: str, setting: Any) -> None:
        """Start the process and build the model.  Raises FailedError, as `attitudes` does."""
        folder = TemporaryDirectory(prefix="lagtop-")
        context = multiprocessing.get_context("spawn")
        self._pipe, other = context.Pipe()
        order = (other, folder.name, model, (body, scheme, setting))
        self._process = context.Process(target=serve, args=order, daemon=True)
        weakref.finalize(self, _stop, self._process, folder)
        with safe_path(), interrupts_blocked():
            self._process.start()
        other.close()
        self._answer(SECONDS_TO_START)

    def attitudes(self, t: Array, seconds: float) -> Array:
        """Return the quaternions (w, x, y, z; a row for each time) of a run.

        Raises FailedError if the engine has an error, exceeds the time limit, or ends.
        """
        with suppress(BrokenPipeError):  # the answer is the reason
            self._pipe.send(t)
        found: Array = self._answer(seconds)
        return found

    def _answer(self, seconds: float) -> Any:
        try:
            if not self._pipe.poll(seconds):
                self._process.kill()
                raise FailedError(f"took more than {seconds:g} s")
            answer = self._pipe.recv()
        except (EOFError, ConnectionError):
            self._process.join()
            code = self._process.exitcode
            raise FailedError(f"its process ended with exit code {code}") from None
        if isinstance(answer, str):
            raise FailedError(textwrap.shorten(answer, LONGEST_ERROR))
        return answer


def _stop(process: SpawnProcess, folder: TemporaryDirectory[str]) -> None:
    """End the process and free its resources."""
    if process.pid is not None:
        process.kill()
        process.join()
    folder.cleanup()


def scaled_body(top: Top, period: float) -> tuple[Body, float]:
    """Return the body of a top with this nutation period, and its units of time per unit of time.

    The units are scaled so that the mass is 1, A = 1, and the rates are of the size of 1.  No
    engine then gets very large or small numbers, whatever the units of the scene.  Raises
    NotApplicableError for moments that no mass distribution has, because engines refuse them.
    """
    p, mass, A = problem_of(top), float(top.m), float(top.A)
    clock = math.sqrt(p.a) + abs(p.b) + abs(p.theta_rate) + abs(p.psi_rate)
    s, C = float(top.s) * math.sqrt(mass / A), float(top.C) / A
    central = 1 - s * s
    if central <= 0 or C > 2 * central * (1 + 1e-12):
        raise NotApplicableError("engines refuse a body with C > 2(A - m s^2)")
    half = p.theta0 / 2
    body = Body(
        central=max(central, C / 2),
        C=C,
        s=s,
        g=p.a / clock / clock / (2 * s),
        attitude=(math.cos(half), math.sin(half), 0.0, 0.0),
        rates=(
            p.theta_rate / clock,
            p.psi_rate / clock * math.sin(p.theta0),
            p.r0 / clock,
        ),
        period=period * clock,
    )
    return body, clock


def engine_attitudes(
    package: str, scheme: str, top: Top, setting: Any, limit: float
) -> Callable[[Array], Array]:
    """Return a function for the quaternions (w, x, y, z; a row for each time) of an engine.

    The engine runs in a separate process for at most `limit` seconds.  Raises NotApplicableError
    for a body that engines refuse, and FailedError if the process does not start.  The function
    raises NotApplicableError for times before the start, and FailedError if a run fails.
    """
    body, clock = scaled_body(top, float(solve(top).T_nutation or 1))
    process = EngineProcess(f"{MODELS}:{package}", body, scheme, setting)

    def attitudes(t: Array) -> Array:
        if t[-1] < 0:
            raise NotApplicableError("engines only run forwards")
        return process.attitudes(t * clock, limit)

    return attitudes


def _engine_angles(
    package: str, scheme: str, top: Top, setting: Any, limit: float
) -> AngleFunction:
    attitudes = engine_attitudes(package, scheme, top, setting, limit)
    return lambda t: quaternion_angles(attitudes(t))


class Scheme(NamedTuple):
    """An integrator of an engine, and its settings."""

    name: str
    settings: Sequence[Any] = STEPS
    """Steps per nutation period, or tolerances."""


FAMILIES: dict[str, dict[str, Scheme]] = {
    "mujoco": {"euler": Scheme("Euler", MANY_STEPS), "rk4": Scheme("RK4")},
    "exudyn": {
        "rk44": Scheme("RK44"),
        "rk67": Scheme("RK67"),
        "alpha": Scheme("GeneralizedAlpha"),
    },
    "pybullet": {"": Scheme("", MANY_STEPS)},
    "drake": {
        "rk3": Scheme("runge_kutta3", [1e-2, 1e-4, 1e-6, 1e-8]),
        "rk5": Scheme("runge_kutta5", [1e-6, 1e-9, 1e-12, 1e-14]),
        "discrete": Scheme("discrete", MANY_STEPS),
    },
}
"""Schemes of each engine, by its package; the model is the function with this name."""


def engines(limit: float) -> dict[str, Method]:
    """Return every scheme of every engine by name, with a time limit of a run in seconds."""
    return {
        f"{package}-{short}".rstrip("-"): Method(
            scheme.settings,
            partial(_engine_angles, package, scheme.name, limit=limit),
            IMPORTS.get(package, package),
            whole_turns=False,
            engine=package,
        )
        for package, schemes in FAMILIES.items()
        for short, scheme in schemes.items()
    }
