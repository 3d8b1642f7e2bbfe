"""`lagtop jacobi`: the elliptic and theta functions."""

from __future__ import annotations

import re
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ..arithmetic.points import ExactComplex, looks_complex, parse_complex
from ..arithmetic.values import Key
from ..errors import LagtopError
from ..inputs.names import check_names, split_names
from ..output.terminal import with_progress
from . import options as opt

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.function_table import ComplexPoints
    from ..elliptic.modulus import ModulusInput
    from ..elliptic.nome_series import SeriesTable
    from ..elliptic.tables import TableOfFunctions
    from ..inputs.ranges import Multiple, Multiples
    from ..output.destination import Output

RANGE = opt.Parsed("X", opt.late("inputs.ranges", "parse_values"))
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


def _parse_argument(text: str) -> Multiple | ExactComplex:
    from ..inputs.ranges import parse_multiple

    return parse_complex(text) if looks_complex(text) else parse_multiple(text)


def _parse_parameter(text: str) -> tuple[ExactComplex, bool]:
    """Return a complex number, and whether it is imaginary."""
    value = parse_complex(text)
    return value, not value.real and text.strip().endswith("i")


def _parse_arguments(text: str) -> Multiples | list[Multiple | ExactComplex]:
    """Return a range, or the arguments of a comma-separated list."""
    if ":" in text:
        from ..inputs.ranges import parse_multiples

        return parse_multiples(text)
    return [_parse_argument(part) for part in text.split(",")]


def write_functions(table: TableOfFunctions | SeriesTable, digits: int | None, out: Output) -> None:
    """Write a table of functions, with its progress."""
    if digits is not None and out.fmt == "parquet":
        raise LagtopError(f"--format {out.fmt} holds doubles: with --digits use csv or json")
    header, blocks = table.rows(digits)
    out.table(header, with_progress(blocks, "rows", table.count or None, len), table.count)


_NAMES = opt.Parsed("NAME,...", split_names, lambda: _FAMILIES)
_FUNCTIONS: Any = opt.Group(
    lambda families: [name for named in families for name in named] or None,
    [
        opt.option(
            _NAMES,
            "Functions of u: am (with sn, cn, dn), theta, zeta (logarithmic derivatives of theta), "
            "omega, pi (of u and --param, after Chrapan).  [default: am]",
            "--functions",
            multiple=True,
        )("families"),
        *(
            opt.option(_NAMES, "", f"--{name}", flag_value=name, multiple=True, hidden=True)(
                "families"
            )
            for name in _FAMILIES
        ),
    ],
)
"""The option --functions, and flags such as --omega, which mean the same."""
function_formats = opt.output("table", "csv", "json", "ndjson", "parquet")


