"""Long arrays, a block at a time: what is computed in between stays in the cache."""

from __future__ import annotations

from collections.abc import Iterator

BLOCK = 16384
"""Elements of an array that are computed together."""


def blocks(size: int) -> Iterator[slice]:
    """Yield slices that cover an array of so many elements; one slice where it is empty."""
    return (slice(start, start + BLOCK) for start in range(0, max(size, 1), BLOCK))
