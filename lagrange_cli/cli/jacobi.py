"""`lagtop jacobi`: the elliptic and theta functions."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ..arithmetic.key import Key
from ..arithmetic.points import ExactComplex, looks_complex, parse_complex
from ..errors import LagtopError
from ..inputs.names import check_names
from ..output.terminal import with_progress
from . import shared as opt

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.function_table import ComplexPoints
    from ..elliptic.nome_series import SeriesTable
    from ..elliptic.tables import TableOfFunctions
    from ..inputs.values import Multiple
    from ..output.destination import Output

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


def _parse_range(text: str) -> Points:
    from ..inputs.values import parse_values

    return parse_values(text)


def _parse_arguments(text: str) -> Multiple | list[Multiple | ExactComplex]:
    """Return a range, or the arguments of a comma-separated list."""
    from ..inputs.values import parse_multiple, parse_multiples

    if ":" in text:
        return parse_multiples(text)
    return [parse_complex(x) if looks_complex(x) else parse_multiple(x) for x in text.split(",")]


def _parse_parameter(text: str) -> tuple[ExactComplex, bool]:
    """Return a complex number, and whether it is imaginary."""
    value = parse_complex(text)
    return value, not value.real and text.strip().endswith("i")


RANGE = opt.Parsed("X", _parse_range)
function_formats = opt.output("table", "csv", "json", "ndjson", "parquet")


def write_functions(table: TableOfFunctions | SeriesTable, digits: int | None, out: Output) -> None:
    """Write a table of functions, with its progress."""
    if digits is not None and out.fmt == "parquet":
        raise LagtopError("--format parquet holds doubles: with --digits use csv or json")
    header, blocks = table.rows(digits)
    out.table(header, with_progress(blocks, "rows", table.count or None, len))


def write_constants(record: dict[str, Any], group: str, table: str, out: Output) -> None:
    """Write the constants of a modulus or of a quadrature."""
    if out.fmt == "parquet":
        raise LagtopError("--format parquet holds tables: use json or csv for constants")
    out.record(record, lambda: constant_keys(group, table))


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
    u: Multiple | list[Multiple | ExactComplex] | None,
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
    from ..elliptic.modulus import ModulusInput

    opt.exclude(phi=phi, u=u)
    opt.exclude(phi=phi, series=series, functions=functions)
    opt.exclude(series=series, digits=digits)
    given = {"k": k, "k_prime": k_prime, "nome": nome}
    chosen = [(name, value) for name, value in given.items() if value is not None]
    if len(chosen) != 1:
        raise LagtopError("give exactly one of --k, --k-prime, --nome")
    named = check_names("functions", functions or ["am"], _FAMILIES)
    asked = tuple(name for name in _FAMILIES if name in named)
    parameter, imaginary = _parameter(param, asked)
    beyond = k is not None and (k.imag != 0 or not 0 <= k.real <= 1)
    has_complex = isinstance(u, list) and any(isinstance(x, ExactComplex) for x in u)
    real = not (beyond or has_complex or (parameter.real and parameter.imag))
    if not real and (phi or series):
        raise LagtopError("--phi and --series need a real --u, and a --k in [0, 1]")
    name, value = chosen[0]
    number = value.real if isinstance(value, ExactComplex) else value
    modulus = ModulusInput(name, number, radians=rad)
    any_modulus = k if k is not None and beyond else modulus
    arguments, in_quarters = (None, False) if u is None else _arguments(u, real=real)
    if phi is not None:
        from ..elliptic.incomplete import AmplitudeTable

        write_functions(AmplitudeTable(phi, modulus), digits, out)
    elif series is not None:
        from ..elliptic.nome_series import SeriesTable

        if arguments is not None and arguments.real.count != 1:
            raise LagtopError(f"--series takes one --u, got {arguments.real.count}")
        at = None if arguments is None else next(arguments.real.decimals())
        write_functions(SeriesTable(modulus, at, series, in_quarters=in_quarters), None, out)
    elif arguments is not None:
        from ..elliptic.function_table import FunctionRequest, FunctionTable

        v = parameter.nearest() if digits is None else parameter
        request = FunctionRequest(any_modulus, asked, v, imaginary, rad, in_quarters, real)
        write_functions(FunctionTable(arguments, request), digits, out)
    elif functions is not None:
        raise LagtopError("--functions needs --u")
    else:
        from ..elliptic.modulus import constants_record

        write_constants(constants_record(any_modulus, digits), "Moduli", _JACOBI, out)


def _arguments(
    u: Multiple | list[Multiple | ExactComplex], *, real: bool
) -> tuple[ComplexPoints, bool]:
    """Return the arguments, and whether they are factors of K.

    Raises LagtopError for factors of K unless all numbers are real.
    """
    from ..arithmetic.points import ListedPoints
    from ..elliptic.function_table import ComplexPoints
    from ..inputs.values import Multiple, listed_multiples

    imag: list[Fraction] = []
    if isinstance(u, list):
        reals = [Multiple(x.real, False) if isinstance(x, ExactComplex) else x for x in u]
        imag = [x.imag if isinstance(x, ExactComplex) else Fraction(0) for x in u]
        units = [x.in_quarters for x in reals]
    else:
        units = [u.in_quarters]
    if not real and any(units):
        raise LagtopError("--u must not contain K if numbers are complex or --k is not in [0, 1]")
    points, in_quarters = listed_multiples(reals) if isinstance(u, list) else u
    return ComplexPoints(points, ListedPoints(imag) if any(imag) else None), in_quarters


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
