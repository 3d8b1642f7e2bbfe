"""Tables of many tops, one after the other, each row with the copied columns of its top."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.given import Given
from ..inputs.text_lines import UNDECIDED, Dialect
from ..inputs.top import Top
from ..inputs.tops_file import Lines, TopRow, TopsFile, open_tops
from ..motion.over_time.columns import DEFAULT_COLUMNS
from ..motion.over_time.table_request import TableRequest
from ..motion.solve import solve
from ..output.formats import block_text
from .angles import angles_of_tops
from .jobs import in_order
from .plan import Part, shared_inputs
from .top_arrays import top_arrays

_TOPS_AT_ONCE = 1024
_ROWS_PER_TASK = 50_000
"""Rows per task, enough to outweigh the way to another process."""
_WORTH_ARRAYS = 16
"""Number of tops from which arrays are faster than tops one by one."""


class Tables(NamedTuple):
    """Instructions for every top of a file: shared inputs, times and columns."""

    source: TopsFile
    shared: Mapping[str, float]
    """Inputs of tops that do not have their own."""
    request: TableRequest
    fmt: str
    same: Array | None = None
    """The times of all tops, if these are few and do not depend on the motion."""

    @property
    def header(self) -> list[str]:
        """The names of the copied columns (or `line` if none), the columns, and `error`."""
        return [*(self.source.carried or ["line"]), *self.request.headings(), "error"]

    def parts(self, lines: Lines) -> Iterator[Part]:
        """Yield blocks of rows as text; a top that has no table has one row with its error."""
        angles_alone = set(self.request.columns) <= set(DEFAULT_COLUMNS)
        if self.same is not None and angles_alone and lines.size >= _WORTH_ARRAYS:
            yield from self._angles(lines, self.same)
        else:
            yield from chain.from_iterable(map(self._table, lines.rows()))

    def computed(self, lines: Iterable[Lines], jobs: int) -> Iterator[Part]:
        """Yield the parts of all lines in order, computed by `jobs` processes."""
        work = self.parts if jobs == 1 else self._listed
        return chain.from_iterable(in_order(work, lines, jobs))

    def _listed(self, lines: Lines) -> list[Part]:
        """Return the parts of some lines as a list, for another process to send."""
        return list(self.parts(lines))

    def _angles(self, lines: Lines, times: Array) -> Iterator[Part]:
        """Yield tables of angles, computed for all tops together."""
        given = lines.arrays(self.shared)
        tops = top_arrays(given.inputs, given.size)
        each = np.broadcast_to(times, (tops.m.size, times.size))
        angles, errors = angles_of_tops(tops, each, wrap=self.request.wrap)
        if not self.request.radians:
            np.degrees(angles, out=angles)
        for i, row in enumerate(lines.rows()):
            if error := row.error or errors[i]:
                yield self._refused(row, error)
                continue
            found = dict(zip(DEFAULT_COLUMNS, (times, *angles[:, i]), strict=True))
            block = np.stack([found[name] for name in self.request.columns], axis=1)
            yield Part(0, self._text(row, block, None), 1, 0, "")

    def _table(self, row: TopRow) -> Iterator[Part]:
        """Yield the table of one top."""
        try:
            if row.error:
                raise LagtopError(row.error)
            motion = solve(Top(**row.completed(self.shared)))
            _, blocks = self.request.rows(motion, self.request.times(motion))
        except LagtopError as error:
            yield self._refused(row, str(error))
            return
        for i, block in enumerate(blocks):
            yield Part(0, self._text(row, block, None), 0 if i else 1, 0, "")

    def _refused(self, row: TopRow, error: str) -> Part:
        """Return the single row of a top that has no table."""
        reason = f"line {row.line}: {error}"
        nothing = np.full((1, len(self.request.headings())), np.nan)
        return Part(0, self._text(row, nothing, reason), 1, 1, reason)

    def _text(self, row: TopRow, block: Array, error: str | None) -> bytes:
        same = [[value] * len(block) for value in row.carried or [row.line]]
        return block_text([*same, block, [error] * len(block)], self.header, self.fmt)


def open_tables(
    path: str,
    scene: str | None,
    inputs: Mapping[str, Any],
    request: TableRequest,
    *,
    fmt: str,
    system: str | None,
    dialect: Dialect = UNDECIDED,
) -> tuple[Tables, Iterator[Lines], Given]:
    """Return the tables of the tops in a file, its lines in blocks, and the shared inputs.

    Inputs missing from a row come from `inputs` by key, and from a scene file.  Blocks are smaller
    if a top has many rows, or an unknown number of rows.  Raises DataError if the file cannot be
    read, LagtopError for bad inputs.
    """
    count = request.rows_per_top
    at_once = 1 if not count else min(max(_ROWS_PER_TASK // count, 1), _TOPS_AT_ONCE)
    file, lines, _ = open_tops(path, [*request.headings(), "error"], at_once, dialect=dialect)
    given, source = file.among(inputs, scene, system)
    tables = Tables(source, shared_inputs(given), request, fmt, _same_times(request))
    return tables, (some._replace(file=source) for some in lines), given


def _same_times(request: TableRequest) -> Array | None:
    """Return the times of all tops, or None if they are many or depend on the motion."""
    try:
        times = request.times(solve(Top())) if request.same else None
    except LagtopError:  # every row reports the error
        return None
    if times is None or times.count > _ROWS_PER_TASK:
        return None
    return np.concatenate([*times.blocks()])
