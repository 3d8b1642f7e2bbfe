"""Points of methods that other programs measured, for the picture of `bench`."""

from __future__ import annotations

import csv
from typing import NamedTuple

from ..arithmetic.text import parse_number, quoted
from ..errors import DataError, LagtopError
from ..file_bytes import read_text, shown_path

COSTS = {"ns_per_sample": "time per sample (ns)", "evaluations": "evaluations"}
"""What a method may cost, as the columns of `bench` name it, and the label of the axis."""


class Point(NamedTuple):
    """The error (rad) and the cost of a method."""

    method: str
    error: float
    cost: float


def read_points(path: str) -> tuple[str, list[Point]]:
    """Return the points of a CSV file, and the column of their costs: one of COSTS.

    The file has the columns `method`, `error_rad`, and `ns_per_sample` or `evaluations`, as `bench`
    writes them; rows without an error are left out.  Raises DataError for another file.
    """
    table = csv.DictReader(read_text(path).splitlines())
    names = table.fieldnames or []
    cost = next((x for x in COSTS if x in names), "")
    if not cost or not {"method", "error_rad"} <= {*names}:
        wanted = "method, error_rad, and ns_per_sample or evaluations"
        raise DataError(f"{shown_path(path)} must have the columns {wanted}")
    points = []
    for row in table:
        place = f"{shown_path(path)}, line {table.line_num}"
        cells = [row[x] or "" for x in ("error_rad", cost)]
        if not all(cells):
            continue
        try:
            error, size = (float(parse_number(x)) for x in cells)
        except LagtopError as failure:
            raise DataError(f"{place}: {failure}") from None
        if not (error >= 0 and size > 0):
            raise DataError(f"{place}: error and cost must be positive, got {quoted(cells)}")
        points.append(Point(str(row["method"]), error, size))
    if not points:
        raise DataError(f"{shown_path(path)} has no row with an error and {cost}")
    return cost, points
