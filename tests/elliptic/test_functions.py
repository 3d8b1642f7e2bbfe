"""The functions of `lagtop jacobi`: every digit against mpmath by other formulas.

`function_reference.py` has the formulas of the reference.  Extreme moduli are compared with the
limits of the functions, whose next terms are far below the digits.
"""

from __future__ import annotations

import math
import random
from concurrent.futures import ThreadPoolExecutor
from decimal import Decimal
from fractions import Fraction
from itertools import pairwise, product
from typing import Any

import mpmath
import pytest
from flint import arb, ctx, fmpq
from function_reference import NUMBER, Reference
from lagtop import LagtopError

from lagrange_cli.arithmetic.ball import balls
from lagrange_cli.arithmetic.points import ExactComplex, ListedPoints, parse_complex
from lagrange_cli.elliptic import functions
from lagrange_cli.elliptic.enclosures import rounded
from lagrange_cli.elliptic.function_table import ComplexPoints, FunctionRequest, FunctionTable
from lagrange_cli.elliptic.functions import Functions, Point
from lagrange_cli.elliptic.modulus import AnyModulus, ModulusInput

EVERY = ("am", "theta", "zeta", "omega", "pi")
MODULI = ["0.3", "0.8", "0.95", "0.999", "0.7071067811865476", "0.05i", "0.8i", "20i", "1.01", "2"]
JACOBI = ("am_rad", "sn", "cn", "dn")
THIRD = ("01", "00", "11")
Number = ExactComplex | str
Cells = dict[str, str]


def row(
    k: AnyModulus | str,
    u: Number,
    v: Number = "0",
    families: tuple[str, ...] = EVERY,
    digits: int | None = None,
    *,
    is_real: bool = False,
    imaginary: bool = False,
) -> Cells:
    """Return the row of an argument; modulus, argument and parameter may be given by their text."""
    first, second = (parse_complex(x) if isinstance(x, str) else x for x in (u, v))
    if isinstance(k, str):
        value = parse_complex(k)
        k = value if value.imag or value.real > 1 else ModulusInput("k", value.real)
    points = ListedPoints([first.real]), None if is_real else ListedPoints([first.imag])
    request = FunctionRequest(
        k, families, second, radians=True, is_real=is_real, imaginary=imaginary
    )
    header, (((cells,),)) = FunctionTable(ComplexPoints(*points), request).rows(digits)
    return dict(zip(header, cells, strict=True))


def columns(reference: Reference, u: Any, v: Any, families: tuple[str, ...]) -> dict[str, Any]:
    """Return the columns by mpmath."""
    found: dict[str, Any] = {}
    for family in families:
        function = getattr(reference, "jacobi" if family == "am" else family)
        if family == "am":
            found |= dict(zip(JACOBI, function(u), strict=True))
        elif family in {"theta", "zeta"}:
            found |= {f"{family}{ij}": function(ij, u) for ij in NUMBER}
        else:
            found |= {f"{family}{ij}": function(ij, u, v) for ij in THIRD}
    return found


def text_of(x: float, y: float) -> str:
    """Return a complex number by its real and imaginary part."""
    return f"{x!r}+{y!r}i".replace("+-", "-")


def check(k: str, u: str, v: str, digits: int) -> None:
    """Check that every cell is the number of the reference, rounded to digits."""
    cells, reference = row(k, u, v, digits=digits), Reference(k, digits + 25)
    ar, checked = reference.ar, 0
    first, second = (
        ar.mpc(*(ar.mpf(x.numerator) / x.denominator for x in parse_complex(z))) for z in (u, v)
    )
    for name, exact in columns(reference, first, second, EVERY).items():
        for part in ("re", "im"):
            text = cells[f"{name}_{part}"]
            assert exact is not None or text == ""
            if text:
                checked += 1
                unit = ar.mpf(10) ** (Decimal(text).adjusted() - digits + 1)
                slack = ar.mpf("0.500001") * unit if float(text) else ar.mpf("1e-30")
                away = ar.mpf(text) - (ar.re(exact) if part == "re" else ar.im(exact))
                assert abs(away) <= slack, (name, part, k, u, v)
    assert checked >= 30


