"""Section 4 g to l: the motion by functions of the imaginary modulus kappa.

With xi = sn(eta, kappa) the cosine is u1 - (u1 - u2) xi^2.  Spin and precession are functions Pi01
of two parameters alpha1 and alpha2.  The paper does not evaluate these functions.  This module
computes each function of kappa = i k_bar by the paper's own transformations to the modulus k =
k_bar k'. Examples are sn(v, kappa) = k' sd(v/k', k), (3,4) and (3,5).  All numbers belong to an
mpmath context.  Equation numbers are Chrapan's. sigma is the sign of r0, which he takes as
positive.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, NamedTuple

from ...elliptic.incomplete import incomplete_f
from ...elliptic.jacobi import jacobi
from ...elliptic.many_digits import ManyDigits
from ...elliptic.modulus import constants, modulus
from ...elliptic.third_kind import pi_function
from ...errors import LagtopError

if TYPE_CHECKING:
    from ..solve import Motion


class SnCnDn(NamedTuple):
    """The functions sn, cn, dn at one argument, or their squares."""

    sn: Any
    cn: Any
    dn: Any


class ImaginaryForm:
    """The motion of a top released from rest, with the imaginary modulus of section 4 g."""

    def __init__(self, ar: ManyDigits, *, a: Any, r0: Any, u1: Any, u2: Any, u3: Any) -> None:
        """Take a context, a of (4,4), the spin rate and the roots of (4,9)."""
        self.ar, self.r0, self.sigma = ar, r0, ar.sign(r0)
        self.u1, self.u2, self.u3 = u1, u2, u3
        self.modulus = modulus(ar, k=ar.sqrt((u1 - u2) / (u3 - u2)))
        self.rate = ar.sqrt(a * (u3 - u1)) / 2

    @property
    def kappa_squared(self) -> Any:
        """The square of the modulus, -(u1 - u2)/(u3 - u1), which is negative (4 g)."""
        return -(self.u1 - self.u2) / (self.u3 - self.u1)

    @property
    def kappa(self) -> Any:
        """The imaginary modulus (4 g)."""
        return self.ar.mpc(0, self.ar.sqrt(-self.kappa_squared))

    @property
    def kappa_prime(self) -> Any:
        """The complementary modulus, which is greater than 1 (4 g)."""
        return self.ar.sqrt((self.u3 - self.u2) / (self.u3 - self.u1))

    @property
    def half_periods(self) -> tuple[Any, Any]:
        """The constants K and iK' of kappa: k' K and k' (iK' + K) of the real modulus k."""
        real, k_prime = constants(self.ar, self.modulus), self.modulus.k_prime
        return k_prime * real.K, k_prime * self.ar.mpc(real.K, real.K_prime)

    def eta(self, t: Any) -> Any:
        """Return the argument eta = sqrt(a (u3 - u1)) t/2 at a time (4 g)."""
        return self.rate * t

    def jacobi(self, v: Any) -> SnCnDn:
        """Return sn, cn, dn of a real or complex v for the modulus kappa: k' sd, cd and nd of k."""
        k_prime = self.modulus.k_prime
        _, sn, cn, dn = jacobi(self.ar, v / k_prime, self.modulus)
        return SnCnDn(k_prime * sn / dn, cn / dn, 1 / dn)

    def u(self, t: Any) -> Any:
        """Return cos theta = u1 - (u1 - u2) sn^2(eta, kappa) at a time (4 g)."""
        return self.u1 - (self.u1 - self.u2) * self.jacobi(self.eta(t)).sn ** 2

    @property
    def alpha(self) -> Any:
        """The parameter alpha = F(phi, k') (1,6), with phi of (7,2)."""
        amplitude = self.ar.asin(self.ar.sqrt((self.u3 - self.u2) / (self.u3 + 1)))
        return incomplete_f(self.ar, amplitude, modulus(self.ar, k=self.modulus.k_prime))

    @property
    def parameters(self) -> tuple[Any, Any]:
        """The parameters alpha1 = i alpha k' and alpha2 = alpha1 + iK' (4 j)."""
        first = self.ar.mpc(0, self.alpha * self.modulus.k_prime)
        return first, first + self.half_periods[1]

    @property
    def squares(self) -> tuple[SnCnDn, SnCnDn]:
        """The squares of sn, cn, dn at alpha1 and at alpha2, from the roots (4 i)."""
        u1, u2, u3 = self.u1, self.u2, self.u3
        south, north = 1 + u1, 1 - u1
        return (
            SnCnDn(-(u3 - u1) / south, (u3 + 1) / south, (1 + u2) / south),
            SnCnDn((u3 - u1) / north, -(u3 - 1) / north, (1 - u2) / north),
        )

    @property
    def at_parameters(self) -> tuple[SnCnDn, SnCnDn]:
        """The functions sn, cn, dn at alpha1 and at alpha2, from the roots (4 i).

        The paper gives the squares and takes positive roots.  At alpha2 = alpha1 + iK', sn and dn
        are negative.
        """
        first, second = (
            SnCnDn(*(self.ar.sqrt(self.ar.mpc(x)) for x in part)) for part in self.squares
        )
        return first, SnCnDn(-second.sn, second.cn, -second.dn)

    def pi01(self, t: Any) -> tuple[Any, Any]:
        """Return Pi01(eta, alpha1, kappa) and Pi01(eta, alpha2, kappa) at a time.

        The functions follow from (3,4), and (3,3) with (3,5).  Modulo i pi they are continuous in
        t, and their sum is 0 at t = 0.
        """
        w, parameter = self.eta(t) / self.modulus.k_prime, self.ar.mpc(0, self.alpha)
        first, second = (
            pi_function(self.ar, kind, w, parameter, self.modulus) for kind in ("00", "11")
        )
        return first, second + self.ar.mpc(0, self.ar.pi / 2)

    def psi(self, t: Any) -> Any:
        """Return the precession sigma i (Pi01(eta, alpha1) + Pi01(eta, alpha2)) (4 i)."""
        first, second = self.pi01(t)
        return -self.sigma * self.ar.im(first + second)

    def phi(self, t: Any) -> Any:
        """Return the spin r0 t + sigma i (Pi01(eta, alpha1) - Pi01(eta, alpha2)) (4 l)."""
        first, second = self.pi01(t)
        return self.r0 * t - self.sigma * self.ar.im(first - second)


def imaginary_form(motion: Motion, digits: int = 30) -> ImaginaryForm:
    """Return the imaginary form of a motion, in numbers with a few more than `digits` digits.

    Raises LagtopError unless the top spins and nutates after release from rest.
    """
    if motion.roots_sum is None or not motion.top.r0:
        raise LagtopError(
            "for the imaginary form the top must spin and nutate after release from rest, "
            f"got {motion.top}"
        )
    ar = ManyDigits(digits + 10)
    names = ["r0", "a", "u1", "u2", "u3"]
    numbers = motion.record(digits=digits + 10, keys=names)
    return ImaginaryForm(ar, **{name: ar.mpf(text) for name, text in numbers.items()})
