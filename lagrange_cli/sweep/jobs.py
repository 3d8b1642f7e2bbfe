"""Work shared by several processes of this machine, with results in the order of the items.

The processes are spawned, not forked, so that they behave alike on every system.  Items and results
pass through files of a temporary folder, not through pipes.  A pipe is read in small pieces, and
its writer would wait for a reader that computes.
"""

from __future__ import annotations

import multiprocessing
import os
import pickle
import signal
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator
from contextlib import closing, contextmanager, suppress
from multiprocessing.connection import Connection, wait
from tempfile import TemporaryDirectory
from threading import Thread
from time import sleep
from typing import Any, TypeVar

from ..errors import CannotWriteError, LagtopError, UnavailableError
from ..inputs.files import temporary_files
from ..output.destination import ENDING, terminated_by

MOST_JOBS = 1024
_HANDED_OUT = 3
"""Items that each other process holds: the current one, and the next ones."""
_AHEAD = 8
"""Results per process that may wait for an earlier one: memory does not grow with the work."""
_SIGNALS_TAKE = 0.2
"""Seconds by which a signal may reach another process before it reaches this one."""
_SAFE_PATH = "PYTHONSAFEPATH"

_T = TypeVar("_T")
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


def in_order(work: Callable[[_T], P], items: Iterable[_T], jobs: int) -> Generator[P, None, None]:
    """Yield `work(item)` for each item, in order; this process is one of the `jobs`.

    If `jobs` > 1, the work, its items and its results must be picklable.  Raises UnavailableError
    if a process cannot be started or is lost, and CannotWriteError if there is no space for items
    or results.  Errors of the work are raised again.
    """
    if jobs == 1:
        yield from map(work, items)
        return
    with terminated_by(ENDING), _folder() as folder, closing(_Team(work, jobs, folder)) as team:
        count = 0
        for count, item in enumerate(items, 1):
            team.do(count - 1, item)
            yield from team.results(count - team.most + 1)
        yield from team.results(count)


def _folder() -> TemporaryDirectory[str]:
    """Return a temporary folder for results, as a context.  Raises CannotWriteError."""
    with temporary_files():
        return TemporaryDirectory(prefix="lagtop-", ignore_cleanup_errors=True)


class _Team:
    """Processes that share work with this one, and the results that wait for earlier ones."""

    def __init__(self, work: Callable[[Any], Any], jobs: int, folder: str) -> None:
        self._work, self._others, self._folder = work, jobs - 1, folder
        self.most = _AHEAD * jobs
        """Items that may be in progress or done before the next result is taken."""
        self._workers: dict[Any, _Worker] = {}
        self._done: dict[int, tuple[str, Any]] = {}
        """The file of each result, or the result itself."""
        self._next = 0

    def do(self, number: int, item: Any) -> None:
        """Hand an item to another process, or do the work here if all have enough items."""
        if len(self._workers) < self._others:  # one by one, as there may be few items
            new = _Worker(self._work)
            self._workers[new.pipe] = new  # from now on `close` ends it
            new.start()
        self._collect(0.0)
        for worker in self._workers.values():
            if len(worker.tasks) < _HANDED_OUT:
                path = os.path.join(self._folder, str(number % self.most))
                worker.give(number, item, path)
                return
        self._done[number] = "", self._work(item)

    def results(self, least: int) -> Iterator[Any]:
        """Yield the next results; wait for all results before the number `least`."""
        while self._next < least or self._next in self._done:
            while self._next not in self._done:
                self._collect(None)
            path, result = self._done.pop(self._next)
            self._next += 1
            yield _load(path) if path else result

    def _collect(self, timeout: float | None) -> None:
        """Take the results of other processes; wait up to `timeout` seconds for the first one."""
        for pipe in wait(self._workers, timeout):
            for number, path in self._workers[pipe].answer():
                self._done[number] = path, None

    def close(self) -> None:
        """End the other processes at once, without waiting for their results."""
        for worker in self._workers.values():
            worker.end()


