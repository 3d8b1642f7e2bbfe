"""eta(tau) by mpmath and its differential equation, in every layout, near every degeneracy."""

from __future__ import annotations

import json
import math
from collections.abc import Iterable, Sequence
from fractions import Fraction
from typing import Any

import mpmath
import pytest
from conftest import Lagtop

from lagrange_cli.elliptic.eta import Quadrature, eta_record, eta_rows
from lagrange_cli.top.ranges import ListedPoints
from lagrange_cli.top.units import RADIANS


def quadrature(
    lower: str, upper: str, outer: str = "", g: str = "1", height: str = "0"
) -> Quadrature:
    """Return the quadrature of roots that are written as decimals, the outer ones in one text."""
    roots = tuple(map(Fraction, outer.split()))
    return Quadrature(Fraction(lower), Fraction(upper), roots, Fraction(g), Fraction(height))


def rows_of(of: Quadrature, times: Iterable[Any], names: Sequence[str]) -> list[dict[str, float]]:
    """Return the rows of a table by column, the angle in radians."""
    header, blocks = eta_rows(ListedPoints(list(map(Fraction, times))), of, names, units=RADIANS)
    rows = (map(float, row) for block in blocks for row in block)
    return [dict(zip(header, row, strict=True)) for row in rows]


def big(x: Fraction) -> Any:
    """Return a fraction as a number of mpmath."""
    return mpmath.mpf(x.numerator) / x.denominator


def is_nearest(value: float, exact: Any) -> bool:
    """Return whether a double is next to a number of mpmath, known to 1e-25."""
    return bool(abs(mpmath.mpf(value) - exact) <= mpmath.mpf("0.501") * math.ulp(value) + 1e-25)


ORBITS = {
    "generic": quadrature("-0.5", "0.6", "-1.3 1.5"),
    "Earth-like": quadrature("-0.9", "0.9", "-33 33.1"),
    "narrow band": quadrature("0.3", "0.300000000001", "-1 1.2"),
    "outer root close above": quadrature("-0.2", "0.7", "-1.5 0.700000000001"),
    "outer root close below": quadrature("-0.2", "0.7", "-0.200000000001 2"),
    "1 - k1 = 1e-12": quadrature("-1", "1", "-1.00000000000025 1.00000000000025", "0.7"),
    "both above": quadrature("-0.5", "0.5", "0.8 3"),
    "both below": quadrature("0.1", "0.5", "-4 0.05"),
    "cubic, root above": quadrature("0.277", "0.866", "1.29", "319.09"),
    "cubic, root below": quadrature("-0.1", "0.8", "-0.4"),
    "complex pair inside": quadrature("-0.5", "0.6", "0.1 0.1", "2", "0.7"),
    "complex pair above": quadrature("-0.5", "0.6", "3 3", "1", "0.01"),
    "complex pair below": quadrature("0.5", "0.6", "-2 -2", "1", "9"),
    "complex pair close to the band": quadrature("-0.5", "0.6", "0.2 0.2", "1", "1e-6"),
    "complex pair close to an end": quadrature("-0.5", "0.6", "0.6 0.6", "1", "1e-9"),
    "complex pair at the band": quadrature("-0.5", "0.6", "0.1 0.1", "1", "1e-60"),
    "complex pair far away": quadrature("-0.5", "0.6", "1e40 1e40", "1", "3"),
    "complex pair at a narrow band": quadrature("0.6", f"0.6{'0' * 38}1", "0.6 0.6", "1", "1e-50"),
    "quadratic": quadrature("-0.5", "0.7", g="0.3"),
    "equal outer roots": quadrature("-0.1", "0.8", "2 2"),
}
WITH_CHAIN = ("eta", "h1", "theta", "xi_prime")
PARTS = [1e-6, 0.21, 0.4999, 0.62, 3.3, -7.7]


