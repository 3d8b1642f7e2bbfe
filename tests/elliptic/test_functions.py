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
from itertools import pairwise
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

ORIGIN = ExactComplex(Fraction(0))
Cells = dict[str, str]


def row(
    k: AnyModulus | str,
    u: ExactComplex,
    v: ExactComplex = ORIGIN,
    families: tuple[str, ...] = EVERY,
    digits: int | None = None,
    **how: Any,
) -> Cells:
    """Return the row of an argument; a modulus in [0, 1] may be given by its text."""
    if isinstance(k, str):
        value = parse_complex(k)
        k = value if value.imag or value.real > 1 else ModulusInput("k", value.real)
    imag = None if how.get("is_real", True) else ListedPoints([u.imag])
    request = FunctionRequest(k, families, v, radians=True, **how)
    header, blocks = FunctionTable(ComplexPoints(ListedPoints([u.real]), imag), request).rows(
        digits
    )
    ((cells,),) = blocks
    return dict(zip(header, cells, strict=True))


def columns(reference: Reference, u: Any, v: Any, families: tuple[str, ...]) -> dict[str, Any]:
    """Return the columns by mpmath."""
    found: dict[str, Any] = {}
    for family in families:
        if family == "am":
            found |= dict(zip(("am_rad", "sn", "cn", "dn"), reference.jacobi(u), strict=True))
        elif family in {"theta", "zeta"}:
            function = getattr(reference, family)
            found |= {f"{family}{ij}": function(ij, u) for ij in NUMBER}
        else:
            function = getattr(reference, family)
            found |= {f"{family}{ij}": function(ij, u, v) for ij in ("01", "00", "11")}
    return found


def check(cells: Cells, k: str, u: str, v: str, digits: int) -> int:
    """Check that every cell is the number of the reference, rounded to digits; return how many."""
    reference = Reference(k, digits + 25)
    ar, checked = reference.ar, 0
    numbers = (parse_complex(text) for text in (u, v))
    first, second = (ar.mpc(*(ar.mpf(x.numerator) / x.denominator for x in z)) for z in numbers)
    for name, exact in columns(reference, first, second, EVERY).items():
        if exact is None:
            assert cells[f"{name}_re"] == cells[f"{name}_im"] == ""
            continue
        for part, value in (("re", ar.re(exact)), ("im", ar.im(exact))):
            text = cells[f"{name}_{part}"]
            if text:
                checked += 1
                unit = Decimal(f"1e{Decimal(text).adjusted() - digits + 1}")
                slack = ar.mpf("0.500001") * ar.mpf(str(unit)) if float(text) else ar.mpf("1e-30")
                assert abs(ar.mpf(text) - value) <= slack, (name, part, k, u, v)
    return checked


@pytest.mark.parametrize("k", MODULI[1::2])
@pytest.mark.parametrize(("u", "v"), [("-4.1-1.3i", "0.2+0.7i"), ("1e-9+2.5i", "100.25-0.5i")])
def test_digits_of_every_column(k: str, u: str, v: str) -> None:
    cells = row(k, parse_complex(u), parse_complex(v), digits=20, is_real=False)
    assert check(cells, k, u, v, 20) >= 34


@pytest.mark.parametrize("k", ["0.5", "0.95i", "2"])
@pytest.mark.parametrize(
    ("u", "v"), [("0.9i", "1.3"), ("1.1i", "0.6i"), ("-0.3+0.7i", "-0.3-0.7i")]
)
def test_digits_on_the_axes(k: str, u: str, v: str) -> None:
    """Arguments, or their sum and difference, are real or imaginary; a printed 0 is a 0."""
    cells = row(k, parse_complex(u), parse_complex(v), digits=20, is_real=False)
    assert check(cells, k, u, v, 20) >= 34


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


@pytest.mark.slow
@pytest.mark.parametrize("k", MODULI)
def test_digits_of_every_column_anywhere(k: str) -> None:
    """Real and imaginary numbers, and numbers of any size, among others."""
    rng = random.Random(f"every {k}")

    def some() -> str:
        real, imag = (f"{rng.uniform(-1, 1) * 10 ** rng.uniform(-3, 1.5):.6f}" for _ in range(2))
        return rng.choice([f"{real}+{imag}i".replace("+-", "-"), real, f"{imag}i"])

    for _ in range(8):
        u, v = some(), some()
        cells = row(k, parse_complex(u), parse_complex(v), digits=25, is_real=False)
        assert check(cells, k, u, v, 25) >= 30


