"""Special functions: `lagtop jacobi`, elliptic and theta functions, and `lagtop eta`."""

from __future__ import annotations

import re
from fractions import Fraction

from ..arithmetic.key import Key
from ..arithmetic.text import quoted
from ..elliptic.eta import ETA_COLUMNS, EtaTable, Quadrature, eta_record
from ..elliptic.function_table import ComplexPoints, FunctionRequest, FunctionTable
from ..elliptic.incomplete import AmplitudeTable
from ..elliptic.modulus import ModulusInput, constants_record
from ..elliptic.nome_series import SeriesTable
from ..elliptic.tables import TableOfFunctions
from ..errors import LagtopError
from ..names import check_names
from ..output.destination import Output
from ..output.terminal import with_progress
from ..top.ranges import ExactComplex, ListedPoints, Points, looks_complex, parse_complex
from ..top.values import listed_multiples, parse_multiple, parse_multiples, parse_values
from . import shared as opt

MOST_TERMS = 10_000
_FAMILIES = ("am", "theta", "zeta", "omega", "pi")
_JACOBI = """
k | k | modulus | |
k_prime | k' | complementary modulus | |
modular_angle_deg | arcsin k | modular angle | deg |
modular_angle_rad | arcsin k | modular angle | rad |
nome | q | nome | | (3.1.6)
nome_prime | q' | nome of k' | | (3.1.6)
Complete integrals
K | K | first kind, k | | (3.1.2)
K_prime | K' | first kind, k' | | (3.1.2)
E | E | second kind, k | |
E_prime | E' | second kind, k' | |
"""
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


def constant_keys(group: str, table: str) -> dict[str, Key]:
    """Return the keys of a table, a line each; a line without columns begins another group.

    Complex numbers also have the keys of their parts.
    """
    keys = {}
    for line in table.strip().split("\n"):
        if "|" not in line:
            group = line
            continue
        name, symbol, *others = re.split(r"\s*\|\s*", line)
        keys[name] = Key(group, symbol, *others)
        for part, sign in (("re", "Re"), ("im", "Im")):
            keys[f"{name}_{part}"] = Key(group, f"{sign} {symbol}", *others)
    return keys


def _parse_arguments(text: str) -> tuple[ComplexPoints, bool]:
    """Return the arguments of a range or a list, and whether they are factors of K."""
    parts = text.split(",")
    if ":" not in text and any(map(looks_complex, parts)):
        if "K" in text:
            raise LagtopError(f"must not contain K if numbers are complex, got {quoted(text)}")
        real, imag = zip(*map(parse_complex, parts), strict=True)
        return ComplexPoints(ListedPoints([*real]), ListedPoints([*imag])), False
    multiples = (
        parse_multiples(text) if ":" in text else listed_multiples([*map(parse_multiple, parts)])
    )
    return ComplexPoints(multiples.factor), multiples.in_quarters


def _parse_parameter(text: str) -> tuple[ExactComplex, bool]:
    """Return a complex number, and whether it is imaginary."""
    value = parse_complex(text)
    return value, not value.real and text.strip().endswith("i")


RANGE = opt.Parsed("X", parse_values)
function_formats = opt.output("table", "csv", "json", "ndjson", "parquet")


def write_functions(table: TableOfFunctions | SeriesTable, digits: int | None, out: Output) -> None:
    """Write a table of functions, with its progress."""
    header, blocks = table.rows(digits)
    out.table(header, with_progress(blocks, "rows", table.count or None, len))


