"""The functions of `lagtop jacobi`: every digit against mpmath by other formulas.

`function_reference.py` has the formulas of the reference.  Extreme moduli are compared with the
limits of the functions, whose next terms are far below the digits.
"""

from __future__ import annotations

from decimal import Decimal
from fractions import Fraction
from itertools import product
from typing import Any

import mpmath
import pytest
from function_reference import NUMBER, Reference

from lagrange_cli.elliptic.arguments import Arguments, ExactComplex, parse_complex
from lagrange_cli.elliptic.function_table import FunctionRequest, function_rows
from lagrange_cli.elliptic.modulus import GivenModulus
from lagrange_cli.top.ranges import ListedPoints
from lagrange_cli.top.units import RADIANS

EVERY = ("am", "theta", "zeta", "omega", "pi")
MODULI = ["0.3", "0.8", "0.95", "0.999", "0.7071067811865476", "0.05i", "0.8i", "20i", "1.01", "2"]
JACOBI = ("am_rad", "sn", "cn", "dn")
THIRD = ("01", "00", "11")
Number = ExactComplex | str
Cells = dict[str, str]


def row(
    k: str,
    u: Number,
    v: Number = "0",
    families: tuple[str, ...] = EVERY,
    digits: int | None = None,
    *,
    is_real: bool = False,
) -> Cells:
    """Return the row of an argument; numbers may be given by their texts."""
    first, second = (parse_complex(x) if isinstance(x, str) else x for x in (u, v))
    imag = None if is_real else ListedPoints([first.imag])
    arguments, modulus = Arguments(ListedPoints([first.real]), imag), parse_complex(k)
    request = FunctionRequest(
        arguments, GivenModulus("k", modulus), families, second, units=RADIANS
    )
    header, (((cells,),)) = function_rows(request, digits)
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


ANYWHERE = [("-4.1-1.3i", "0.2+0.7i"), ("1e-9+2.5i", "100.25-0.5i")]
ON_THE_AXES = [("0.9i", "1.3"), ("1.1i", "0.6i"), ("-0.3+0.7i", "-0.3-0.7i")]
"""Arguments, or their sum and difference, are real or imaginary; a printed 0 is a 0."""


@pytest.mark.parametrize(
    ("k", "numbers", "more"),
    [
        *product(MODULI[1::2], ANYWHERE, [25]),
        *product(["0.5", "0.95i", "2"], ON_THE_AXES, [25]),
        ("1e-200", ("0.5+0.1i", "-1.25+0.3i"), 500),
        (f"0.{'9' * 20}", ("0.5+0.1i", "-1.25+0.3i"), 60),
    ],
)
def test_digits_of_every_column(k: str, numbers: tuple[str, str], more: int) -> None:
    """Every cell is the number of the reference, which has `more` digits, rounded to 20 digits."""
    (u, v), digits = numbers, 20
    cells, reference = row(k, u, v, digits=digits), Reference(k, digits + more)
    ar, checked = reference.ar, 0
    first, second = (
        ar.mpc(*(ar.mpf(x.numerator) / x.denominator for x in parse_complex(z)[:2])) for z in (u, v)
    )
    for name, exact in columns(reference, first, second, EVERY).items():
        for part in ("re", "im"):
            text = cells[f"{name}_{part}"]
            assert exact is not None or text == ""
            if text:
                checked += 1
                unit = ar.mpf(10) ** (Decimal(text).adjusted() - digits + 1)
                slack = ar.mpf("0.500001") * unit if Decimal(text) else ar.mpf("1e-30")
                away = ar.mpf(text) - (ar.re(exact) if part == "re" else ar.im(exact))
                assert abs(away) <= slack, (name, part, k, u, v)
    assert checked >= 30


@pytest.mark.parametrize("k", MODULI)
@pytest.mark.parametrize("place", [(0, 1), (1, 1), (0.3, 1)])
def test_parameters_next_to_half_periods(k: str, place: tuple[float, float]) -> None:
    """Take the doubles next to iK', K + iK' and 0.3 K + iK' in the period lattice of k."""
    reference = Reference(k, 60)
    ar, (x, y) = reference.ar, place
    v = (float(z / reference.stretch) for z in (x * reference.K, y * reference.K_prime))
    first, second = parse_complex("0.3+0.2i").nearest(), ExactComplex(*map(Fraction, v))
    cells = row(k, first, second, ("omega", "pi"))
    at = [ar.mpc(*(ar.mpf(float(part)) for part in z[:2])) for z in (first, second)]
    for name, exact in columns(reference, at[0], at[1], ("omega", "pi")).items():
        found = complex(float(cells[f"{name}_re"]), float(cells[f"{name}_im"]))
        assert found == complex(exact), (name, k)


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
