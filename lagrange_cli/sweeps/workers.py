"""Work shared by processes of this machine or by a Dask cluster, with results in order.

Both are executors of `concurrent.futures`, so that one loop hands out the work.
"""

from __future__ import annotations

import logging
import multiprocessing
import os
import pickle
import pkgutil
import signal
import time
import warnings
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Future, ProcessPoolExecutor, wait
from contextlib import contextmanager, suppress
from secrets import token_hex
from tempfile import TemporaryDirectory
from threading import Thread
from typing import Any, TypeVar

from .. import __version__
from ..errors import CannotWriteError, LagtopError, UnavailableError
from ..output.terminal import waiting

MOST_JOBS = 1024
_AHEAD = 4
"""Items for each process that are handed out before the next result is taken."""
_PATIENCE = 20.0
"""Seconds to wait for an answer of a cluster."""
_SIGNALS_TAKE = 0.2
"""Seconds by which a signal may reach another process before it reaches this one."""

_T = TypeVar("_T")
P = TypeVar("P")
Submit = Callable[[Callable[[Any], Any], Any], Callable[[], Any]]
"""A function that hands out work and an item, and returns a function that waits for the result."""


def parse_jobs(text: str) -> int:
    """Return a number of processes; `auto` is one for each core that this process may use.

    Raises LagtopError.
    """
    if text == "auto":
        may_use = getattr(os, "sched_getaffinity", None)
        return len(may_use(0)) if may_use else min(os.cpu_count() or 1, 61)  # Windows has no more
    if not (text.isdecimal() and text.isascii() and 1 <= int(text[:9]) <= MOST_JOBS):
        raise LagtopError(f"must be auto or in [1, {MOST_JOBS}], got {text[:60]!r}")
    return int(text)


def in_order(
    work: Callable[[_T], P],
    items: Iterable[_T],
    jobs: int = 1,
    address: str | None = None,
    warn: Callable[[str], None] = warnings.warn,
) -> Generator[P, None, None]:
    """Yield `work(item)` for each item, in order, from `jobs` processes or a Dask cluster.

    `warn` shows a warning about the cluster.

    With other processes, work, items and results must be picklable.  Raises UnavailableError if a
    process or the cluster cannot be started or is lost, and LagtopError for a bad address.  Errors
    of the work are raised again.
    """
    if jobs == 1 and address is None:
        yield from map(work, items)
        return
    waiting: deque[Callable[[], P]] = deque()
    shared = _processes(jobs) if address is None else _cluster(address, warn)
    with shared as (submit, count):
        for item in items:
            waiting.append(_unless_lost(submit, work, item))
            if len(waiting) >= _AHEAD * count:
                yield _unless_lost(waiting.popleft())
        while waiting:
            yield _unless_lost(waiting.popleft())


def _unless_lost(call: Callable[..., P], *arguments: Any) -> P:
    """Return the result of a call.  Raises UnavailableError if a process or the cluster is lost."""
    try:
        return call(*arguments)
    except Exception as error:
        is_lost = isinstance(error, BrokenExecutor | CancelledError | OSError)
        if not (is_lost or type(error).__module__.startswith("distributed")):
            raise
        time.sleep(_SIGNALS_TAKE)  # a signal to all processes is raised here, as the cause
        raise UnavailableError(
            f"a process that shared the work was lost (killed, or out of memory): {error}"
        ) from None


@contextmanager
def _temporary_files() -> Iterator[None]:
    """Raise CannotWriteError if a temporary file or folder cannot be made or written."""
    try:
        yield
    except OSError as error:
        raise CannotWriteError(f"cannot write temporary files: {error.strerror}") from None


def _through_file(path: str) -> None:
    """Do the work in a file, and write its result to the same file.

    A process that is killed while it writes a long result to a pipe would block the reader.
    """
    work, item = _loaded(path)
    _dump(work(item), path)


def _dump(value: object, path: str) -> None:
    """Write a value to a new file.  Raises CannotWriteError."""
    with _temporary_files(), open(path, "xb") as file:
        pickle.dump(value, file, pickle.HIGHEST_PROTOCOL)


def _loaded(path: str) -> Any:
    """Return the value in a file, which is removed."""
    with open(path, "rb") as file:
        os.unlink(path)
        return pickle.load(file)


@contextmanager
def _starting() -> Iterator[None]:
    """Start Python processes that import nothing from the current folder, and ignore Ctrl-C.

    They inherit the blocked signals.  Raises UnavailableError.
    """
    from multiprocessing.resource_tracker import ensure_running

    safe = os.environ.get("PYTHONSAFEPATH", "")
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        if hasattr(signal, "pthread_sigmask"):  # not on Windows
            # signals of a terminal, which go to the whole process group
            blocked = signal.SIGINT, signal.SIGHUP, signal.SIGQUIT
            usual = signal.pthread_sigmask(signal.SIG_BLOCK, blocked)
            ensure_running()  # which unblocks Ctrl-C
            signal.pthread_sigmask(signal.SIG_BLOCK, blocked)
        yield
    except OSError as error:
        raise UnavailableError(f"cannot start a process: {error.strerror or error}") from None
    finally:
        os.environ["PYTHONSAFEPATH"] = safe
        if hasattr(signal, "pthread_sigmask"):
            signal.pthread_sigmask(signal.SIG_SETMASK, usual)


