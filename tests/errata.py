"""Errata of the sources: errata one by one, and the figures of Chrapan's section 8.

A table of tests/README.md is made from here.  The registers of equations check the errata: each
of them must be listed, and each that is listed by an equation must fail as printed.
"""

from __future__ import annotations

import csv
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

import mpmath
from lagtop import Top
from record_reference import reference_record


def table(name: str) -> list[dict[str, str]]:
    """Return the rows of a table in this folder."""
    with (Path(__file__).parent / f"{name}.tsv").open(encoding="utf-8", newline="") as file:
        return list(csv.DictReader(file, dialect="excel-tab"))


def misprints(source: str, *sections: int) -> set[str]:
    """Return the places of the errata in some sections that a register must compute.

    They are the equations as the registers call them, with " as printed, ..." if several.
    """
    found = (x for x in table("errata") if x["source"] == source and x["tested"] == "yes")
    return {x["place"] for x in found if int(x["section"]) in sections}


class Figure(NamedTuple):
    """A number of section 8: a row of `figures.tsv`.

    `text` is printed, and `key` is its name in the program.  `own` is empty if the figure is right,
    or says whether it follows from the other printed figures.
    """

    name: str
    text: str
    key: str
    own: str


FIGURES = [Figure(*row.values()) for row in table("figures")]
"""All numbers printed in section 8 that are computed there."""


def true_values() -> dict[str, Any]:
    """Return the figures by key, by the reference."""
    exact = reference_record(Top().as_dict())
    return {x.key: exact[x.key] for x in FIGURES if exact[x.key] is not None}


def figures_table() -> list[str]:
    """Return the wrong figures of section 8 as a table in Markdown; all others must be right."""
    lines = ["| quantity | printed | true | to 15 digits | from the printed figures |"]
    lines.append("|---|---|---|---|---|")
    values = true_values()
    with mpmath.workdps(40):
        for figure in FIGURES:
            true = values[figure.key]
            shown = round_alike(true, figure.text)
            assert (shown == figure.text) == (not figure.own), figure.name
            if figure.own:
                cells = figure.name, figure.text, shown, mpmath.nstr(true, 15), figure.own
                lines.append(f"| {' | '.join(cells)} |")
    return lines


def round_alike(value: Any, text: str) -> str:
    """Return a value to as many places, or to whole seconds of arc, as the text has."""
    if "d" in text:
        seconds = int(mpmath.nint(value * 3600))
        return f"{seconds // 3600}d{seconds // 60 % 60:02d}m{seconds % 60:02d}s"
    places = Decimal(1).scaleb(-len(text.partition(".")[2]))
    return str(Decimal(mpmath.nstr(value, 30)).quantize(places))
