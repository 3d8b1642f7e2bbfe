"""The functions of `lagtop jacobi` by mpmath, with formulas that the package does not use.

- sn, cn, dn and their quotients are `mpmath.ellipfun` of the parameter m; am is Jacobi's series in
  the nome (3.1.7).
- Theta and Zeta functions are `mpmath.jtheta` in the nome of the modulus itself.
- Omega and Pi are sums of logarithms over the infinite products of theta functions.  In the strip
  between two lines of zeros every factor is 1 - w with |w| < 1, so the sum of the principal
  logarithms is continuous.  It is the branch that the README of `elliptic` describes.

Numbers belong to a context of mpmath, and have its digits except the last few.
"""

from __future__ import annotations

from decimal import Decimal
from typing import Any

from conftest import Lagtop, columns_of
from ours import ManyDigits

DIGITS = 18
PQ = ["sn", "cn", "dn", "ns", "nc", "nd", "sc", "cs", "sd", "ds", "cd", "dc"]
NUMBER = {"01": 4, "00": 3, "11": 1, "10": 2}
THIRD = ("01", "00", "11")
"""The indices of Omega and Pi."""


class Reference:
    """The functions of one modulus, given by the option of `lagtop jacobi` and its text."""

    def __init__(self, name: str, text: str, digits: int = 50) -> None:
        self.ar = ar = ManyDigits(digits)
        x = self.number(text)
        if name == "nome":
            self.nome, at0 = x, [ar.jtheta(i, 0, x) for i in (2, 3, 4)]
            self.m = (at0[0] / at0[1]) ** 4
            self.K = ar.pi / 2 * at0[1] ** 2
            self.K_prime = -ar.log(x) * self.K / ar.pi
        else:
            square = {"k": x**2, "k-prime": 1 - x**2, "m": x}
            self.m = ar.sin(x * ar.pi / 180) ** 2 if name == "modular-angle" else square[name]
            self.m = self.m if ar.im(self.m) else ar.re(self.m)
            self.K, self.K_prime = ar.ellipk(self.m), ar.ellipk(1 - self.m)
            self.nome = ar.exp(-ar.pi * self.K_prime / self.K)
        self.is_real = not ar.im(self.m)
        self.is_imaginary = self.is_real and ar.re(self.m) < 0
        self.is_large = self.is_real and ar.re(self.m) > 1
        if self.is_imaginary:
            self.nome = ar.re(self.nome)

    def number(self, text: str) -> Any:
        """Return the number of a text, complex if it ends with i or j."""
        at = max(text.rfind("+"), text.rfind("-"), 0)
        if text[-1] not in "ij":
            return self.ar.mpf(text)
        return self.ar.mpc(text[:at] or "0", text[at:-1])

    def theta(self, i: int, u: Any, order: int = 0) -> Any:
        """Return theta_i of pi u/2K, or its derivative by u."""
        scale = self.ar.pi / (2 * self.K)
        return scale**order * self.ar.jtheta(i, scale * u, self.nome, order)

    def zeta(self, ij: str, u: Any) -> Any:
        """Return Z_ij(u)."""
        return self.theta(NUMBER[ij], u, 1) / self.theta(NUMBER[ij], u)

    def functions(self, u: Any) -> dict[str, Any]:
        """Return the functions of a complex argument by column, but am, Omega and Pi."""
        ar = self.ar
        found = {pq: ar.ellipfun(pq, u, m=self.m) for pq in PQ}
        for ij, i in NUMBER.items():
            found[f"theta{i}"], found[f"theta{ij}"] = ar.jtheta(i, u, self.nome), self.theta(i, u)
            found[f"zeta{ij}"] = self.zeta(ij, u)
            at_0 = self.theta(i, 0, int(i == 1))
            found[f"theta_{'scdn'[i - 1]}"] = self.theta(i, u) / at_0
        found["epsilon"] = found["zeta01"] + u * ar.ellipe(self.m) / ar.ellipk(self.m)
        return found

    def am(self, u: Any) -> Any:
        """Return am u in radians for m < 1, None beyond its branch points."""
        ar, q = self.ar, self.ar.re(self.nome)
        x = ar.pi * u / (2 * self.K)
        terms, size = ar.mpc(x), ar.exp(2 * abs(ar.im(x)))
        if abs(q) * size >= 1:
            return None
        n, weight = 1, q
        while abs(weight) * size**n > ar.eps * ar.mpf("1e-5"):
            terms += 2 * weight / (n * (1 + q ** (2 * n))) * ar.sin(2 * n * x)
            n, weight = n + 1, weight * q
        return terms

    def third_kind(self, u: Any, v: Any) -> dict[str, Any]:
        """Return Omega_ij(u, v) and Pi_ij(u, v) by column, for a real k^2."""
        found = {}
        for ij in THIRD:
            found[f"omega{ij}"] = omega = self._omega(ij, u, v)
            found[f"pi{ij}"] = u * self.zeta(ij, v) + omega
        return found

    def _omega(self, ij: str, u: Any, v: Any) -> Any:
        """Return Omega_ij(u, v) by that of the modulus in (0, 1) to which k is transformed."""
        ar, m = self.ar, self.m
        inner = 1 / m if self.is_large else -m / (1 - m) if self.is_imaginary else m
        stretch = ar.sqrt(m if self.is_large else 1 - m if self.is_imaginary else 1)
        K, ratio = ar.ellipk(inner), ar.ellipk(1 - inner) / ar.ellipk(inner)
        if self.is_imaginary:
            ij = {"01": "00", "00": "01"}.get(ij, ij)
        elif self.is_large:
            ij = {"00": "10"}.get(ij, ij)
        z, w = (x * stretch / (2 * K) for x in (u, v))
        value = (self._logarithm(ij, z - w, ratio) - self._logarithm(ij, z + w, ratio)) / 2
        if self.is_large:  # the factor exp(-i pi z^2/(1 - tau)) of the transformation
            value += 2j * ar.pi * z * w / (1 - ar.mpc(0, ratio))
        return value

    def _logarithm(self, ij: str, z: Any, ratio: Any) -> Any:
        """Return log theta_ij(z) up to a constant, for tau = iT; on a line of zeros, its mean."""
        ar, odd = self.ar, ij[0] == "1"
        height, half = ar.im(z) / ratio, ar.mpf("0.5")
        if odd and not height:
            return ar.mpc(ar.re(self._in_strip(ij, z, half, ratio)))
        number = ar.floor(height) + half if odd else ar.floor(height + half)
        return self._in_strip(ij, z, number, ratio)

    def _in_strip(self, ij: str, z: Any, number: Any, ratio: Any) -> Any:
        ar, tau = self.ar, self.ar.mpc(0, ratio)
        sign = -1 if ij[1] == "1" else 1
        below = sign * ar.expjpi(2 * (z - (number - 0.5) * tau))
        above = sign * ar.expjpi(-2 * (z - (number + 0.5) * tau))
        step, factor = ar.exp(-2 * ar.pi * ratio), ar.mpf(1)
        total = 1j * ar.pi * (number**2 * tau - 2 * number * z + number * (sign < 0))
        while factor > ar.eps * ar.mpf("1e-5"):
            total += ar.log1p(factor * below) + ar.log1p(factor * above)
            factor *= step
        return total


