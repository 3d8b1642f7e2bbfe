"""Where the parts of a sweep are computed: here, by several processes or by a Dask cluster."""

from __future__ import annotations

import asyncio
import logging
import pickle
import pkgutil
from collections import deque
from collections.abc import Callable, Generator, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import AbstractContextManager, closing, contextmanager, suppress
from itertools import islice
from time import monotonic
from typing import TYPE_CHECKING, Any, NamedTuple

from .. import __version__
from ..errors import LagtopError, UnavailableError
from .jobs import in_order, interrupts_blocked, safe_path
from .plan import Make, NumberedBlock, Part

if TYPE_CHECKING:
    from distributed import Client, Future

PATIENCE = 8.0
"""Seconds to wait for a scheduler that does not answer, or for a first or another worker."""

_BETWEEN_LOOKS = 1.0
_SECONDS_PER_TASK = 1.0
"""Work that is worth the way to a worker and back."""
MOST_PARTS_PER_TASK = 16
"""Parts that a task may send back, some 30 MB with all keys."""


@contextmanager
def connected(address: str | None) -> Iterator[Client | None]:
    """Yield the client of a Dask cluster, or None if there is no address.

    The address may be `local`, for a cluster on this machine that ends with the block.  Raises
    UnavailableError for a cluster that cannot be reached, has no worker, or whose workers have no
    lagtop or another version of it, and LagtopError for an address that is none.
    """
    if address is None:
        yield None
        return
    with safe_path():  # a local cluster replaces workers that are lost
        client = _client(address)
        try:
            _check_workers(client)
            yield client
        finally:
            with suppress(Exception):  # what ended the sweep is what matters
                client.close(timeout=20 if address == "local" else 2)


def computed(
    make: Make, blocks: Iterable[NumberedBlock], client: Client | None, jobs: int = 1
) -> AbstractContextManager[Iterator[Part]]:
    """Return the parts in their order, to be closed: made by a cluster, or by so many processes.

    Raises UnavailableError for a cluster that is lost, and what `make` raises.
    """
    return closing(
        in_order(make, blocks, jobs) if client is None else _gathered(client, make, blocks)
    )


def _client(address: str) -> Client:
    """Return a client.  Raises UnavailableError, and LagtopError for an address that is none."""
    try:
        from distributed import Client
    except ImportError:
        raise UnavailableError(
            "dask needs distributed: pip install 'lagtop[cluster]'", "dask"
        ) from None
    silent = logging.CRITICAL  # one line of ours says what is wrong
    for name in ("distributed", "distributed.client", "asyncio", "tornado"):
        logging.getLogger(name).setLevel(silent)
    try:
        if address != "local":
            asyncio.run(asyncio.wait_for(_greet(address), PATIENCE))
            return Client(address, timeout=PATIENCE)
        with interrupts_blocked():
            return Client(threads_per_worker=1, dashboard_address=":0", silence_logs=silent)
    except (TypeError, ValueError) as error:
        raise LagtopError(
            f"dask must be local or a scheduler, got {address}: {error}", "dask"
        ) from None
    except Exception as error:  # of any kind: whatever answers may be no scheduler
        started = "a cluster of this machine cannot be started"
        what = started if address == "local" else f"no scheduler answers at {address}"
        raise UnavailableError(f"{what}: {error}") from None


async def _greet(address: str) -> None:
    """Exchange greetings with a scheduler: a client waits for them without end."""
    from distributed.comm.core import connect

    connection = await connect(address, timeout=PATIENCE)
    await connection.close()