def half_periods(k: str) -> list[tuple[str, str]]:
    """Return the doubles next to K, iK', K + iK', 3K and x + iK' in the period lattice of k."""
    reference = Reference(k, 40)
    K, height = (x / reference.stretch for x in (reference.K, reference.K_prime))
    places = [(K, 0), (0, height), (K, height), (3 * K, 0), (0.3, height)]
    return [(repr(float(x)), repr(float(y))) for x, y in places]


def assert_doubles(k: str, u: str, v: str) -> None:
    """Check that Omega and Pi are the doubles next to those of the reference."""
    reference, z = Reference(k, 60), [parse_complex(x).nearest() for x in (u, v)]
    first, second = (reference.ar.mpc(*(reference.ar.mpf(float(x)) for x in y)) for y in z)
    cells = row(k, z[0], z[1], ("omega", "pi"), is_real=False)
    for name, exact in columns(reference, first, second, ("omega", "pi")).items():
        found = complex(float(cells[f"{name}_re"]), float(cells[f"{name}_im"]))
        assert found == complex(exact), (name, k, u, v)


@pytest.mark.parametrize("k", MODULI)
@pytest.mark.parametrize("place", [1, 2, 4])
def test_parameters_next_to_half_periods(k: str, place: int) -> None:
    """All digits were wrong for many of these in an earlier version."""
    real, imag = half_periods(k)[place]
    assert_doubles(k, "0.3+0.2i", f"{real}+{imag}i")


@pytest.mark.slow
@pytest.mark.parametrize("k", MODULI)
def test_numbers_next_to_half_periods(k: str) -> None:
    """Take arguments there as well, and the doubles on both sides."""
    for real, imag in half_periods(k):
        for towards in (-math.inf, 0.0, math.inf):
            x, y = (math.nextafter(float(text), towards) for text in (real, imag))
            for u in ("0.3+0.2i", "-2.7+3.1i"):
                assert_doubles(k, u, f"{x!r}+{y!r}i".replace("+-", "-"))
            assert_doubles(k, f"{x!r}+{y!r}i".replace("+-", "-"), "0.4-0.9i")


@pytest.mark.parametrize(("k", "K"), [("0.8", "1.9953027776647294"), ("0.3", "1.6080486199305128")])
def test_real_functions_are_parts_of_the_complex_ones(k: str, K: str) -> None:
    """The parameters are real or imaginary, and next to K."""
    families = ("omega", "pi")
    for u in ("0.3", K, "-17.25"):
        for v in ("0.7", K, "-1.3i"):
            argument, parameter = parse_complex(u).nearest(), parse_complex(v).nearest()
            real = row(k, argument, parameter, families, imaginary=v.endswith("i"))
            both = row(k, argument, parameter, families, is_real=False)
            for name, cell in real.items():
                part = "im" if name.endswith("_imag") else "re"
                assert cell == both[f"{name.removesuffix('_imag')}_{part}"], (name, u, v)


def test_the_side_of_a_line_of_zeros_is_decided() -> None:
    """Omega01 jumps by i pi where Im(u - v) passes K', however close to K' the number is."""
    found = []
    for below in ("1e-6", "1e-45", "-1e-45", "-1e-6"):
        with mpmath.workdps(80):
            height = mpmath.ellipk(mpmath.mpf("0.36")) * (1 - mpmath.mpf(below))
            u = parse_complex(f"0.1+{mpmath.nstr(height, 60)}i")
        cells = row("0.8", u, parse_complex("0.3"), ("omega",), 4, is_real=False)
        found.append(float(cells["omega01_im"]))
    assert found[0] == found[1] == pytest.approx(found[2] - math.pi, abs=1e-3)
    assert found[2] == found[3]


@pytest.mark.parametrize(("k", "v"), [("0.8", "0.4+0.9i"), ("0.8i", "0.4-3i"), ("1.5", "0.4-3i")])
def test_the_branch_has_no_jumps_between_lines_of_zeros(k: str, v: str) -> None:
    """Along the real direction nothing jumps, in any strip."""
    for height in ("0", "1.3", "-2.1", "7.7"):
        steps = [parse_complex(f"{x / 16}+{height}i".replace("+-", "-")) for x in range(-24, 25)]
        rows = [row(k, u, parse_complex(v), ("omega",), is_real=False) for u in steps]
        for name in ("omega01_im", "omega00_im", "omega11_im"):
            values = [float(cells[name]) for cells in rows]
            assert max(abs(b - a) for a, b in pairwise(values)) < 1.5


