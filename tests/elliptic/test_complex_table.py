"""`lagtop jacobi` of complex numbers, of imaginary moduli and of those above 1."""

from __future__ import annotations

import json
import math
import random
from decimal import Decimal
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from arb_balls import exact_arb
from conftest import Lagtop
from flint import arb
from function_judge import STEPS, ComplexJudge, complex_units
from lagtop import LagtopError

from lagrange_cli.arithmetic.points import parse_complex

EVERYTHING = "--functions am,theta,zeta,omega,pi --param 0.2+0.7i --format json"


@pytest.mark.parametrize(
    ("text", "value"),
    [
        ("0.3", 0.3),
        ("i", 1j),
        ("-i", -1j),
        ("0.7i", 0.7j),
        ("-0.5+i", -0.5 + 1j),
        ("1e-3-2e-4i", 0.001 - 0.0002j),
        ("-1e+3i", -1000j),
    ],
)
def test_complex_numbers_are_read(text: str, value: complex) -> None:
    assert complex(parse_complex(text)) == value


@pytest.mark.parametrize("text", ["0.3+-0.7i", "xi", "0.3+0.7j", "1i2i", "0.3+0.7ii", "1e400i", ""])
def test_other_texts_are_refused(text: str) -> None:
    with pytest.raises(LagtopError, match="must be"):
        parse_complex(text)


@pytest.mark.parametrize("option", ["--u", "--k", "--param"])
@pytest.mark.parametrize("text", ["1+2j", "0.7i+0.3", "2Ki", "0.3 + 0.7i", "1+I", "0.3+infi"])
def test_odd_spellings_are_told_the_right_one(option: str, text: str, lagtop: Lagtop) -> None:
    """The line names all of the text, as it was typed, and the right spelling."""
    given = {"--k": "0.8", "--u": "1", "--param": "0.3"} | {option: text}
    result = lagtop(
        "jacobi", "--functions", "pi", *(word for pair in given.items() for word in pair)
    )
    assert (result.exit_code, result.stdout) == (2, "")
    line = f"Error: {option} must be a finite number, complex as 0.3+0.7i, got {text!r}\n"
    assert result.stderr == line


def test_a_flag_of_a_function_means_its_name(lagtop: Lagtop) -> None:
    """Flags and --functions add to each other; --phi excludes both."""
    given = ["jacobi", "--k", "0.7", "--u=-6.6+0.7i", "--param=8.5+0.7i", "--format", "csv"]
    named = lagtop(*given, "--functions", "theta,zeta,omega")
    flags = lagtop(*given, "--omega", "--zeta", "--functions", "theta")
    assert named.stdout
    assert flags.stdout == named.stdout
    omega = json.loads(lagtop(*given[:-1], "json", "--omega").stdout)[0]["omega11_im"]
    assert omega == pytest.approx(0.0200677814681204, rel=1e-14)  # by mpmath
    refused = lagtop("jacobi", "--k", "0.7", "--phi", "30", "--omega")
    assert (refused.exit_code, refused.stderr) == (2, "Error: use --phi or --functions, not both\n")


@pytest.mark.parametrize(
    ("options", "row"),
    [
        ("--u 0.25 --digits 1", "0.2,0.2,0.2,1.0,1.0"),
        ("--u 12345 --digits 4", "12340.0,12340.0,-0.9938,0.1114,1.0"),
        ("--phi 0.25 --digits 1", "0.2,0.2,0.2"),
        ("--u 0.25+1i --digits 1", "0.2,1.0,0.2,1.0,0.4,1.0,1.0,-0.3,1.0,0.0"),
        ("--u 1+2.5i --digits 1", "1.0,2.0,1.0,2.0,5.0,3.0,3.0,-5.0,1.0,0.0"),
    ],
)
def test_am_at_k_0_is_u_also_midway(options: str, row: str, lagtop: Lagtop) -> None:
    """Midway between two roundings, only the exact value decides: the even digit is printed."""
    result = lagtop("jacobi", "--k", "0", "--rad", "--format", "csv", *options.split())
    assert result.stdout.splitlines()[1:] == [row]


