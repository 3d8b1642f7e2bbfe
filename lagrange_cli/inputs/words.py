"""Words in a column of numbers, such as the names of trials: each stands for a number."""

from __future__ import annotations


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
