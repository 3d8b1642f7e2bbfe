"""`lagtop jacobi`: the elliptic and theta functions."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import click

from ..arithmetic.points import ExactComplex, looks_complex, parse_complex
from ..errors import LagtopError
from ..output.layouts import JACOBI
from ..output.write import write_record
from .command import ExamplesFirst, complain
from .options import (
    COUNT,
    MOST_TABLE_DIGITS,
    NUMBER,
    Parsed,
    digits_option,
    exclude,
    output_options,
)
from .row_options import RANGE, listed, write_functions

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.modulus import ModulusInput
    from ..elliptic.request import Arguments, FunctionRequest
    from ..elliptic.tables import TableOfFunctions
    from ..inputs.multiples import Multiple, Multiples

MOST_TERMS = 10_000


def _parse_multiple(text: str) -> Multiple:
    from ..inputs.multiples import parse_multiple

    return parse_multiple(text)


def _parse_argument(text: str) -> Multiple | ExactComplex:
    return parse_complex(text) if looks_complex(text) else _parse_multiple(text)


def _parse_multiples(text: str) -> Multiples:
    from ..inputs.multiples import parse_multiples

    return parse_multiples(text)


ARGUMENT = Parsed("number", _parse_argument)
COMPLEX = Parsed("number", parse_complex)
MULTIPLES = Parsed("range", _parse_multiples)


@click.command(
    "jacobi",
    cls=ExamplesFirst,
    examples="""
        lagtop jacobi --k 0.8
        lagtop jacobi --k-prime 1e-9 --u 0.5 --u 20
        lagtop jacobi --modular-angle 45 --u-range 0:10:101 -o sn.csv
        lagtop jacobi --k 0.8 --u 0.3 --theta --pi --param 0.7i
        lagtop jacobi --nome 0.1 --u 1 --digits 40
        lagtop jacobi --k 0.8 --u-range 0:4K:5
        lagtop jacobi --modular-angle 45 --phi 30 --phi 60
        lagtop jacobi --k 0.99 --u 1 --series 10
        lagtop jacobi --k 0.8i --u 0.3+0.7i --pi --param 0.2+0.1i
    """,
)
@click.option("--k", type=COMPLEX, help="Modulus, 0 to 1, above 1, or imaginary as 0.8i.")
@click.option("--k-prime", type=NUMBER, help="Its complement, for k close to 1.")
@click.option("--modular-angle", "angle", type=NUMBER, help="arcsin k, 0 to 90 degrees.")
@click.option("--nome", "q", type=NUMBER, help="exp(-pi K'/K), below 1.")
@click.option(
    *("--u", "single"),
    type=ARGUMENT,
    multiple=True,
    help="Argument, as 0.5, 0.3+0.7i or, in units of K, K, -2.5K, K/2, 3K/4; may be repeated.",
)
@click.option("--u-range", "grid", type=MULTIPLES, help="Arguments, as [log:]start:stop:count.")
@click.option("--phi", "amplitudes", type=NUMBER, multiple=True, help="F and E of it instead.")
@click.option("--phi-range", "fan", type=RANGE, help="Amplitudes, as [log:]start:stop:count.")
@click.option("--am", is_flag=True, help="am, sn, cn, dn of u; the default.")
@click.option("--theta", is_flag=True, help="Theta functions of u.")
@click.option("--zeta", is_flag=True, help="Their logarithmic derivatives.")
@click.option("--omega", is_flag=True, help="Chrapan's Omega functions of u and --param.")
@click.option("--pi", is_flag=True, help="Chrapan's Pi functions of u and --param.")
@click.option(
    "--param", metavar="NUMBER", help="Parameter of Omega and Pi, as 0.7, 0.7i, 0.2+0.7i."
)
@click.option(
    "--series", "terms", type=COUNT, metavar="N", help="Partial sums of the nome series instead."
)
@click.option("--rad", is_flag=True, help="Angles in radians, in and out.")
@digits_option(MOST_TABLE_DIGITS)
@output_options("table", "csv", "json")
def command(
    k: ExactComplex | None,
    k_prime: Fraction | None,
    angle: Fraction | None,
    q: Fraction | None,
    single: tuple[Multiple | ExactComplex, ...],
    grid: Multiples | None,
    amplitudes: tuple[Fraction, ...],
    fan: Points | None,
    am: bool,
    theta: bool,
    zeta: bool,
    omega: bool,
    pi: bool,
    param: str | None,
    terms: int | None,
    rad: bool,
    digits: int | None,
    fmt: str,
    output: str,
) -> None:
    """Elliptic integrals, Jacobi's functions and theta functions of one modulus.

    Without --u the constants of the modulus are written; with it am, sn, cn, dn of every u or, of
    --am, --theta, --zeta, --omega and --pi, what is asked for.  With --phi it is Legendre's
    F(phi, k) and E(phi, k) of every phi, which is in degrees and may be any number.

    Every value is within 4 units of 2^-52 (max(1, |f|) + |u df/du| + |v df/dv|), with v = --param.
    Here u and a real v are reduced by whole periods; for k > 1 only in am, sn, cn and dn.  In
    small tables every value is the nearest double.  u and a real v go up to 2^50 periods, an
    imaginary v up to K'; what is beyond is refused.  An empty cell is a pole.

    The modulus counts as the decimal that you type, u and --param as the nearest doubles; with
    --digits all of them count as decimals.

    Where a modulus is imaginary or above 1, an argument complex, or a parameter neither real nor
    imaginary, columns end in _re and _im, and imaginary parts go up to 2^50 periods too.  Omega and
    Pi are continuous between the lines of zeros of theta; am is empty beyond its branch points.
    """
    from ..elliptic.modulus import ModulusInput, constants_record

    beyond = k is not None and (k.imag != 0 or not 0 <= k.real <= 1)
    real_k = None if k is None else k.real
    named = {"k": real_k, "k_prime": k_prime, "modular_angle": angle, "nome": q}
    chosen = [(name, value) for name, value in named.items() if value is not None]
    if len(chosen) != 1:
        raise LagtopError("give exactly one of --k, --k-prime, --modular-angle, --nome")
    modulus = ModulusInput(*chosen[0], radians=rad)
    flags = {"am": am, "theta": theta, "zeta": zeta, "omega": omega, "pi": pi}
    asked = tuple(name for name, wanted in flags.items() if wanted)
    families = asked or ("am",)
    parameter, imaginary = _parameter(param, families)
    real = not (
        beyond
        or any(isinstance(u, ExactComplex) for u in single)
        or (parameter.real and parameter.imag)
    )
    if not real:
        for name, wanted in (("--phi", amplitudes or fan), ("--series", terms)):
            if wanted:
                raise LagtopError(f"{name} needs a real --u, and a --k in [0, 1]")
    arguments, in_quarters = _arguments(single, grid, real=real)
    angles = listed("phi", amplitudes, fan)
    if angles:
        others = {"--u": arguments, "--series": terms, f"--{(*asked, '')[0]}": asked or None}
        for name, value in {**others, "--param": param}.items():
            exclude({"--phi": angles, name: value})
        from ..elliptic.incomplete import AmplitudeTable

        write_functions(AmplitudeTable(angles, modulus), digits, fmt, output)
        return
    if terms is not None:
        exclude({"--series": terms, "--digits": digits})
        exclude({"--series": terms, f"--{(*asked, '')[0]}": asked or None})
        _write_series(modulus, arguments, in_quarters, terms, (fmt, output))
        return
    if arguments is None:
        if asked:
            raise LagtopError(f"--{asked[0]} needs --u or --u-range")
        if k is None or not beyond:
            write_record(constants_record(modulus, digits), fmt, output, lambda: JACOBI)
            return
        from ..elliptic.complex_table import any_constants_record
        from ..output.layouts import in_parts

        record = any_constants_record(k, digits)
        write_record(record, fmt, output, lambda: in_parts(JACOBI, record))
        return
    from ..elliptic.request import FunctionRequest

    given = k if k is not None and beyond else modulus
    request = FunctionRequest(given, families, parameter, imaginary, rad, in_quarters)
    write_functions(_table(arguments, request, real=real), digits, fmt, output)


def _arguments(
    single: tuple[Multiple | ExactComplex, ...], grid: Multiples | None, *, real: bool
) -> tuple[Arguments | None, bool]:
    """Return the arguments, if any, and whether they are factors of K.

    Raises LagtopError for factors of K unless all is real.
    """
    exclude({"--u": single or None, "--u-range": grid})
    if not (single or grid):
        return None, False
    from ..arithmetic.points import ListedPoints
    from ..elliptic.request import Arguments
    from ..inputs.multiples import Multiple, listed_multiples

    reals = [Multiple(u.real, False) if isinstance(u, ExactComplex) else u for u in single]
    units = [grid.in_quarters] if grid else [u.in_quarters for u in reals]
    if not real and any(units):
        raise LagtopError(
            "--u must be without K beside complex numbers, and where --k is not in [0, 1]"
        )
    points, in_quarters = grid if grid else listed_multiples(tuple(reals))
    imag = [u.imag if isinstance(u, ExactComplex) else Fraction(0) for u in single]
    return Arguments(points, ListedPoints(imag) if any(imag) else None), in_quarters


def _parameter(param: str | None, families: tuple[str, ...]) -> tuple[ExactComplex, bool]:
    """Return the value of --param, 0 where it is not needed, and whether it is imaginary."""
    if not {"omega", "pi"} & set(families):
        if param is not None:
            raise LagtopError("--param needs --omega or --pi")
        return ExactComplex(Fraction(0)), False
    if param is None:
        raise LagtopError("--omega and --pi need --param, as 0.7, 0.7i or 0.2+0.7i")
    try:
        value = parse_complex(param)
    except LagtopError as error:
        raise LagtopError(f"--param {error}") from None
    return value, not value.real and param.strip().endswith("i")


def _table(arguments: Arguments, request: FunctionRequest, *, real: bool) -> TableOfFunctions:
    """Return the table of real functions, or that of complex ones."""
    if real:
        from ..elliptic.function_table import FunctionTable

        return FunctionTable(arguments.real, request)
    from ..elliptic.complex_table import ComplexTable

    return ComplexTable(arguments, request)


def _write_series(
    modulus: ModulusInput,
    arguments: Arguments | None,
    in_quarters: bool,
    terms: int,
    destination: tuple[str, str],
) -> None:
    """Write the sums, and on standard error how many terms are enough."""
    from ..elliptic.nome_series import TOLERANCE, SeriesTable

    if not 1 <= terms <= MOST_TERMS:
        raise LagtopError(f"--series must be in [1, {MOST_TERMS}], got {terms}")
    if arguments is not None and arguments.real.count != 1:
        raise LagtopError(f"--series takes one --u, got {arguments.real.count}")
    u = None if arguments is None else next(arguments.real.decimals())
    table = SeriesTable(modulus, u, terms, in_quarters=in_quarters)
    write_functions(table, None, *destination)
    complain(f"Terms whose error is proved to be below {TOLERANCE}: {table.needed()}")