@pytest.mark.parametrize("options", ["--k 0 --u 1e19i", "--k 1 --u 1e19+0.5i"])
def test_sizes_beyond_decimals_are_refused(options: str, lagtop: Lagtop) -> None:
    result = lagtop("jacobi", *options.split(), "--digits", "10")
    assert (result.exit_code, result.stdout) == (2, "")
    assert "1e+990000000000000000, the limits of --digits" in result.stderr


def complex_cells(row: dict[str, Any]) -> dict[str, complex]:
    """Return the columns of a row with both parts, which may be numbers or texts."""
    return {
        name.removesuffix("_re"): complex(float(row[name]), float(row[f"{name[:-3]}_im"]))
        for name in row
        if name.endswith("_re") and row[name] is not None
    }


LONG = "0.71828182845904523536028747135266249775724709369995"


@pytest.mark.parametrize("k", ["0.3", "0.95", "0.8i", "1.5"])
@pytest.mark.parametrize(
    ("u", "v"),
    [
        ("-4.1-1.3i", "0.2+0.7i"),
        ("1e-9+2.5i", "1000.25-0.5i"),
        (f"0.3+{LONG}i", f"-1.4+{LONG}i"),
        (f"-{LONG}+0.4i", f"{LONG}-2i"),
    ],
)
def test_all_digits_of_every_column(k: str, u: str, v: str, lagtop: Lagtop) -> None:
    """Each is rounded from Arb's; equal parts of u and v put u - v or u + v on an axis."""
    args = f"jacobi --k {k} --rad --u={u} --param={v} --digits 25 --format json"
    shown = lagtop(*args.split(), "--functions", "am,theta,zeta,omega,pi").stdout
    (row,) = json.loads(shown, parse_float=str)
    judge, names = ComplexJudge(parse_complex(k)), set()  # type: ignore[arg-type]
    for name, exact in judge.columns(parse_complex(u), parse_complex(v)):  # type: ignore[arg-type]
        column, step = f"{name}_rad" if name == "am" else name, STEPS.get(name.rstrip("01"), 0)
        for part in ("real", "imag"):
            text = row[f"{column}_{part[:2]}"]
            error = exact_arb(text or 0) - getattr(exact.value, part)
            if turn := getattr(complex(step), part):
                whole = arb.pi() * round(turn / math.pi)
                error -= whole * (error / whole + exact_arb("0.5")).floor()
            if text is not None:
                names.add(column)
                unit = Decimal(f"1e{Decimal(text).adjusted() - 24}")
                assert abs(error) < exact_arb(unit) * 0.500001, (column, part)
    assert len(names) >= 14


def test_the_side_of_a_line_of_zeros_is_decided(lagtop: Lagtop) -> None:
    """Omega01 jumps by i pi where Im(u - v) passes K', however close to K' the number is."""
    found = []
    for below in ("1e-6", "1e-45", "-1e-45", "-1e-6"):
        with mpmath.workdps(80):
            height = mpmath.ellipk(mpmath.mpf("0.36")) * (1 - mpmath.mpf(below))
            u = f"0.1+{mpmath.nstr(height, 60)}i"
        args = f"jacobi --k 0.8 --u {u} --param 0.3 --functions omega --digits 4 --format json"
        found.append(json.loads(lagtop(*args.split()).stdout)[0]["omega01_im"])
    assert found[0] == found[1] == pytest.approx(found[2] - math.pi, abs=1e-3)
    assert found[2] == found[3]