def _check_workers(client: Client) -> None:
    """Raise UnavailableError where there is no worker, or one that would compute otherwise."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        _threads(client)
        raise UnavailableError("the cluster has no worker") from None
    # A function of the standard library: a worker that cannot unpickle what it is sent would die.
    versions = _answer(
        lambda: client.run(
            pkgutil.resolve_name,
            "lagrange_cli:__version__",
            on_error="return",
            callback_timeout=PATIENCE,
        )
    )
    for worker, version in versions.items():
        if isinstance(version, BaseException):
            raise UnavailableError(f"the worker {worker} of the cluster has no lagtop: {version}")
        if version != __version__:
            raise UnavailableError(
                f"the worker {worker} of the cluster has lagtop {version}, and not {__version__}"
            )


def _threads(client: Client) -> dict[str, int]:
    """Return the number of threads of each worker.  Raises UnavailableError."""
    threads: dict[str, int] = _answer(lambda: client.nthreads(callback_timeout=PATIENCE))
    return threads


def _answer(ask: Callable[[], Any]) -> Any:
    """Return what the cluster answers.  Raises UnavailableError where it does not."""
    try:
        return ask()
    except TimeoutError:
        raise UnavailableError(f"the cluster does not answer for {PATIENCE:.0f} s") from None
    except (OSError, CancelledError, RuntimeError) as error:
        raise UnavailableError(f"the cluster is lost: {error}") from None


class _Call:
    """Some parts that are computed by being unpickled.

    A worker is sent `pickle.loads` and these bytes: one that joined later and has no lagtop, or
    another version, fails in the task, where an error is reported, and not in reading the message,
    where it would die.
    """

    def __init__(self, make: Make, blocks: Sequence[NumberedBlock]) -> None:
        self.content = pickle.dumps((make, blocks))

    def __reduce__(self) -> tuple[Any, ...]:
        return compute, (__version__, self.content)


class Computed(NamedTuple):
    """What a task has made, and how long it took."""

    parts: Sequence[Part]
    seconds: float

    def next_size(self) -> int:
        """Return how many parts the next task should have, to take about a second."""
        size = len(self.parts) * _SECONDS_PER_TASK / max(self.seconds, 1e-3)
        return max(1, min(int(size), MOST_PARTS_PER_TASK))


def compute(version: str, content: bytes) -> Computed:
    """Compute parts on a worker.  Raises UnavailableError for a sweep of another version."""
    if version != __version__:
        raise UnavailableError(f"a worker of the cluster has lagtop {__version__}, not {version}")
    begun = monotonic()
    make, blocks = pickle.loads(content)
    parts = [make(block) for block in blocks]
    return Computed(parts, monotonic() - begun)


def _gathered(
    client: Client, make: Make, blocks: Iterable[NumberedBlock]
) -> Generator[Part, None, None]:
    """Yield the parts in their order; those of a lost worker are computed by another one.

    A few tasks per worker are under way at a time, so that memory does not grow with their number.
    The first have a part each; how long they took says how many the next have.
    """
    most = 2 * max(sum(_threads(client).values()), 4)
    waiting: deque[Future[Computed]] = deque()
    left, size = iter(blocks), 1
    while True:
        if few := list(islice(left, size)):
            call = pickle.dumps(_Call(make, few))
            waiting.append(client.submit(pickle.loads, call, pure=False))
        elif not waiting:
            return
        if not few or len(waiting) >= most:
            done = _result(client, waiting.popleft())
            yield from done.parts
            size = done.next_size()


def _result(client: Client, future: Future[Computed]) -> Computed:
    """Wait for some parts.  Raises UnavailableError as soon as nothing is left to wait for."""
    from distributed import KilledWorker, wait

    seen = monotonic()  # when there was a worker last
    try:
        while True:
            with suppress(TimeoutError):
                wait([future], timeout=_BETWEEN_LOOKS)
                return future.result(timeout=PATIENCE / 2)  # its worker may die before it is here
            if _threads(client):
                seen = monotonic()
            elif monotonic() - seen > PATIENCE:
                raise UnavailableError("the cluster has no worker left")
    except (ImportError, AttributeError) as error:
        raise UnavailableError(f"a worker of the cluster has no lagtop: {error}") from None
    except CancelledError:
        raise UnavailableError("the cluster has no scheduler any more") from None
    except (OSError, KilledWorker) as error:
        raise UnavailableError(f"the cluster lost a part: {error}") from None