def cells_of(lagtop: Lagtop, *args: str, digits: int | None = DIGITS) -> dict[str, list[str]]:
    """Return the cells of `lagtop jacobi` by column."""
    more = ["--digits", f"{digits}"] if digits else []
    shown = lagtop("jacobi", *args, *more, "--format", "csv")
    assert shown.exit_code == 0, (args, shown.stderr)
    return columns_of(shown.stdout)


def check(cells: dict[str, list[str]], exact: dict[str, Any], where: Any, i: int = 0) -> int:
    """Check all cells of a row to the last digit, and return their number; None is empty."""
    seen, ar = 0, ManyDigits(60)
    for column, texts in cells.items():
        name, text = column.removesuffix("_re").removesuffix("_im"), texts[i]
        if name not in exact:
            continue
        seen += 1
        assert (exact[name] is None) == (text == ""), (column, where)
        if exact[name] is None:
            continue
        true = ar.im(exact[name]) if column.endswith("_im") else ar.re(exact[name])
        if not column.endswith(("_re", "_im")):
            assert abs(ar.im(exact[name])) < ar.mpf("1e-30") * (1 + abs(exact[name])), (name, where)
        unit = ar.mpf(10) ** (Decimal(text).adjusted() - DIGITS + 1)
        slack = unit * ar.mpf("0.5001") if Decimal(text) else ar.mpf("1e-30")
        assert abs(ar.mpf(text) - true) <= slack, (column, text, true, where)
    return seen
