"""Points of methods that other programs measured, for the picture of `bench`."""

from __future__ import annotations

import math
from typing import NamedTuple

from ..errors import DataError
from ..files.tables import table_in

COSTS = {"ns_per_sample": "time per sample (ns)", "evaluations": "evaluations"}
"""What a method may cost, as the columns of `bench` name it, and the label of the axis."""


class Point(NamedTuple):
    """The error (rad) and the cost of a method."""

    method: str
    error: float
    cost: float


def read_points(path: str) -> tuple[str, list[Point]]:
    """Return the points of a table in a file, and the column of their costs: one of COSTS.

    The file has the columns `method`, `error_rad`, and `ns_per_sample` or `evaluations`, as `bench`
    writes them; rows without an error are left out.  Raises DataError for another file.
    """
    wanted = ("method", "error_rad", *COSTS)
    table = table_in(path, lambda names: len({*names} & {*wanted}))
    at = {name: i for i, name in enumerate(table.headings or ()) if name in wanted}
    cost = next((x for x in COSTS if x in at), "")
    if not cost or not {"method", "error_rad"} <= at.keys():
        columns = "method, error_rad, and ns_per_sample or evaluations"
        raise DataError(f"{table.name} must have the columns {columns}")
    methods, points = dict(table.column(at["method"])), []
    found = table.numbers([at["error_rad"], at[cost]], table.headings or ())
    for line, (error, size), empty in zip(found.lines, found.values, found.empty, strict=True):
        if empty.any():
            continue
        if not (0 <= error < math.inf and 0 < size < math.inf):
            got = f"{error:g} and {size:g}"
            raise table.wrong(line, f"error and cost must be positive, got {got}")
        points.append(Point(str(methods[line]), float(error), float(size)))
    if not points:
        raise DataError(f"{table.name} has no row with an error and {cost}")
    return cost, points
