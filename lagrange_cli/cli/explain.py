"""`lagtop explain`, the meaning and the formula of every number, and `lagtop scenes`."""

from __future__ import annotations

import re
from types import SimpleNamespace
from typing import TYPE_CHECKING

from ..arithmetic.text import value_text
from ..output.document import Grid
from ..output.report import Field, Report
from ..top.scenes import scene_names, scene_remark
from . import shared as opt

if TYPE_CHECKING:
    from ..account.explanation import Explained
    from ..output.destination import Output


@opt.command(
    "explain",
    "explain",
    "explain T_nutation mean_precession_rate looping-top",
    "explain b psidot --r0 20 --format json",
)
@opt.top("[SCENE] [KEY]...")
@opt.output("table")
def explain_command(top: opt.TopOptions, words: list[str], out: Output) -> None:
    """Explain keys and columns, with formulas and numbers.

    A key is the name of a result.  Each formula is shown in symbols and with the numbers of the
    top.  Without KEY, all keys and columns are listed.  By default, solve prints the keys of the
    record.  Pass keys to solve --get, sweep --keys, find --keys and plot --key, and columns to
    table --columns.
    """
    from ..account.explanation import explanations, listed

    found = top.given()
    units = found.units(radians=top.radians)
    if not words:
        rows = listed(units)
        opt.write_report(out, lambda: Report({}, _LISTED, rows, []))
        return
    rows = explanations(opt.motion_of(found), words, units)
    document = Report({}, _EXPLAINED, rows, []).document()
    out.document(document._replace(page=lambda _: [_table(row) for row in rows]))


def _table(row: Explained) -> Grid | str:
    """Return the table of a key or column; each equation of a formula has a line of its own."""
    unit = "" if row.value is None or isinstance(row.value, str) else row.unit
    texts = {
        "formula": row.formula,
        "numbers": row.numbers,
        "value": f"{value_text(row.value)} {unit}".strip(),
        "missing": row.missing,
    }
    about = ", ".join(filter(None, (row.symbol, row.meaning, row.equation)))
    cells: list[list[str]] = []
    for name, text in texts.items():
        parts = filter(None, re.split(r" where |, (?=[^,()]+ = )", text))
        cells += [["" if i else name, part] for i, part in enumerate(parts)]
    return Grid([row.name, about], cells) if cells else f"{row.name}: {about}"


_LISTED = [
    *(Field(x, x, is_text=True) for x in ("name", "symbol", "meaning", "unit")),
    *(Field(x) for x in ("equation", "kind", "formula")),
]
_EXPLAINED = [
    *_LISTED[:4],
    *(Field(x) for x in ("value", "equation", "formula", "numbers", "missing", "kind")),
]


@opt.command("scenes", "scenes", "solve fast-gyroscope", "scenes --format json")
@opt.output("table")
def scenes_command(out: Output) -> None:
    """List the built-in scenes.

    Commands that solve a top accept these names as SCENE.  You can write your own scene: a TOML
    file with inputs by name, such as r0 = 40 or theta0 = "30 deg".
    """
    rows = [SimpleNamespace(name=x, remark=scene_remark(x)) for x in scene_names()]
    fields = [Field(x, x, is_text=True) for x in ("name", "remark")]
    opt.write_report(out, lambda: Report({}, fields, rows, []))
