"""Computation of the parts of a sweep: in this process, in several, or on a Dask cluster."""

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
"""Seconds to wait for an answer of a scheduler, for a first worker, or for a replacement."""

_BETWEEN_LOOKS = 1.0
_SECONDS_PER_TASK = 1.0
"""Seconds of work per task, long enough to outweigh the way to a worker and back."""
MOST_PARTS_PER_TASK = 16
"""Parts that a task may send back, some 30 MB with all keys."""


@contextmanager
def connected(address: str | None) -> Iterator[Client | None]:
    """Yield the client of a Dask cluster, or None if there is no address.

    The address may be `local`, for a cluster on this machine that ends with the block.  Raises
    UnavailableError if the cluster cannot be reached or has no worker, or if a worker has no lagtop
    or another version of it.  Raises LagtopError for an invalid address.
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
            with suppress(Exception):  # report the error that ended the sweep, not one of closing
                client.close(timeout=20 if address == "local" else 2)


def computed(
    make: Make, blocks: Iterable[NumberedBlock], client: Client | None, jobs: int = 1
) -> AbstractContextManager[Iterator[Part]]:
    """Return a context of the parts in order, computed on a cluster or in `jobs` processes.

    Raises UnavailableError if the cluster is lost, and any error of `make`.
    """
    return closing(
        in_order(make, blocks, jobs) if client is None else _gathered(client, make, blocks)
    )


def _client(address: str) -> Client:
    """Return a client.  Raises UnavailableError, and LagtopError for an invalid address."""
    try:
        from distributed import Client
    except ImportError:
        raise UnavailableError(
            "dask needs distributed: pip install 'lagtop[cluster]'", "dask"
        ) from None
    silent = logging.CRITICAL  # lagtop reports the error in one line
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
    except Exception as error:  # of any kind: the peer may be no scheduler
        started = "a cluster of this machine cannot be started"
        what = started if address == "local" else f"no scheduler answers at {address}"
        why = str(error) or f"no answer in {PATIENCE:g} s"  # wait_for has no text
        raise UnavailableError(f"{what}: {why}") from None


async def _greet(address: str) -> None:
    """Exchange greetings with a scheduler, with a time limit: a client would wait forever."""
    from distributed.comm.core import connect

    connection = await connect(address, timeout=PATIENCE)
    await connection.close()


def _check_workers(client: Client) -> None:
    """Raise UnavailableError if there is no worker, or if one has no lagtop or another version."""
    try:
        client.wait_for_workers(1, timeout=PATIENCE)
    except TimeoutError:
        _threads(client)
        raise UnavailableError("the cluster has no worker") from None
    # A function of the standard library: a worker dies if it cannot unpickle a message.
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
    """Return the answer of the cluster.  Raises UnavailableError if there is none."""
    try:
        return ask()
    except TimeoutError:
        raise UnavailableError(f"the cluster does not answer for {PATIENCE:.0f} s") from None
    except (OSError, CancelledError, RuntimeError) as error:
        raise UnavailableError(f"the cluster is lost: {error}") from None


class _Call:
    """Some parts that are computed by being unpickled.

    The message to a worker holds `pickle.loads` and these bytes.  A worker that joined later may
    have no lagtop, or another version.  It then fails in the task, where the error is reported, and
    not while it reads the message, where it would die.
    """

    def __init__(self, make: Make, blocks: Sequence[NumberedBlock]) -> None:
        self.content = pickle.dumps((make, blocks))

    def __reduce__(self) -> tuple[Any, ...]:
        return compute, (__version__, self.content)


class Computed(NamedTuple):
    """The result of a task, and its run time in seconds."""

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
    """Yield the parts in order; if a worker is lost, another one computes its parts.

    A few tasks per worker are under way at a time, so that memory does not grow with their number.
    The first tasks have one part each; their run times set the size of the next ones.
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
    """Wait for some parts.  Raises UnavailableError as soon as they cannot arrive any more."""
    from distributed import KilledWorker, wait

    seen = monotonic()  # time at which a worker was last seen
    try:
        while True:
            with suppress(TimeoutError):
                wait([future], timeout=_BETWEEN_LOOKS)
                return future.result(timeout=PATIENCE / 2)  # its worker may die first
            if _threads(client):
                seen = monotonic()
            elif monotonic() - seen > PATIENCE:
                raise UnavailableError("all workers of the cluster are lost")
    except (ImportError, AttributeError) as error:
        raise UnavailableError(f"a worker of the cluster has no lagtop: {error}") from None
    except CancelledError:
        raise UnavailableError("the cluster has no scheduler any more") from None
    except (OSError, KilledWorker) as error:
        raise UnavailableError(f"the cluster lost a part: {error}") from None
