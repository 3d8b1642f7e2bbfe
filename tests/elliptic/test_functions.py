"""am, sn, cn, dn, theta and Carlson functions on arrays against mpmath; `lagtop jacobi`."""

from __future__ import annotations

import json
import math
import random
from collections.abc import Callable, Iterator
from typing import Any

import mpmath
import numpy as np
import pytest
from arb_balls import exact_arb
from balls.scene import arb_bits
from conftest import Lagtop
from error_units import error_in_units
from flint import acb
from lagtop import LagtopError
from scenes import EPS

from lagrange_cli.arithmetic.arrays import ARRAYS
from lagrange_cli.elliptic.carlson import carlson_rc, carlson_rd, carlson_rf, carlson_rj
from lagrange_cli.elliptic.complete import complete_k
from lagrange_cli.elliptic.jacobi import jacobi
from lagrange_cli.elliptic.many_digits import ManyDigits
from lagrange_cli.elliptic.modulus import Modulus, constants, modulus
from lagrange_cli.elliptic.theta import theta, zeta
from lagrange_cli.elliptic.third_kind import omega


def moduli(rng: random.Random) -> Iterator[tuple[str, float]]:
    """Yield ways to give k, each over all it can say; k' down to 1 - k^2 = 1e-300."""
    while True:
        yield rng.choice(
            [
                ("k", rng.random()),
                ("k", 10 ** rng.uniform(-20, 0)),
                ("k", 1 - 10 ** rng.uniform(-15, -1)),
                ("k_prime", rng.random()),
                ("k_prime", 10 ** rng.uniform(-150, 0)),
                ("k_prime", 10 ** rng.uniform(-300, -150)),
                ("m", rng.random()),
            ]
        )


def arguments(rng: random.Random, K: float) -> float:
    """Return an argument within K, up to 1e12 K, close to the zeros of sn and of cn."""
    close = (
        2 * rng.randrange(10**6)
        + rng.choice([0, 1])
        + rng.choice([-1, 1]) * 10 ** rng.uniform(-12, -3)
    )
    parts = [rng.random(), 10 ** rng.uniform(-12, 0), 10 ** rng.uniform(0, 12), close]
    return rng.choice([-1, 1]) * K * rng.choice(parts)


def errors(name: str, value: float, u: float) -> list[float]:
    """Return the errors of am, sn, cn, dn in units."""
    ours = jacobi(ARRAYS, u, modulus(ARRAYS, **{name: value}))
    with mpmath.workdps(700):
        x = mpmath.mpf(value)
        m = {"k": x**2, "k_prime": 1 - x**2, "m": x}[name]
        K = mpmath.pi / 2 / mpmath.agm(1, mpmath.sqrt(1 - m))
    with mpmath.workdps(60 if 1 - m > 1e-20 else 680):
        halves = mpmath.nint(u / (2 * K))
        tau = u - 2 * K * halves
        sn, cn, dn = (mpmath.ellipfun(f, tau, m=m) for f in ("sn", "cn", "dn"))
        am, sign = mpmath.atan2(sn, cn) + halves * mpmath.pi, (-1) ** int(halves % 2)
        exact = [am, sign * sn, sign * cn, dn]
        slopes = [dn, cn * dn, sn * dn, m * sn * cn]
        return [
            error_in_units(float(x), true, slope, tau)
            for x, true, slope in zip(ours, exact, slopes, strict=True)
        ]


@pytest.mark.slow
def test_jacobi() -> None:
    """Worst seen in 20 000: 1.23 units."""
    rng = random.Random("sn")
    for _, (name, value) in zip(range(150), moduli(rng), strict=False):
        K = float(complete_k(ARRAYS, modulus(ARRAYS, **{name: value}).k_prime))
        assert max(errors(name, value, arguments(rng, K))) <= 1.25


