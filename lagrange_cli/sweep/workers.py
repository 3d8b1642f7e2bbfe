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
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import BrokenExecutor, CancelledError, Executor, ProcessPoolExecutor
from contextlib import AbstractContextManager, contextmanager, suppress
from functools import partial
from tempfile import TemporaryDirectory, mkstemp
from threading import Thread
from typing import Any, TypeVar

from .. import __version__
from ..errors import LagtopError, UnavailableError
from ..inputs.files import temporary_files

MOST_JOBS = 1024
_AHEAD = 4
"""Items for each process that are handed out before the next result is taken."""
_PATIENCE = 8.0
"""Seconds to wait for an answer of a cluster."""
_SIGNALS_TAKE = 0.2
"""Seconds by which a signal may reach another process before it reaches this one."""

_T = TypeVar("_T")
P = TypeVar("P")


def parse_jobs(text: str) -> int:
    """Return a number of processes; `auto` is one for each core that this process may use.

    Raises LagtopError.
    """
    if text == "auto":
        may_use = getattr(os, "sched_getaffinity", None)
        return len(may_use(0)) if may_use else os.cpu_count() or 1
    if not (text.isdecimal() and text.isascii() and 1 <= int(text[:9]) <= MOST_JOBS):
        raise LagtopError(f"must be auto or in [1, {MOST_JOBS}], got {text[:60]!r}")
    return int(text)


def in_order(
    work: Callable[[_T], P], items: Iterable[_T], jobs: int = 1, address: str | None = None
) -> Generator[P, None, None]:
    """Yield `work(item)` for each item, in order, from `jobs` processes or a Dask cluster.

    With other processes, work, items and results must be picklable.  Raises UnavailableError if a
    process or the cluster cannot be started or is lost, and LagtopError for a bad address.  Errors
    of the work are raised again.
    """
    if jobs == 1 and address is None:
        yield from map(work, items)
        return
    waiting: deque[tuple[str, Any]] = deque()
    with (
        _folder() as folder,
        _cluster(address) if address is not None else _processes(jobs) as (executor, count),
    ):
        for item in items:
            if address is not None:
                call = partial(_on_cluster, __version__, pickle.dumps((work, item)))
                waiting.append(("", executor.submit(call)))
            else:
                path = _dumped((work, item), folder)
                with _starting():
                    waiting.append((path, executor.submit(_through_file, path)))
            if len(waiting) >= _AHEAD * count:
                yield _result(*waiting.popleft())
        while waiting:
            yield _result(*waiting.popleft())


def _result(path: str, future: Any) -> Any:
    """Wait for a result.  Raises UnavailableError if its process is lost."""
    try:
        found = future.result()
        return _loaded(path) if path else pickle.loads(found)
    except (BrokenExecutor, CancelledError, OSError) as error:
        time.sleep(_SIGNALS_TAKE)  # a signal to all processes is raised here, as the cause
        raise UnavailableError(
            f"a process that shared the work was lost (killed, or out of memory): {error}"
        ) from None


def _folder() -> AbstractContextManager[str]:
    """Return a temporary folder for items and results.  Raises CannotWriteError."""
    with temporary_files():
        return TemporaryDirectory(prefix="lagtop-", ignore_cleanup_errors=True)


def _dumped(value: object, folder: str) -> str:
    """Return the name of a new file that holds a value.  Raises CannotWriteError."""
    with temporary_files():
        descriptor, path = mkstemp(dir=folder)
        with open(descriptor, "wb") as file:
            pickle.dump(value, file, pickle.HIGHEST_PROTOCOL)
    return path


def _loaded(path: str) -> Any:
    """Return the value in a file, which is removed."""
    with open(path, "rb") as file:
        os.unlink(path)
        return pickle.load(file)


def _through_file(path: str) -> None:
    """Do the work in a file, and write its result to the same file.

    A process that is killed while it writes a long result to a pipe would block the reader.
    """
    work, item = _loaded(path)
    result = work(item)
    with temporary_files(), open(path, "xb") as file:
        pickle.dump(result, file, pickle.HIGHEST_PROTOCOL)


