"""The one error that every bad input raises."""

from __future__ import annotations


class LagtopError(ValueError):
    """A bad input. `key` names the input at fault where there is one."""

    def __init__(self, message: str, key: str | None = None) -> None:
        super().__init__(message)
        self.key = key
