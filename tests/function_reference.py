"""The functions of `lagtop jacobi` by mpmath, with formulas that the package does not use.

- am is Jacobi's series in the nome (3.1.7), or arcsin sn for k > 1; sn, cn and dn are
  `mpmath.ellipfun`.
- Theta and Zeta functions are `mpmath.jtheta` in the nome of the modulus itself.
- Omega and Pi are sums of logarithms over the infinite products of theta functions.  In the strip
  between two lines of zeros every factor is 1 - w with |w| < 1, so the sum of the principal
  logarithms is continuous.  It is the branch that the README of `elliptic` describes.

Numbers belong to a context of mpmath, and have its digits except the last few.
"""

from __future__ import annotations

from typing import Any

from ours import ManyDigits

NUMBER = {"01": 4, "00": 3, "11": 1, "10": 2}


class Reference:
    """The functions of one modulus, such as `0.8` in (0, 1), `0.8i`, or `2` above 1."""

    def __init__(self, text: str, digits: int = 50) -> None:
        self.ar = ar = ManyDigits(digits)
        k = ar.mpf(text.removesuffix("i"))
        self.m = m = -k * k if text.endswith("i") else k * k
        self.is_large, self.is_imaginary = m > 1, m < 0
        self.stretch = k if self.is_large else ar.sqrt(1 - m) if self.is_imaginary else ar.mpf(1)
        inner = 1 / m if self.is_large else -m / (1 - m) if self.is_imaginary else m
        self.K, self.K_prime = ar.ellipk(inner), ar.ellipk(1 - inner)
        self.ratio = self.K_prime / self.K
        tau = ar.mpc(0, self.ratio)
        self.rate, self.nome = self.stretch / (2 * self.K), ar.exp(-ar.pi * self.ratio)
        if self.is_large:
            self.rate, self.nome = self.rate / (1 - tau), ar.expjpi(tau / (1 - tau))
        elif self.is_imaginary:
            self.nome = -self.nome

    def jacobi(self, u: Any) -> tuple[Any, Any, Any, Any]:
        """Return am (None beyond its branch points), sn, cn, dn."""
        ar = self.ar
        sn, cn, dn = (ar.ellipfun(name, u, m=self.m) for name in ("sn", "cn", "dn"))
        if self.is_large:
            return ar.asin(sn), sn, cn, dn
        x, q = ar.pi * u * self.rate, ar.re(self.nome)
        terms, size = ar.mpc(x), ar.exp(2 * abs(ar.im(x)))
        if abs(q) * size >= 1:  # beyond the branch points of am
            return None, sn, cn, dn
        n, weight = 1, q
        while abs(weight) * size**n > ar.eps * ar.mpf("1e-5"):
            terms += 2 * weight / (n * (1 + q ** (2 * n))) * ar.sin(2 * n * x)
            n, weight = n + 1, weight * q
        return terms, sn, cn, dn

    def theta(self, ij: str, v: Any, order: int = 0) -> Any:
        """Return Theta_ij(v), or a derivative by v."""
        scale = self.ar.pi * self.rate
        return scale**order * self.ar.jtheta(NUMBER[ij], scale * v, self.nome, order)

    def zeta(self, ij: str, v: Any) -> Any:
        """Return Z_ij(v)."""
        return self.theta(ij, v, 1) / self.theta(ij, v)

    def omega(self, ij: str, u: Any, v: Any) -> Any:
        """Return Omega_ij(u, v)."""
        ar, z, w = self.ar, *(x * self.stretch / (2 * self.K) for x in (u, v))
        inner = ij
        if self.is_imaginary:
            inner = {"01": "00", "00": "01"}.get(ij, ij)
        elif self.is_large:
            inner = {"00": "10"}.get(ij, ij)
        value = (self._logarithm(inner, z - w) - self._logarithm(inner, z + w)) / 2
        if self.is_large:  # the factor exp(-i pi z^2/(1 - tau)) of the transformation
            value += 2j * ar.pi * z * w / (1 - ar.mpc(0, self.ratio))
        return value

    def pi(self, ij: str, u: Any, v: Any) -> Any:
        """Return Pi_ij(u, v)."""
        return u * self.zeta(ij, v) + self.omega(ij, u, v)

    def _logarithm(self, ij: str, z: Any) -> Any:
        """Return log theta_ij(z) up to a constant, for tau = iT; on a line of zeros, its mean."""
        ar, T, odd = self.ar, self.ratio, ij[0] == "1"
        height, half = ar.im(z) / T, ar.mpf("0.5")
        if odd and not height:
            return ar.mpc(ar.re(self._in_strip(ij, z, half)))
        number = ar.floor(height) + half if odd else ar.floor(height + half)
        return self._in_strip(ij, z, number)

    def _in_strip(self, ij: str, z: Any, number: Any) -> Any:
        ar, tau = self.ar, self.ar.mpc(0, self.ratio)
        sign = -1 if ij[1] == "1" else 1
        below = sign * ar.expjpi(2 * (z - (number - 0.5) * tau))
        above = sign * ar.expjpi(-2 * (z - (number + 0.5) * tau))
        step, factor = ar.exp(-2 * ar.pi * self.ratio), ar.mpf(1)
        total = 1j * ar.pi * (number**2 * tau - 2 * number * z + number * (sign < 0))
        while factor > ar.eps * ar.mpf("1e-5"):
            total += ar.log1p(factor * below) + ar.log1p(factor * above)
            factor *= step
        return total