ANYWHERE = [("-4.1-1.3i", "0.2+0.7i"), ("1e-9+2.5i", "100.25-0.5i")]
ON_THE_AXES = [("0.9i", "1.3"), ("1.1i", "0.6i"), ("-0.3+0.7i", "-0.3-0.7i")]
"""Arguments, or their sum and difference, are real or imaginary; a printed 0 is a 0."""


@pytest.mark.parametrize(
    ("k", "numbers"),
    [*product(MODULI[1::2], ANYWHERE), *product(["0.5", "0.95i", "2"], ON_THE_AXES)],
)
def test_digits_of_every_column(k: str, numbers: tuple[str, str]) -> None:
    check(k, *numbers, 20)


@pytest.mark.slow
@pytest.mark.parametrize("k", MODULI)
def test_digits_of_every_column_anywhere(k: str) -> None:
    """Real and imaginary numbers, and numbers of any size, among others."""
    rng = random.Random(f"every {k}")

    def some() -> str:
        real, imag = (round(rng.uniform(-1, 1) * 10 ** rng.uniform(-3, 1.5), 6) for _ in range(2))
        return rng.choice([text_of(real, imag), f"{real:.6f}", f"{imag:.6f}i"])

    for _ in range(8):
        check(k, some(), some(), 25)


@pytest.mark.parametrize("k", ["0.7071067811865476", "0.3"])
def test_a_series_cut_short_holds_the_truth(k: str, monkeypatch: pytest.MonkeyPatch) -> None:
    """Only the error of what is left out makes the balls wide enough."""
    u, v = Point(fmpq(5, 4), fmpq(4, 5)), Point(fmpq(-2, 5), fmpq(3, 5))
    modulus = ModulusInput("k", Fraction(k))
    with balls(40):
        exact = Functions(modulus.ball()).third(u, v)
        for terms in (0, 1):
            monkeypatch.setattr(functions, "isqrt", lambda _, terms=terms: terms)
            for ij, values in Functions(modulus.ball()).third(u, v).items():
                for wide, sharp in zip(values, exact[ij], strict=True):
                    assert wide is not None
                    assert sharp is not None
                    assert wide.overlaps(sharp), (ij, terms)
                    assert wide.rel_accuracy_bits() < 100, (ij, terms)


def test_a_ball_that_stays_wide_is_no_fraction() -> None:
    with pytest.raises(LagtopError, match="1200 digits do not determine these numbers"):
        rounded(lambda: {"x": arb(0, 1e-5)}, 10, 1200)
    assert rounded(lambda: {"x": arb(1, arb(10) ** -1100)}, 10, 1200) == {"x": "1.0"}


def half_periods(k: str) -> list[tuple[float, float]]:
    """Return the doubles next to K, iK', K + iK', 3K and x + iK' in the period lattice of k."""
    reference = Reference(k, 40)
    K, height = (x / reference.stretch for x in (reference.K, reference.K_prime))
    places = [(K, 0), (0, height), (K, height), (3 * K, 0), (0.3, height)]
    return [(float(x), float(y)) for x, y in places]


def assert_doubles(k: str, u: str, v: str) -> None:
    """Check that Omega and Pi are the doubles next to those of the reference."""
    reference, z = Reference(k, 60), [parse_complex(x).nearest() for x in (u, v)]
    first, second = (reference.ar.mpc(*(reference.ar.mpf(float(x)) for x in y)) for y in z)
    cells = row(k, z[0], z[1], ("omega", "pi"))
    for name, exact in columns(reference, first, second, ("omega", "pi")).items():
        found = complex(float(cells[f"{name}_re"]), float(cells[f"{name}_im"]))
        assert found == complex(exact), (name, k, u, v)


@pytest.mark.parametrize("k", MODULI)
@pytest.mark.parametrize("place", [1, 2, 4])
def test_parameters_next_to_half_periods(k: str, place: int) -> None:
    """All digits were wrong for many of these in an earlier version."""
    assert_doubles(k, "0.3+0.2i", text_of(*half_periods(k)[place]))


@pytest.mark.slow
@pytest.mark.parametrize("k", MODULI)
def test_numbers_next_to_half_periods(k: str) -> None:
    """Take arguments there as well, and the doubles on both sides."""
    for place, towards in product(half_periods(k), (-math.inf, 0.0, math.inf)):
        x, y = (math.nextafter(x, towards) for x in place)
        text = text_of(x, y)
        for u, v in (("0.3+0.2i", text), ("-2.7+3.1i", text), (text, "0.4-0.9i")):
            assert_doubles(k, u, v)


