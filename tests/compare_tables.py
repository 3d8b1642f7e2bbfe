"""The tables in the README of `compare`, made from what the program knows."""

from __future__ import annotations

from functools import partial

from lagrange_cli.compare.compare import COMPARISON_KEYS, VERDICTS
from lagrange_cli.compare.differences import WORDS
from lagrange_cli.inputs.trajectory_columns import QUANTITIES


def _table(first: str, second: str, rows: dict[str, str]) -> list[str]:
    lines = [f"| `{x}` | {y} |" for x, y in rows.items()]
    return [f"| {first} | {second} |", "|---|---|", *lines]


COLUMNS = {key: f"{x.meaning}: {x.shown}" for key, x in QUANTITIES.items()}
COMPARE_TABLES = [
    partial(_table, "column", "quantity, and known names", COLUMNS),
    partial(_table, "key", "meaning", COMPARISON_KEYS),
    partial(_table, "verdict", "if", VERDICTS),
    partial(_table, "word", "meaning", WORDS),
]
