"""Markdown as GitHub renders it, for reports and issues."""

from __future__ import annotations

import re
from collections.abc import Sequence

from ..document import Grid, Lines, Page
from ..terminal import printable
from .base import ForPeople

_SPECIAL = re.compile(r"[\\`*|~$]|<(?=\S)|&(?=[\w#])|\](?=[(\[:])|(?<![^\W_])_|_(?![^\W_])")
"""What has a meaning wherever it stands."""
_FIRST = re.compile(r"^(?=[-+#>])|^(\d+)(?=[.)](?:\s|$))")
"""What makes the beginning of a paragraph a list, a heading or a quotation."""


class Markdown(ForPeople):
    """Paragraphs, blocks of lines, and tables."""

    def page(self, page: Page, width: int | None) -> str:
        """Return texts, lines and tables with an empty line between them."""
        return "\n\n".join(filter(None, map(_part, page))) + "\n"


def _part(part: str | Grid | Lines) -> str:
    if isinstance(part, str):
        return _FIRST.sub(r"\1\\", _escaped(part))
    if isinstance(part, Lines):
        return "\n".join(["```", *map(printable, part.lines), "```"])
    size = len(part.headings)
    marks = ["---:" if i in part.numbers else "---" for i in range(size)]
    rows = [
        [*map(_escaped, row)]
        if len(row) == size
        else [f"**{_escaped(row[0])}**", *[""] * (size - 1)]
        for row in part.rows
    ]
    return "\n".join(map(_line, [[*map(_escaped, part.headings)], marks, *rows]))


def _line(cells: Sequence[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _escaped(text: str) -> str:
    """Return a text that means only itself."""
    return _SPECIAL.sub(r"\\\g<0>", printable(" ".join(text.split())))


FORMAT = Markdown()
