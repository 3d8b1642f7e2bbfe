"""Work shared by processes of this machine or by a Dask cluster, with results in order."""

from __future__ import annotations

import logging
import pickle
import pkgutil
import subprocess
import sys
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import CancelledError, Future, ThreadPoolExecutor
from contextlib import contextmanager, suppress
from functools import partial
from threading import Thread, local
from typing import Any, TypeVar

from .. import __version__
from ..errors import LagtopError, UnavailableError, install
from ..output.terminal import waiting

_AHEAD = 4
"""Items for each process that are handed out before the next result is taken."""
_PATIENCE = 21.0
"""Seconds to wait for an answer of a cluster."""
_SIGNALS_TAKE = 0.2
"""Seconds by which a signal may reach another process before it reaches this one."""

_T = TypeVar("_T")
P = TypeVar("P")
Shared = tuple[Callable[[Callable[[Any], Any], Any], Any], int, Callable[[], object]]
"""A function that hands out work and an item and returns a future, the number of processes, and a
function that raises UnavailableError if they no longer answer."""


def in_order(
    work: Callable[[_T], P],
    items: Iterable[_T],
    jobs: int = 1,
    address: str | None = None,
    warn: Callable[[str], None] = warnings.warn,
) -> Generator[P, None, None]:
    """Yield `work(item)` for each item, in order, from `jobs` processes or a Dask cluster.

    With other processes, work, items and results must be picklable.  `warn` shows a warning about
    the cluster.  Raises UnavailableError if a process or the cluster cannot be started or is lost,
    and LagtopError for a bad address.  Errors of the work are raised again.
    """
    if jobs == 1 and address is None:
        yield from map(work, items)
        return
    futures = deque[Any]()
    shared = _processes(jobs) if address is None else _cluster(address, warn)
    with shared as (submit, count, check):
        for item in items:
            futures.append(_unless_lost(submit, work, item))
            if len(futures) >= _AHEAD * count:
                yield _result(futures.popleft(), check)
        while futures:
            yield _result(futures.popleft(), check)


def _result(future: Any, check: Callable[[], object]) -> Any:
    """Return the result of some work; `check` raises UnavailableError if nobody does it."""
    while True:
        with suppress(TimeoutError):
            return _unless_lost(future.result, _PATIENCE / 10)
        _unless_lost(check)


def _unless_lost(call: Callable[..., P], *arguments: Any) -> P:
    """Return the result of a call.  Raises UnavailableError if a process or the cluster is lost."""
    try:
        return call(*arguments)
    except TimeoutError:
        raise
    except Exception as error:
        is_lost = isinstance(error, EOFError | CancelledError | OSError)
        if not (is_lost or type(error).__module__.startswith("distributed")):
            raise
        time.sleep(_SIGNALS_TAKE)  # a signal to all processes is raised here, as the cause
        why = "the connection to the scheduler was lost"
        if isinstance(error, EOFError) or type(error).__name__ == "KilledWorker":
            why = f"a process that shared the work was lost (killed, or out of memory): {error}"
        raise UnavailableError(why) from None


@contextmanager
def _processes(jobs: int) -> Iterator[Shared]:
    """Yield a function that hands work to other Python processes, which are killed at the end.

    Each belongs to a thread, which starts it, sends it work through a pipe and waits for the
    result.  It ends if its pipe is closed, that is, also with this process.
    """
    own, processes = local(), list[subprocess.Popen[bytes]]()

    def ask(work: Callable[[Any], Any], item: Any) -> Any:
        if not hasattr(own, "process"):
            own.process = _started()
            processes.append(own.process)
        try:
            _send((work, item), own.process.stdin)
            result, error = pickle.load(own.process.stdout)
        except (EOFError, OSError, pickle.UnpicklingError):
            raise EOFError(f"it ended with code {own.process.wait()}") from None
        if error is not None:
            raise error
        return result

    threads = ThreadPoolExecutor(jobs)
    try:
        yield lambda work, item: threads.submit(ask, work, item), jobs, int
    finally:
        threads.shutdown(wait=False, cancel_futures=True)
        for process in processes:
            process.kill()
        threads.shutdown()
        for process in processes:
            with suppress(OSError), process:  # closes its pipes
                process.kill()  # it may have been started late


