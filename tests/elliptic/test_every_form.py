"""Every function and form of `lagtop jacobi` with random numbers, and tables of A&S and DLMF.

The references are mpmath's functions of the parameter m, theta functions of the nome, and
quadratures.  With the slow tests, more than 5,000 values are compared.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from decimal import Decimal
from itertools import product
from typing import Any

import mpmath
import pytest
from conftest import Lagtop
from function_reference import PQ, Reference, cells_of, check
from ours import ManyDigits

ar = ManyDigits(50)


def decimal(rng: random.Random, reach: float) -> str:
    """Return a number of a few digits."""
    return f"{rng.uniform(-reach, reach):.{rng.randint(2, 9)}f}"


def number(rng: random.Random, reach: float) -> str:
    """Return a complex number."""
    return f"{decimal(rng, reach)}{rng.uniform(-reach, reach):+.5f}{rng.choice('ij')}"


KINDS: dict[str, Callable[[random.Random], str]] = {
    "k": lambda rng: decimal(rng, 0.9999),
    "k-prime": lambda rng: decimal(rng, 0.9),
    "imaginary k": lambda rng: f"{decimal(rng, 3)}i",
    "m": lambda rng: f"{abs(float(decimal(rng, 5))) + 1.0625}",
    "modular-angle": lambda rng: f"{abs(float(decimal(rng, 89)))}",
    "complex k": lambda rng: number(rng, 2),
    "complex k-prime": lambda rng: number(rng, 2),
    "complex m": lambda rng: number(rng, 4),
    "nome": lambda rng: decimal(rng, 0.8),
    "complex nome": lambda rng: number(rng, 0.6),
}


def amplitude(pq: str, x: Any, m: Any) -> Any:
    """Return the amplitude at which pq is x, for m < 1."""
    if pq in {"ns", "ds", "nc", "dc", "nd"}:
        if pq == "ds":
            return ar.asin(1 / ar.sqrt(m + x * x)) * ar.sign(x)
        pq, x = pq[::-1], 1 / x
    return {
        "sn": lambda: ar.asin(x),
        "cn": lambda: ar.acos(x),
        "dn": lambda: ar.asin(ar.sqrt((1 - x * x) / m)),
        "sc": lambda: ar.atan(x),
        "cs": lambda: ar.pi / 2 - ar.atan(x),
        "sd": lambda: ar.asin(x / ar.sqrt(1 + m * x * x)),
        "cd": lambda: ar.acos(x * ar.sqrt((1 - m) / (1 - m * x * x))),
    }[pq]()


def modulus(rng: random.Random, kind: str) -> tuple[str, str, Reference]:
    """Return the option, its text, and the reference of a random modulus of a kind."""
    name, text = kind.rpartition(" ")[-1], KINDS[kind](rng)
    while abs((reference := Reference(name, text)).nome) > 0.8 and name == "nome":
        text = KINDS[kind](rng)
    return f"--{name}", text, reference


MANY = pytest.mark.parametrize("count", [2, pytest.param(25, marks=pytest.mark.slow)])


@MANY
@pytest.mark.parametrize("kind", KINDS)
def test_functions_of_u(kind: str, count: int, lagtop: Lagtop) -> None:
    """Twelve quotients, theta of u and of z, Neville's, Zeta and epsilon, at real and complex u."""
    rng, seen = random.Random(f"u {kind} {count}"), 0
    names = [*PQ, "theta", "zeta", *(f"theta{i}" for i in range(1, 5))]
    names += [f"theta_{x}" for x in "scdn"]
    for i in range(count):
        option, text, reference = modulus(rng, kind)
        u = number(rng, 1.5) if i % 2 else decimal(rng, 4)
        asked = names if kind == "complex nome" else [*names, "epsilon"]
        cells = cells_of(lagtop, f"{option}={text}", f"--u={u}", "--functions", ",".join(asked))
        seen += check(cells, reference.functions(reference.number(u)), (text, u))
    assert seen >= 25 * count


