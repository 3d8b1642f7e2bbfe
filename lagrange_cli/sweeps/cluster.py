"""Where the parts of a sweep are computed: in this process or on a Dask cluster."""

from __future__ import annotations

import logging
import signal
from collections import deque
from collections.abc import Iterable, Iterator
from concurrent.futures import CancelledError
from contextlib import closing, contextmanager
from itertools import chain, repeat
from typing import TYPE_CHECKING

from ..errors import LagtopError
from .parts import Block, Part, Sweep

if TYPE_CHECKING:
    from distributed import Client, Future


@contextmanager
def computed(
    sweep: Sweep, blocks: Iterable[Block], cluster: str | None
) -> Iterator[Iterator[Part]]:
    """The parts in their order, made here or on a Dask cluster (its address, or `local`).

    Raises LagtopError for a cluster that cannot be reached.
    """
    if cluster is None:
        yield map(sweep.part, blocks)
        return
    with closing(_client(cluster)) as client:
        yield _gathered(client, sweep, blocks)


def _client(address: str) -> Client:
    try:
        from distributed import Client
    except ImportError:
        raise LagtopError("--dask needs dask: pip install 'lagtop[cluster]'") from None
    for name in ("distributed", "distributed.client"):  # we say ourselves, and once, what is wrong
        logging.getLogger(name).setLevel(logging.CRITICAL)
    if address == "local":
        with _no_interrupts():
            return Client(threads_per_worker=1, dashboard_address=":0", silence_logs=logging.ERROR)
    try:
        return Client(address, timeout=10)
    except (OSError, ValueError) as error:
        raise LagtopError(f"--dask must be local or a scheduler, got {address}: {error}") from None


@contextmanager
def _no_interrupts() -> Iterator[None]:
    """Ignore Ctrl-C, and for good in the processes that are started meanwhile: workers are ours to
    stop, and would each print a traceback."""
    before = signal.signal(signal.SIGINT, signal.SIG_IGN)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)


def _gathered(client: Client, sweep: Sweep, blocks: Iterable[Block]) -> Iterator[Part]:
    """Some parts a worker are under way at a time, so that memory does not grow with their number.

    What a lost worker was at is computed by another one.
    """
    from distributed import KilledWorker

    most = 4 * max(sum(client.nthreads().values()), 4)
    waiting: deque[Future[Part]] = deque()
    for block in chain(blocks, repeat(None)):
        if block is not None:
            waiting.append(client.submit(sweep.part, block, pure=False))
        elif not waiting:
            return
        if block is None or len(waiting) >= most:
            try:
                yield waiting.popleft().result()
            except (ImportError, OSError, CancelledError, KilledWorker) as error:
                raise LagtopError(f"--dask: the cluster lost a part: {error}") from None
