"""`lagtop jacobi`: columns, exact zeros and poles, multiples of K, constants, input."""

from __future__ import annotations

import json
from typing import Any

import mpmath
import pytest
from conftest import Lagtop
from function_reference import cells_of

DIGITS = pytest.mark.parametrize("digits", ["", " --digits 20"])


def cells(lagtop: Lagtop, args: str) -> dict[str, list[str]]:
    """Return the cells of a table by column, in doubles unless the words say digits."""
    return cells_of(lagtop, *args.split(), digits=None)


@DIGITS
@pytest.mark.parametrize(
    ("modulus", "parameter"), [("--k 0.3", "0.4"), ("--k-prime 1e-9", "0.4i"), ("--nome 0.2", "0")]
)
def test_zeros_and_poles_at_whole_quarters(
    digits: str, modulus: str, parameter: str, lagtop: Lagtop
) -> None:
    """No other cell there is 0 or empty."""
    args = f"{modulus} --u=-3K:3K:7 --functions am,theta,zeta,omega,pi --param {parameter}{digits}"
    even, odd = [1, 3, 5], [0, 2, 4, 6]
    imaginary, zero = parameter.endswith("i"), parameter == "0"
    zeros: dict[str, Any] = {
        **{"theta11": even, "theta10": odd, "zeta10": even, "zeta11": odd},
        **dict.fromkeys(("zeta01", "zeta00", "omega01", "omega00"), range(7)),
        "omega11": [4] if imaginary else [i for i in range(7) if not (zero and i == 3)],
        **dict.fromkeys(("pi01", "pi00"), range(7) if zero else [3]),
        "pi11": [] if imaginary or zero else [3],
        **{"sn": even, "cn": odd, "u": [3], "am_deg": [3]},
    }
    poles = {"zeta11": even, "zeta10": odd, "pi11": range(7) if zero else []}
    poles["omega11"] = [3] if zero else []  # the quotient of two zeros
    for column, found in cells(lagtop, args).items():
        name = column.removesuffix("_imag")
        assert [i for i, x in enumerate(found) if x == "0.0"] == list(zeros.get(name, [])), name
        assert [i for i, x in enumerate(found) if not x] == list(poles.get(name, [])), name


@DIGITS
def test_poles_and_zeros_of_complex_numbers(digits: str, lagtop: Lagtop) -> None:
    found = cells(lagtop, f"--k 0.5 --u 0,1+i,-1-i,9i --functions am,zeta,pi --param 1+i{digits}")
    empty = {"pi11_re": [1, 2], "zeta11_im": [0], "am_deg_re": [3]}
    for name, where in empty.items():
        assert [i for i, x in enumerate(found[name]) if not x] == where, name
    assert (found["sn_re"][0], found["pi01_im"][0], found["sn_re"][3]) == ("0.0", "0.0", "0.0")


def test_the_constants_of_a_complex_modulus_have_parts(lagtop: Lagtop) -> None:
    assert "Re K'" in lagtop("jacobi", "--k", "0.8i").stdout


def test_a_nome_next_to_1(lagtop: Lagtop) -> None:
    """K is pi/2 theta3^2: -pi^2/(2 log q) but for a term as small as k'^2."""
    nome = f"0.{'9' * 16}"
    args = ["--nome", nome, "--digits", "30", "--format", "json"]
    shown = json.loads(lagtop("jacobi", *args).stdout, parse_float=str)
    with mpmath.workdps(60):
        K = -(mpmath.pi**2) / (2 * mpmath.log(mpmath.mpf(nome)))
        assert abs(mpmath.mpf(shown["K"]) / K - 1) < 1e-29
        mantissa, exponent = shown["nome_prime"].split("e")
        size = mpmath.mpf(mantissa) * mpmath.mpf(10) ** int(exponent)
        assert abs(size / mpmath.exp(-2 * K) - 1) < 1e-29
