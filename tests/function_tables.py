"""Tables of functions as the tests read them."""

from __future__ import annotations

from fractions import Fraction
from typing import cast

from lagrange_cli.arithmetic.points import ExactComplex
from lagrange_cli.arithmetic.types import Array
from lagrange_cli.elliptic.modulus import ModulusInput
from lagrange_cli.elliptic.request import FunctionRequest
from lagrange_cli.elliptic.tables import TableOfFunctions


def array_rows(table: TableOfFunctions) -> list[dict[str, float]]:
    """Return the rows of a table in doubles, computed in arrays, each by the columns."""
    header, blocks = table.array_rows()
    rows = (row for block in blocks for row in cast(Array, block).tolist())
    return [dict(zip(header, row, strict=True)) for row in rows]


def request_of(
    modulus: ModulusInput, families: tuple[str, ...], size: Fraction, imaginary: bool = False
) -> FunctionRequest:
    """Return a request of real functions with a parameter, or with i times it."""
    parameter = ExactComplex(Fraction(0), size) if imaginary else ExactComplex(size)
    return FunctionRequest(modulus, families, parameter, imaginary)
