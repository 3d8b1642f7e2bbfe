"""What every reader of trajectories makes of a file: rows of numbers, a block at a time."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple, Protocol

from .descriptions import Description

if TYPE_CHECKING:
    from ..arithmetic.types import Array


class Block(NamedTuple):
    """Rows that follow one another, and where they stand."""

    values: Array
    """A row for each row, a column for each one that was asked for; NaN for an empty cell."""
    places: Sequence[int]
    """The number of the line, or of the row where there are no lines, from 1."""


class Words:
    """The words of a column, each with a number in the order in which they come."""

    def __init__(self) -> None:
        self._numbers: dict[str, float] = {}

    def number(self, word: str) -> float:
        """Return the number that stands for a word, whose quotes and blanks do not count."""
        return self._numbers.setdefault(word.strip().strip('"'), float(len(self._numbers)))

    def word(self, number: float) -> str:
        """Return the word that a number stands for."""
        return list(self._numbers)[int(number)]


class PlainNumbers(Words):
    """The words of a column that holds numbers only: their texts."""

    def number(self, word: str) -> float:
        """Return the number itself."""
        return float(word)

    def word(self, number: float) -> str:
        """Return the number as text, without a fraction where it has none."""
        return f"{number:.17g}"


class Table(Protocol):
    """Rows of numbers, in whatever form they are stored."""

    @property
    def place(self) -> str:
        """What is counted by the places of a block: `line` or `row`."""

    @property
    def width(self) -> int:
        """The number of columns."""

    @property
    def description(self) -> Description:
        """What the file says of its numbers; empty if it has no description."""

    @property
    def names(self) -> Sequence[str] | None:
        """The names of the columns, if they have any."""

    def blocks(self, columns: Sequence[int], names: Sequence[str]) -> Iterator[Block]:
        """Yield some columns, once, a block of rows at a time; names are for errors."""

    def words_of(self, column: int) -> Words:
        """Return the words of a column, which from now on stand for numbers in it."""