@pytest.mark.parametrize(
    ("name", "value", "u"),
    [
        ("m", 1 - 1e-10, 13.5),
        ("m", 1 - 1e-12, 20.0),
        ("k_prime", 1e-6, 40.0),
        ("k_prime", 1e-8, 123.4),
        ("m", 0.5, 1e6),
        ("k", 0.9999999992240866, -3.079849288428686),  # 1 - k^2 is the sum of two doubles
        ("k", 0.2738929647185465, 512232610885.36005),  # the period is known to 30 digits
    ],
)
def test_where_scipy_fails(name: str, value: float, u: float) -> None:
    """scipy.special.ellipj is off by up to 2 for 1 - m <= 1e-10 beyond K, and drifts far away."""
    assert max(errors(name, value, u)) <= 1.25


def test_the_limits_of_the_modulus() -> None:
    u = np.array([-800.0, -400.0, -1.5, 0.0, 1e-9, 0.5, 356.0, 1e300])
    one = jacobi(ARRAYS, u, modulus(ARRAYS, k=1.0))
    bounded = np.clip(u, -40, 40)
    np.testing.assert_allclose(one.sn, np.tanh(bounded), rtol=4 * EPS)
    np.testing.assert_allclose(
        one.cn, 1 / np.cosh(np.clip(u, -700, 700)), atol=1e-150, rtol=4 * EPS
    )
    assert abs(one.am).max() <= np.pi / 2
    u = u[2:6]
    zero = jacobi(ARRAYS, u, modulus(ARRAYS, k=0.0))
    for ours, exact in zip(zero, (u, np.sin(u), np.cos(u), 1 + 0 * u), strict=True):
        np.testing.assert_allclose(ours, exact, rtol=4 * EPS)


def test_arrays_of_moduli_give_what_single_ones_give() -> None:
    rng = np.random.default_rng(5)
    k, u = rng.random((40, 1)), rng.uniform(-9, 9, 30)
    k[0], k[1] = 0, 1
    together = jacobi(ARRAYS, u, modulus(ARRAYS, k=k))
    for i in range(40):
        alone = jacobi(ARRAYS, u, modulus(ARRAYS, k=k[i, 0]))
        for one, other in zip(alone, together, strict=True):
            np.testing.assert_allclose(other[i], one, rtol=1e-14, atol=4 * EPS)
    assert jacobi(ARRAYS, np.empty((0, 3)), modulus(ARRAYS, k=0.5)).sn.shape == (0, 3)


@pytest.mark.parametrize("k", [0.25, 0.5, 0.9])
def test_zeta_next_to_its_pole(k: float) -> None:
    """Z10 has a pole at K; its relative digits are kept as close to it as doubles go."""
    with mpmath.workdps(60):
        first = mpmath.ellipk(mpmath.mpf(k) ** 2)
        q = mpmath.exp(-mpmath.pi * mpmath.ellipk(1 - mpmath.mpf(k) ** 2) / first)
        u = np.array(
            [
                float(first * (1 + sign * mpmath.mpf(10) ** -n))
                for n in (1, 3, 6, 9, 13)
                for sign in (-1, 1)
            ]
        )
        places = [mpmath.pi * mpmath.mpf(x) / (2 * first) for x in u.tolist()]
        slopes = [mpmath.jtheta(2, x, q, 1) / mpmath.jtheta(2, x, q) for x in places]
        wanted = [mpmath.pi / (2 * first) * slope for slope in slopes]
    with ARRAYS.working():
        found = zeta(ARRAYS, "10", u, modulus(ARRAYS, k=k))
    for got, exact in zip(found.tolist(), wanted, strict=True):
        assert abs(got / exact - 1) < 4 * EPS


def test_odd_and_imaginary_parameters_and_mixed_moduli() -> None:
    """Omega_11 and Omega_10 below zero, over periods, at k = 0; values of mixed moduli."""
    ar = ManyDigits(40)
    eta = np.linspace(-7, 7, 29)
    for k, alpha in ((0.3, -0.4), (0.95, -0.4), (0.0, 2.5)):
        for ij in ("11", "10"):
            exact = [
                complex(omega(ar, ij, ar.mpf(x), ar.mpc(0, alpha), modulus(ar, k=k))) for x in eta
            ]
            ours = omega(ARRAYS, ij, eta, 1j * alpha, modulus(ARRAYS, k=k))
            np.testing.assert_allclose(ours, exact, atol=2e-14)
    mixed = modulus(ARRAYS, k=np.array([[0.3], [0.95]]))
    for i, k in enumerate((0.3, 0.95)):
        for function in (theta, zeta):
            alone = function(ARRAYS, "11", eta + 0.1, modulus(ARRAYS, k=k))
            together = function(ARRAYS, "11", eta + 0.1, mixed)[i]
            np.testing.assert_allclose(together, alone, rtol=1e-13)


