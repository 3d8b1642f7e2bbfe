"""Work shared by several processes of this machine, with results in the order of the work.

The processes are started afresh and not forked, so that they behave alike on every system.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
import sys
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing, contextmanager
from itertools import cycle
from tempfile import TemporaryDirectory
from threading import Thread
from typing import NamedTuple, TypeVar

from ..errors import CannotWriteError, LagtopError, UnavailableError
from ..output.signals import terminated_by

MOST_JOBS = 1024
_HANDED_OUT = 3
"""Items that each other process has: one that it works at, and the next ones."""
_AHEAD = 8
"""Results per process that may wait for an earlier one: memory does not grow with the work."""

T = TypeVar("T")
P = TypeVar("P")


def parse_jobs(text: str) -> int:
    """Return a number of processes; `auto` is one per core that this process may use.

    Raises LagtopError.
    """
    if text == "auto":
        may_use = getattr(os, "sched_getaffinity", None)
        return len(may_use(0)) if may_use else os.cpu_count() or 1
    if not (text.isdecimal() and text.isascii() and 1 <= int(text[:9]) <= MOST_JOBS):
        raise LagtopError(f"must be auto or in [1, {MOST_JOBS}], got {text[:60]!r}")
    return int(text)


def in_order(work: Callable[[T], P], items: Iterable[T], jobs: int) -> Generator[P, None, None]:
    """Yield what the work makes of each item, in their order; this process is one of the `jobs`.

    With more than one, the work and its results must be picklable.  Raises UnavailableError where
    a process is lost, CannotWriteError where results find no room, and what the work raises.
    """
    if jobs == 1:
        yield from map(work, items)
        return
    with (
        terminated_by(["SIGTERM", "SIGHUP"]),
        _folder() as folder,
        _threads_that_wait_less(),
    ):
        pool = ProcessPoolExecutor(
            jobs - 1, mp_context=multiprocessing.get_context("spawn"), initializer=_start_worker
        )
        try:
            with closing(_shared(pool, work, iter(items), jobs, folder)) as results:
                yield from results
        except BrokenProcessPool:
            raise UnavailableError(
                "a process that shared the work was lost (killed, or out of memory)"
            ) from None
        finally:
            pool.shutdown(wait=True, cancel_futures=True)


def _folder() -> TemporaryDirectory[str]:
    """Return a folder for results that goes when it is left.  Raises CannotWriteError."""
    try:
        return TemporaryDirectory(prefix="lagtop-")
    except OSError as error:
        raise CannotWriteError(f"cannot write temporary files: {error.strerror}") from None


@contextmanager
def _threads_that_wait_less() -> Iterator[None]:
    """Let threads that hand out work wait less for the lock of the interpreter, held by our own.

    By default they wait up to 5 ms each time, and other processes have nothing to do meanwhile.
    """
    usual = sys.getswitchinterval()
    sys.setswitchinterval(5e-4)
    try:
        yield
    finally:
        sys.setswitchinterval(usual)


def _shared(
    pool: ProcessPoolExecutor, work: Callable[[T], P], items: Iterator[T], jobs: int, folder: str
) -> Generator[P, None, None]:
    """Yield the results in order; what no other process has room for is done in this one."""
    started = pool.submit(_start_work, work)
    for item in items:  # a process takes longer to start than most items to be done
        yield work(item)
        if started.done():
            break
    most = _AHEAD * jobs
    paths = [os.path.join(folder, str(number)) for number in range(most)]
    results: deque[Future[P | _Left]] = deque()
    for item, path in zip(items, cycle(paths), strict=False):
        if sum(not result.done() for result in results) < _HANDED_OUT * (jobs - 1):
            results.append(pool.submit(_left, work, item, path))
        else:
            results.append(Future())
            results[-1].set_result(work(item))
        while results and (results[0].done() or len(results) >= most):
            yield _taken(results.popleft().result())
    while results:
        yield _taken(results.popleft().result())


class _Left(NamedTuple):
    """A result that another process left in a file.

    A pipe is read by a thread in small pieces, and each would wait for the lock of the interpreter
    that computes here.  A file is used again, by a result that may be shorter.
    """

    path: str


def _left(work: Callable[[T], P], item: T, path: str) -> _Left:
    """Do the work and leave what it makes in a file.  Raises CannotWriteError."""
    result = work(item)
    try:
        with open(os.open(path, os.O_WRONLY | os.O_CREAT, 0o600), "wb") as file:
            pickle.dump(result, file, pickle.HIGHEST_PROTOCOL)
    except OSError as error:
        raise CannotWriteError(f"cannot write {path}: {error.strerror}") from None
    return _Left(path)


def _taken(result: P | _Left) -> P:
    """Return a result, which may be in a file."""
    if isinstance(result, _Left):
        with open(result.path, "rb") as file:
            found: P = pickle.load(file)
            return found
    return result


def _start_work(work: Callable[[T], P]) -> None:
    """Do nothing: to hand the work over has loaded what it needs."""


def _start_worker() -> None:
    """Leave Ctrl-C to the process that shares the work out, and end with that process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