@MANY
@pytest.mark.parametrize("kind", KINDS)
def test_sums_with_quarter_periods(kind: str, count: int, lagtop: Lagtop) -> None:
    """K and K' are those of the modulus, complex ones too."""
    rng = random.Random(f"K {kind} {count}")
    for _ in range(count):
        option, text, reference = modulus(rng, kind)
        K, K_prime = reference.K, reference.K_prime
        units = {"": 1, "i": 1j, "K": K, "iK": 1j * K, "K'": K_prime, "*iK'": 1j * K_prime}
        terms = [(f"{rng.uniform(-1, 1):+.4f}", unit) for unit in units]
        u = "".join(map("".join, terms))
        at = sum(ar.mpf(x) * units[unit] for x, unit in terms)
        names = "am,sd,cd,theta,theta_c" if reference.is_real else "sd,cd,theta,theta_c"
        cells = cells_of(lagtop, f"{option}={text}", f"--u={u}", "--functions", names)
        assert check(cells, {**reference.functions(at), "u": at}, (text, u)) >= 15
        if reference.is_real and cells["am_deg_re"][0]:  # sin(am) = sn
            am = ar.mpc(*(cells[f"am_deg_{x}"][0] for x in ("re", "im"))) * ar.pi / 180
            sn = ar.mpc(*(cells[f"sn_{x}"][0] for x in ("re", "im")))
            assert abs(ar.sin(am) - sn) <= 1e-15 * (1 + abs(sn))


MODULI = ["0.3", "0.8", "0.95", "0.999", "0.7071067811865476", "0.05i", "0.8i", "20i", "1.01", "2"]
ANYWHERE = [("-4.1-1.3i", "0.2+0.7i"), ("1e-9+2.5i", "100.25-0.5i")]
ON_THE_AXES = [("0.9i", "1.3"), ("1.1i", "0.6i"), ("-0.3+0.7i", "-0.3-0.7i")]
"""Arguments, or their sum and difference, are real or imaginary; a printed 0 is a 0."""
EXTREME = ("0.5+0.1i", "-1.25+0.3i")


@pytest.mark.parametrize(
    ("k", "numbers", "digits"),
    [
        *product(MODULI[1::2], ANYWHERE, [45]),
        *product(["0.5", "0.95i", "2"], ON_THE_AXES, [45]),
        *(("1e-200", EXTREME, 520), (f"0.{'9' * 20}", EXTREME, 80)),
    ],
)
def test_am_omega_and_pi(k: str, numbers: tuple[str, str], digits: int, lagtop: Lagtop) -> None:
    """By a reference with more digits for extreme moduli; am is empty beyond its branch points."""
    reference, (u, v) = Reference("k", k, digits), numbers
    first, second = map(reference.number, numbers)
    args = (f"--k={k}", f"--u={u}", "--functions=am,omega,pi", f"--param={v}", "--rad")
    exact = reference.third_kind(first, second)
    if not reference.is_large:  # test_sums_with_quarter_periods checks it
        exact["am_rad"] = reference.am(first)
    assert check(cells_of(lagtop, *args), exact, (k, u, v)) >= 12


@pytest.mark.parametrize("k", MODULI)
@pytest.mark.parametrize("place", ["iK'", "K+iK'", "0.3K+iK'"])
def test_parameters_next_to_half_periods(k: str, place: str, lagtop: Lagtop) -> None:
    """The parameter is in the doubles next to them, in the period lattice of k."""
    reference = Reference("k", k, 60)
    at = reference.K_prime * 1j + reference.K * {"i": 0, "K": 1, "0": 0.3}[place[0]]
    v = ar.mpc(float(ar.re(at)), float(ar.im(at)))
    text = f"{ar.nstr(ar.re(v), 40)}+{ar.nstr(ar.im(v), 40)}i".replace("+-", "-")
    cells = cells_of(lagtop, f"--k={k}", "--u=0.3+0.2i", "--functions=omega,pi", f"--param={text}")
    assert check(cells, reference.third_kind(reference.number("0.3+0.2i"), v), (k, place)) == 12


@pytest.mark.parametrize("u", ["1e25", "1e300"])
def test_far_numbers(u: str, lagtop: Lagtop) -> None:
    """The precision grows with them; two that are too low could agree on a wrong number."""
    with mpmath.workdps(700):
        far, period = mpmath.mpf(u), 2 * mpmath.ellipk(mpmath.mpf("0.25"))
        exact = {"sn": mpmath.ellipfun("sn", far, m=mpmath.mpf("0.25"))}
        exact["am_rad"] = far * mpmath.pi / period
        near = mpmath.nstr(far - period * mpmath.nint(far / period), 60)
    found = cells_of(lagtop, "--k=0.5", f"--u={u}", "--rad", digits=12)
    assert {x: float(found[x][0]) for x in exact} == pytest.approx(exact, rel=1e-11)
    of_pi = ("--k=0.5", "--u=1", "--functions=pi")
    one, other = (cells_of(lagtop, *of_pi, f"--param={v}") for v in (u, near))
    assert one == other


