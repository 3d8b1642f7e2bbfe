"""Numbers that others have printed, checked: a table of tests/README.md is made from here.

The exact values are those of `lagtop` in many digits; a test compares them with those of
`record_reference`, which shares only Viete's cosines for the roots with it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from fractions import Fraction
from functools import cache
from operator import itemgetter
from typing import Any, NamedTuple

import mpmath
from conftest import ROOT
from errata import table
from lagtop import Motion, read_scene, solve
from ours import ManyDigits, Ours
from record_reference import reference_columns, reference_record

from lagrange_cli.solver.tables import ProvedTable
from lagrange_cli.top.units import Units

Many = Any
"""An mpf with many digits."""

DIGITS, SHOWN = 60, 18
ELLIPJ, _K = "k = 0.99999999997", "0.99999999997"


class Printed(NamedTuple):
    """A number that somebody has printed."""

    source: str
    scene: str
    quantity: str
    """A key of the record, or one of QUANTITIES."""
    text: str
    t: str = ""


Columns = Mapping[str, Many]
QUANTITIES: dict[str, Callable[[Columns], Many]] = {
    **{x: itemgetter(x) for x in ("theta", "phi", "psi")},
    "omega_y": lambda of: -of["omega_space_y"],
    "q0": lambda of: (of["quaternion_w"] + of["quaternion_x"]) / mpmath.sqrt(2),
    "q1": lambda of: (of["quaternion_w"] - of["quaternion_x"]) / mpmath.sqrt(2),
    "q2": lambda of: (of["quaternion_z"] - of["quaternion_y"]) / mpmath.sqrt(2),
    "q3": lambda of: (of["quaternion_z"] + of["quaternion_y"]) / mpmath.sqrt(2),
    "u0": lambda of: -of["axis_x"],
    "u1": lambda of: -of["axis_y"] - 1,
    "u2": lambda of: of["axis_z"],
    "Rot x": lambda of: mpmath.atan2(of["matrix_yy"], of["matrix_zy"]),
    "Rot y": lambda of: mpmath.asin(-of["matrix_xy"]),
    "Rot z": lambda of: mpmath.atan2(of["matrix_xz"], of["matrix_xx"]),
}
"""Our angles, and what others print of the top of Bruels, Cardona and Arnold, by our columns.

Their body axis y is the figure axis, and lies along y of space; so our body, at a tilt of 90
degrees, is turned by 180 degrees about z of space and by -90 degrees about x of the body.  u is the
displacement of the centre of mass, Rot are Tait-Bryan angles about x, y and z in turn.
"""
COLUMNS = ["theta", "phi", "psi", "quaternion", "axis", "matrix", "omega_space_y"]


def _elementary(t: str) -> Printed:
    """Return the tilt of Whittaker's top by his formula, to 20 digits."""
    with mpmath.workdps(30):
        tilt = mpmath.asec(1 + mpmath.sech(mpmath.sqrt(3) * int(t)))
        text = mpmath.nstr(tilt, 20, strip_zeros=False)
    return Printed("Whittaker §71, sec ϑ = 1 + sech √3t", "whittaker-71", "theta", text, t)


PRINTED = [Printed(*row.values()) for row in table("published")]
PRINTED[-1:-1] = [_elementary(t) for t in ("1", "5", "-2")]
"""All numbers, as their sources have them."""


@cache
def motion(scene: str) -> Motion:
    """Return the motion of a scene file, its numbers read as decimals."""
    return solve(read_scene(str(ROOT / "sample_inputs" / f"{scene}.toml"), exact=True))


def exact(x: Printed, *, by_reference: bool = False) -> Many:
    """Return the exact value of a printed number, by lagtop or by the reference.

    The reference of cn is mpmath.
    """
    with mpmath.workdps(DIGITS):
        if x.scene == ELLIPJ and by_reference:
            return mpmath.ellipfun("cn", 50, k=mpmath.mpf(_K))
        if x.scene == ELLIPJ:
            ar = ManyDigits(DIGITS)
            return mpmath.mpf(ar.nstr(Ours(ar).jacobi(50, ar.mpf(_K))[2], DIGITS))
        if not x.t:
            key = x.quantity
            record = motion(x.scene).record(digits=DIGITS, keys=[key])
            inputs = motion(x.scene).top.as_dict()
            return reference_record(inputs)[key] if by_reference else mpmath.mpf(record[key])
        if by_reference:
            now = reference_columns(motion(x.scene).top.as_dict(), Fraction(x.t))
        else:
            proved = ProvedTable(motion(x.scene), COLUMNS, DIGITS, units=Units(radians=True))
            row = (mpmath.mpf(found.value) for found in proved.row(Fraction(x.t)))
            now = dict(zip(proved.chosen, row, strict=True))
        value = QUANTITIES[x.quantity](now)
        if x.quantity.startswith("Rot"):  # angles of a rotation have the whole turns of the print
            value += 2 * mpmath.pi * mpmath.nint((mpmath.mpf(x.text) - value) / 2 / mpmath.pi)
        return value


def error(x: Printed) -> tuple[Many, bool]:
    """Return what the print has too much, and whether it is right to its last digit."""
    with mpmath.workdps(DIGITS):
        off = mpmath.mpf(x.text) - exact(x)
        unit = mpmath.mpf(10) ** -len(x.text.partition(".")[2])
        return off, abs(off) <= unit / 2


def published_table() -> list[str]:
    """Return printed numbers as a table in Markdown, the worst one of each program and time."""
    lines = ["| source | scene | quantity | printed | exact | error of the print |"]
    lines.append("|---|---|---|---|---|---|")
    worst: dict[tuple[str, str], Printed] = {}
    for x in PRINTED:
        of = x.source.partition(",")[0] + x.scene, x.t
        worst[of] = max(worst.get(of, x), x, key=lambda one: abs(error(one)[0]))
    for x in worst.values():
        off, right = error(x)
        shown = "none to its last digit" if right else f"{float(off):.1e}"
        what = f"{x.quantity}({x.t})" if x.t else f"`{x.quantity}`"
        value = mpmath.nstr(exact(x), SHOWN, strip_zeros=False, min_fixed=-9, max_fixed=9)
        lines.append(f"| {x.source} | {x.scene} | {what} | {x.text} | {value} | {shown} |")
    return lines
