"""The one error that every bad input raises."""

from __future__ import annotations

from collections.abc import Iterable, Sequence


class LagtopError(ValueError):
    """A bad input. `key` names the input at fault where there is one."""

    exit_code = 2

    def __init__(self, message: str, key: str | None = None) -> None:
        super().__init__(message)
        self.key = key


def check_names(option: str, names: Sequence[str], known: Iterable[str]) -> None:
    """Raise LagtopError for a name that is not known, for one that comes twice, and for none."""
    known = list(known)
    for name in names or [""]:
        if name not in known:
            raise LagtopError(f"{option} must be among {' '.join(known)}, got {name!r}")
    if len(set(names)) < len(names):
        raise LagtopError(f"{option} must name each one once, got {' '.join(names)}")