@pytest.mark.slow
@pytest.mark.parametrize("k", ["0.8", "0.8i", "1.5"])
def test_every_column(k: str, lagtop: Lagtop) -> None:
    args = f"jacobi --k {k} --rad --u 0.3+0.7i,-4-1i {EVERYTHING}"
    rows = json.loads(lagtop(*args.split()).stdout)
    many = json.loads(lagtop(*args.split(), "--digits", "20").stdout)
    judge = ComplexJudge(complex(parse_complex(k)))
    for u, row, digits in zip((0.3 + 0.7j, -4 - 1j), rows, many, strict=True):
        cells, exactly = complex_cells(row), complex_cells(digits)
        assert cells["u"] == u
        for name, exact in judge.columns(u, 0.2 + 0.7j):
            column = f"{name}_rad" if name == "am" else name
            if column not in cells:
                assert exactly.keys() == cells.keys()
                continue
            assert complex_units(name, cells[column], exact) <= 4, name
            assert exactly[column] == pytest.approx(cells[column], rel=1e-14, abs=1e-15)


def test_constants(lagtop: Lagtop) -> None:
    """The nearest doubles to what mpmath has, on its side of the cuts."""
    for text, square in (("0.8i", "-0.64"), ("1.5", "2.25")):
        record = json.loads(lagtop("jacobi", "--k", text, "--format", "json").stdout)
        with mpmath.workdps(40):
            m = mpmath.mpf(square)
            exact = {"K": mpmath.ellipk(m), "K_prime": mpmath.ellipk(1 - m), "E": mpmath.ellipe(m)}
        for name, value in exact.items():
            found = complex(record[f"{name}_re"], record[f"{name}_im"])
            assert found == complex(value)
    assert "Re K'" in lagtop("jacobi", "--k", "0.8i").stdout


@pytest.mark.slow
def test_digits_are_right(lagtop: Lagtop) -> None:
    """All of those printed, of sn, against mpmath."""
    rng = random.Random("digits")
    for _ in range(3):
        u = f"{rng.uniform(-3, 3):.4f}{rng.uniform(-2, 2):+.4f}i"
        args = f"jacobi --k 0.8i --u={u} --digits 30 --format json"
        row = json.loads(lagtop(*args.split(), "--functions", "am,theta").stdout, parse_float=str)[
            0
        ]
        with mpmath.workdps(50):
            real, imag = (mpmath.mpf(str(part)) for part in map(_decimal, parse_complex(u)))
            exact = mpmath.ellipfun("sn", mpmath.mpc(real, imag), m=-mpmath.mpf("0.64"))
            shown = mpmath.mpc(row["sn_re"], row["sn_im"])
            assert abs(shown.real / exact.real - 1) < 5e-30
            assert abs(shown.imag / exact.imag - 1) < 5e-30


def _decimal(exact: Fraction) -> Any:
    return mpmath.mpf(exact.numerator) / exact.denominator


DIGITS = ["--digits", "30"]


@pytest.mark.parametrize("k", ["5.874862083807e18i", "2i", "2", "0.5"])
def test_the_quotient_of_two_zeros_is_no_number(k: str, lagtop: Lagtop) -> None:
    """Omega11 of u = v = 0 was looked for in thousands of digits, as a number that is not 0."""
    args = f"jacobi --k {k} --u 0+0i --functions omega,pi --param 0 --format json"
    plain, many = (json.loads(lagtop(*args.split(), *more).stdout) for more in ([], DIGITS))
    assert [*plain[0].values()] == [*many[0].values()]
    assert {key for key, x in many[0].items() if x is None} == {
        *("omega11_re", "omega11_im", "pi11_re", "pi11_im")
    }


@pytest.mark.parametrize("digits", ["", " --digits 12"])
def test_poles_and_zeros(digits: str, lagtop: Lagtop) -> None:
    args = f"jacobi --k 0.5 --u 0,1+i,-1-i,9i --functions am,zeta,pi --param 1+i{digits}"
    rows = json.loads(lagtop(*args.split(), "--format", "json").stdout)
    assert [row["pi11_re"] is None for row in rows] == [False, True, True, False]
    assert [row["zeta11_im"] is None for row in rows] == [True, False, False, False]
    assert [row["am_deg_re"] is None for row in rows] == [False, False, False, True]
    assert (rows[0]["sn_re"], rows[0]["pi01_im"], rows[3]["sn_re"]) == (0, 0, 0)


