"""`lagtop eta`: Aksenov's coordinate eta."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import click

from ..arithmetic.points import ExactComplex, parse_complex
from ..errors import LagtopError
from ..output.layouts import ETA
from ..output.write import write_record
from .command import ExamplesFirst
from .options import MOST_TABLE_DIGITS, NUMBER, Parsed, digits_option, exclude, output_options
from .row_options import RANGE, listed, write_functions

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.eta import Quadrature


def _parse_distance(text: str) -> ExactComplex:
    """Return 0.7 or, imaginary, 0.7i."""
    value = parse_complex(text)
    if value.real and value.imag:
        raise LagtopError(f"must be real, or imaginary as 0.7i, got {value}")
    return value


DISTANCE = Parsed("number", _parse_distance)


@click.command(
    "eta",
    cls=ExamplesFirst,
    examples="""
        lagtop eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4
        lagtop eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4 --tau-range 0:10:101 --format csv
        lagtop eta --delta 0.7 --delta-star 0.2 --gap-above 1e-12 --gap-below 2 --digits 30
        lagtop eta --delta 0.5 --delta-star -0.5 --p 3 --q 1 --tau 0.1 --tau 0.2 --chain
        lagtop eta --delta 0.5 --delta-star -0.5 --p 0.1 --q 0.7i
        lagtop eta --delta 0.866 --delta-star 0.277 --gap-above 0.424 --g 319
    """,
)
@click.option("--delta", type=NUMBER, required=True, help="Upper end of the band.")
@click.option("--delta-star", type=NUMBER, required=True, help="Lower end of the band.")
@click.option("--p", type=NUMBER, help="Middle of the two outer roots p - q and p + q.")
@click.option("--q", type=DISTANCE, help="Half their distance; 0.7i for the roots p +- 0.7i.")
@click.option("--gap-above", type=NUMBER, help="From delta up to an outer root, instead.")
@click.option("--gap-below", type=NUMBER, help="From delta* down to an outer root, instead.")
@click.option("--quadratic", is_flag=True, help="Both outer roots are at infinity, instead.")
@click.option(
    "--g",
    type=NUMBER,
    default="1",
    show_default=True,
    help="Leading coefficient, -2 alpha1 c^2.",
)
@click.option(
    "--c3", type=NUMBER, default="0", show_default=True, help="eta = delta* at tau = -c3."
)
@click.option("--tau", "single", type=NUMBER, multiple=True, help="Time; may be repeated.")
@click.option("--tau-range", "grid", type=RANGE, help="Times, as [log:]start:stop:count.")
@click.option("--rate", is_flag=True, help="d eta/d tau of every tau too.")
@click.option("--chain", is_flag=True, help="h1, theta and xi' of every tau too.")
@click.option("--rad", is_flag=True, help="theta in radians.")
@digits_option(MOST_TABLE_DIGITS)
@output_options("table", "csv", "json")
def command(
    delta: Fraction,
    delta_star: Fraction,
    p: Fraction | None,
    q: ExactComplex | None,
    gap_above: Fraction | None,
    gap_below: Fraction | None,
    quadratic: bool,
    g: Fraction,
    c3: Fraction,
    single: tuple[Fraction, ...],
    grid: Points | None,
    rate: bool,
    chain: bool,
    rad: bool,
    digits: int | None,
    fmt: str,
    output: str,
) -> None:
    """The oscillation of eta between delta* and delta, from its quadrature (Aksenov, 3.2).

    (d eta/d tau)^2 = g (delta - eta) (eta - delta*) (q^2 - (eta - p)^2), the motion of a satellite
    in latitude.

    Without --tau the constants are written; with it eta, under --rate also its rate, and under
    --chain also h1, theta and xi' of (3.2.9) to (3.2.11).  The outer roots are given by --p and --q
    (imaginary, as 0.7i, for a complex pair), or by the gaps to them; with one gap alone the other
    outer root is at infinity, as for Lagrange's top, and under --quadratic both are.
    """
    from ..elliptic.eta_table import record

    times = listed("tau", single, grid)
    if quadratic:
        ways = {"--p": p, "--q": q, "--gap-above": gap_above, "--gap-below": gap_below}
        for name, value in ways.items():
            exclude({"--quadratic": quadratic, name: value})
        from ..elliptic.eta import Quadrature

        quadrature = Quadrature(delta_star, delta, (), g)
    else:
        quadrature = _quadrature(delta, delta_star, (p, q), (gap_above, gap_below), g)
    if times is None:
        for name, asked in {"--rate": rate, "--chain": chain}.items():
            if asked:
                raise LagtopError(f"{name} needs --tau or --tau-range")
        write_record(record(quadrature, digits, c3), fmt, output, lambda: ETA)
        return
    from ..elliptic.eta_table import EtaTable

    angle = ("rad" if rad else "deg") if chain else ""
    table = EtaTable(times, quadrature, c3, rate=rate, angle=angle)
    write_functions(table, digits, fmt, output)


def _quadrature(
    delta: Fraction,
    delta_star: Fraction,
    middle: tuple[Fraction | None, ExactComplex | None],
    gaps: tuple[Fraction | None, Fraction | None],
    g: Fraction,
) -> Quadrature:
    """Return the quadrature from either way to give the outer roots; it is checked when used."""
    from ..elliptic.eta import Quadrature

    p, q = middle
    above, below = gaps
    if (p is None) != (q is None) or (p is None) == (above is None and below is None):
        raise LagtopError(
            "give either --p and --q or one or both of --gap-above, --gap-below, or --quadratic"
        )
    if p is not None and q is not None:
        if q.real < 0 or q.imag < 0:
            raise LagtopError(f"--q must be >= 0, or imaginary as 0.7i, got {q}")
        if q.imag:
            return Quadrature(delta_star, delta, (p, p), g, q.imag)
        return Quadrature(delta_star, delta, (p - q.real, p + q.real), g)
    for name, gap in {"--gap-above": above, "--gap-below": below}.items():
        if gap is not None and gap <= 0:
            raise LagtopError(f"{name} must be > 0 (the period is infinite at 0), got {float(gap)}")
    outer = (delta_star - below if below else None, delta + above if above else None)
    return Quadrature(delta_star, delta, tuple(root for root in outer if root is not None), g)
