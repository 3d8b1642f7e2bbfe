"""What a shell may complete: the names that an option takes, loaded only when a shell asks."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import click

from .options import FILE, Parsed

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

Known = Callable[[], Iterable[str]]


class Words(click.ParamType):  # type: ignore[type-arg]
    """A parameter type: a word of a list or the name of a file, told apart by the command."""

    name = "text"

    def __init__(self, known: Known) -> None:
        self.known = known

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Return the words that go on like this one or, where there is none, files."""
        return _items(self.known(), incomplete) or FILE.shell_complete(ctx, param, incomplete)


class Names(Parsed):
    """A parameter type: names with commas between, of which a shell completes the last."""

    def __init__(self, known: Known) -> None:
        super().__init__("names", _split_names)
        self.known = known

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Return the names that go on like the last one, behind those that are there."""
        before, comma, begun = incomplete.rpartition(",")
        return _items((before + comma + name for name in self.known()), before + comma + begun)


def _items(names: Iterable[str], incomplete: str) -> list[CompletionItem]:
    """Return the names that go on like a word that is not complete."""
    from click.shell_completion import CompletionItem

    return [CompletionItem(name) for name in names if name.startswith(incomplete)]


def _split_names(text: str) -> list[str]:
    from ..inputs.names import split_names

    return split_names(text)


def _keys() -> list[str]:
    from ..motion.record import all_keys

    return all_keys()


def _columns() -> list[str]:
    from ..motion.columns import column_names

    return column_names()


def _methods() -> list[str]:
    from ..bench.work_precision import all_methods, groups

    return list(dict.fromkeys([*all_methods(1.0), *groups()]))


def _pictures() -> Iterable[str]:
    from ..plot.kinds import KINDS, SHEET

    return [*KINDS, SHEET]


def _strata() -> Iterable[str]:
    from ..bench.hard_scenes import STRATA

    return STRATA


KEY_NAMES, COLUMN_NAMES = Names(_keys), Names(_columns)
METHOD_NAMES, STRATUM_NAMES = Names(_methods), Names(_strata)
PICTURES = Words(_pictures)