@pytest.mark.parametrize(("k", "K"), [("0.8", "1.9953027776647294"), ("0.3", "1.6080486199305128")])
def test_real_functions_are_parts_of_the_complex_ones(k: str, K: str) -> None:
    """The parameters are real or imaginary, and next to K."""
    for u, v in product(("0.3", K, "-17.25"), ("0.7", K, "-1.3i")):
        z, families = [parse_complex(x).nearest() for x in (u, v)], ("omega", "pi")
        both = row(k, z[0], z[1], families)
        real = row(k, z[0], z[1], families, is_real=True, imaginary=v.endswith("i"))
        for name, cell in real.items():
            part = "im" if name.endswith("_imag") else "re"
            assert cell == both[f"{name.removesuffix('_imag')}_{part}"], (name, u, v)


def test_the_side_of_a_line_of_zeros_is_decided() -> None:
    """Omega01 jumps by i pi where Im(u - v) passes K', however close to K' the number is."""
    found = []
    for below in ("1e-6", "1e-45", "-1e-45", "-1e-6"):
        with mpmath.workdps(80):
            height = mpmath.ellipk(mpmath.mpf("0.36")) * (1 - mpmath.mpf(below))
            cells = row("0.8", f"0.1+{mpmath.nstr(height, 60)}i", "0.3", ("omega",), 4)
        found.append(float(cells["omega01_im"]))
    assert found[0] == found[1] == pytest.approx(found[2] - math.pi, abs=1e-3)
    assert found[2] == found[3]


@pytest.mark.parametrize(("k", "v"), [("0.8", "0.4+0.9i"), ("0.8i", "0.4-3i"), ("1.5", "0.4-3i")])
def test_the_branch_has_no_jumps_between_lines_of_zeros(k: str, v: str) -> None:
    """Along the real direction nothing jumps, in any strip."""
    for height in (0.0, 1.3, -2.1, 7.7):
        rows = [row(k, text_of(x / 8, height), v, ("omega",)) for x in range(-12, 13)]
        for ij in THIRD:
            values = [float(cells[f"omega{ij}_im"]) for cells in rows]
            assert max(abs(b - a) for a, b in pairwise(values)) < 1.5


# Limits for k -> 0 and k -> 1, of relative errors q and q' (U, V: arguments times pi/2K').


def _circular(q: Any, u: Any, v: Any) -> dict[str, Any]:
    sin, cos, cot = mpmath.sin, mpmath.cos, mpmath.cot
    odd = mpmath.log(abs(sin(u - v) / sin(u + v))) / 2
    even = -2 * q * sin(2 * u) * sin(2 * v)
    third = 4 * q * sin(2 * v) * u + even
    return {
        **{"sn": sin(u), "cn": cos(u), "theta11": 2 * q ** mpmath.mpf("0.25") * sin(u)},
        **{"zeta01": 4 * q * sin(2 * u), "zeta11": cot(u), "omega01": even, "omega11": odd},
        **{"pi01": third, "pi00": -third, "pi11": u * cot(v) + odd},
    }


def _hyperbolic(q: Any, u: Any, v: Any) -> dict[str, Any]:
    sinh, cosh, tanh = mpmath.sinh, mpmath.cosh, mpmath.tanh
    line = -2 * u / mpmath.log(q)
    odd = mpmath.log(abs(sinh(u - v) / sinh(u + v))) / 2
    even = mpmath.log(cosh(u - v) / cosh(u + v)) / 2
    return {
        **{"sn": tanh(u), "cn": 1 / cosh(u), "dn": 1 / cosh(u)},
        **{"zeta01": tanh(u) - line, "zeta00": -line},
        **{"omega00": line * v, "omega01": line * v + even, "omega11": line * v + odd},
        **{"pi01": u * tanh(v) + even, "pi11": u / tanh(v) + odd},
        "pi00": 4 * q * u * sinh(2 * v) - 2 * q * sinh(2 * u) * sinh(2 * v),
    }


def number(text: str) -> Any:
    """Return a number whose exponent may have many digits."""
    mantissa, _, exponent = text.partition("e")
    return mpmath.mpf(mantissa) * mpmath.mpf(10) ** int(exponent or 0)


