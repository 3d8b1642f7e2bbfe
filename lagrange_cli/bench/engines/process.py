"""The engines that take part, each in a process of its own: started, asked, and killed if it hangs.

Another engine, or another scheme, is one entry in FAMILIES.
"""

from __future__ import annotations

import multiprocessing
import textwrap
import weakref
from collections.abc import Callable, Sequence
from contextlib import suppress
from functools import partial
from multiprocessing.context import SpawnProcess
from tempfile import TemporaryDirectory
from typing import Any, NamedTuple

from ...arithmetic.types import Array
from ...inputs.top import Top
from ...motion.solve import solve
from ...sweeps.jobs import interrupts_blocked, safe_path
from ..integrators import quaternion_angles
from ..method import AngleFunction, FailedError, Method, NotApplicableError
from .scaled_body import Body, scaled_body
from .serve import serve

SECONDS_TO_START = 60.0
"""How long the import of an engine may take."""
LONGEST_ERROR = 80
"""Letters of the error of an engine that are shown."""
STEPS = [50, 200, 800, 3200]
MANY_STEPS = [200, 800, 3200, 12800]
"""Steps per nutation period of schemes with a fixed step; many for those of order 1."""
IMPORTS = {"drake": "pydrake"}
"""Modules of packages, where they have another name than the package."""


class EngineProcess:
    """A process that runs one module of this folder; it ends with this object.

    What the engine writes, such as a log, goes to a directory that ends with it.
    """

    def __init__(self, module: str, body: Body, scheme: str, setting: Any) -> None:
        """Start the process and build the model.  Raises FailedError as `attitudes` does."""
        folder = TemporaryDirectory(prefix="lagtop-")
        context = multiprocessing.get_context("spawn")
        self._pipe, other = context.Pipe()
        order = (other, folder.name, f"{__package__}.{module}", (body, scheme, setting))
        self._process = context.Process(target=serve, args=order, daemon=True)
        weakref.finalize(self, _stop, self._process, folder)
        with safe_path(), interrupts_blocked():
            self._process.start()
        other.close()
        self._answer(SECONDS_TO_START)

    def attitudes(self, t: Array, seconds: float) -> Array:
        """Return the quaternions (w, x, y, z; a row for each time) of a run.

        Raises FailedError if the engine has an error, takes longer, or ends.
        """
        with suppress(BrokenPipeError):  # the answer is why
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
    """End the process and free what it holds."""
    if process.pid is not None:
        process.kill()
        process.join()
    folder.cleanup()


def engine_sample(
    module: str, scheme: str, top: Top, setting: Any, limit: float = 5.0
) -> AngleFunction:
    """Return an engine in a process of its own; a run may take `limit` seconds.

    Raises NotApplicableError for a body that engines refuse, and FailedError if the process does
    not start.
    """
    attitudes = engine_attitudes(module, scheme, top, setting, limit)
    return lambda t: quaternion_angles(attitudes(t))


def engine_attitudes(
    module: str, scheme: str, top: Top, setting: Any, limit: float
) -> Callable[[Array], Array]:
    """Return a function that gives the quaternions (w, x, y, z; a row for each time) of an engine.

    Raises NotApplicableError and FailedError as `engine_sample` does; so does the function, for
    times before the start and for a run that goes wrong.
    """
    period = solve(top).T_nutation
    body, clock = scaled_body(top, float(period or 1))
    process = EngineProcess(module, body, scheme, setting)

    def attitudes(t: Array) -> Array:
        if t[-1] < 0:
            raise NotApplicableError("engines run forwards only")
        return process.attitudes(t * clock, limit)

    return attitudes


class Scheme(NamedTuple):
    """An integrator of an engine, and the settings that it is tried at."""

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
"""Schemes of each engine, by the module of this folder that runs it: that of its package."""


def engines(limit: float) -> dict[str, Method]:
    """Return each engine with each of its schemes by name; a run may take `limit` seconds."""
    return {
        f"{package}-{short}".rstrip("-"): Method(
            scheme.settings,
            partial(engine_sample, package, scheme.name, limit=limit),
            IMPORTS.get(package, package),
            whole_turns=False,
            engine=package,
        )
        for package, schemes in FAMILIES.items()
        for short, scheme in schemes.items()
    }