@pytest.mark.parametrize("name", ORBITS)
def test_chain(name: str) -> None:
    """Every column by mpmath and (3.2.2), and the constants (3.2.3) to (3.2.12) from the roots.

    The differential equation of eta checks the formulas in each layout.  The constants cancel in
    300 digits.
    """
    of = ORBITS[name]
    with mpmath.workdps(300):
        lower, upper, g, height, *outer = map(big, (of.lower, of.upper, of.g, of.height, *of.outer))
        less, more = (
            mpmath.sqrt(abs(mpmath.fprod(end - root for root in outer)) + height**2)
            for end in (upper, lower)
        )
        width = upper - lower
        sign = 0 if len(outer) < 2 else 1 if of.layout == "one on each side" else -1
        k2 = (sign * width**2 + (less - more) ** 2) / (4 * less * more)
        m, sigma1 = k2 / (1 + k2), mpmath.sqrt(g * less * more * (1 + k2))
        K, total, part = mpmath.ellipk(m), less + more, "_imag" if height else ""
        exact = {
            **{"m_prime": less, "m_double_prime": more, "sigma1": sigma1, "K1": K},
            **{f"k{part}": mpmath.sqrt(abs(k2)), f"k1{part}": mpmath.sqrt(abs(m))},
            **{"period": 4 * K / sigma1, "tau3": -K / sigma1, "d": (more - less) / total},
            **{"k1_prime": 1 / mpmath.sqrt(1 + k2), "s": (more * upper - less * lower) / total},
            "gamma": (more * upper + less * lower) / total,
        }
        constants = eta_record(of, 30)
        for key, value in exact.items():
            away = abs(mpmath.mpf(constants[key]) - value)
            assert away <= 1e-29 * abs(value) + mpmath.mpf("1e-140"), key

        def eta_at(h1: Any) -> Any:
            xi = mpmath.re(mpmath.ellipfun("sn", h1, m=m))
            share = (less - more - (less + more) * xi) / ((less - more) * xi - less - more)
            return (upper + lower + width * share) / 2

        times = [Fraction(float(4 * K / sigma1) * part) for part in PARTS]
        for time, row in zip(times, rows_of(of, times, (*WITH_CHAIN, "etadot")), strict=True):
            h1 = sigma1 * big(time) - K
            turns = mpmath.nint(h1 / (2 * K))
            sn, cn = (mpmath.re(mpmath.ellipfun(f, h1 - 2 * turns * K, m=m)) for f in ("sn", "cn"))
            eta = eta_at(h1)
            product = abs(mpmath.fprod(eta - root for root in outer)) + height**2
            speed = mpmath.sqrt(g * (upper - eta) * (eta - lower) * product)
            slope = sigma1 * (eta_at(h1 + 1e-90) - eta_at(h1 - 1e-90)) / 2e-90
            assert abs(slope) == pytest.approx(speed, rel=1e-9, abs=1e-17)
            assert is_nearest(row["eta"], eta)
            assert is_nearest(row["etadot"], mpmath.sign(slope) * speed)
            assert is_nearest(row["h1"], h1)
            assert is_nearest(row["theta_rad"], mpmath.atan2(sn, cn) + turns * mpmath.pi)
            assert is_nearest(row["xi_prime"], sn * (-1) ** int(turns))


@pytest.mark.parametrize(
    ("outer", "kind"),
    [
        ("--p 0 --q 2", "quartic"),
        ("--p 3 --q 0", "quartic with a double outer root, k1 = 0: circular functions"),
        ("--p 3 --q 0i", "quartic with a double outer root, k1 = 0: circular functions"),
        ("--p 0.1 --q 2i", "quartic, k1 is imaginary"),
        ("--gap-above 1", "cubic"),
        ("", "quadratic, k1 = 0: a harmonic oscillation"),
    ],
)
def test_degenerate_radicands_are_named(lagtop: Lagtop, outer: str, kind: str) -> None:
    args = f"eta --delta 0.5 --delta-star -0.25 {outer} --format json".split()
    assert json.loads(lagtop(*args).stdout)["kind"] == kind
    assert kind in " ".join(lagtop(*args[:-1], "table").stdout.split())
    still = json.loads(lagtop(*args, "--delta-star", "0.5").stdout)
    degree = kind.split(maxsplit=1)[0].rstrip(",")
    assert still["kind"] == f"{degree}, the band is a double root: eta is constant"