@pytest.mark.parametrize("place", [0.55j, 0.5 + 0.55j, -0.5 + 0.55j, 1.5 + 0.55j, 0.3 + 2.6j])
@pytest.mark.parametrize("k", [0.1, 0.76, 0.999])
def test_complex_arguments(k: float, place: complex) -> None:
    """On a tie between two ways of reduction; far away the largest term is not the first."""
    ar = ManyDigits(40)
    m = ar.mpf(k) ** 2
    K, x = ar.ellipk(m), ar.convert(place)
    q = ar.exp(-ar.pi * ar.ellipk(1 - m) / K)
    for ij, n in {"01": 4, "00": 3, "11": 1, "10": 2}.items():
        value, slope = (ar.jtheta(n, ar.pi * x, q, derivative=i) for i in (0, 1))
        assert abs(theta(ar, ij, x, modulus(ar, k=k)) / value - 1) < 1e-37
        computed = theta(ARRAYS, ij, place, modulus(ARRAYS, k=k))
        assert abs(complex(computed) / complex(value) - 1) < 1e-14
        zeta_there = zeta(ar, ij, 2 * K * x, modulus(ar, k=k))
        size = abs(ar.pi * slope / value) + 1
        assert abs(zeta_there * 2 * K - ar.pi * slope / value) < 1e-36 * size


def relative(value: Any, exact: Any) -> float:
    return float(abs(mpmath.mpf(float(value)) / exact - 1) / EPS)


CARLSON: dict[str, tuple[Callable[..., Any], Callable[..., Any], int, float]] = {
    "rf": (carlson_rf, acb.elliptic_rf, 3, 2.4),
    "rc": (carlson_rc, acb.elliptic_rc, 2, 0.6),
    "rd": (carlson_rd, lambda x, y, z: acb.elliptic_rj(x, y, z, z), 3, 2.6),
    "rj": (carlson_rj, acb.elliptic_rj, 4, 0.6),
}
"""Our functions, those of Arb, the number of arguments, and the worst errors seen, in eps."""


@pytest.mark.parametrize("name", CARLSON)
def test_carlson(name: str) -> None:
    """Arguments over forty decades, the first 0 or the last small; once R_J was off by 6.9 eps."""
    ours, exact, count, most = CARLSON[name]
    rng = np.random.default_rng(7)
    arguments = 10 ** rng.uniform(-20, 20, (4, 400))
    arguments[0, ::5] = 0
    arguments[:, 1] = 1.15e-10, 4.28e-17, 6.09e-20, 68998445.29696697
    with arb_bits(300):
        for value, numbers in zip(
            ours(ARRAYS, *arguments[:count]), arguments[:count].T, strict=True
        ):
            true = exact(*(acb(exact_arb(float(x))) for x in numbers)).real
            assert float(abs(exact_arb(float(value)) / true - 1).mid()) <= most * EPS, numbers
    assert ours(ARRAYS, *arguments[:count, 1]) == pytest.approx(
        ours(ARRAYS, *arguments[:count])[1], rel=2 * EPS
    )


def test_carlson_at_equal_arguments_and_over_the_range() -> None:
    x = np.array([0.5, 2.0, 1e60, 1e-60])
    np.testing.assert_allclose(carlson_rc(ARRAYS, x, x), 1 / np.sqrt(x), rtol=2 * EPS)
    np.testing.assert_allclose(carlson_rj(ARRAYS, x, x, x, x), x**-1.5, rtol=4 * EPS)
    wide = np.array([1e100]), np.array([1e-100])
    assert relative(carlson_rc(ARRAYS, *wide)[0], mpmath.elliprc(1e100, 1e-100)) <= 2


def test_many_digits_of_carlson() -> None:
    ar = ManyDigits(60)
    x, y, z, p = (ar.mpf(text) for text in ("0.3", "0.2", "5", "0.01"))
    assert abs(carlson_rj(ar, x, y, z, p) / ar.elliprj(x, y, z, p) - 1) < 1e-57
    assert abs(carlson_rd(ar, x, y, z) / ar.elliprd(x, y, z) - 1) < 1e-57


