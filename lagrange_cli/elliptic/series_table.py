"""How the nome series of Aksenov converge, a row per number of terms."""

from __future__ import annotations

from collections.abc import Iterator
from fractions import Fraction
from itertools import islice

from ..arithmetic.many_digits import ManyDigits
from ..arithmetic.points import MAX_PERIODS
from ..arithmetic.protocol import Value
from ..arithmetic.text import double_text
from ..errors import LagtopError
from .complete import complete_k
from .jacobi import jacobi
from .modulus_input import ModulusInput
from .nome_series import am_sums, cn_sums, k_sums, sn_sums


def series_rows(
    modulus_input: ModulusInput, u: Fraction | None, terms: int
) -> tuple[list[str], list[list[str]]]:
    """Return the header and partial sums 1 to `terms`, each with its error.

    They are (3.1.8) for K and, at u, (3.1.7), (3.1.4), (3.1.5) for am, sn, cn.  Raises LagtopError
    for k = 0 and k = 1, where the series are limits, and for u beyond 2^50 periods.
    """
    ar = ManyDigits()
    exact = modulus_input.in_digits(ar)
    if not (exact.k and exact.k_prime):
        raise LagtopError(f"the nome series need 0 < k < 1, got k = {float(exact.k)}")
    sums: dict[str, tuple[Iterator[Value], Value]] = {
        "K": (k_sums(ar, exact), complete_k(ar, exact.k_prime))
    }
    if u is not None:
        limit = MAX_PERIODS * 2 * complete_k(ar, exact.k_prime)
        if abs(u) > limit:
            reach = ar.nstr(limit, 3)
            raise LagtopError(f"u must be within 2^50 periods = {reach} of 0, got {float(u)}", "u")
        x, unit = ar.convert(u), 1 if modulus_input.radians else 180 / ar.pi
        am, sn, cn, _ = jacobi(ar, x, exact)
        from_first_term = islice(am_sums(ar, x, exact), 1, None)
        sums["am_rad" if modulus_input.radians else "am_deg"] = (
            (unit * part for part in from_first_term),
            unit * am,
        )
        sums |= {"sn": (sn_sums(ar, x, exact), sn), "cn": (cn_sums(ar, x, exact), cn)}
    header = ["terms", *(name for key in sums for name in (key, f"{key}_error"))]
    sums_exactly = [value for _, value in sums.values()]
    table = []
    for n, row in enumerate(zip(*(parts for parts, _ in sums.values()), strict=False), 1):
        pairs = zip(row, sums_exactly, strict=True)
        cells = (x for part, true in pairs for x in (part, abs(part - true)))
        table.append([str(n), *(double_text(float(x)) for x in cells)])
        if n == terms:
            break
    return header, table
