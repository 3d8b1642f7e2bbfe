"""The meaning of every key and column of a motion, for `lagtop explain` and the READMEs."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import NamedTuple

from ..inputs.names import check_names
from .over_time.columns import COLUMNS
from .quantity import unit_name
from .record import KEYS, all_keys, shown_keys
from .solve import Motion


class Explained(NamedTuple):
    """A key or a column: how it is called and where it comes from."""

    name: str
    kind: str
    """`record`, `on request` or `column`."""
    symbol: str
    meaning: str
    unit: str
    equation: str
    formula: str


def explained_names() -> list[str]:
    """Return the names of all keys and columns; a name of both is there once."""
    return list(dict.fromkeys([*all_keys(), *COLUMNS]))


def listed(*, radians: bool = False, named: Callable[[str], str] = str) -> list[Explained]:
    """Return all keys and columns, with the names of units of a system."""
    keys = shown_keys(radians=radians, named=named, requested=True)
    of_record = {unit_name(name, radians=radians) for name in KEYS}
    rows = [
        Explained(
            *(name, "record" if name in of_record else "on request", key.symbol, key.meaning),
            *(key.unit, key.equation, key.formula),
        )
        for name, key in keys.items()
        if key.meaning
    ]
    columns = [
        Explained(name, "column", "", column.meaning, "", "", "")
        for name, column in COLUMNS.items()
    ]
    return [*rows, *columns]


def explanations(
    motion: Motion,
    names: Sequence[str],
    *,
    radians: bool = False,
    named: Callable[[str], str] = str,
) -> list[Explained]:
    """Return the explanations of some keys and columns.  Raises LagtopError for an unknown name."""
    rows = listed(radians=radians, named=named)
    check_names("KEY", names, list(dict.fromkeys(row.name for row in rows)))
    return [row for name in names for row in rows if row.name == name]