def test_loops_end_at_nan() -> None:
    """Loops that wait for convergence do not wait for NaN."""
    nan = np.array([1.0, math.nan])
    with np.errstate(all="ignore"):
        for values in (
            carlson_rf(ARRAYS, nan, 1.0, 2.0),
            carlson_rj(ARRAYS, nan, 1.0, 2.0, 3.0),
            complete_k(ARRAYS, nan),
        ):
            assert np.isnan(values).tolist() == [False, True]


@pytest.mark.slow
def test_carlson_in_blocks() -> None:
    """Arrays longer than a block, of elements that need different numbers of steps."""
    x, y, z, p = np.exp(np.random.default_rng(3).normal(0, 4, (4, 40_000)))
    together = carlson_rj(ARRAYS, x, y, z, p)
    some = slice(None, None, 4001)
    alone = [
        carlson_rj(ARRAYS, *values)
        for values in zip(x[some], y[some], z[some], p[some], strict=True)
    ]
    np.testing.assert_allclose(together[some], alone, rtol=8 * EPS)


@pytest.mark.parametrize("q", [0.0, 1e-200, 0.01, 0.0432139, 0.0432140, 0.5, 0.99])
def test_inverse_of_the_nome(q: float) -> None:
    with mpmath.workdps(60):
        k, k_prime, _ = modulus(ARRAYS, q=q)
        assert float(k) == pytest.approx(float(mpmath.kfrom(q=mpmath.mpf(q))), rel=4 * EPS)
        there = mpmath.sqrt(1 - mpmath.kfrom(q=mpmath.mpf(q)) ** 2) if q < 0.6 else None
        if there is not None:
            assert float(k_prime) == pytest.approx(float(there), rel=8 * EPS)
    if 0 < q < 1:
        assert float(constants(ARRAYS, Modulus(k, k_prime)).q) == pytest.approx(q, rel=1e-13)


def test_a_nome_next_to_1_takes_more_digits(lagtop: Lagtop) -> None:
    """K is pi/2 theta3^2: -pi^2/(2 log q) but for a term as small as k'^2."""
    nome = f"0.{'9' * 16}"
    args = ["--nome", nome, "--digits", "30", "--format", "json"]
    shown = json.loads(lagtop("jacobi", *args).stdout, parse_float=str)
    with mpmath.workdps(60):
        K = -(mpmath.pi**2) / (2 * mpmath.log(mpmath.mpf(nome)))
        assert abs(mpmath.mpf(shown["K"]) / K - 1) < 1e-29
        assert abs(mpmath.mpf(shown["nome_prime"]) / mpmath.exp(-2 * K) - 1) < 1e-29


@pytest.mark.parametrize("given", [{}, {"k": 0.1, "q": 0.1}, {"k": 1.1}, {"m": -0.1}, {"q": 1.0}])
def test_one_modulus_in_range(given: dict[str, float]) -> None:
    for ar in (ARRAYS, ManyDigits(30)):
        with pytest.raises(LagtopError, match="must be"):
            modulus(ar, **given)


def test_constants_of_the_command(lagtop: Lagtop) -> None:
    record = json.loads(lagtop("jacobi", "--modular-angle", "60", "--format", "json").stdout)
    with mpmath.workdps(40):
        m = mpmath.mpf(3) / 4
        exact = {
            "k": mpmath.sqrt(m),
            "k_prime": mpmath.mpf(0.5),
            "modular_angle_deg": 60,
            "nome": mpmath.qfrom(m=m),
            "nome_prime": mpmath.qfrom(m=1 - m),
            "K": mpmath.ellipk(m),
            "K_prime": mpmath.ellipk(1 - m),
            "E": mpmath.ellipe(m),
            "E_prime": mpmath.ellipe(1 - m),
        }
        assert record == {key: float(value) for key, value in exact.items()}
    one = json.loads(lagtop("jacobi", "--modular-angle", "90", "--format", "json").stdout)
    assert (one["k_prime"], one["K"], one["E"], one["nome"]) == (0.0, None, 1.0, 1.0)


