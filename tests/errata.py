"""Section 8 of the source, as printed, against the true values (the README's table)."""

from __future__ import annotations

from collections.abc import Callable
from decimal import Decimal
from types import SimpleNamespace
from typing import Any, NamedTuple

import mpmath
import oracle


class Printed(NamedTuple):
    """A number of section 8: its name, the text printed, and its true value from the oracle's."""

    name: str
    text: str
    formula: Callable[[Any], Any]


PRINTED = [
    Printed("a", "319.091", lambda c: c.a),
    Printed("1 - C/2A", "0.776363", lambda c: 1 - c.C / (2 * c.A)),
    Printed("u1", "0.8660254", lambda c: c.u1),
    Printed("b", "22.3637", lambda c: c.b),
    Printed("u3 + u2", "1.56737", lambda c: c.u3 + c.u2),
    Printed("u3 u2", "0.35738", lambda c: c.u3 * c.u2),
    Printed("(u3 + u2)^2", "2.45665", lambda c: (c.u3 + c.u2) ** 2),
    Printed("-4 u3 u2", "-1.42952", lambda c: -4 * c.u3 * c.u2),
    Printed("(u3 - u2)^2", "1.02713", lambda c: (c.u3 - c.u2) ** 2),
    Printed("u3 - u2", "1.01347", lambda c: c.u3 - c.u2),
    Printed("u3", "1.29042", lambda c: c.u3),
    Printed("u2", "0.27695", lambda c: c.u2),
    Printed("k^2", "0.581238", lambda c: c.k**2),
    Printed("arcsin k", "49d40m31s", lambda c: c.modular_angle_deg),
    Printed("arcsin k'", "40d19m29s", lambda c: 90 - c.modular_angle_deg),
    Printed("amplitude (7,2)", "41d41m50s", lambda c: c.amplitude_deg),
    Printed("K", "1.9299", lambda c: c.K),
    Printed("E", "1.3085", lambda c: c.E),
    Printed("alpha = F(amplitude, k')", "0.7544", lambda c: c.alpha),
    Printed(
        "E(amplitude, k')",
        "0.7028",
        lambda c: mpmath.ellipe(c.amplitude_deg * mpmath.pi / 180, c.k_prime**2),
    ),
    Printed("T", "0.42927", lambda c: c.T_nutation),
    Printed("u(T/4)", "0.63459", lambda c: c.u_quarter),
    Printed("mean spin rate", "46.13659", lambda c: c.mean_spin_rate),
    Printed("mean precession rate", "7.98957", lambda c: c.mean_precession_rate),
    Printed("spin rate at T/2", "46.04841", lambda c: c.spin_rate_half),
    Printed("precession rate at T/2", "14.2682", lambda c: c.precession_rate_half),
    Printed("T of the spin", "0.136186", lambda c: c.T_spin),
    Printed("T of the precession", "0.786423", lambda c: c.T_precession),
]


def errata_table() -> list[str]:
    """The table in Markdown: printed, true to as many digits, and to 15; bold where they differ."""
    lines = ["| quantity | printed | true | to 15 digits |", "|---|---|---|---|"]
    scene = oracle.Scene()
    constants = oracle.constants(scene)
    values = SimpleNamespace(**constants, A=mpmath.mpf(scene.A), C=mpmath.mpf(scene.C))
    for entry in PRINTED:
        with mpmath.workdps(40):
            true = entry.formula(values)
        shown = round_alike(true, entry.text)
        mark = "" if shown == entry.text else "**"
        digits = mpmath.nstr(true, 15)
        lines.append(f"| {entry.name} | {entry.text} | {mark}{shown}{mark} | {digits} |")
    return lines


def round_alike(true: Any, text: str) -> str:
    """The true value to as many places, or to whole seconds of arc, as the text has."""
    if "d" in text:
        seconds = int(mpmath.nint(true * 3600))
        return f"{seconds // 3600}d{seconds // 60 % 60:02d}m{seconds % 60:02d}s"
    places = Decimal(1).scaleb(-len(text.partition(".")[2]))
    return str(Decimal(mpmath.nstr(true, 30)).quantize(places))