@opt.command(
    "jacobi",
    "jacobi --k 0.8",
    "jacobi --k 0.8 --u 0:4K:101 -o sn.csv",
    "jacobi --k 0.8 --u 0.3,1 --functions theta,pi --param 0.7i",
)
@opt.option("--k", type=opt.Parsed("X", parse_complex), help="Modulus: real, or imaginary as 0.8i.")
@opt.option("--k-prime", type=opt.NUMBER, help="Complementary modulus k', for k close to 1.")
@opt.option("--nome", type=opt.NUMBER, help="Nome q = exp(-pi K'/K), below 1.")
@opt.option(
    "--u",
    type=opt.Parsed("X", _parse_arguments),
    help="Arguments: a list such as 0.5,0.3+0.7i, a range [log:]start:stop:count, or multiples of "
    "K such as K/2,-2.5K.",
)
@opt.option(
    "--functions",
    type=opt.LIST,
    help="Functions of u: am (with sn, cn, dn), theta, zeta (logarithmic derivatives of theta), "
    "omega, pi (of u and --param, after Chrapan).  [default: am]",
)
@opt.option("--param", type=opt.Parsed("V", _parse_parameter), help="Of omega and pi, as 0.2+0.7i.")
@opt.option("--phi", type=RANGE, help="Amplitudes: print F(phi, k) and E(phi, k) instead.")
@opt.option("--series", type=opt.count(MOST_TERMS), help="Print N partial sums of the nome series.")
@opt.rad
@opt.digits(opt.MOST_TABLE_DIGITS)
@function_formats
def jacobi_command(
    k: ExactComplex | None,
    k_prime: Fraction | None,
    nome: Fraction | None,
    u: tuple[ComplexPoints, bool] | None,
    functions: list[str] | None,
    param: tuple[ExactComplex, bool] | None,
    phi: Points | None,
    series: int | None,
    rad: bool,
    digits: int | None,
    out: Output,
) -> None:
    """Compute elliptic integrals, elliptic and theta functions.

    Without --u and --phi, the constants of the modulus are printed.

    Every value is correctly rounded, or has N correct digits with --digits N.  u and a real --param
    may be up to 2^50 periods, an imaginary --param up to K'.  An empty cell is a pole, or am beyond
    its branch points.

    The modulus is read as an exact decimal, u and --param as doubles unless --digits is given.
    Complex results have columns that end in _re and _im.
    """
    opt.exclude(phi=phi, u=u)
    opt.exclude(phi=phi, series=series, functions=functions)
    opt.exclude(series=series, digits=digits)
    given = {"k": k and k.real, "k_prime": k_prime, "nome": nome}
    chosen = [(name, value) for name, value in given.items() if value is not None]
    if len(chosen) != 1:
        raise LagtopError("give exactly one of --k, --k-prime, --nome")
    named = check_names("functions", functions or ["am"], _FAMILIES)
    asked = tuple(name for name in _FAMILIES if name in named)
    parameter, imaginary = _parameter(param, asked)
    points, in_quarters = u or (None, False)
    beyond = k is not None and (k.imag != 0 or not 0 <= k.real <= 1)
    has_complex = points is not None and points.imag is not None
    real = not (beyond or has_complex or (parameter.real and parameter.imag))
    if not real and (phi or series):
        raise LagtopError("--phi and --series need a real --u, and a --k in [0, 1]")
    if not real and in_quarters:
        raise LagtopError("--u must not contain K if numbers are complex or --k is not in [0, 1]")
    modulus = ModulusInput(*chosen[0], radians=rad)
    any_modulus = k if k is not None and beyond else modulus
    if phi is not None:
        write_functions(AmplitudeTable(phi, modulus), digits, out)
    elif series is not None:
        if points is not None and points.real.count != 1:
            raise LagtopError(f"--series takes one --u, got {points.real.count}")
        at = None if points is None else next(points.real.decimals())
        write_functions(SeriesTable(modulus, at, series, in_quarters=in_quarters), None, out)
    elif points is not None:
        v = parameter.nearest() if digits is None else parameter
        request = FunctionRequest(any_modulus, asked, v, imaginary, rad, in_quarters, real)
        write_functions(FunctionTable(points, request), digits, out)
    elif functions is not None:
        raise LagtopError("--functions needs --u")
    else:
        keys = constant_keys("Moduli", _JACOBI)
        out.record(constants_record(any_modulus, digits), lambda: keys)


def _parameter(
    param: tuple[ExactComplex, bool] | None, families: tuple[str, ...]
) -> tuple[ExactComplex, bool]:
    """Return the value of --param, 0 if it is not needed, and whether it is imaginary."""
    if not {"omega", "pi"} & set(families):
        if param is not None:
            raise LagtopError("--param needs --functions omega or pi")
        return ExactComplex(Fraction(0)), False
    if param is None:
        raise LagtopError("the functions omega and pi need --param, as 0.7, 0.7i or 0.2+0.7i")
    return param


def _parse_distance(text: str) -> ExactComplex:
    """Return 0.7 or, imaginary, 0.7i."""
    value = parse_complex(text)
    if min(value) < 0 or all(value):
        raise LagtopError(f"must be >= 0, or imaginary as 0.7i, got {value}")
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
    opt.exclude(p=p, gap_above=gap_above)
    opt.exclude(p=p, gap_below=gap_below)
    quadrature = _quadrature(delta, delta_star, (p, q), (gap_above, gap_below), g)
    if tau is not None:
        names = check_names("columns", columns or ["eta"], ETA_COLUMNS)
        table = EtaTable(tau, quadrature, names=names, angle="rad" if rad else "deg")
        write_functions(table, digits, out)
        return
    if columns is not None:
        raise LagtopError("--columns needs --tau")
    keys = constant_keys("Roots", _ETA)
    out.record(eta_record(quadrature, digits), lambda: keys)


def _quadrature(
    delta: Fraction,
    delta_star: Fraction,
    middle: tuple[Fraction | None, ExactComplex | None],
    gaps: tuple[Fraction | None, Fraction | None],
    g: Fraction,
) -> Quadrature:
    """Return the quadrature with its outer roots, by their middle or by the gaps to them."""
    (p, q), (above, below) = middle, gaps
    if p is not None and q is not None:
        return Quadrature(delta_star, delta, (p - q.real, p + q.real), g, q.imag)
    if p is not None or q is not None:
        raise LagtopError("--p and --q belong together: give both, or neither")
    for name, gap in {"--gap-above": above, "--gap-below": below}.items():
        if gap is not None and gap <= 0:
            raise LagtopError(f"{name} must be > 0 (the period is infinite at 0), got {float(gap)}")
    outer = (delta_star - below if below else None, delta + above if above else None)
    return Quadrature(delta_star, delta, tuple(root for root in outer if root is not None), g)
