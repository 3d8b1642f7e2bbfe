"""Recordings as a camera makes them: `python tests/tools/recordings.py` writes them as samples.

The motions are exact.  The camera sees the tilt and the precession with some noise, loses frames,
and sees the mark on the rotor only while that is in front.
"""

from __future__ import annotations

from pathlib import Path
from typing import NamedTuple

import numpy as np
from lagtop import Top, solve

SAMPLES = Path(__file__).parents[2] / "sample_inputs"
FIRST, PSI_ZERO, PHI_ZERO = 3.25, 137.0, 62.0
"""The time on the clock of the camera, and where its zeros are, in degrees."""
DROPPED = 0.05
"""Share of the frames that are lost."""
BODY = {"m": 1.587, "A": 3.9032e-3, "C": 1.7458e-3, "s": 0.04, "g": 9.81}
TOP = Top(**BODY, r0=50, theta0_deg=41, thetadot0=1.3, psidot0=2.5)


class Camera(NamedTuple):
    """A recording: the top, the frames, and the noise of theta, psi and phi in degrees."""

    name: str
    top: Top
    rate: int
    seconds: float
    noise: tuple[float, float, float]
    comment: str


SMALL_TOP = Camera(
    *("recording.csv", TOP, 120, 2.0, (0.3, 0.5, 1.0)),
    "# A top of 1.587 kg, its centre of mass 0.04 m from the pivot; 120 frames a second.",
)
WHEEL = Camera(
    "tutorials/wheel.csv",
    Top(m=2.04, A=0.1313, C=0.1562, s=0.152, g=9.81, r0=23.7, theta0_deg=82, psidot0=0.35),
    *(60, 6.0, (0.15, 0.2, 1.0)),
    "# A bicycle wheel of 2.04 kg on a handle, seen from above; 60 frames a second.",
)


def wrapped(degrees: np.ndarray) -> np.ndarray:
    """Return angles brought to (-180, 180]."""
    return 180 - (180 - degrees) % 360


def text(camera: Camera = SMALL_TOP, seed: int = 1952) -> str:
    """Return a recording."""
    rng = np.random.default_rng(seed)
    t = np.arange(int(camera.rate * camera.seconds)) / camera.rate
    kept = rng.random(t.size) > DROPPED
    kept[0] = True
    t = t[kept]
    exact = dict(zip(("theta", "phi", "psi"), solve(camera.top).angles(t), strict=True))
    theta, psi, phi = (
        np.degrees(exact[name]) + rng.normal(scale=noise, size=t.size)
        for name, noise in zip(("theta", "psi", "phi"), camera.noise, strict=True)
    )
    psi, phi = wrapped(psi + PSI_ZERO), wrapped(phi + PHI_ZERO)
    lines = [
        camera.comment,
        "# Noise: theta {}, psi {}, phi {} ".format(*camera.noise)
        + "degrees; phi is of a mark seen in front only.",
        "t,theta_deg,psi_deg,phi_deg",
    ]
    for at, *angles in zip(t + FIRST, theta, psi, phi, strict=True):
        seen = abs(angles[2]) < 100
        cells = [f"{at:.4f}", *(f"{x:.2f}" for x in angles[:2]), f"{angles[2]:.1f}" if seen else ""]
        lines.append(",".join(cells))
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    for made in (SMALL_TOP, WHEEL):
        (SAMPLES / made.name).write_text(text(made))