def _on_cluster(version: str, content: bytes) -> bytes:
    """Do pickled work on a cluster; workers that join later may have another version."""
    if version != __version__:
        raise UnavailableError(f"a worker of the cluster has lagtop {__version__}, not {version}")
    work, item = pickle.loads(content)
    return pickle.dumps(work(item))


@contextmanager
def _starting() -> Iterator[None]:
    """Start Python processes that import nothing from the current folder and ignore Ctrl-C.

    They inherit the blocked signal.  Raises UnavailableError.
    """
    from multiprocessing.resource_tracker import ensure_running

    safe, usual = os.environ.get("PYTHONSAFEPATH", ""), None
    os.environ["PYTHONSAFEPATH"] = "1"
    try:
        if hasattr(signal, "pthread_sigmask"):  # not on Windows
            ensure_running()  # which unblocks the signal
            usual = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
        yield
    except OSError as error:
        raise UnavailableError(f"cannot start a process: {error.strerror or error}") from None
    finally:
        os.environ["PYTHONSAFEPATH"] = safe
        if usual is not None:
            signal.pthread_sigmask(signal.SIG_SETMASK, usual)


@contextmanager
def _processes(jobs: int) -> Iterator[tuple[Executor, int]]:
    """Yield an executor of spawned processes, which are killed if the block fails."""
    executor = ProcessPoolExecutor(jobs, multiprocessing.get_context("spawn"), _begin)
    try:
        yield executor, jobs
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
def _cluster(address: str) -> Iterator[tuple[Executor, int]]:
    """Yield the executor of a Dask cluster and its number of threads.

    The address may be `local`, for a cluster on this machine that ends with the block.  Raises
    UnavailableError, and LagtopError for an invalid address.
    """
    try:
        import dask
        from distributed import Client
    except ImportError:
        why = "dask needs distributed: pip install 'lagtop[cluster]'"
        raise UnavailableError(why, "dask") from None
    for name in ("distributed", "distributed.client", "asyncio", "tornado"):
        logging.getLogger(name).setLevel(logging.CRITICAL)  # lagtop reports errors in one line
    dask.config.set({"distributed.comm.timeouts.connect": _PATIENCE})
    own = {"threads_per_worker": 1, "dashboard_address": None, "silence_logs": logging.CRITICAL}
    try:
        with _starting():
            client = Client(**own) if address == "local" else Client(address, timeout=_PATIENCE)
    except (TypeError, ValueError) as error:
        why = f"dask must be local or a scheduler, got {address}: {error}"
        raise LagtopError(why, "dask") from None
    except Exception as error:  # of any kind: the peer may be no scheduler
        raise UnavailableError(f"no scheduler answers at {address}: {error}") from None
    try:
        yield client.get_executor(pure=False), _threads(client)
    finally:
        with suppress(Exception):  # report the error that ended the sweep, not one of closing
            client.close(timeout=_PATIENCE if address == "local" else 2)


def _threads(client: Any) -> int:
    """Return the number of threads of a cluster.

    Raises UnavailableError if it has no worker, or one without lagtop or with another version.
    """
    try:
        client.wait_for_workers(1, timeout=_PATIENCE)
        # A function of the standard library, which every worker can unpickle.
        name = "lagrange_cli:__version__"
        versions = client.run(pkgutil.resolve_name, name, on_error="return")
        threads: int = sum(client.nthreads().values())
    except (TimeoutError, CancelledError, OSError, RuntimeError) as error:
        raise UnavailableError(f"the cluster has no worker: {error}") from None
    for worker, version in versions.items():
        if version != __version__:
            found = f"no lagtop: {version}" if isinstance(version, Exception) else version
            raise UnavailableError(f"the worker {worker} needs lagtop {__version__}, has {found}")
    return threads
