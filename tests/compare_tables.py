"""The tables in the README of `compare`, made from what the program knows."""

from __future__ import annotations

from collections.abc import Iterable
from functools import partial

from lagrange_cli.compare.compare import COMPARISON_KEYS, VERDICTS
from lagrange_cli.compare.differences import WORDS
from lagrange_cli.inputs.trajectory_columns import QUANTITIES

_COLUMNS = {key: f"{x.meaning}: {x.shown}" for key, x in QUANTITIES.items()}


def _table(first: str, second: str, rows: Iterable[tuple[str, str]]) -> list[str]:
    return [f"| {first} | {second} |", "|---|---|", *(f"| `{x}` | {y} |" for x, y in rows)]


COMPARE_TABLES = [
    partial(_table, "column", "quantity, and known names", _COLUMNS.items()),
    partial(_table, "key", "meaning", COMPARISON_KEYS.items()),
    partial(_table, "verdict", "if", VERDICTS.items()),
    partial(_table, "word", "meaning", WORDS.items()),
]