@pytest.mark.parametrize("given", ["k 1e-200", "k_prime 1e-300", "nome 0.9999999999999"])
@pytest.mark.parametrize(("u", "v"), [("0.5", "0.3"), ("-1.25", "2.75"), ("1e-5", "0.125")])
def test_extreme_moduli(given: str, u: str, v: str) -> None:
    """Pi00 is as small as 1e-42863147299611, with all its digits; 1e-200 squared is no double."""
    name, value = given.split()
    modulus = ModulusInput(name, Fraction(value))
    cells, doubles = (row(modulus, u, v, digits=digits, is_real=True) for digits in (40, None))
    with mpmath.workdps(90):
        size = mpmath.mpf(value)
        q = mpmath.exp(mpmath.pi**2 / mpmath.log(size)) if name == "nome" else (size / 4) ** 2
        limit = _circular if name == "k" else _hyperbolic
        for column, exact in limit(q, mpmath.mpf(u), mpmath.mpf(v)).items():
            assert abs(number(cells[column]) - exact) <= abs(exact) * 5.001e-40, column
        for column, text in cells.items():
            if doubles[column]:
                nearest = pytest.approx(float(number(text)), rel=1e-15, abs=5e-324)
                assert float(doubles[column]) == nearest, column


@pytest.mark.parametrize("u", ["0.7", "-3.25+0.5i", "25"])
def test_moduli_0_and_1(u: str) -> None:
    """Circular and hyperbolic functions; am is u, or the Gudermannian of u."""
    with mpmath.workdps(50):
        z = mpmath.mpc(*(mpmath.mpf(x.numerator) / x.denominator for x in parse_complex(u)))
        circular = z, mpmath.sin(z), mpmath.cos(z), mpmath.mpf(1)
        hyperbolic = mpmath.atan(mpmath.sinh(z)), mpmath.tanh(z), mpmath.sech(z), mpmath.sech(z)
        for k, values in (("0", circular), ("1", hyperbolic)):
            cells = row(k, u, families=("am",), digits=25)
            for name, exact in zip(JACOBI, values, strict=True):
                found = mpmath.mpc(cells[f"{name}_re"], cells[f"{name}_im"])
                assert abs(found - exact) <= abs(exact) * 1e-24, (k, name)


@pytest.mark.parametrize("u", ["1e25", "1e300"])
def test_far_numbers(u: str) -> None:
    """The precision grows with them; two that are too low could agree on a wrong number."""
    cells = row("0.5", u, families=("am",), digits=12, is_real=True)
    with mpmath.workdps(700):
        far, period = mpmath.mpf(u), 2 * mpmath.ellipk(mpmath.mpf("0.25"))
        sn, am = mpmath.ellipfun("sn", far, m=mpmath.mpf("0.25")), far * mpmath.pi / period
        near = mpmath.nstr(far - period * mpmath.nint(far / period), 60)
    assert float(cells["sn"]) == pytest.approx(float(sn), rel=1e-11)
    assert float(cells["am_rad"]) == pytest.approx(float(am), rel=1e-11)
    assert row("0.5", "1", u, ("pi",), 20) == row("0.5", "1", near, ("pi",), 20)


@pytest.mark.parametrize(("k", "height"), [("0.8", 1.75075), ("0.8i", 1.5307), ("0", 5e5)])
def test_am_ends_at_its_branch_points(k: str, height: float) -> None:
    """They are the poles of sn next to the real axis, at Im u = Re K'."""
    for part, exists in ((0.999, True), (1.001, k == "0")):
        u = ExactComplex(Fraction(7), Fraction(part * height))
        assert bool(row(k, u, families=("am",))["am_rad_re"]) is exists


def test_threads_and_the_precision_of_the_host() -> None:
    """Rows from eight threads, with other moduli and digits each, are those of one thread."""

    def rows(i: int) -> list[Cells]:
        u, v = f"0.{i}1+0.3i", "0.2+0.7i"
        return [row(k, u, v, digits=20 * i or None) for k in MODULI[i : i + 2]]

    before, ctx.prec = ctx.prec, 77
    try:
        serial = list(map(rows, range(8)))
        with ThreadPoolExecutor(8) as pool:
            assert list(pool.map(rows, range(8))) == serial
        assert ctx.prec == 77
    finally:
        ctx.prec = before
