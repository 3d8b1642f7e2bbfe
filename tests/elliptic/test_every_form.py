"""Every function and form of `lagtop jacobi` with random numbers, and tables of A&S and DLMF.

The references are mpmath's functions of the parameter m, theta functions of the nome, and
quadratures.  With the slow tests, more than 5,000 values are compared.
"""

from __future__ import annotations

import math
import random
from collections.abc import Callable
from decimal import Decimal
from typing import Any

import pytest
from conftest import Lagtop, columns_of
from ours import ManyDigits

DIGITS = 18
ar = ManyDigits(50)
PQ = ["sn", "cn", "dn", "ns", "nc", "nd", "sc", "cs", "sd", "ds", "cd", "dc"]
THETA = {"theta1": "11", "theta2": "10", "theta3": "00", "theta4": "01"}
NEVILLE = {"s": 1, "c": 2, "d": 3, "n": 4}


def decimal(rng: random.Random, reach: float) -> str:
    """Return a number of a few digits."""
    return f"{rng.uniform(-reach, reach):.{rng.randint(2, 9)}f}"


def number(rng: random.Random, reach: float) -> str:
    """Return a complex number."""
    return f"{decimal(rng, reach)}{rng.uniform(-reach, reach):+.5f}{rng.choice('ij')}"


def parsed(text: str) -> Any:
    """Return the number of a text by Python's reader."""
    at = max(text.rfind("+"), text.rfind("-"), 0)
    if text[-1] not in "ij":
        return ar.mpf(text)
    return ar.mpc(text[:at] or "0", text[at:-1])


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


class Reference:
    """The functions of a modulus by mpmath."""

    def __init__(self, name: str, text: str) -> None:
        x = parsed(text)
        if name == "nome":
            self.q, at0 = x, [ar.jtheta(i, 0, x) for i in (2, 3, 4)]
            self.m = (at0[0] / at0[1]) ** 4
            self.K = ar.pi / 2 * at0[1] ** 2
            self.K_prime = -ar.log(x) * self.K / ar.pi
        else:
            square = {"k": x**2, "k-prime": 1 - x**2, "m": x}
            self.m = ar.sin(x * ar.pi / 180) ** 2 if name == "modular-angle" else square[name]
            self.K, self.K_prime = ar.ellipk(self.m), ar.ellipk(1 - self.m)
            self.q = ar.exp(-ar.pi * self.K_prime / self.K)
        self.is_real = not ar.im(self.m)
        if self.is_real and ar.re(self.m) < 0:
            self.q = ar.re(self.q)
        self.is_large = self.is_real and ar.re(self.m) > 1

    def theta(self, i: int, u: Any, order: int = 0) -> Any:
        """Return theta_i of pi u/2K, or its derivative by u."""
        scale = ar.pi / (2 * self.K)
        return scale**order * ar.jtheta(i, scale * u, self.q, order)

    def functions(self, u: Any) -> dict[str, Any]:
        """Return the functions of a complex argument by column."""
        found = {pq: ar.ellipfun(pq, u, m=self.m) for pq in PQ}
        for name, ij in THETA.items():
            i = int(name[-1])
            found[name], found[f"theta{ij}"] = ar.jtheta(i, u, self.q), self.theta(i, u)
            found[f"zeta{ij}"] = self.theta(i, u, 1) / self.theta(i, u)
        for letter, i in NEVILLE.items():
            at_0 = self.theta(i, 0, int(i == 1))
            found[f"theta_{letter}"] = self.theta(i, u) / at_0
        found["epsilon"] = found["zeta01"] + u * ar.ellipe(self.m) / ar.ellipk(self.m)
        return found

    def amplitude(self, pq: str, x: Any) -> Any:
        """Return the amplitude at which pq is x, for m < 1."""
        if pq in {"ns", "ds", "nc", "dc", "nd"}:
            if pq == "ds":
                return ar.asin(1 / ar.sqrt(self.m + x * x)) * ar.sign(x)
            pq, x = pq[::-1], 1 / x
        return {
            "sn": lambda: ar.asin(x),
            "cn": lambda: ar.acos(x),
            "dn": lambda: ar.asin(ar.sqrt((1 - x * x) / self.m)),
            "sc": lambda: ar.atan(x),
            "cs": lambda: ar.pi / 2 - ar.atan(x),
            "sd": lambda: ar.asin(x / ar.sqrt(1 + self.m * x * x)),
            "cd": lambda: ar.acos(x * ar.sqrt((1 - self.m) / (1 - self.m * x * x))),
        }[pq]()


def rows(lagtop: Lagtop, *args: str) -> dict[str, list[str]]:
    """Return the cells of a table with 18 digits by column."""
    shown = lagtop("jacobi", *args, "--digits", f"{DIGITS}", "--format", "csv")
    assert shown.exit_code == 0, (args, shown.stderr)
    return columns_of(shown.stdout)


def check(cells: dict[str, list[str]], exact: dict[str, Any], where: Any, i: int = 0) -> int:
    """Check all cells of a row to the last digit, and return their number."""
    seen = 0
    for column, texts in cells.items():
        name, text = column.removesuffix("_re").removesuffix("_im"), texts[i]
        if name not in exact:
            continue
        true = ar.im(exact[name]) if column.endswith("_im") else ar.re(exact[name])
        if not column.endswith(("_re", "_im")):
            assert abs(ar.im(exact[name])) < ar.mpf("1e-30") * (1 + abs(exact[name])), (name, where)
        unit = ar.mpf(10) ** (Decimal(text).adjusted() - DIGITS + 1) if float(text) else 0
        slack = unit * ar.mpf("0.5001") + ar.mpf("1e-33") * (1 + abs(exact[name]))
        assert abs(ar.mpf(text) - true) <= slack, (column, text, true, where)
        seen += 1
    return seen