class Child:
    """Another process, which runs `target(pipe, *arguments)`, and the pipe to it."""

    def __init__(self, target: Callable[..., None], *arguments: Any) -> None:
        context = multiprocessing.get_context("spawn")
        self.pipe, self._other = context.Pipe()
        self.process = context.Process(target=target, args=(self._other, *arguments), daemon=True)

    def start(self) -> None:
        """Start the process.  Raises UnavailableError."""
        try:
            with safe_path(), interrupts_blocked():
                self.process.start()
        except OSError as error:
            raise UnavailableError(f"cannot start a process: {error.strerror or error}") from None
        self._other.close()

    def end(self) -> None:
        """End the process at once, if it has started."""
        if self.process.pid is not None:
            self.process.kill()
            self.process.join()


class _Worker(Child):
    """A process that shares the work; `tasks` has a number and the path of the result for each."""

    def __init__(self, work: Callable[[Any], Any]) -> None:
        super().__init__(_serve, work)
        self.tasks = deque([(-1, "")] * _HANDED_OUT)  # full until it has started

    def give(self, number: int, item: Any, path: str) -> None:
        """Hand out a task.  Raises UnavailableError if the process is lost."""
        _dump(item, path)
        with _known_to_be_alive():
            self.pipe.send(path)
        self.tasks.append((number, f"{path}.result"))

    def answer(self) -> Iterator[tuple[int, str]]:
        """Yield the task that is done.  Raises UnavailableError, and any error of the work."""
        with _known_to_be_alive():
            error = self.pipe.recv()
        if error is not None:
            raise error
        if self.tasks[0][0] < 0:
            self.tasks.clear()  # it has started
        else:
            yield self.tasks.popleft()


@contextmanager
def _known_to_be_alive() -> Iterator[None]:
    try:
        yield
    except (EOFError, OSError):
        sleep(_SIGNALS_TAKE)
        raise UnavailableError(
            "a process that shared the work was lost (killed, or out of memory)"
        ) from None


@contextmanager
def safe_path() -> Iterator[None]:
    """Start Python processes in the block that import nothing from the current folder."""
    before = os.environ.get(_SAFE_PATH, "")
    os.environ[_SAFE_PATH] = "1"
    try:
        yield
    finally:
        os.environ[_SAFE_PATH] = before


@contextmanager
def interrupts_blocked() -> Iterator[None]:
    """Start processes that leave Ctrl-C to this one, because they inherit the blocked signal."""
    if not hasattr(signal, "pthread_sigmask"):  # on Windows
        yield
        return
    from multiprocessing.resource_tracker import ensure_running

    ensure_running()  # which unblocks the signal
    usual = signal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, usual)


def _serve(pipe: Connection, work: Callable[[Any], Any]) -> None:
    """Report that the process has started, then do tasks until it is ended."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # where signals cannot be blocked
    Thread(target=_end_with_parent, daemon=True).start()
    with suppress(EOFError, BrokenPipeError):  # the other end is gone
        pipe.send(None)
        while True:
            path, error = pipe.recv(), None
            try:
                _dump(work(_load(path)), f"{path}.result")
            except Exception as wrong:  # of any kind: raised again by the reader of the result
                error = wrong
            pipe.send(error)


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def _dump(value: object, path: str) -> None:
    """Write a value to a file, which may hold a longer one.  Raises CannotWriteError."""
    try:
        with open(os.open(path, os.O_WRONLY | os.O_CREAT, 0o600), "wb") as file:
            pickle.dump(value, file, pickle.HIGHEST_PROTOCOL)
    except OSError as error:
        raise CannotWriteError(f"cannot write {path}: {error.strerror}") from None


def _load(path: str) -> Any:
    """Return the value of a file.  Raises CannotWriteError if the file is gone."""
    try:
        with open(path, "rb") as file:
            return pickle.load(file)
    except OSError as error:
        raise CannotWriteError(f"cannot read {path}: {error.strerror}") from None
