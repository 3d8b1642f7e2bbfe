"""`lagtop jacobi`: the elliptic and theta functions."""

from __future__ import annotations

from fractions import Fraction
from typing import TYPE_CHECKING

import click

from ..arithmetic.exact_complex import ExactComplex, looks_complex, parse_complex
from ..errors import LagtopError
from ..output.layouts import JACOBI
from ..output.write import write_record, write_table
from .command import ExamplesFirst, complain
from .jacobi_complex import all_real, complex_points, write_complex
from .options import (
    COUNT,
    MOST_TABLE_DIGITS,
    NUMBER,
    Parsed,
    digits_option,
    exclude,
    output_options,
)
from .progress import with_progress
from .row_options import RANGE, listed

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..elliptic.modulus_input import ModulusInput
    from ..elliptic.request import Request
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
    from ..elliptic.modulus_input import ModulusInput, constants_record

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
    if beyond or not all_real(single, parameter):
        for name, wanted in (("--phi", amplitudes or fan), ("--series", terms)):
            if wanted:
                raise LagtopError(f"{name} needs a real --u, and a --k in [0, 1]")
        points = complex_points(single, grid)
        if points is None and asked:
            raise LagtopError(f"--{asked[0]} needs --u or --u-range")
        given = k if beyond and k is not None else modulus
        write_complex(points, (given, families, parameter, rad), digits, (fmt, output))
        return
    arguments, in_quarters = _arguments(
        [u for u in single if not isinstance(u, ExactComplex)], grid
    )
    angles = listed("phi", amplitudes, fan)
    if angles:
        others = {"--u": arguments, "--series": terms, f"--{(*asked, '')[0]}": asked or None}
        for name, value in {**others, "--param": param}.items():
            exclude({"--phi": angles, name: value})
        _write_integrals(modulus, angles, digits, fmt, output)
        return
    if terms is not None:
        exclude({"--series": terms, "--digits": digits})
        exclude({"--series": terms, f"--{(*asked, '')[0]}": asked or None})
        _write_series(modulus, arguments, in_quarters, terms, (fmt, output))
        return
    if arguments is None:
        if asked:
            raise LagtopError(f"--{asked[0]} needs --u or --u-range")
        write_record(constants_record(modulus, digits), fmt, output, lambda: JACOBI)
        return
    from ..elliptic.request import Request

    part = parameter.imag if imaginary else parameter.real
    request = Request(modulus, families, part, imaginary, rad, in_quarters)
    _write_rows(arguments, request, digits, fmt, output)


def _arguments(single: list[Multiple], grid: Multiples | None) -> tuple[Points | None, bool]:
    """Return the arguments, if any, and whether they are factors of K."""
    exclude({"--u": single or None, "--u-range": grid})
    if not (single or grid):
        return None, False
    from ..inputs.multiples import listed_multiples

    return grid or listed_multiples(tuple(single))


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


def _write_rows(
    arguments: Points, request: Request, digits: int | None, fmt: str, output: str
) -> None:
    from ..elliptic.function_table import blocks, digit_rows

    if digits is None:
        header, found = blocks(arguments, request)
        parts = with_progress(found, arguments.count, 3_000_000)
        write_table(header, parts, fmt, output)
    else:
        header, lines = digit_rows(arguments, request, digits)
        texts = with_progress(([line] for line in lines), arguments.count, 1000)
        write_table(header, texts, fmt, output)


def _write_integrals(
    modulus: ModulusInput, amplitudes: Points, digits: int | None, fmt: str, output: str
) -> None:
    from ..elliptic.amplitude_table import blocks, digit_rows, header

    if digits is None:
        parts = with_progress(blocks(amplitudes, modulus), amplitudes.count, 3_000_000)
        write_table(header(modulus), parts, fmt, output)
    else:
        lines = digit_rows(amplitudes, modulus, digits)
        texts = with_progress(([line] for line in lines), amplitudes.count, 1000)
        write_table(header(modulus), texts, fmt, output)


def _write_series(
    modulus: ModulusInput,
    arguments: Points | None,
    in_quarters: bool,
    terms: int,
    destination: tuple[str, str],
) -> None:
    """Write the sums, and on standard error how many terms are enough."""
    from ..elliptic.series_table import TOLERANCE, series_table

    if not 1 <= terms <= MOST_TERMS:
        raise LagtopError(f"--series must be in [1, {MOST_TERMS}], got {terms}")
    if arguments is not None and arguments.count != 1:
        raise LagtopError(f"--series takes one --u, got {arguments.count}")
    u = None if arguments is None else next(arguments.decimals())
    table = series_table(modulus, u, terms, in_quarters=in_quarters)
    write_table(
        table.header, with_progress(([row] for row in table.rows), terms, 1000), *destination
    )
    needed = ", ".join(f"{name} {_count_text(n)}" for name, n in table.needed.items())
    complain(f"Terms whose error is proved to be below {TOLERANCE}: {needed}")


def _count_text(count: int) -> str:
    """Return a whole number; one that is very long is rounded."""
    digits = str(count)
    return digits if len(digits) < 10 else f"{digits[0]}.{digits[1:3]}e+{len(digits) - 1}"
