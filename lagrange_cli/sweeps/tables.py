"""Tables of many tops, one after the other, each row with what its top carries."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from itertools import chain
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.points import Points
from ..arithmetic.types import Array
from ..errors import LagtopError
from ..inputs.given import Given
from ..inputs.top import Top
from ..inputs.tops_file import Lines, TopRow, TopsFile, open_tops
from ..motion.over_time.columns import headings
from ..motion.over_time.table import DEFAULT_COLUMNS, rows
from ..motion.solve import Motion, solve
from ..output.write import block_text
from .angles import angles_of
from .jobs import in_order
from .measured_arrays import top_arrays
from .parts import Part
from .plan import shared_inputs

_TOPS_AT_ONCE = 1024
_ROWS_PER_TASK = 50_000
"""Rows that are worth the way to another process."""
_WORTH_ARRAYS = 16
"""Tops that are sooner computed together, as arrays, than one by one."""


class Tables(NamedTuple):
    """What to do with every top of a file."""

    source: TopsFile
    shared: Mapping[str, float]
    """Inputs of all tops that have none of their own."""
    columns: Sequence[str]
    times: Callable[[Motion], Points]
    """The times for a motion."""
    radians: bool
    wrap: bool
    fmt: str
    same: Array | None = None
    """The times of all tops, where these are few and do not hang on the motion."""

    @property
    def header(self) -> list[str]:
        """The names of what is carried (or `line`, if nothing is), of the columns, and `error`."""
        carried = self.source.carried or ["line"]
        return [*carried, *headings(self.columns, radians=self.radians), "error"]

    def parts(self, lines: Lines) -> Iterator[Part]:
        """Yield blocks of rows as text; a top that has no table has one row with its error."""
        angles_alone = set(self.columns) <= set(DEFAULT_COLUMNS)
        if self.same is not None and angles_alone and lines.size >= _WORTH_ARRAYS:
            yield from self._angles(lines, self.same)
            return
        for row in lines.rows():
            yield from self._table(row)

    def listed(self, lines: Lines) -> list[Part]:
        """Return the parts of some lines together, as another process has to."""
        return list(self.parts(lines))

    def computed(self, lines: Iterable[Lines], jobs: int) -> Iterator[Part]:
        """Yield the parts of all lines in their order, computed by so many processes."""
        work = self.parts if jobs == 1 else self.listed
        return chain.from_iterable(in_order(work, lines, jobs))

    def _angles(self, lines: Lines, times: Array) -> Iterator[Part]:
        """Yield tables of angles, computed for all tops at once."""
        given = lines.arrays(self.shared)
        tops = top_arrays(given.inputs, given.size)
        rows = np.broadcast_to(times, (tops.m.size, times.size))
        angles, errors = angles_of(tops, rows, wrap=self.wrap)
        if not self.radians:
            np.degrees(angles, out=angles)
        for i, row in enumerate(lines.rows()):
            if error := row.error or errors[i]:
                yield self._refused(row, error)
                continue
            found = dict(zip(DEFAULT_COLUMNS, (times, *angles[:, i]), strict=True))
            block = np.stack([found[name] for name in self.columns], axis=1)
            yield Part(0, self._text(row, block, None), 1, 0, "")

    def _table(self, row: TopRow) -> Iterator[Part]:
        try:
            if row.error:
                raise LagtopError(row.error)
            motion = solve(Top(**row.completed(self.shared)))
            _, blocks = rows(
                motion, self.times(motion), self.columns, radians=self.radians, wrap=self.wrap
            )
        except LagtopError as error:
            yield self._refused(row, str(error))
            return
        for i, block in enumerate(blocks):
            yield Part(0, self._text(row, block, None), 0 if i else 1, 0, "")

    def _refused(self, row: TopRow, error: str) -> Part:
        """Return the one row of a top that has no table."""
        reason = f"line {row.line}: {error}"
        nothing = np.full((1, len(headings(self.columns))), np.nan)
        return Part(0, self._text(row, nothing, reason), 1, 1, reason)

    def _text(self, row: TopRow, block: Array, error: str | None) -> bytes:
        carried = row.carried or [row.line]
        same = [[value] * len(block) for value in carried]
        return block_text([*same, block, [error] * len(block)], self.header, self.fmt)


def open_tables(
    path: str,
    scene: str | None,
    inputs: Mapping[str, Any],
    columns: Sequence[str],
    times: Callable[[Motion], Points],
    *,
    radians: bool,
    wrap: bool,
    fmt: str,
    rows_per_top: int | None = None,
    same: Points | None = None,
    system: str | None = None,
) -> tuple[Tables, Iterator[Lines], Given]:
    """Return the tables of the tops in a file, its lines a few at a time, and what is shared.

    What a row lacks comes from `inputs` by key, and from a scene file.  The lines are fewer where a
    top has many rows, or nobody knows how many.  `same` are the times where they are those of all
    tops.  Raises DataError for a file that cannot be read, LagtopError for bad inputs.
    """
    at_once = 1 if not rows_per_top else min(max(_ROWS_PER_TASK // rows_per_top, 1), _TOPS_AT_ONCE)
    file, lines = open_tops(path, [*headings(columns, radians=radians), "error"], at_once)
    block = (
        None if same is None or same.count > _ROWS_PER_TASK else np.concatenate([*same.blocks()])
    )
    given, source = file.among(inputs, scene, system)
    shared = shared_inputs(given)
    tables = Tables(source, shared, columns, times, radians, wrap, fmt, block)
    return tables, (some._replace(file=source) for some in lines), given
