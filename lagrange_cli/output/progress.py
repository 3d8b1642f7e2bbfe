"""The type of progress: a function that passes on the parts of long work as they are done."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from typing import Any, Protocol, TypeVar

Item = TypeVar("Item")


def one(_: Any) -> int:
    """Return 1, the size of a part that counts as one item."""
    return 1


class Progress(Protocol):
    """A function that shows the progress of some work during iteration over its parts."""

    def __call__(
        self,
        parts: Iterable[Item],
        label: str,
        total: int | None = None,
        size: Callable[[Item], int] = one,
    ) -> Iterator[Item]:
        """Yield the parts as they arrive.

        `size` gives the items of a part, and `total` the items of all parts.  Without a total it is
        summed over the parts if these are a sequence, and unknown otherwise.
        """


def silent(
    parts: Iterable[Item],
    label: str,
    total: int | None = None,
    size: Callable[[Item], int] = one,
) -> Iterator[Item]:
    """Yield the parts and show nothing."""
    return iter(parts)
