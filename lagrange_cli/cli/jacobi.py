"""Special functions: `lagtop jacobi`, elliptic and theta functions, and `lagtop eta`."""

from __future__ import annotations

from fractions import Fraction

from ..elliptic import eta, legendre
from ..elliptic.arguments import (
    Arguments,
    ExactComplex,
    parse_arguments,
    parse_complex,
    parse_small,
    parse_sum,
)
from ..elliptic.function_table import FAMILIES, FunctionRequest, function_rows
from ..elliptic.modulus import GivenModulus, Kind
from ..elliptic.tables import Rows
from ..errors import LagtopError
from ..names import Key, check_names
from ..output.destination import Output
from ..output.document import record_document
from ..output.terminal import with_progress
from ..top.inputs import declared
from ..top.ranges import Points
from ..top.units import Units
from ..top.values import parse_values
from . import shared as opt


def constant_keys(group: str, table: str) -> dict[str, Key]:
    """Return the keys of a table, a line each; a line without columns begins another group.

    Complex numbers also have the keys of their parts.
    """
    keys = {}
    for name, *cells in declared(table):
        if not cells:
            group = name
            continue
        symbol, *others = cells
        keys[name] = Key(group, symbol, *others)
        for part, sign in (("re", "Re"), ("im", "Im")):
            keys[f"{name}_{part}"] = Key(group, f"{sign} {symbol}", *others)
    return keys


ARGUMENTS = opt.Parsed("X", parse_arguments)
MODULUS = opt.Parsed("X", parse_small)
RANGE = opt.Parsed("X", parse_values)
function_formats = opt.output("table", rows=True)


def write_functions(rows: Rows, count: int, out: Output) -> None:
    """Write a table of functions with `count` rows, with its progress."""
    header, blocks = rows
    out.rows(header, with_progress(blocks, "rows", count, len))


@opt.command(
    "jacobi",
    "jacobi --k 0.8",
    "jacobi --k 0.8 --u 0:4K:101 -o sn.csv",
    "jacobi --k 0.8 --u 0.3,1 --functions theta,pi --param 0.7i",
    "jacobi --m 2 --phi 10,20 --n 0.3",
)
@opt.option("--k", type=MODULUS, help="Modulus, real or complex (0.8, 2, 0.8i, 1+2i).")
@opt.option("--k-prime", type=MODULUS, help="Complementary modulus k', for k close to 1.")
@opt.option("--m", type=MODULUS, help="Parameter m = k^2, any real or complex number.")
@opt.option("--nome", type=MODULUS, help="Nome q = exp(-pi K'/K), below 1 in magnitude.")
@opt.option("--modular-angle", type=MODULUS, help="Modular angle arcsin k, 0 to 90 degrees.")
@opt.option(
    "--u",
    type=ARGUMENTS,
    help="Arguments of functions: a list such as 0.5,0.3+0.7i or a range [log:]start:stop:count.  "
    "Numbers may contain K and K', as in K/2, \"K+iK'\" or 0:4K:9.",
)
@opt.option(
    "--functions",
    type=opt.LIST,
    help="Functions of the table (see above).  [default: am for --u; F,E for --phi]",
)
@opt.option(
    "--param",
    type=opt.Parsed("V", parse_sum),
    help="Parameter v of omega and pi, such as 0.2+0.7i.",
)
@opt.option("--phi", type=ARGUMENTS, help="Amplitudes of F, E and zeta: 30,90,-210 or 30+20i.")
@opt.option("--n", type=opt.NUMBER, help="Print Legendre's Pi(n; phi | k) or Pi(n | k).")
@opt.rad
@opt.digits(opt.MOST_TABLE_DIGITS)
@function_formats
def jacobi_command(
    u: Arguments | None,
    functions: list[str] | None,
    param: ExactComplex | None,
    phi: Arguments | None,
    n: Fraction | None,
    rad: bool,
    digits: int | None,
    out: Output,
    **moduli: ExactComplex | None,
) -> None:
    """Compute elliptic integrals, elliptic and theta functions.

    Give the modulus with exactly one of --k, --k-prime, --m, --nome and --modular-angle.  k and -k
    have the same values.  Without --u and --phi, the constants of the modulus are printed.

    \b
    A&S: sn(u | m) takes --m, and sn(u \\ alpha) --modular-angle alpha.
    DLMF: sn(u, k) takes --k.
    Mathematica, SciPy, mpmath: JacobiSN[u, m], ellipj(u, m) take --m.

    \b
    --functions of --u:
      am            am, sn, cn and dn (default)
      sn, cd, ...   Jacobi's twelve functions
      arcsn, ...    their inverses, F of an amplitude; --u is the value
      epsilon       Jacobi's epsilon E(am u, k)
      zeta          Z_ij = d log Theta_ij/du; zeta01 is Jacobi's zeta
      theta         Theta_ij(u):
                      Theta01 = theta4, Theta00 = theta3,
                      Theta11 = theta1, Theta10 = theta2 at z = pi u/2K
      theta1, ...   theta1(z, q) to theta4(z, q), --u is z in radians
      theta_s, ...  Neville's theta_s, theta_c, theta_d, theta_n
      omega, pi     Chrapan's functions of u and --param
    \b
    --functions of --phi:
      F, E, zeta    F(phi, k), E(phi, k), and Jacobi's zeta(phi, k)
      Pi            Pi(n; phi | k), with --n

    Every value is correctly rounded, or has N correct digits with --digits N.  u and --param may be
    up to 2^50 periods.  An empty cell is a pole, am beyond its branch points, an integral on a
    branch cut, or an inverse function without a real value.

    The modulus and --n are read as exact decimals, u, --phi and --param as doubles unless --digits
    is given.  Complex results have columns that end in _re and _im.
    """
    opt.exclude(phi=phi, u=u)
    opt.exclude(phi=phi, param=param)
    opt.exclude(n=n, u=u)
    chosen = [(name, value) for name, value in moduli.items() if value is not None]
    if len(chosen) != 1:
        raise LagtopError("give exactly one of --k, --k-prime, --m, --nome, --modular-angle")
    units = Units(rad)
    given = GivenModulus(*chosen[0], units)
    if phi is not None:
        default = ["F", "E", "Pi"][: 2 if n is None else 3]
        names = check_names("functions", functions or default, legendre.INTEGRALS)
        if (n is None) is ("Pi" in names):
            raise LagtopError("--n and --functions Pi belong together: give both, or neither")
        rows = legendre.amplitude_rows(phi, given, n, names, units=units, digits=digits)
        write_functions(rows, phi.real.count, out)
    elif u is not None:
        if "Z" in (functions or []):
            wanted = "use zeta, whose column zeta01 is Jacobi's Z(u)"
            raise LagtopError(f"--functions must not contain Z: {wanted}")
        usual = ["sn", "cn", "dn"] if given.kind is Kind.COMPLEX else ["am"]
        named = check_names("functions", functions or usual, FAMILIES)
        if param is not None and not {"omega", "pi"} & {*named}:
            raise LagtopError("--param needs --functions omega or pi")
        if param is None and {"omega", "pi"} & {*named}:
            wanted = "--param, such as 0.7, 0.7i or 0.2+0.7i"
            raise LagtopError(f"the functions omega and pi need {wanted}")
        v = param or ExactComplex(Fraction(0))
        asked = tuple(name for name in FAMILIES if name in named)
        request = FunctionRequest(u, given, asked, v if digits else v.nearest(), units)
        write_functions(function_rows(request, digits), u.real.count, out)
    elif functions is not None:
        raise LagtopError("--functions needs --u or --phi")
    else:
        keys = constant_keys("Moduli", legendre.CONSTANTS)
        record = legendre.constants_record(given, digits, n=n, units=units)
        out.document(record_document(record, lambda: keys))