def exact_third(tau: mpmath.mpc, K: mpmath.mpf, u: complex, v: complex) -> dict[str, mpmath.mpc]:
    """Return Omega and Pi, but for half turns, of mpmath's theta functions."""
    found = {}
    for ij, n in (("01", 4), ("00", 3), ("11", 1)):

        def theta(z: complex, order: int = 0, n: int = n) -> mpmath.mpc:
            zeta, q = mpmath.pi * z / (2 * K), mpmath.exp(1j * mpmath.pi * tau)
            return mpmath.jtheta(n, zeta, q, order) * (mpmath.pi / (2 * K)) ** order

        found[f"omega{ij}"] = mpmath.log(theta(u - v) / theta(u + v)) / 2
        found[f"pi{ij}"] = found[f"omega{ij}"] + u * theta(v, 1) / theta(v)
    return found


@pytest.mark.slow
@pytest.mark.parametrize(
    ("modulus", "u", "v", "zeros"),
    [
        ("--k 0.8", "0.3+0.7i", "0.3-0.7i", "omega01_im omega00_im"),
        ("--k 0.8", "0.3+0.7i", "-0.3+0.7i", "omega01_im omega00_im"),
        ("--k 0.8i", "0.25-0.5i", "0.25+0.5i", "omega01_im omega00_im"),
        ("--k 0.8", "5.5+1i", "5.5-1i", "omega00_im"),
        ("--k i", "1+i", "0.25+0.25i", "pi01_im pi11_im"),
        ("--k i", "1+i", "0.25-0.25i", "pi01_re pi11_re"),
        ("--modular-angle 45", "1-i", "-0.25+0.25i", "pi00_im pi11_im"),
        ("--modular-angle 45", "-0.5-0.5i", "0.25-0.25i", "pi00_re pi11_re"),
        ("--modular-angle 45", "0.5+0.5i", "0.5-0.5i", "omega01_im omega00_im pi00_re pi11_re"),
        ("--modular-angle 46", "1-i", "-0.25+0.25i", ""),
    ],
)
def test_zeros_by_symmetry(modulus: str, u: str, v: str, zeros: str, lagtop: Lagtop) -> None:
    """Parts that are 0 by a symmetry are printed as 0, and nothing else is."""
    args = f"jacobi {modulus} --u={u} --functions omega,pi --param={v} --digits 9 --format json"
    row = json.loads(lagtop(*args.split()).stdout)[0]
    third = {name: row[name] for name in row if name[:2] in {"om", "pi"}}
    assert {name for name in third if not third[name]} == set(zeros.split())
    with mpmath.workdps(30):
        name, value = modulus.split()
        angle = mpmath.radians(float(value)) if name == "--modular-angle" else None
        m = mpmath.sin(angle) ** 2 if angle else mpmath.re(complex(parse_complex(value)) ** 2)
        m = mpmath.nint(m * 100) / 100 if angle is None else m
        K, K_prime = mpmath.ellipk(m), mpmath.ellipk(1 - m)
        exact = exact_third(1j * K_prime / K, K, *map(complex, map(parse_complex, (u, v))))
        for name, z in exact.items():
            difference = mpmath.mpc(third[f"{name}_re"], third[f"{name}_im"]) - z
            turns = mpmath.nint(difference.imag / mpmath.pi)
            assert abs(difference - 1j * mpmath.pi * turns) < 2e-8


def test_real_input_prints_what_it_did(lagtop: Lagtop) -> None:
    shown = lagtop(*"jacobi --k 0.5 --u 0.3 --functions pi --param 0i --format csv".split()).stdout
    assert shown.splitlines()[0] == "u,pi01_imag,pi00_imag,pi11_imag"
