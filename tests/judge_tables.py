"""The tables in the README of the judge, made from what the program knows."""

from __future__ import annotations

from collections.abc import Iterable

from lagrange_cli.inputs.trajectory_columns import QUANTITIES
from lagrange_cli.judge.alignment import WORDS
from lagrange_cli.judge.compare import JUDGEMENTS
from lagrange_cli.judge.judgement import JUDGEMENT_KEYS
from lagrange_cli.judge.mistakes import MISTAKES


def _table(first: str, second: str, rows: Iterable[tuple[str, str]]) -> list[str]:
    return [f"| {first} | {second} |", "|---|---|", *(f"| {x} | {y} |" for x, y in rows)]


def columns_table() -> list[str]:
    """Return the table of the columns of a trajectory."""
    shown = ((f"`{key}`", f"{x.meaning}: {x.shown}") for key, x in QUANTITIES.items())
    return _table("column", "quantity, and known names", shown)


def keys_table() -> list[str]:
    """Return the table of the keys of a record."""
    return _table("key", "meaning", ((f"`{key}`", text) for key, text in JUDGEMENT_KEYS.items()))


def verdicts_table() -> list[str]:
    """Return the table of the verdicts."""
    return _table("verdict", "when", ((f"`{word}`", text) for word, text in JUDGEMENTS.items()))


def alignments_table() -> list[str]:
    """Return the table of the words of --align."""
    return _table("word", "meaning", ((f"`{word}`", text) for word, text in WORDS.items()))


def mistakes_table() -> list[str]:
    """Return the table of the common mistakes."""
    names = dict.fromkeys(x.name for x in MISTAKES)
    return ["| mistake |", "|---|", *(f"| {name} |" for name in names)]


JUDGE_TABLES = (columns_table, keys_table, verdicts_table, alignments_table, mistakes_table)