def _parse_distance(text: str) -> ExactComplex:
    """Return 0.7 or, imaginary, 0.7i."""
    value = parse_complex(text)
    if min(value) < 0 or (value.real and value.imag):
        raise LagtopError(f"must be >= 0, or imaginary (0.7i), got {value}")
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
    """Compute eta of Aksenov's satellite orbit (1977, section 3.2).

    Eta gives the latitude of the satellite.  It oscillates between delta* and delta:
    (d eta/d tau)^2 = g (delta - eta) (eta - delta*) (q^2 - (eta - p)^2).

    Give the outer roots of the right-hand side with --p and --q (0.7i for a complex pair), or by
    their gaps from delta and delta*.  If you give one gap, the other root is at infinity, as for
    Lagrange's top.  If you give no outer root, both are at infinity.

    Without --tau, the constants are printed.  At tau = 0, eta is delta*.  h1, theta and xi' are
    defined in (3.2.9) to (3.2.11).
    """
    opt.exclude(p=p, gap_above=gap_above)
    opt.exclude(p=p, gap_below=gap_below)
    if (p is None) is not (q is None):
        raise LagtopError("--p and --q belong together: give both, or neither")
    for name, gap in {"--gap-above": gap_above, "--gap-below": gap_below}.items():
        if gap is not None and gap <= 0:
            raise LagtopError(f"{name} must be > 0 (the period is infinite at 0), got {float(gap)}")
    gaps = [delta_star - gap_below] if gap_below else []
    gaps += [delta + gap_above] if gap_above else []
    outer = gaps if p is None or q is None else [p - q.real, p + q.real]
    quadrature = eta.Quadrature(delta_star, delta, tuple(outer), g, q.imag if q else Fraction(0))
    if tau is not None:
        names = check_names("columns", columns or ["eta"], eta.ETA_COLUMNS)
        rows = eta.eta_rows(tau, quadrature, names, units=Units(rad), digits=digits)
        write_functions(rows, tau.count, out)
        return
    if columns is not None:
        raise LagtopError("--columns needs --tau")
    keys = constant_keys("Roots", eta.CONSTANTS)
    out.document(record_document(eta.eta_record(quadrature, digits), lambda: keys))
