"""What a shell may complete: names that an option takes, loaded only when a shell asks."""

from __future__ import annotations

from collections.abc import Iterable

from click.shell_completion import CompletionItem


def completed(words: str, incomplete: str) -> list[CompletionItem]:
    """Return the names of a list, such as `keys`, that go on like the last word behind a comma."""
    before, comma, begun = incomplete.rpartition(",")
    names = _LISTS[words]() if words else []
    found = [CompletionItem(before + comma + name) for name in names if name.startswith(begun)]
    return found if found or words != "pictures" else files(incomplete)  # a scene file goes there


def files(incomplete: str) -> list[CompletionItem]:
    """Return the request that the shell offers its files."""
    return [CompletionItem(incomplete, type="file")]


def _keys() -> list[str]:
    from ..motion.record import all_keys

    return all_keys()


def _columns() -> list[str]:
    from ..motion.over_time.columns import column_names

    return column_names()


def _methods() -> Iterable[str]:
    from ..bench.measure import all_methods, groups

    return dict.fromkeys([*all_methods(1.0), *groups()])


def _strata() -> Iterable[str]:
    from ..bench.hard_scenes import STRATA

    return STRATA


def _pictures() -> Iterable[str]:
    from ..plot.kinds import KINDS, SHEET

    return [*KINDS, SHEET]


_LISTS = {
    "keys": _keys,
    "columns": _columns,
    "methods": _methods,
    "strata": _strata,
    "pictures": _pictures,
}
