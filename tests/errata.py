"""Errata of the sources: errata one by one, and the figures of Chrapan's section 8.

The tables of tests/README.md are made from here.  The registers of equations check the errata: each
of them must be listed, and each that is listed by an equation must fail as printed.
"""

from __future__ import annotations

import csv
from collections.abc import Callable
from decimal import Decimal
from pathlib import Path
from typing import Any, NamedTuple

import mpmath
from ball_reference import BallReference
from balls.scene import many_digits
from lagtop import Top


class Erratum(NamedTuple):
    """An erratum in the text at hand: a row of `errata.tsv`.

    `place` is the equation as the registers call it, with " as printed, ..." where it has several
    errata; `tested` says whether a register computes it.
    """

    source: str
    section: str
    place: str
    kind: str
    tested: str
    right: str


with (Path(__file__).parent / "errata.tsv").open(encoding="utf-8", newline="") as _file:
    ERRATA = [Erratum(*row) for row in csv.reader(_file, "excel-tab")][1:]
"""All errata, in the order of the sources."""


def misprints(source: str, *sections: int) -> set[str]:
    """Return the places of the errata in some sections that a register must compute."""
    some = [x for x in ERRATA if x.source == source and int(x.section) in sections]
    return {x.place for x in some if x.tested == "yes"}


def errata_table() -> list[str]:
    """Return the errata as a table in Markdown."""
    lines = ["| place | right | kind |", "|---|---|---|"]
    for erratum in ERRATA:
        place = (
            erratum.place if erratum.source == "Chrapan" else f"{erratum.source}, {erratum.place}"
        )
        right = erratum.right.replace("|", "\\|")
        lines.append(f"| {place.replace(' as printed', '')} | {right} | {erratum.kind} |")
    return lines


class Figure(NamedTuple):
    """A number of section 8.

    `text` is printed, `key` is its name in the program, and `own` computes it from other printed
    figures, which it may read from its argument by name; without `own` it stands alone.
    """

    name: str
    text: str
    key: str
    own: Callable[[dict[str, Any]], Any] | None = None


def mean_precession(p: dict[str, Any]) -> Any:
    """Return (7,3) from the printed figures."""
    K, E, F = p["K"], p["E"], p["alpha = F(amplitude, k')"]
    curve = K * p["E(amplitude, k')"] - (K - E) * F - mpmath.pi / 4
    return p["precession rate at T/2"] / 2 * (2 - p["u3 - u2"]) + 4 / p["T"] * curve


OWN: dict[str, Callable[[dict[str, Any]], Any]] = {
    "(u3 + u2)^2": lambda p: p["u3 + u2"] ** 2,
    "-4 u3 u2": lambda p: -4 * p["u3 u2"],
    "(u3 - u2)^2": lambda p: p["(u3 + u2)^2"] + p["-4 u3 u2"],
    "k^2": lambda p: (p["u1"] - p["u2"]) / p["u3 - u2"],
    "arcsin k": lambda p: mpmath.degrees(mpmath.asin(mpmath.sqrt(p["k^2"]))),
    "arcsin k'": lambda p: 90 - p["arcsin k"],
    "K": lambda p: interpolated(mpmath.ellipk, p["arcsin k"]),
    "alpha = F(amplitude, k')": lambda p: mpmath.ellipf(
        mpmath.radians(p["amplitude (7,2)"]), 1 - p["k^2"]
    ),
    "T": lambda p: 4 * p["K"] / mpmath.sqrt(p["a"] * p["u3 - u2"]),
    "mean spin rate": lambda p: 50 * p["1 - C/2A"] + mpmath.pi / p["T"],
    "mean precession rate": mean_precession,
    "spin rate at T/2": lambda p: 50 - p["precession rate at T/2"] * p["u2"],
    "precession rate at T/2": lambda p: p["a"] / p["b"],
    "T of the precession": lambda p: 2 * mpmath.pi / p["mean precession rate"],
}
"""Figures from other printed ones."""

