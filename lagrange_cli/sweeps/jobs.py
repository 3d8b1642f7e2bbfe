"""Work shared by several processes of this machine, with results in the order of the work.

The processes are started afresh and not forked, so that they behave alike on every system.
"""

from __future__ import annotations

import multiprocessing
import os
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterable
from concurrent.futures import Future, ProcessPoolExecutor
from concurrent.futures.process import BrokenProcessPool
from contextlib import closing
from itertools import chain, repeat
from threading import Thread
from typing import TypeVar

from ..errors import LagtopError, UnavailableError

MOST_JOBS = 1024
_AHEAD = 3
"""Items that are handed out per process: so none waits, and memory does not grow with the work."""

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
    """Yield what the work makes of each item, in their order.

    With more than one of the `jobs`, the work and its results must be picklable.  Raises
    UnavailableError where a process is lost, and what the work raises.
    """
    if jobs == 1:
        yield from map(work, items)
        return
    pool = ProcessPoolExecutor(
        jobs, mp_context=multiprocessing.get_context("spawn"), initializer=_start_worker
    )
    try:
        with closing(_gathered(pool, work, items, _AHEAD * jobs)) as results:
            yield from results
    except BrokenProcessPool:
        raise UnavailableError(
            "a process that shared the work was lost (killed, or out of memory)"
        ) from None
    finally:
        pool.shutdown(wait=True, cancel_futures=True)


def _gathered(
    pool: ProcessPoolExecutor, work: Callable[[T], P], items: Iterable[T], most: int
) -> Generator[P, None, None]:
    """Yield the results in order, with so many items under way at a time."""
    waiting: deque[Future[P]] = deque()
    for item in chain(((x,) for x in items), repeat(None)):
        if item is not None:
            waiting.append(pool.submit(work, *item))
        elif not waiting:
            return
        if item is None or len(waiting) >= most:
            yield waiting.popleft().result()


def _start_worker() -> None:
    """Leave Ctrl-C to the process that shares the work out, and end with that process."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
