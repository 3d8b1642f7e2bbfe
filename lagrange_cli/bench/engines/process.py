"""The process of an engine, seen from the bench: started, asked, and killed if it hangs."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import tempfile
import textwrap
import threading
import time
import weakref
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from ...arithmetic.types import Array
from ...inputs.top import Top
from ...motion.solve import solve
from ..integrators import quaternion_angles
from ..method import FailedError, NotApplicableError, Sample
from .body import scaled_body
from .wire import EngineError, receive, send

SECONDS_TO_START = 60.0
"""How long the import of an engine may take."""
LONGEST_ERROR = 80
"""Letters of the error of an engine that are shown."""
_ROOT = Path(__file__).parents[3]


class EngineProcess:
    """A process that runs one module of this folder; it ends with this object.

    What the engine writes, such as a log, goes to a directory that ends with it.
    """

    def __init__(self, module: str) -> None:
        known = filter(None, os.environ.get("PYTHONPATH", "").split(os.pathsep))
        paths = [str(_ROOT), *map(os.path.abspath, known)]
        folder = tempfile.TemporaryDirectory(prefix="lagtop-")
        self._process = subprocess.Popen(
            [sys.executable, "-P", "-W", "ignore", "-m", f"{__package__}.{module}"],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            cwd=folder.name,
            env=os.environ | {"PYTHONPATH": os.pathsep.join(paths)},
        )
        weakref.finalize(self, _stop, self._process, folder)

    def ask(self, payload: bytes, seconds: float) -> bytes:
        """Return the answer to a message.

        Raises FailedError if the engine has an error, takes longer, or ends.
        """
        process = self._process
        assert process.stdin
        assert process.stdout
        clock, end = threading.Timer(seconds, process.kill), time.perf_counter() + seconds
        clock.start()
        try:
            send(process.stdin, payload)
            return receive(process.stdout)
        except EngineError as error:
            raise FailedError(textwrap.shorten(str(error), LONGEST_ERROR)) from None
        except (EOFError, OSError):
            if time.perf_counter() >= end:
                raise FailedError(f"took more than {seconds:g} s") from None
            code = process.wait()
            raise FailedError(f"its process ended with exit code {code}") from None
        finally:
            clock.cancel()


def _stop(process: subprocess.Popen[bytes], folder: tempfile.TemporaryDirectory[str]) -> None:
    """End the process and free what it holds."""
    process.kill()
    with process:
        pass
    folder.cleanup()


def engine_sample(module: str, scheme: str, top: Top, setting: Any, limit: float = 5.0) -> Sample:
    """Return an engine in a process of its own; a run may take `limit` seconds.

    Raises NotApplicableError for a body that engines refuse, and FailedError where the process does
    not start.
    """
    attitudes = engine_attitudes(module, scheme, top, setting, limit)
    return lambda t: quaternion_angles(attitudes(t).T)


def engine_attitudes(
    module: str, scheme: str, top: Top, setting: Any, limit: float
) -> Callable[[Array], Array]:
    """Return what gives the quaternions (w, x, y, z; a row for each time) of an engine.

    Raises NotApplicableError and FailedError as `engine_sample` does; what is returned raises them
    too, for times before the start and for a run that goes wrong.
    """
    period = solve(top).T_nutation
    body, clock = scaled_body(top, float(period or 1))
    process = EngineProcess(module)
    order = {"body": body, "scheme": scheme, "setting": setting}
    process.ask(json.dumps(order).encode(), SECONDS_TO_START)

    def attitudes(t: Array) -> Array:
        if t[-1] < 0:
            raise NotApplicableError("engines run forwards only")
        answer = process.ask((t * clock).tobytes(), limit)
        return np.frombuffer(answer).reshape(-1, 4)

    return attitudes
