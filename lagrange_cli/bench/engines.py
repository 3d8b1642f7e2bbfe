"""Physics engines, each in a separate process that is started, queried, and killed if it hangs.

Another engine, or another scheme, is one entry in SCHEMES.
"""

from __future__ import annotations

import math
import textwrap
import weakref
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from ..arithmetic.types import Array
from ..inputs.rotations import angles_of
from ..inputs.top import Top
from ..motion.solve import solve
from ..sweep.jobs import Child
from .engine_simulation import Body, serve
from .integrators import problem_of
from .method import AngleFunction, FailedError, Method, NotApplicableError, Run

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
        self._child = Child(serve, folder.name, model, (body, scheme, setting))
        weakref.finalize(self, _stop, self._child, folder)
        self._child.start()
        self._answer(SECONDS_TO_START)

    def attitudes(self, t: Array, seconds: float) -> Array:
        """Return the quaternions (w, x, y, z; a row for each time) of a run.

        Raises FailedError if the engine has an error, exceeds the time limit, or ends.
        """
        with suppress(BrokenPipeError):  # the answer is the reason
            self._child.pipe.send(t)
        found: Array = self._answer(seconds)
        return found

    def _answer(self, seconds: float) -> Any:
        pipe, process = self._child.pipe, self._child.process
        try:
            if not pipe.poll(seconds):
                process.kill()
                raise FailedError(f"took more than {seconds:g} s")
            answer = pipe.recv()
        except (EOFError, ConnectionError):
            process.join()
            raise FailedError(f"its process ended with exit code {process.exitcode}") from None
        if isinstance(answer, str):
            raise FailedError(textwrap.shorten(answer, LONGEST_ERROR))
        return answer


def _stop(child: Child, folder: TemporaryDirectory[str]) -> None:
    """End the process and free its resources."""
    child.end()
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
    return lambda t: Run([*angles_of(attitudes(t)).values()])


class Scheme(NamedTuple):
    """An integrator of an engine, and its settings."""

    package: str
    """The package of the engine; its model is the function with this name."""
    name: str
    settings: Sequence[Any] = STEPS
    """Steps per nutation period, or tolerances."""


SCHEMES = {
    "mujoco-euler": Scheme("mujoco", "Euler", MANY_STEPS),
    "mujoco-rk4": Scheme("mujoco", "RK4"),
    "exudyn-rk44": Scheme("exudyn", "RK44"),
    "exudyn-rk67": Scheme("exudyn", "RK67"),
    "exudyn-alpha": Scheme("exudyn", "GeneralizedAlpha"),
    "pybullet": Scheme("pybullet", "", MANY_STEPS),
    "drake-rk3": Scheme("drake", "runge_kutta3", [1e-2, 1e-4, 1e-6, 1e-8]),
    "drake-rk5": Scheme("drake", "runge_kutta5", [1e-6, 1e-9, 1e-12, 1e-14]),
    "drake-discrete": Scheme("drake", "discrete", MANY_STEPS),
}
"""Schemes of all engines, by the names of their methods."""


def engines(limit: float) -> dict[str, Method]:
    """Return every scheme of every engine by name, with a time limit of a run in seconds."""
    return {
        name: Method(
            settings,
            partial(_engine_angles, package, scheme, limit=limit),
            IMPORTS.get(package, package),
            whole_turns=False,
            engine=package,
        )
        for name, (package, scheme, settings) in SCHEMES.items()
    }