def modulus(rng: random.Random, kind: str) -> tuple[str, str, Reference]:
    """Return the option, its text, and the reference of a random modulus of a kind."""
    name, text = kind.rpartition(" ")[-1], KINDS[kind](rng)
    while name == "nome" and abs(parsed(text)) > 0.8:
        text = KINDS[kind](rng)
    return f"--{name}", text, Reference(name, text)


MANY = pytest.mark.parametrize("count", [2, pytest.param(25, marks=pytest.mark.slow)])


@MANY
@pytest.mark.parametrize("kind", KINDS)
def test_functions_of_u(kind: str, count: int, lagtop: Lagtop) -> None:
    """Twelve quotients, theta of u and of z, Neville's, Zeta and epsilon, at real and complex u."""
    rng, seen = random.Random(f"u {kind} {count}"), 0
    names = [*PQ, "theta", "zeta", *THETA, *(f"theta_{x}" for x in NEVILLE)]
    for i in range(count):
        option, text, reference = modulus(rng, kind)
        u = number(rng, 1.5) if i % 2 else decimal(rng, 4)
        asked = names if kind == "complex nome" else [*names, "epsilon"]
        cells = rows(lagtop, f"{option}={text}", f"--u={u}", "--functions", ",".join(asked))
        seen += check(cells, reference.functions(parsed(u)), (text, u))
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
        cells = rows(lagtop, f"{option}={text}", f"--u={u}", "--functions", names)
        assert check(cells, {**reference.functions(at), "u": at}, (text, u)) >= 15
        if reference.is_real and cells["am_deg_re"][0]:  # sin(am) = sn
            am = ar.mpc(*(cells[f"am_deg_{x}"][0] for x in ("re", "im"))) * ar.pi / 180
            sn = ar.mpc(*(cells[f"sn_{x}"][0] for x in ("re", "im")))
            assert abs(ar.sin(am) - sn) <= 1e-15 * (1 + abs(sn))


@pytest.mark.parametrize("k", ["0.8", "0.8i", "1.25"])
def test_omega_and_pi_at_sums(k: str, lagtop: Lagtop) -> None:
    """At multiples of K and K' they are those at the same numbers."""
    reference, unit = Reference("k", k), ar.mpc(0, 1)
    at = (0.3 * reference.K, 0.2 * reference.K + 1.1 * unit * reference.K_prime)
    u, v = (f"{ar.nstr(ar.re(x), 40)}+{ar.nstr(ar.im(x), 40)}i".replace("+-", "-") for x in at)
    found = [
        rows(lagtop, f"--k={k}", f"--u={u}", "--functions=omega,pi", f"--param={v}")
        for u, v in (("0.3K", "0.2K+1.1iK'"), (u, v))
    ]
    for name in found[1]:
        x, y = (float(cells[name][0]) for cells in found)
        assert x == pytest.approx(y, rel=1e-14, abs=1e-30), name


def test_omega_on_a_line_of_zeros(lagtop: Lagtop) -> None:
    """Omega01 jumps by i pi where Im(u - v) passes K', and is the mean of both sides there."""
    found = []
    for height in (f"0.{'9' * 9}iK'", f"0.{'9' * 45}iK'", "iK'", f"1.{'0' * 44}1iK'"):
        args = ("--k=0.8", f"--u=-0.3K+0.2i+{height}", "--functions=omega", "--param=0.1+0.2i")
        cells = rows(lagtop, *args)
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
        found = rows(
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
                phi = reference.amplitude(pq, value)
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
            assert check(rows(lagtop, *args), exact, (text, phi)) >= 3
        if abs(ar.ellipk(m) / reference.K - 1) > 1e-20:  # the nome has another K
            assert "|2 tau" in lagtop("jacobi", f"{option}={text}").stderr
            continue
        constants = {"K": reference.K, "K_prime": reference.K_prime, "nome": reference.q}
        constants |= {"E": ar.ellipe(m), "E_prime": ar.ellipe(1 - m)}
        assert check(rows(lagtop, f"{option}={text}"), constants, text) >= 5


@pytest.mark.parametrize("m", ["0.3", "-2", "2", "0.4-0.7i"])
def test_epsilon_and_inverses_by_quadrature(m: str, lagtop: Lagtop) -> None:
    """Epsilon is the integral of dn^2; arcsc is that of 1/sqrt((1 + t^2)(1 + k'^2 t^2))."""
    exact = {
        "epsilon": ar.quad(
            lambda t: ar.ellipfun("dn", t, m=parsed(m)) ** 2, [0, ar.mpf("0.4"), ar.mpf("0.8")]
        )
    }
    assert check(rows(lagtop, f"--m={m}", "--u=0.8", "--functions", "epsilon"), exact, m)
    if "i" not in m:
        root = ar.quad(
            lambda t: ((1 + t * t) * (1 + (1 - ar.mpf(m)) * t * t)) ** ar.mpf("-0.5"),
            [0, ar.mpf("0.4"), ar.mpf("0.8")],
        )
        found = rows(lagtop, f"--m={m}", "--u=0.8", "--functions", "arcsc")
        assert check(found, {"arcsc": root}, m)


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
    cells = rows(lagtop, f"--k={k}", "--u", ",".join(DLMF_22_5), "--functions", "sn,cn,dn")
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
    cells = rows(lagtop, *args.split())
    for name, text in zip(known[::2], known[1::2], strict=True):
        digits = len(text.partition(".")[2])
        assert abs(Decimal(cells[name][0]) - Decimal(text)) < Decimal(10) ** -digits, name
