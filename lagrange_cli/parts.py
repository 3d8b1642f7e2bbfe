"""A sweep cut into parts: blocks of tops that any process can compute, in any order.

The bytes of a part depend on nothing but its number, so a run on one machine writes what all parts
hold in their order, wherever each of them was made.
"""

from __future__ import annotations

import logging
import signal
from asyncio import CancelledError
from collections import deque
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import closing, contextmanager
from itertools import chain, repeat
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from .grid import Grid
from .output import Columns, block_text
from .rowfile import Lines, RowFile
from .sweeps import Column, records
from .top import LagtopError
from .tops import Tops

if TYPE_CHECKING:
    from distributed import Client, Future

Block = tuple[int, range | Lines]
"""The number of a part, and the points of the grid or the lines of the file that it is made of."""


class FailedError(LagtopError):
    """Some tops have an error, which stands in their rows."""

    exit_code = 1


class Part(NamedTuple):
    """One part, computed."""

    number: int
    text: bytes
    tops: int
    """How many tops it has."""
    failed: int
    """How many of them have an error."""
    first_error: str


class Inputs(NamedTuple):
    """The tops of a part, and what goes with each of them."""

    tops: Tops
    carried: Sequence[Sequence[Any]] = ()
    """Columns that are carried through."""
    lines: Sequence[int] | None = None
    errors: Mapping[int, str] | None = None
    """What is already known to be wrong, by row."""


class Sweep(NamedTuple):
    """What to do with every part: where the inputs stand, what to compute, how to write it."""

    source: Grid | RowFile
    given: Mapping[str, float]
    """Inputs that all tops share, or that a row may lack."""
    keys: Sequence[str]
    radians: bool
    style: str

    @property
    def header(self) -> list[str]:
        """The names of the columns."""
        carried = self.source.carried if isinstance(self.source, RowFile) else ()
        return [*carried, *self.keys]

    def part(self, block: Block) -> Part:
        """Compute one part."""
        number, place = block
        inputs = self._inputs(place)
        found = records(
            inputs.tops, [*self.keys, "error"], radians=self.radians, errors=inputs.errors
        )
        errors = [(row, error) for row, error in enumerate(found["error"]) if error]
        if inputs.lines is not None:
            errors = [(row, f"line {inputs.lines[row]}: {error}") for row, error in errors]
        for row, error in errors:
            found["error"][row] = error
        columns = [*inputs.carried, *_runs([found[key] for key in self.keys])]
        text = block_text(columns, self.header, self.style)
        return Part(number, text, inputs.tops.m.size, len(errors), errors[0][1] if errors else "")

    def _inputs(self, place: range | Lines) -> Inputs:
        if isinstance(self.source, Grid):
            assert isinstance(place, range)
            given = {**self.given, **self.source.points(place.start, place.stop)}
            return Inputs(Tops(*(_column(given.get(x), len(place)) for x in Tops._fields)))
        assert isinstance(place, Lines)
        rows = list(self.source.rows(place))
        filled = [row.completed(self.given) for row in rows]
        return Inputs(
            Tops(*(np.array([x.get(name, np.nan) for x in filled]) for name in Tops._fields)),
            list(zip(*(row.carried for row in rows), strict=True)),
            [row.line for row in rows],
            {i: row.error for i, row in enumerate(rows) if row.error},
        )


def _column(value: Any, count: int) -> Any:
    return np.broadcast_to(np.float64(np.nan if value is None else value), (count,))


def _runs(columns: Iterable[Column]) -> Columns:
    """Neighbouring columns of numbers as one array of rows, and texts as lists."""
    runs: list[Any] = []
    numbers: list[Column] = []
    for column in columns:
        if column.dtype == np.float64:
            numbers.append(column)
            continue
        if numbers:
            runs.append(np.stack(numbers, axis=1))
            numbers = []
        runs.append(column.tolist())
    return [*runs, np.stack(numbers, axis=1)] if numbers else runs


def shard_of(blocks: Iterable[Block], which: tuple[int, int] | None) -> Iterator[Block]:
    """Every N-th block, from the I-th on."""
    first, step = which or (1, 1)
    return (block for block in blocks if block[0] % step == first - 1)


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
                raise LagtopError(
                    f"--dask: the cluster could not compute a part: {error}"
                ) from None


class Tally:
    """Counts the tops that have an error as the parts pass by."""

    def __init__(self, *, fail_fast: bool = False) -> None:
        self.fail_fast = fail_fast
        self.count = self.failed = 0
        self.first = ""

    def passing(self, parts: Iterable[Part]) -> Iterator[Part]:
        """The parts.  With `fail_fast`, raises FailedError at the first one with an error."""
        for part in parts:
            self.count, self.failed = self.count + part.tops, self.failed + part.failed
            self.first = self.first or part.first_error
            if self.fail_fast:
                self.check()
            yield part

    def texts(self, parts: Iterable[Part]) -> Iterator[bytes]:
        """What there is to write."""
        return (part.text for part in self.passing(parts))

    def check(self) -> None:
        """Raise FailedError if there was any error."""
        if self.failed and self.fail_fast:
            raise FailedError(self.first)
        if self.failed:
            raise FailedError(
                f"{self.failed} of {self.count} tops have an error; the first: {self.first}"
            )
