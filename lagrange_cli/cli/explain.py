"""`lagtop explain`, the meaning and the formula of every number, and `lagtop scenes`."""

from __future__ import annotations

from textwrap import fill
from typing import TYPE_CHECKING, NamedTuple

import click

from ..arithmetic.text import value_text
from ..inputs.scene_file import scene_names, scene_remark
from ..output.report import Field, Report
from ..output.terminal import spelt, view_of
from .app import Command
from .options import Parsed, output_options
from .top import UNCERTAIN, TopOptions, motion_of, scene_among, top_options

if TYPE_CHECKING:
    from ..motion.explanation import Explained
    from ..output.destination import Output

_FORMATS = ("table", "json", "csv", "ndjson", "markdown")


def _names() -> list[str]:
    from ..motion.explanation import explained_names

    return [*explained_names(), *scene_names()]


@click.command(
    "explain",
    cls=Command,
    examples="""
        lagtop explain
        lagtop explain T_nutation mean_precession_rate looping-top
        lagtop explain b psidot --r0 20 --format json
    """,
)
@click.argument("words", nargs=-1, type=Parsed("KEY", str, _names), metavar="[SCENE] [KEY]...")
@top_options(UNCERTAIN, scene=False)
@output_options(*_FORMATS)
def explain_command(words: tuple[str, ...], top: TopOptions, out: Output) -> None:
    """Explain keys and columns, with formulas and numbers.

    Each formula is shown in symbols and with the numbers of the top.  Without a key, all keys of
    the record, keys on request and columns are listed.  Pass keys to solve --get, sweep --keys,
    find and plot --key, and columns to table --columns.
    """
    from ..motion.explanation import explanations, listed

    scene, names = scene_among(words)
    found = top.replace(scene=scene).given()
    named = found.system.named if found.system else str
    if not names:
        out.report(lambda: Report({}, _LISTED, listed(radians=top.radians, named=named), []))
        return
    rows = explanations(motion_of(found), names, radians=top.radians, named=named)
    if out.fmt == "table":
        view = view_of(out.path)
        out.text(spelt("\n".join(_block(row, view.width or 80) for row in rows), view))
    else:
        out.report(lambda: Report({}, _EXPLAINED, rows, []))


def _block(row: Explained, width: int) -> str:
    """Return the lines of one key or column."""
    title = ", ".join(filter(None, (row.symbol, row.meaning, row.equation)))
    lines = {
        "formula": row.formula,
        "numbers": row.numbers if row.numbers != row.formula else "",
        "value": "" if row.value is None else f"{value_text(row.value)} {row.unit}".rstrip(),
        "missing": row.missing,
    }
    shown = [
        fill(f"  {name:9}{text}", width, subsequent_indent=" " * 11, break_on_hyphens=False)
        for name, text in lines.items()
        if text
    ]
    return "\n".join([f"{row.name}: {title}", *shown, ""])


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


@click.command(
    "scenes",
    cls=Command,
    examples="""
        lagtop scenes
        lagtop solve fast-gyroscope
        lagtop scenes --format json
    """,
)
@output_options(*_FORMATS)
def scenes_command(out: Output) -> None:
    """List the shipped scenes, whose names every command takes as a scene.

    A scene of your own is a TOML file with inputs by name, such as r0 = 40 or theta0 = "30 deg".
    """
    rows = [_Scene(name, scene_remark(name)) for name in scene_names()]
    fields = [_NAME, _text("remark", "remark")]
    out.report(lambda: Report({}, fields, rows, []))
