"""Inputs of neighbouring tops of a sweep, as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, Protocol

if TYPE_CHECKING:
    from ..arithmetic.types import Array


class InputArrays(NamedTuple):
    """The inputs of some tops and what goes with each of them."""

    size: int
    """The number of tops."""
    inputs: Mapping[str, Array | float]
    """An array for each input, or one number for all; NaN where a top lacks it."""
    carried: Sequence[Sequence[Any]] = ()
    """The columns that are carried through."""
    lines: Sequence[int] | None = None
    """The number of the line of each top, if they come from a file."""
    errors: Mapping[int, str] = {}
    """What is already known to be wrong, by row."""


class Block(Protocol):
    """Neighbouring tops of a grid or of a file, not read yet."""

    @property
    def size(self) -> int:
        """The number of tops."""

    def arrays(self, shared: Mapping[str, float]) -> InputArrays:
        """Return the inputs of the tops; `shared` ones stand where a top has none of its own."""