def test_omega_on_a_line_of_zeros(lagtop: Lagtop) -> None:
    """Omega01 jumps by i pi where Im(u - v) passes K', and is the mean of both sides there."""
    found = []
    for height in (f"0.{'9' * 9}iK'", f"0.{'9' * 45}iK'", "iK'", f"1.{'0' * 44}1iK'"):
        args = ("--k=0.8", f"--u=-0.3K+0.2i+{height}", "--functions=omega", "--param=0.1+0.2i")
        cells = cells_of(lagtop, *args)
        found.append(complex(*(float(cells[f"omega01_{part}"][0]) for part in ("re", "im"))))
    assert found[0] == pytest.approx(found[1], abs=1e-7)
    assert found[2] == pytest.approx((found[1] + found[3]) / 2, abs=1e-12)
    assert found[1] == pytest.approx(found[3] - 1j * math.pi, abs=1e-12)


@MANY
@pytest.mark.parametrize("kind", ["k", "imaginary k", "modular-angle", "nome", "m"])
def test_inverse_functions(kind: str, count: int, lagtop: Lagtop) -> None:
    """arcpq is F of its amplitude; a value that pq does not have is empty.  For k > 1, pq is x."""
    rng, seen = random.Random(f"arc {kind} {count}"), 0
    for _ in range(4 * count):
        option, text, reference = modulus(rng, kind)
        x = decimal(rng, rng.choice([1, 3]))
        found = cells_of(
            lagtop, f"{option}={text}", f"--u={x}", "--functions", ",".join(f"arc{y}" for y in PQ)
        )
        for pq in PQ:
            u, value = found[f"arc{pq}"][0], ar.mpf(x)
            if reference.is_large:
                if u:
                    at = ar.ellipfun(pq, ar.mpf(u), m=reference.m)
                    assert abs(at - value) <= 1e-15 * (1 + abs(value) ** 3), (pq, text, x)
                continue
            try:
                phi = amplitude(pq, value, reference.m)
            except ZeroDivisionError:
                phi = ar.mpc(0, 1)
            exists = not ar.im(phi) and not (pq in {"dn", "nd"} and value < 0)
            assert bool(u) is exists, (pq, text, x)
            if exists:
                seen += check({"u": [u]}, {"u": ar.ellipf(phi, reference.m)}, (pq, text, x))
    assert seen >= 10 * count or kind == "m"


@MANY
@pytest.mark.parametrize("kind", KINDS)
def test_integrals_and_constants(kind: str, count: int, lagtop: Lagtop) -> None:
    """F, E and zeta of an amplitude, below 1 in m; K, K', E, E' and the nome."""
    rng = random.Random(f"F {kind} {count}")
    for _ in range(count):
        option, text, reference = modulus(rng, kind)
        m, phi = reference.m, decimal(rng, 400)
        if not reference.is_large:
            radians = ar.mpf(phi) * ar.pi / 180
            F, E = ar.ellipf(radians, m), ar.ellipe(radians, m)
            exact = {"F": F, "E": E, "zeta": E - F * ar.ellipe(m) / ar.ellipk(m)}
            args = (f"{option}={text}", f"--phi={phi}", "--functions", "F,E,zeta")
            assert check(cells_of(lagtop, *args), exact, (text, phi)) >= 3
        if abs(ar.ellipk(m) / reference.K - 1) > 1e-20:  # the nome has another K
            assert "|2 tau" in lagtop("jacobi", f"{option}={text}").stderr
            continue
        constants = {"K": reference.K, "K_prime": reference.K_prime, "nome": reference.nome}
        constants |= {"E": ar.ellipe(m), "E_prime": ar.ellipe(1 - m)}
        assert check(cells_of(lagtop, f"{option}={text}"), constants, text) >= 5