@contextmanager
def _processes(jobs: int) -> Iterator[tuple[Submit, int]]:
    """Yield a function that hands work to spawned processes, which are killed if the block fails.

    Items and results pass through files of a temporary folder.
    """
    with _temporary_files():
        temporary = TemporaryDirectory(prefix="lagtop-", ignore_cleanup_errors=True)
    with _starting():
        executor = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _begin)

    def submit(work: Callable[[Any], Any], item: Any) -> Callable[[], Any]:
        path = os.path.join(temporary.name, token_hex(8))
        _dump((work, item), path)
        with _starting():
            future = executor.submit(_through_file, path)
        return lambda: future.result() or _loaded(path)

    with temporary:
        try:
            yield submit, jobs
        except BaseException:
            for process in [*(executor._processes or {}).values()]:
                process.kill()
            raise
        finally:
            executor.shutdown(cancel_futures=True)


def _begin() -> None:
    """Leave Ctrl-C to the parent process, and end with it."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


@contextmanager
def _cluster(address: str, warn: Callable[[str], None]) -> Iterator[tuple[Submit, int]]:
    """Yield a function that hands work to a Dask cluster, and the number of its threads.

    dask itself waits without end for a stopped process, and for work whose workers are gone.
    Raises UnavailableError, and LagtopError for an invalid address.
    """
    try:
        import distributed
    except ImportError:
        why = "dask needs distributed: pip install 'lagtop[cluster]'"
        raise UnavailableError(why, "dask") from None
    for name in ("distributed", "distributed.client", "asyncio", "tornado.application"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # lagtop reports errors in one line
    with waiting(f"waiting for the cluster at {address}"):
        client = _connected(distributed, address, warn)
        threads = _threads(client, address)

    def submit(work: Callable[[Any], Any], item: Any) -> Callable[[], Any]:
        future = client.submit(work, item, pure=False)
        return lambda: _result(future, client, address)

    try:
        yield submit, threads
    finally:
        with suppress(Exception):  # report the error that ended the sweep, not one of closing
            _within(2.0, lambda: client.close(timeout=1))


def _connected(distributed: Any, address: str, warn: Callable[[str], None]) -> Any:
    """Return a client of a scheduler.  Raises UnavailableError, LagtopError for a bad address."""
    import dask

    dask.config.set({"distributed.comm.timeouts.connect": _PATIENCE / 3})
    try:
        with warnings.catch_warnings(record=True, action="always") as found:
            client = _within(_PATIENCE, lambda: distributed.Client(address, timeout=_PATIENCE / 3))
    except (TypeError, ValueError) as error:
        why = f"dask must be the address of a scheduler, got {address!r}: {error}"
        raise LagtopError(why, "dask") from None
    except Exception as error:  # of any kind: it may be no scheduler
        raise UnavailableError(f"no scheduler answers at {address}: {error}") from None
    if any(x.category.__name__ == "VersionMismatchWarning" for x in found):
        warn("the cluster has other versions of Python packages: last digits may differ")
    return client


def _threads(client: Any, address: str) -> int:
    """Return the number of threads of a cluster.

    Raises UnavailableError if it has no worker, or one that does not answer, that lacks lagtop or
    that has another version.
    """
    _answer(address, lambda: client.wait_for_workers(1, timeout=_PATIENCE))
    ask, name = pkgutil.resolve_name, "lagrange_cli:__version__"  # which every worker can unpickle
    versions = _answer(address, lambda: client.run(ask, name, on_error="return"))
    for worker, version in versions.items():
        if version != __version__:
            found = f"no lagtop: {version}" if isinstance(version, Exception) else version
            raise UnavailableError(f"the worker {worker} needs lagtop {__version__}, has {found}")
    return sum(_answer(address, client.nthreads).values())


def _result(future: Any, client: Any, address: str) -> Any:
    """Return the result of some work.  Raises UnavailableError if workers no longer answer."""
    heard = time.monotonic()
    while True:
        with suppress(TimeoutError):
            return future.result(_PATIENCE / 10)
        if _answer(address, lambda: client.run(int)):
            heard = time.monotonic()
        elif time.monotonic() - heard > _PATIENCE:
            raise UnavailableError(f"all workers of the cluster at {address} were lost")


def _answer(address: str, ask: Callable[[], _T]) -> _T:
    """Return an answer of a cluster.  Raises UnavailableError if there is none in time."""
    try:
        return _within(_PATIENCE, ask)
    except (TimeoutError, CancelledError, OSError, RuntimeError) as error:
        why = f"a worker of the cluster at {address} was lost or stopped: {error}"
        raise UnavailableError(why) from None


def _within(seconds: float, call: Callable[[], _T]) -> _T:
    """Return the result of a call in a thread.  Raises TimeoutError after some seconds."""
    future = Future[_T]()

    def run() -> None:
        try:
            future.set_result(call())
        except BaseException as error:
            future.set_exception(error)

    Thread(target=run, daemon=True).start()
    if not wait([future], seconds).done:
        raise TimeoutError(f"no answer in {seconds:g} s")
    return future.result()
