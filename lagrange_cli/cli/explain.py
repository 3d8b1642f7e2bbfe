"""`lagtop explain`, the meaning and the formula of every number, and `lagtop scenes`."""

from __future__ import annotations

import re
from collections.abc import Iterator, Sequence
from textwrap import fill
from typing import TYPE_CHECKING, NamedTuple

from ..arithmetic.text import value_text
from ..inputs.scene_file import scene_names, scene_remark
from ..output.report import Field, Report
from ..output.terminal import width_of
from . import options as opt
from .top import UNCERTAIN, TopOptions, motion_of, top_options, words

if TYPE_CHECKING:
    from ..motion.explanation import Explained
    from ..output.destination import Output

_FORMATS = ("table", "json", "csv", "ndjson")


def _names() -> list[str]:
    from ..motion.over_time.columns import COLUMNS
    from ..motion.record import all_keys

    return list(dict.fromkeys([*all_keys(), *COLUMNS, *scene_names()]))


@opt.command(
    "explain",
    """
    lagtop explain
    lagtop explain T_nutation mean_precession_rate looping-top
    lagtop explain b psidot --r0 20 --format json
    """,
)
def explain_command(
    top: TopOptions = top_options(
        UNCERTAIN, words("[SCENE] [KEY]...", opt.Parsed("KEY", str, _names))
    ),
    out: Output = opt.output(*_FORMATS),
) -> None:
    """Explain keys and columns, with formulas and numbers.

    A key is the name of a result.  Each formula is shown in symbols and with the numbers of the
    top.  Without KEY, all keys and columns are listed.  The record of solve has most keys; others
    are computed on request.  Keys go to solve --get, sweep --keys, find --keys and plot --key;
    columns go to table --columns.
    """
    from ..motion.explanation import explanations, listed

    found, names = top.given(), top.words
    named = found.system.named if found.system else str
    if names:
        rows = explanations(motion_of(found), names, radians=top.radians, named=named)
    else:
        rows = listed(radians=top.radians, named=named)
    if out.fmt == "table":
        view = width_of(out.path)
        out.text("\n".join((_block(row, view) for row in rows) if names else _lists(rows, view)))
    else:
        out.report(lambda: Report({}, _EXPLAINED if names else _LISTED, rows, []))


_HEADINGS = {
    "record": "Keys of the record",
    "on request": "Keys on request",
    "column": "Columns of lagtop table",
}


def _lists(rows: Sequence[Explained], view: int | None) -> Iterator[str]:
    """Yield the list of each kind: names, and beside them symbol, meaning, unit and equation."""
    for kind, heading in _HEADINGS.items():
        lines = [f"{heading}:"]
        for row in rows:
            if row.kind == kind:
                meaning = f"{row.meaning} [{row.unit}]" if row.unit else row.meaning
                text = ", ".join(filter(None, (row.symbol, meaning, row.equation)))
                lines.append(_filled(row.name, text, view, 28))
        yield "\n".join([*lines, ""])


def _block(row: Explained, view: int | None) -> str:
    """Return the lines of one key or column; each equation of a formula has a line of its own."""
    title = ", ".join(filter(None, (row.symbol, row.meaning, row.equation)))
    texts = {
        "formula": row.formula,
        "numbers": row.numbers,
        "value": "" if row.value is None else f"{value_text(row.value)} {row.unit}".rstrip(),
        "missing": row.missing,
    }
    lines = [f"{row.name}: {title}"]
    for name, text in texts.items():
        for i, part in enumerate(re.split(r" where |, (?=\w+ = )", text)):
            if part:
                lines.append(_filled(name if not i else "", part, view, 9))
    return "\n".join([*lines, ""])


def _filled(name: str, text: str, view: int | None, width: int) -> str:
    """Return a name and a text beside it, in lines that fit; names are `width` characters wide."""
    line, indent = f"  {name:{width}}{text}", " " * (width + 2)
    return fill(line, view or 80, subsequent_indent=indent, break_on_hyphens=False)


def _text(key: str, heading: str) -> Field:
    return Field(key, heading, is_text=True)


_NAME = Field("name", "name", is_text=True, names_the_row=True)
_LISTED = [
    _NAME,
    _text("symbol", "symbol"),
    _text("meaning", "meaning"),
    _text("unit", "unit"),
    _text("equation", "equation"),
    Field("kind"),
    Field("formula"),
]
_EXPLAINED = [
    *_LISTED[:4],
    Field("value", "value", value_text),
    _text("equation", "equation"),
    _text("formula", "formula"),
    _text("numbers", "with numbers"),
    _text("missing", "missing"),
    Field("kind"),
]


class _Scene(NamedTuple):
    name: str
    remark: str


@opt.command(
    "scenes",
    """
    lagtop scenes
    lagtop solve fast-gyroscope
    lagtop scenes --format json
    """,
)
def scenes_command(out: Output = opt.output(*_FORMATS)) -> None:
    """List the built-in scenes.

    Commands that solve a top accept these names as SCENE.  You can write your own scene: a TOML
    file with inputs by name, such as r0 = 40 or theta0 = "30 deg".
    """
    rows = [_Scene(name, scene_remark(name)) for name in scene_names()]
    fields = [_NAME, _text("remark", "remark")]
    out.report(lambda: Report({}, fields, rows, []))