@opt.command(
    "jacobi",
    """
    lagtop jacobi --k 0.8
    lagtop jacobi --modular-angle 45 --u 0:4K:101 -o sn.csv
    lagtop jacobi --k 0.8 --u 0.3,1 --functions theta,pi --param 0.7i
    """,
    exclusive=[
        *("--phi --u", "--phi --series", "--phi --functions"),
        *("--series --digits", "--series --functions"),
    ],
)
def jacobi_command(
    k: ExactComplex | None = opt.option(
        opt.Parsed("X", parse_complex), "Modulus, 0 to 1, above 1, or imaginary as 0.8i."
    ),
    k_prime: Fraction | None = opt.number("Complementary modulus k', for k close to 1."),
    modular_angle: Fraction | None = opt.number("Modular angle arcsin k, 0 to 90 degrees."),
    nome: Fraction | None = opt.number("Nome q = exp(-pi K'/K), below 1."),
    u: Multiples | list[Multiple | ExactComplex] | None = opt.option(
        opt.Parsed("X", _parse_arguments),
        "Arguments: a list such as 0.5,0.3+0.7i, a range [log:]start:stop:count, or multiples of "
        "K such as K/2,-2.5K.",
    ),
    families: list[str] | None = _FUNCTIONS,
    param: tuple[ExactComplex, bool] | None = opt.option(
        opt.Parsed("V", _parse_parameter), "Parameter of omega and pi, such as 0.7, 0.7i, 0.2+0.7i."
    ),
    phi: Points | None = opt.option(
        RANGE, "Amplitudes: print F(phi, k) and E(phi, k) for a list or a range."
    ),
    series: int | None = opt.count(
        "Print the first N partial sums of the nome series instead.", most=MOST_TERMS
    ),
    rad: bool = opt.rad,
    digits: int | None = opt.digits(opt.MOST_TABLE_DIGITS),
    out: Output = function_formats,
) -> None:
    """Compute elliptic integrals, Jacobi's functions and theta functions.

    Without --u and --phi, the constants of the modulus are printed.

    The error of a value f is at most 4 units, and in small tables every value is correctly rounded.
    A unit is 2^-52 (max(1, |f|) + |u df/du| + |v df/dv|), where v = --param.  Whole
    periods are first removed from u and from a real v; for k > 1 only in am, sn, cn and dn.

    u and a real v may be up to 2^50 periods, an imaginary v up to K'.  An empty cell is a pole,
    or am beyond its branch points.

    The modulus is read as an exact decimal, u and --param as doubles unless --digits is given.
    Complex results have columns that end in _re and _im.
    """
    from ..elliptic.modulus import ModulusInput

    beyond = k is not None and (k.imag != 0 or not 0 <= k.real <= 1)
    real_k = None if k is None else k.real
    way = _modulus(k=real_k, k_prime=k_prime, modular_angle=modular_angle, nome=nome)
    modulus = ModulusInput(*way, radians=rad)
    if families is not None:
        check_names("functions", families, _FAMILIES)
    asked = tuple(name for name in _FAMILIES if name in (families or ["am"]))
    parameter, imaginary = _parameter(param, asked)
    has_complex = isinstance(u, list) and any(isinstance(x, ExactComplex) for x in u)
    real = not (beyond or has_complex or (parameter.real and parameter.imag))
    if not real:
        for name, wanted in (("--phi", phi), ("--series", series)):
            if wanted:
                raise LagtopError(f"{name} needs a real --u, and a --k in [0, 1]")
    arguments, in_quarters = (None, False) if u is None else _arguments(u, real=real)
    given = k if k is not None and beyond else modulus
    if phi is not None:
        from ..elliptic.incomplete import AmplitudeTable

        write_functions(AmplitudeTable(phi, modulus), digits, out)
    elif series is not None:
        _write_series(modulus, arguments, in_quarters, series, out)
    elif arguments is not None:
        from ..elliptic.function_table import FunctionRequest, FunctionTable

        v = parameter.nearest() if digits is None else parameter
        request = FunctionRequest(given, asked, v, imaginary, rad, in_quarters, real)
        write_functions(FunctionTable(arguments, request), digits, out)
    elif families is not None:
        raise LagtopError("--functions needs --u")
    else:
        from ..elliptic.modulus import constants_record

        write_constants(constants_record(given, digits), "Moduli", _JACOBI, out)


def _modulus(**named: Fraction | None) -> tuple[str, Fraction]:
    """Return the name and value of the modulus that is given.  Raises LagtopError."""
    chosen = [(name, value) for name, value in named.items() if value is not None]
    if len(chosen) != 1:
        raise LagtopError("give exactly one of --k, --k-prime, --modular-angle, --nome")
    return chosen[0]


def write_constants(record: dict[str, Any], group: str, table: str, out: Output) -> None:
    """Write the constants of a modulus or of a quadrature."""
    if out.fmt == "parquet":
        raise LagtopError(f"--format {out.fmt} holds tables: use json or csv for constants")
    out.record(record, lambda: constant_keys(group, table))


def _arguments(
    u: Multiples | list[Multiple | ExactComplex], *, real: bool
) -> tuple[ComplexPoints, bool]:
    """Return the arguments, and whether they are factors of K.

    Raises LagtopError for factors of K unless all numbers are real.
    """
    from ..arithmetic.points import ListedPoints
    from ..elliptic.function_table import ComplexPoints
    from ..inputs.ranges import Multiple, listed_multiples

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


def _write_series(
    modulus: ModulusInput,
    arguments: ComplexPoints | None,
    in_quarters: bool,
    terms: int,
    out: Output,
) -> None:
    """Write the partial sums."""
    from ..elliptic.nome_series import SeriesTable

    if arguments is not None and arguments.real.count != 1:
        raise LagtopError(f"--series takes one --u, got {arguments.real.count}")
    u = None if arguments is None else next(arguments.real.decimals())
    write_functions(SeriesTable(modulus, u, terms, in_quarters=in_quarters), None, out)
