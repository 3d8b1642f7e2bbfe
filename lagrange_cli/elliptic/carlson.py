"""Carlson's symmetric elliptic integrals R_F, R_C, R_D, R_J by duplication (DLMF 19.36(i)).

Real arguments as stated, or complex ones off the negative axis in mpmath.  Each step replaces the
arguments by others four times closer to their mean; the rest is a Taylor series about the mean.
"""

from __future__ import annotations

from .arithmetic import Arithmetic, Real, epsilon, everywhere


def carlson_rf(ar: Arithmetic, x: Real, y: Real, z: Real) -> Real:
    """Carlson's R_F(x, y, z) for x, y, z >= 0, at most one of them zero (DLMF 19.36.1).

    F(phi, k) = sin(phi) R_F(cos^2 phi, 1 - k^2 sin^2 phi, 1).
    """
    tolerance = (epsilon(ar) / 4) ** (ar.sqrt(1) / 8)
    while True:
        mean = (x + y + z) / 3
        dx, dy = 1 - x / mean, 1 - y / mean
        dz = -dx - dy
        if everywhere((abs(dx) < tolerance) & (abs(dy) < tolerance) & (abs(dz) < tolerance)):
            break
        root_x, root_y, root_z = ar.sqrt(x), ar.sqrt(y), ar.sqrt(z)
        shift = root_x * root_y + root_y * root_z + root_z * root_x
        x, y, z = (x + shift) / 4, (y + shift) / 4, (z + shift) / 4
    e2, e3 = dx * dy - dz * dz, dx * dy * dz
    series = -e2 / 10 + e3 / 14 + e2 * e2 / 24 - 3 * e2 * e3 / 44
    series += -5 * e2**3 / 208 + 3 * e3 * e3 / 104 + e2 * e2 * e3 / 16
    return (1 + series) / ar.sqrt(mean)