# Limits for k -> 0 and k -> 1, of relative errors q and q' (U, V: arguments times pi/2K').


def _circular(q: Any, u: Any, v: Any) -> dict[str, Any]:
    sin, cos, cot = mpmath.sin, mpmath.cos, mpmath.cot
    wave = 4 * q * sin(2 * v) * u
    third = wave - 2 * q * sin(2 * u) * sin(2 * v)
    return {
        "sn": sin(u),
        "cn": cos(u),
        "theta11": 2 * q ** mpmath.mpf("0.25") * sin(u),
        "zeta01": 4 * q * sin(2 * u),
        "zeta11": cot(u),
        "omega01": -2 * q * sin(2 * u) * sin(2 * v),
        "omega11": mpmath.log(abs(sin(u - v) / sin(u + v))) / 2,
        "pi01": third,
        "pi00": -third,
        "pi11": u * cot(v) + mpmath.log(abs(sin(u - v) / sin(u + v))) / 2,
    }


def _hyperbolic(q: Any, u: Any, v: Any) -> dict[str, Any]:
    sinh, cosh, tanh = mpmath.sinh, mpmath.cosh, mpmath.tanh
    K = -mpmath.log(q) / 2
    odd = mpmath.log(abs(sinh(u - v) / sinh(u + v))) / 2
    even = mpmath.log(cosh(u - v) / cosh(u + v)) / 2
    return {
        "sn": tanh(u),
        "cn": 1 / cosh(u),
        "dn": 1 / cosh(u),
        "zeta01": tanh(u) - u / K,
        "zeta00": -u / K,
        "omega00": u * v / K,
        "omega01": u * v / K + even,
        "omega11": u * v / K + odd,
        "pi01": u * tanh(v) + even,
        "pi00": 4 * q * u * sinh(2 * v) - 2 * q * sinh(2 * u) * sinh(2 * v),
        "pi11": u / tanh(v) + odd,
    }


def number(text: str) -> Any:
    """Return a number whose exponent may have many digits."""
    mantissa, _, exponent = text.partition("e")
    return mpmath.mpf(mantissa) * mpmath.mpf(10) ** int(exponent or 0)


EXTREME: dict[str, tuple[Any, Any]] = {
    "k 1e-200": (_circular, lambda: (mpmath.mpf("1e-200") / 4) ** 2),
    "k-prime 1e-300": (_hyperbolic, lambda: (mpmath.mpf("1e-300") / 4) ** 2),
    "nome 0.999999": (
        _hyperbolic,
        lambda: mpmath.exp(mpmath.pi**2 / mpmath.log(mpmath.mpf("0.999999"))),
    ),
    "nome 0.9999999999999": (
        _hyperbolic,
        lambda: mpmath.exp(mpmath.pi**2 / mpmath.log(mpmath.mpf("0.9999999999999"))),
    ),
}


@pytest.mark.parametrize("modulus", EXTREME)
@pytest.mark.parametrize(("u", "v"), [("0.5", "0.3"), ("-1.25", "2.75"), ("1e-5", "0.125")])
def test_extreme_moduli(modulus: str, u: str, v: str) -> None:
    """Pi00 is as small as 1e-42863147299611, with all its digits."""
    name, value = modulus.split()
    limit, nome = EXTREME[modulus]
    given = ModulusInput(name.replace("-", "_"), Fraction(value))
    cells = row(given, parse_complex(u), parse_complex(v), digits=40)
    with mpmath.workdps(90):
        for column, exact in limit(nome(), mpmath.mpf(u), mpmath.mpf(v)).items():
            assert abs(number(cells[column]) - exact) <= abs(exact) * 5.001e-40, column
    doubles = row(given, parse_complex(u), parse_complex(v))
    with mpmath.workdps(60):
        for column, text in cells.items():
            assert doubles[column] == "" or float(doubles[column]) == pytest.approx(
                float(number(text)), rel=1e-15, abs=5e-324
            )


