"""Numbers that others have printed, checked: a table of tests/README.md is made from here.

The exact values are those of `lagtop` in many digits; a test compares them with those of
`record_reference`, which shares no formula with it.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Sequence
from fractions import Fraction
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import mpmath
from conftest import ROOT
from lagtop import Motion, read_scene, solve
from ours import ManyDigits, Ours
from record_reference import State, reference_record, reference_state

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


def product(p: Sequence[Many], q: Sequence[Many]) -> tuple[Many, Many, Many, Many]:
    """Return the product of two quaternions."""
    (a, b, c, d), (w, x, y, z) = p, q
    return (
        a * w - b * x - c * y - d * z,
        a * x + b * w + c * z - d * y,
        a * y - b * z + c * w + d * x,
        a * z + b * y - c * x + d * w,
    )


def quaternion(now: State) -> tuple[Many, Many, Many, Many]:
    """Return the attitude in the frame of Bruels, Cardona and Arnold, 1 at the start.

    Their body axis y is the figure axis, and lies along y of space; so ours, at a tilt of 90
    degrees, is turned by 180 degrees about z of space and by -90 degrees about x of the body.
    """
    sin, cos = mpmath.sin(now.theta / 2), mpmath.cos(now.theta / 2)
    plus, minus = (now.psi + now.phi) / 2, (now.psi - now.phi) / 2
    ours = cos * mpmath.cos(plus), sin * mpmath.cos(minus), sin * mpmath.sin(minus)
    h = mpmath.sqrt(0.5)
    body = product((h, -h, 0, 0), (0, 0, 0, -1))
    return product((0, 0, 0, 1), product((*ours, cos * mpmath.sin(plus)), body))


def rotation(now: State) -> list[list[Many]]:
    """Return the rotation matrix, from body to space, in the frame of `quaternion`."""
    w, x, y, z = quaternion(now)
    return [
        [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
        [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
        [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
    ]


def omega_y(now: State) -> Many:
    """Return the angular velocity about y of space, in the frame of `quaternion`."""
    ours = now.thetadot * mpmath.sin(now.psi)
    ours -= now.phidot * mpmath.sin(now.theta) * mpmath.cos(now.psi)
    return -ours  # space is turned by 180 degrees about z


QUANTITIES: dict[str, Callable[[State], Many]] = {
    "theta": lambda now: now.theta,
    "phi": lambda now: now.phi,
    "psi": lambda now: now.psi,
    "omega_y": omega_y,
    **{f"q{i}": lambda now, i=i: quaternion(now)[i] for i in range(4)},  # type: ignore[misc]
    **{f"u{i}": lambda now, i=i: rotation(now)[i][1] - (i == 1) for i in range(3)},  # type: ignore[misc]
    "Rot x": lambda now: mpmath.atan2(-rotation(now)[1][2], rotation(now)[2][2]),
    "Rot y": lambda now: mpmath.asin(rotation(now)[0][2]),
    "Rot z": lambda now: mpmath.atan2(-rotation(now)[0][1], rotation(now)[0][0]),
}
"""Functions of the state: our angles, and what others print of the top of Bruels and others.

u is the displacement of the centre of mass, Rot are Tait-Bryan angles about x, y and z in turn.
"""


def _elementary(t: str) -> Printed:
    """Return the tilt of Whittaker's top by his formula, to 20 digits."""
    with mpmath.workdps(30):
        tilt = mpmath.asec(1 + mpmath.sech(mpmath.sqrt(3) * int(t)))
        text = mpmath.nstr(tilt, 20, strip_zeros=False)
    return Printed("Whittaker §71, sec ϑ = 1 + sech √3t", "whittaker-71", "theta", text, t)


with (Path(__file__).parent / "published.tsv").open(encoding="utf-8", newline="") as _file:
    PRINTED = [Printed(*row) for row in csv.reader(_file, "excel-tab")][1:]
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
            now = reference_state(motion(x.scene).top.as_dict(), Fraction(x.t))
        else:
            table = ProvedTable(motion(x.scene), State._fields, DIGITS, units=Units(radians=True))
            now = State(*(mpmath.mpf(found.value) for found in table.row(Fraction(x.t))))
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
