"""`lagtop eta`: Aksenov's coordinate eta."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

from ..arithmetic.points import ExactComplex, parse_complex
from ..errors import LagtopError
from ..inputs.names import check_names
from . import shared as opt
from .jacobi import RANGE, function_formats, write_constants, write_functions

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.eta import Quadrature
    from ..output.destination import Output

_ETA = """
delta | δ | upper end of the band | | (3.2.1)
delta_star | δ* | lower end of the band | | (3.2.1)
p | p' | middle of the outer roots | | (3.2.1)
q | q' | half the distance of the outer roots | | (3.2.1)
q_imag | q'/i | the same for a complex pair | | (3.2.1)
outer_root | | the finite outer root | |
layout | | outer roots | |
kind | | radicand | |
g | g | -2 α1 c² | 1/time² | (3.2.1)
Constants
m_prime | m' | at δ | | (3.2.3)
m_double_prime | m" | at δ* | | (3.2.3)
k | k | modulus of (3.2.4) | | (3.2.5)
k_imag | k/i | imaginary modulus of (3.2.4) | | (3.2.5)
k1 | k1 | modulus | | (3.2.8)
k1_imag | k1/i | imaginary modulus | | (3.2.8)
k1_prime | k1' | complementary modulus | |
K1 | K1 | first kind, k1 | | (3.2.8)
sigma1 | σ1 | rate of the argument | 1/time | (3.2.8)
s | s | amplitude of sn | | (3.2.12)
d | d | of the denominator | | (3.2.12)
gamma | γ | shift | | (3.2.12)
period | T | of η, 4 K1/σ1 | time | (3.2.10)
tau3 | τ3 | -K1/σ1 | time | (3.2.10)
"""


def _parse_distance(text: str) -> ExactComplex:
    """Return 0.7 or, imaginary, 0.7i."""
    value = parse_complex(text)
    if value.real and value.imag:
        raise LagtopError(f"must be real, or imaginary as 0.7i, got {value}")
    return value


@opt.command(
    "eta",
    "eta --delta 0.6 --delta-star -0.5 --p 0.1 --q 1.4",
    "eta --delta 0.5 --delta-star -0.5 --p 3 --q 1 --tau 0:9:99 -o e.csv",
    "eta --delta 0.866 --delta-star 0.277 --gap-above 0.424 --g 319",
)
@opt.option("--delta", type=opt.NUMBER, required=True, help="Upper end of the band.")
@opt.option("--delta-star", type=opt.NUMBER, required=True, help="Lower end of the band.")
@opt.option("--p", type=opt.NUMBER, help="Middle of the two outer roots p - q and p + q.")
@opt.option(
    "--q",
    type=opt.Parsed("X", _parse_distance),
    help="Half the distance between the outer roots; 0.7i for the roots p +- 0.7i.",
)
@opt.option("--gap-above", type=opt.NUMBER, help="Distance from delta up to an outer root.")
@opt.option("--gap-below", type=opt.NUMBER, help="Distance from delta* down to an outer root.")
@opt.option("--g", type=opt.NUMBER, default="1", help="Leading coefficient.")
@opt.option("--tau", type=RANGE, help="Times: a list 0,1,2 or a range [log:]start:stop:count.")
@opt.option("--columns", type=opt.LIST, help="eta, etadot, h1, theta, xi_prime.  [default: eta]")
@opt.rad
@opt.digits(opt.MOST_TABLE_DIGITS)
@function_formats
def eta_command(
    delta: Fraction,
    delta_star: Fraction,
    p: Fraction | None,
    q: ExactComplex | None,
    gap_above: Fraction | None,
    gap_below: Fraction | None,
    g: Fraction,
    tau: Points | None,
    columns: list[str] | None,
    rad: bool,
    digits: int | None,
    out: Output,
) -> None:
    """Compute Aksenov's coordinate eta of a satellite (1977, 3.2).

    Eta oscillates between delta* and delta:
    (d eta/d tau)^2 = g (delta - eta) (eta - delta*) (q^2 - (eta - p)^2).

    Give the outer roots of the right-hand side with --p and --q (0.7i for a complex pair), or by
    their gaps from delta and delta*.  If you give one gap, the other root is at infinity, as for
    Lagrange's top.  If you give no outer root, both are at infinity.

    Without --tau, the constants are printed.  At tau = 0, eta is delta*.  h1, theta and xi' are
    defined in (3.2.9) to (3.2.11).
    """
    from ..elliptic.eta import eta_record

    opt.exclude(p=p, gap_above=gap_above)
    opt.exclude(p=p, gap_below=gap_below)
    quadrature = _quadrature(delta, delta_star, (p, q), (gap_above, gap_below), g)
    if tau is None:
        if columns is not None:
            raise LagtopError("--columns needs --tau")
        write_constants(eta_record(quadrature, digits), "Roots", _ETA, out)
        return
    from ..elliptic.eta import ETA_COLUMNS, EtaTable

    names = check_names("columns", columns or ["eta"], ETA_COLUMNS)
    write_functions(
        EtaTable(tau, quadrature, names=names, angle="rad" if rad else "deg"), digits, out
    )


def _quadrature(
    delta: Fraction,
    delta_star: Fraction,
    middle: tuple[Fraction | None, ExactComplex | None],
    gaps: tuple[Fraction | None, Fraction | None],
    g: Fraction,
) -> Quadrature:
    """Return the quadrature with its outer roots, by their middle or by the gaps to them."""
    from ..elliptic.eta import Quadrature

    (p, q), (above, below) = middle, gaps
    if (p is None) != (q is None):
        raise LagtopError("--p and --q belong together: give both, or neither")
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