@pytest.mark.parametrize(("k", "factor"), [("1e-160", 1e-80), ("1e-300", 1e-150)])
def test_odd_thetas_keep_their_digits_where_the_nome_leaves_the_doubles(
    k: str, factor: float
) -> None:
    """q^(1/4) = sqrt(k)/2 there, while q itself is 0 in doubles."""
    cells = row(k, parse_complex("1"), families=("theta",))
    assert float(cells["theta11"]) == pytest.approx(factor * math.sin(1), rel=1e-15, abs=0)
    assert float(cells["theta10"]) == pytest.approx(factor * math.cos(1), rel=1e-15, abs=0)


@pytest.mark.parametrize("u", ["0.7", "-3.25+0.5i", "25"])
def test_moduli_0_and_1(u: str) -> None:
    """Circular and hyperbolic functions; am is u, or the Gudermannian of u."""
    argument = parse_complex(u)
    with mpmath.workdps(50):
        z = mpmath.mpc(mpmath.mpf(str(float(argument.real))), float(argument.imag))
        circular = z, mpmath.sin(z), mpmath.cos(z), mpmath.mpf(1)
        sech = 1 / mpmath.cosh(z)
        hyperbolic = mpmath.atan(mpmath.sinh(z)), mpmath.tanh(z), sech, sech
        for k, values in (("0", circular), ("1", hyperbolic)):
            cells = row(k, argument, families=("am",), digits=25, is_real=False)
            for name, exact in zip(("am_rad", "sn", "cn", "dn"), values, strict=True):
                found = mpmath.mpc(cells[f"{name}_re"], cells[f"{name}_im"])
                assert abs(found - exact) <= abs(exact) * 1e-24, (k, name)


@pytest.mark.parametrize("u", ["1e25", "1e300"])
def test_arguments_far_away(u: str) -> None:
    """The precision grows with the argument; two that are too low could agree on a wrong number."""
    cells = row("0.5", parse_complex(u), families=("am",), digits=12)
    with mpmath.workdps(400):
        exact = mpmath.ellipfun("sn", mpmath.mpf(u), m=mpmath.mpf("0.25"))
        am = mpmath.mpf(u) * mpmath.pi / (2 * mpmath.ellipk(mpmath.mpf("0.25")))
    assert float(cells["sn"]) == pytest.approx(float(exact), rel=1e-11)
    assert float(cells["am_rad"]) == pytest.approx(float(am), rel=1e-11)


def test_far_parameters() -> None:
    """Pi of the parameter 1e300 is that of the parameter less whole periods."""
    cells = row("0.5", parse_complex("1"), parse_complex("1e300"), ("pi",), 20)
    with mpmath.workdps(700):
        period = 2 * mpmath.ellipk(mpmath.mpf("0.25"))
        v = mpmath.mpf("1e300")
        near = Fraction(mpmath.nstr(v - period * mpmath.nint(v / period), 60))
    near_cells = row("0.5", parse_complex("1"), ExactComplex(near), ("pi",), 20)
    assert cells == near_cells


@pytest.mark.parametrize(("k", "height"), [("0.8", 1.75075), ("0.8i", 1.5307), ("0", math.inf)])
def test_am_ends_at_its_branch_points(k: str, height: float) -> None:
    """They are the poles of sn next to the real axis, at Im u = Re K'."""
    for part, exists in ((0.999, True), (1.001, False)):
        imag = Fraction(part * height) if height < math.inf else Fraction(500)
        cells = row(k, ExactComplex(Fraction(7), imag), families=("am",), is_real=False)
        assert bool(cells["am_rad_re"]) is (exists or k == "0")


def test_threads_and_the_precision_of_the_host() -> None:
    """Rows from eight threads, with other moduli and digits each, are those of one thread."""

    def rows(i: int) -> list[Cells]:
        u, v = parse_complex(f"0.{i}1+0.3i"), parse_complex("0.2+0.7i")
        return [row(k, u, v, digits=20 * i or None, is_real=False) for k in MODULI[i : i + 2]]

    before, ctx.prec = ctx.prec, 77
    try:
        serial = list(map(rows, range(8)))
        with ThreadPoolExecutor(8) as pool:
            assert list(pool.map(rows, range(8))) == serial
        assert ctx.prec == 77
    finally:
        ctx.prec = before