def _started() -> subprocess.Popen[bytes]:
    """Start a process that serves this one.  Raises UnavailableError.

    It imports nothing from the current folder.  As it has a process group of its own, it gets no
    signal of the terminal.
    """
    code = f"import sys; sys.path[:] = {[*filter(None, sys.path)]!r}; import {__name__} as of"
    command, pipe = [sys.executable, "-P", "-c", f"{code}; of.serve()"], subprocess.PIPE
    how: Any = {"stdin": pipe, "stdout": pipe, "stderr": subprocess.DEVNULL, "process_group": 0}
    try:
        return subprocess.Popen(command, **how)
    except OSError as error:
        raise UnavailableError(f"cannot start a process: {error.strerror or error}") from None


def _send(value: object, stream: Any) -> None:
    pickle.dump(value, stream, pickle.HIGHEST_PROTOCOL)
    stream.flush()


def serve() -> None:
    """Do the work that comes from standard input, until it ends."""
    source, target = sys.stdin.buffer, sys.stdout.buffer
    sys.stdout = sys.stderr
    with suppress(EOFError, OSError):
        while True:
            work, item = pickle.load(source)
            result = raised = None
            try:
                result = work(item)
            except Exception as error:
                raised = error
            _send((result, raised), target)


@contextmanager
def _cluster(address: str, warn: Callable[[str], None]) -> Iterator[Shared]:
    """Yield a function that hands work to a Dask cluster, the number of its threads, and a check.

    dask itself waits without end for a stopped process, and for work whose workers are gone.
    Raises LagtopError for an invalid address, and UnavailableError if the cluster does not answer
    or if a worker lacks lagtop or has another version.
    """
    try:
        import dask
        import distributed
    except ImportError:
        why = f"dask needs distributed: {install('cluster')}"
        raise UnavailableError(why, "dask") from None
    for name in ("distributed", "distributed.client", "asyncio", "tornado.application"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # lagtop reports errors in one line
    dask.config.set({"distributed.comm.timeouts.connect": _PATIENCE / 3})
    with waiting(f"waiting for the cluster at {address}"):
        with warnings.catch_warnings(record=True, action="always") as found:
            client = _answer(address, lambda: distributed.Client(address, timeout=_PATIENCE / 3))
        if not _answer(address, client.nthreads):
            _answer(
                address, lambda: client.wait_for_workers(1, timeout=_PATIENCE / 2), "no workers"
            )
        ask, name = pkgutil.resolve_name, "lagrange_cli:__version__"  # any worker can unpickle it
        versions = _answer(address, lambda: client.run(ask, name, on_error="return"))
        threads = sum(_answer(address, client.nthreads).values())
    for worker, version in versions.items():
        if version != __version__:
            has = f"no lagtop: {version}" if isinstance(version, Exception) else version
            raise UnavailableError(f"the worker {worker} needs lagtop {__version__}, has {has}")
    if any(x.category.__name__ == "VersionMismatchWarning" for x in found):
        warn("the cluster has other versions of Python packages: last digits may differ")

    def check() -> None:
        _answer(address, lambda: client.wait_for_workers(1, timeout=_PATIENCE))
        _answer(address, lambda: client.run(int))

    try:
        yield partial(client.submit, pure=False), threads, check
    finally:
        with suppress(Exception):  # report the error that ended the sweep, not one of closing
            _answer(address, lambda: client.close(timeout=1), seconds=2.0)


def _answer(
    address: str, ask: Callable[[], _T], lacks: str = "", seconds: float | None = None
) -> _T:
    """Return an answer of a cluster.

    Raises UnavailableError if there is none in time, as the cluster does not answer or `lacks`
    something, and LagtopError for a bad address.
    """
    future = Future[_T]()

    def run() -> None:
        try:
            future.set_result(ask())
        except BaseException as error:
            future.set_exception(error)

    Thread(target=run, daemon=True).start()
    try:
        return future.result(seconds or _PATIENCE)
    except (TypeError, ValueError) as error:
        why = f"dask must be the address of a scheduler, got {address!r}: {error}"
        raise LagtopError(why, "dask") from None
    except Exception as error:  # of any kind: it may be no scheduler
        if lacks:
            raise UnavailableError(f"the cluster at {address} has {lacks}") from None
        why = str(error) or "its scheduler or a worker was lost or stopped"
        raise UnavailableError(f"the cluster at {address} does not answer: {why}") from None
