"""A recording as a camera makes it: `python tests/tools/recordings.py` writes it to sample_inputs.

The motion is exact.  The camera takes 120 pictures a second, sees the tilt and the precession with
some noise, loses frames, and sees the mark on the rotor only while that is in front.
"""

from __future__ import annotations

from pathlib import Path

import numpy as np

from lagrange_cli import Top, solve

PATH = Path(__file__).parents[2] / "sample_inputs" / "recording.csv"
TOP = Top(
    m=1.587,
    A=3.9032e-3,
    C=1.7458e-3,
    s=0.04,
    g=9.81,
    r0=50,
    theta0_deg=41,
    thetadot0=1.3,
    psidot0=2.5,
)
RATE, SECONDS, DROPPED = 120, 2.0, 0.05
THETA_NOISE, PSI_NOISE, PHI_NOISE = 0.3, 0.5, 1.0
"""Degrees."""
FIRST, PSI_ZERO, PHI_ZERO = 3.25, 137.0, 62.0
"""The time on the clock of the camera, and where its zeros are, in degrees."""


def wrapped(degrees: np.ndarray) -> np.ndarray:
    """Return angles brought to (-180, 180]."""
    return 180 - (180 - degrees) % 360


def text(seed: int = 1952) -> str:
    """Return the recording."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(RATE * SECONDS)) / RATE
    kept = rng.random(t.size) > DROPPED
    kept[0] = True
    t = t[kept]
    theta, phi, psi = (np.degrees(x) for x in solve(TOP).angles(t))
    theta += rng.normal(scale=THETA_NOISE, size=t.size)
    psi = wrapped(psi + PSI_ZERO + rng.normal(scale=PSI_NOISE, size=t.size))
    phi = wrapped(phi + PHI_ZERO + rng.normal(scale=PHI_NOISE, size=t.size))
    lines = [
        "# A top of 1.587 kg, its mass centre 0.04 m from the pivot; 120 frames a second.",
        "# Noise: theta 0.3, psi 0.5, phi 1.0 degrees; phi is of a mark seen in front only.",
        "t,theta_deg,psi_deg,phi_deg",
    ]
    for at, *angles in zip(t + FIRST, theta, psi, phi, strict=True):
        seen = abs(angles[2]) < 100
        cells = [f"{at:.4f}", *(f"{x:.2f}" for x in angles[:2]), f"{angles[2]:.1f}" if seen else ""]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PATH.write_text(text())