@pytest.mark.parametrize("m", ["0.3", "-2", "2", "0.4-0.7i"])
def test_epsilon_and_inverses_by_quadrature(m: str, lagtop: Lagtop) -> None:
    """Epsilon is the integral of dn^2; arcsc is that of 1/sqrt((1 + t^2)(1 + k'^2 t^2))."""
    reference = Reference("m", m, 25)
    few, square = reference.ar, reference.m
    ends = [0, few.mpf("0.4"), few.mpf("0.8")]
    exact = {"epsilon": few.quad(lambda t: few.ellipfun("dn", t, m=square) ** 2, ends)}
    if "i" not in m:
        rest = 1 - square
        exact["arcsc"] = few.quad(lambda t: 1 / few.sqrt((1 + t * t) * (1 + rest * t * t)), ends)
    for name in exact:
        assert check(cells_of(lagtop, f"--m={m}", "--u=0.8", "--functions", name), exact, m)


DLMF_22_5 = {
    "K/2": ("1/sqrt(1+k1)", "sqrt(k1/(1+k1))", "sqrt(k1)"),
    "K/2+iK'/2": (
        "(sqrt(1+k) + 1j*sqrt(1-k))/sqrt(2*k)",
        "(1-1j)*sqrt(k1)/sqrt(2*k)",
        "sqrt(k1)*(sqrt(1+k1) - 1j*sqrt(1-k1))/sqrt(mpf(2))",
    ),
    "iK'/2": ("1j/sqrt(k)", "sqrt((1+k)/k)", "sqrt(1+k)"),
    **{"0": ("0", "1", "1"), "K": ("1", "0", "k1"), "K+iK'": ("1/k", "-1j*k1/k", "0")},
    **{"iK'": ("", "", ""), "2K": ("0", "-1", "1"), "2K+2iK'": ("0", "1", "-1")},
    "2iK'": ("0", "-1", "-1"),
}
"""sn, cn and dn in tables 22.5.1 and 22.5.2; an empty text is a pole."""


@pytest.mark.parametrize("k", ["0.8", "0.3", "0.6"])
def test_tables_of_dlmf(k: str, lagtop: Lagtop) -> None:
    """Zeros, poles and special values are exact."""
    known = {"sqrt": ar.sqrt, "mpf": ar.mpf, "k": ar.mpf(k), "k1": ar.sqrt(1 - ar.mpf(k) ** 2)}
    cells = cells_of(lagtop, f"--k={k}", "--u", ",".join(DLMF_22_5), "--functions", "sn,cn,dn")
    for i, texts in enumerate(DLMF_22_5.values()):
        for pq, text in zip(("sn", "cn", "dn"), texts, strict=True):
            shown = [cells[f"{pq}_{part}"][i] for part in ("re", "im")]
            if text:  # "0" only if it is printed as 0
                true = eval(text, None, known)
                check({f"{pq}_re": shown[:1], f"{pq}_im": shown[1:]}, {pq: true}, (k, i))
            assert (shown == ["0.0", "0.0"]) is (text == "0"), (pq, i)
            assert ("" in shown) is (not text), (pq, i)


ABRAMOWITZ = """
--m=0.00 | K | 1.570796326794897
--m=0.01 | K | 1.574745561517356 | E | 1.566861942
--m=0.10 | K | 1.612441348720219 | E | 1.530757637
--m=0.20 | K | 1.659623598610528 | E | 1.489035058
--m=0.50 | K | 1.854074677301372 | E | 1.350643881
--m=0.90 | K | 2.578092113348173 | E | 1.104774733
--m=0.99 | K | 3.695637362989875 | E | 1.015993546
--modular-angle=20 | K | 1.620025899124204 | E | 1.523799205259774
--modular-angle=20 --phi=20 | F | 0.34988016 | E | 0.34825492
--modular-angle=30 --phi=30 --n=0.2 | Pi | 0.53896
--modular-angle=20 --u=2K/9 --functions=theta_s | theta_s | 0.352749211
--modular-angle=20 --u=2K/9 --functions=theta_n | theta_n | 1.003695313
"""
"""Options, and values of tables 17.1, 17.2, 17.5, 17.6, 17.9 and 16.1 of Abramowitz and Stegun."""


@pytest.mark.parametrize("line", ABRAMOWITZ.strip().splitlines())
def test_tables_of_abramowitz_and_stegun(line: str, lagtop: Lagtop) -> None:
    args, *known = line.split(" | ")
    cells = cells_of(lagtop, *args.split())
    for name, text in zip(known[::2], known[1::2], strict=True):
        digits = len(text.partition(".")[2])
        assert abs(Decimal(cells[name][0]) - Decimal(text)) < Decimal(10) ** -digits, name