FIGURES = [
    Figure(name, text, key, OWN.get(name))
    for name, text, key in (
        ("a", "319.091", "a"),
        ("1 - C/2A", "0.776363", "spin_share"),
        ("u1", "0.8660254", "u1"),
        ("b", "22.3637", "b"),
        ("u3 + u2", "1.56737", "roots_sum"),
        ("u3 u2", "0.35738", "roots_product"),
        ("(u3 + u2)^2", "2.45665", "roots_sum_squared"),
        ("-4 u3 u2", "-1.42952", "roots_product_fourfold"),
        ("(u3 - u2)^2", "1.02713", "roots_gap_squared"),
        ("u3 - u2", "1.01347", "roots_gap"),
        ("2 u3", "2.58084", "u3_twice"),
        ("2 u2", "0.55390", "u2_twice"),
        ("u3", "1.29042", "u3"),
        ("u2", "0.27695", "u2"),
        ("k^2", "0.581238", "k_squared"),
        ("arcsin k", "49d40m31s", "modular_angle_deg"),
        ("arcsin k'", "40d19m29s", "comodular_angle_deg"),
        ("amplitude (7,2)", "41d41m50s", "amplitude_deg"),
        ("K", "1.9299", "K"),
        ("E", "1.3085", "E"),
        ("alpha = F(amplitude, k')", "0.7544", "alpha"),
        ("E(amplitude, k')", "0.7028", "E_amplitude"),
        ("T", "0.42927", "T_nutation"),
        ("u(T/4)", "0.63459", "u_quarter"),
        ("mean spin rate", "46.13659", "mean_spin_rate"),
        ("mean precession rate", "7.98957", "mean_precession_rate"),
        ("spin rate at T/2", "46.04841", "spin_rate_half"),
        ("precession rate at T/2", "14.2682", "precession_rate_half"),
        ("T of the spin", "0.136186", "T_spin"),
        ("T of the precession", "0.786423", "T_precession"),
    )
]
"""All numbers printed in section 8 that are computed there."""


def interpolated(integral: Callable[[Any], Any], degrees: Any) -> Any:
    """Return a complete integral between whole degrees of a table with four decimals."""
    below = mpmath.floor(degrees)
    ends = [
        mpmath.nint(integral(mpmath.sin(mpmath.radians(below + i)) ** 2) * 10**4) / 10**4
        for i in (0, 1)
    ]
    return ends[0] + (degrees - below) * (ends[1] - ends[0])


def true_values() -> dict[str, Any]:
    """Return the figures by key, by the reference."""
    balls = BallReference(Top().as_dict())
    found = ((x.key, balls.exact(x.key)) for x in FIGURES)
    return {key: many_digits(ball) for key, ball in found if ball is not None}


def carried_on(figure: Figure, true: Any) -> str:
    """Return "" for a figure that is right, else whether it follows from the printed ones.

    It does if it is at most one unit of its last place from what they give.
    """
    if round_alike(true, figure.text) == figure.text:
        return ""
    assert figure.own is not None, f"{figure.name} is wrong and stands alone"
    own = figure.own({x.name: number(x.text) for x in FIGURES})
    units = abs(number(round_alike(own, figure.text)) - number(figure.text)) / last_place(figure)
    shown = round_alike(own, figure.text)
    return f"carried on: {shown}" if units < 1.5 else f"mistake: {shown}"


def figures_table() -> list[str]:
    """Return section 8 as a table in Markdown; what is wrong is bold."""
    lines = [
        "| quantity | printed | true | to 15 digits | from the printed figures |",
        "|---|---|---|---|---|",
    ]
    values = true_values()
    with mpmath.workdps(40):
        for figure in FIGURES:
            true = values[figure.key]
            verdict = carried_on(figure, true)
            mark = "**" if verdict else ""
            shown = f"{mark}{round_alike(true, figure.text)}{mark}"
            digits = mpmath.nstr(true, 15)
            lines.append(f"| {figure.name} | {figure.text} | {shown} | {digits} | {verdict} |")
    return lines


def number(text: str) -> Any:
    """Return a printed figure as a number, angles in degrees."""
    if "d" not in text:
        return mpmath.mpf(text)
    degrees, minutes, seconds = text.replace("d", " ").replace("m", " ").rstrip("s").split()
    return int(degrees) + mpmath.mpf(int(minutes) * 60 + int(seconds)) / 3600


def last_place(figure: Figure) -> Any:
    """Return the unit of the last printed place."""
    if "d" in figure.text:
        return mpmath.mpf(1) / 3600
    return mpmath.mpf(10) ** -len(figure.text.partition(".")[2])


def round_alike(value: Any, text: str) -> str:
    """Return a value to as many places, or to whole seconds of arc, as the text has."""
    if "d" in text:
        seconds = int(mpmath.nint(value * 3600))
        return f"{seconds // 3600}d{seconds // 60 % 60:02d}m{seconds % 60:02d}s"
    places = Decimal(1).scaleb(-len(text.partition(".")[2]))
    return str(Decimal(mpmath.nstr(value, 30)).quantize(places))