def test_what_is_asked_for_is_shown_and_nothing_else(lagtop: Lagtop) -> None:
    """am, sn, cn and dn are the default, and beside other functions only if they are named."""
    plain = "u,am_deg,sn,cn,dn"
    for families, names in (
        ("", plain),
        ("--functions am", plain),
        ("--functions zeta", "u,zeta01,zeta00,zeta11,zeta10"),
        ("--functions am,pi --param 0.3", f"{plain},pi01,pi00,pi11"),
    ):
        for count in (2, 20):  # with and without NumPy
            args = ["--k", "0.8", "--u", f"0.1:1:{count}", *families.split()]
            shown = lagtop("jacobi", *args, "--format", "csv").stdout.splitlines()
            assert (shown[0], len(shown)) == (names, count + 1)


def test_rows_of_the_command(lagtop: Lagtop) -> None:
    args = "--k 0.8 --u -3:3.5:6 --functions am,theta,zeta,omega,pi --param 0.4i".split()
    plain = json.loads(lagtop("jacobi", *args, "--format", "json").stdout)
    many = json.loads(lagtop("jacobi", *args, "--format", "json", "--digits", "25").stdout)
    assert len(plain) == 6
    assert list(plain[0])[:6] == ["u", "am_deg", "sn", "cn", "dn", "theta01"]
    assert list(plain[0])[-1] == "pi11_imag"
    for row, exact in zip(plain, many, strict=True):
        assert row == pytest.approx(exact, abs=1e-13, rel=1e-10)
    radians = json.loads(lagtop("jacobi", *args, "--rad", "--format", "json").stdout)
    assert radians[5]["am_rad"] == pytest.approx(math.radians(plain[5]["am_deg"]), rel=1e-15)


def test_poles_are_empty(lagtop: Lagtop) -> None:
    for digits in ([], ["--digits", "20"]):
        shown = lagtop(
            "jacobi", "--k", "0.8", "--u", "0", "--functions", "zeta", "--format", "json", *digits
        )
        assert json.loads(shown.stdout)[0]["zeta11"] is None


@pytest.mark.slow
@pytest.mark.parametrize("u", ["1e25", "1e50", "1e300"])
def test_digits_of_far_arguments(u: str, lagtop: Lagtop) -> None:
    """The precision grows with the argument; two that are too low could agree on a wrong number."""
    shown = lagtop("jacobi", "--k", "0.5", "--u", u, "--digits", "3", "--format", "csv").stdout
    with mpmath.workdps(400):
        exact = mpmath.ellipfun("sn", mpmath.mpf(u), m=mpmath.mpf("0.25"))
    assert float(shown.splitlines()[1].split(",")[2]) == pytest.approx(float(exact), abs=6e-4)
    refused = lagtop("jacobi", "--k", "0.5", "--u", u)
    assert (refused.exit_code, refused.stdout) == (2, "")
    assert "u must be within 2^50 periods" in refused.stderr


def test_at_zero_modulus_zeta_has_a_limit(lagtop: Lagtop) -> None:
    for digits in ([], ["--digits", "20"]):
        args = ["--k", "0", "--u", "1", "--functions", "zeta", "--format", "json", *digits]
        row = json.loads(lagtop("jacobi", *args).stdout)[0]
        assert row["zeta11"] == pytest.approx(1 / math.tan(1), rel=1e-15)
        assert row["zeta10"] == pytest.approx(-math.tan(1), rel=1e-15)


def test_series_of_the_command(lagtop: Lagtop) -> None:
    args = "--k 0.9 --u 1.1 --series 20 --format json".split()
    rows = json.loads(lagtop("jacobi", *args).stdout)
    assert [row["terms"] for row in rows] == list(range(1, 21))
    assert rows[-1]["sn"] == pytest.approx(float(mpmath.ellipfun("sn", 1.1, k=0.9)), abs=1e-15)
    assert rows[-1]["K_error"] == pytest.approx(2.2805491384227703 - rows[-1]["K"], abs=1e-15)
    assert rows[0]["cn_error"] > 1e-3 > rows[9]["cn_error"] > rows[-1]["cn_error"]
