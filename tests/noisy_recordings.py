"""Noisy recordings of integrators for the tests of `fit`, and what their fits must be."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np
from engines import Array, Body, dop853
from lagtop import Top, fit
from machines import gimballed, unlike
from scipy.spatial.transform import Rotation

from lagrange_cli.inverse.measured import Measured, measured
from lagrange_cli.inverse.outcome import Outcome
from lagrange_cli.recordings.recording import recording_of

DEGREE = math.pi / 180
TOP = Top(m=0.5, A=4.45e-3, C=2.5e-3, s=0.08, g=9.81, r0=52.36, theta0_deg=75)
"""A disc on an axle, released from rest."""
TRUTH = {"a": 2 * 0.5 * 9.81 * 0.08 / 4.45e-3, "b": 2.5e-3 / 4.45e-3 * 52.36, "r0": 52.36}
LAB = {"m": 0.5, "g": 9.81, "s": 0.08}


def recording_from(t: Array, **arrays: Array) -> Measured:
    """Return the measured motion in arrays of radians."""
    return measured(recording_of(t, arrays))


def motion_of(top: Top, t: Array, **sizes: float) -> dict[str, Array]:
    """Return the angles of a top at times by Euler's equations, or of a machine of some sizes."""
    one = Body.of(top)
    if sizes:
        a, b, r0 = 2 * one.torque / one.A, one.C / one.A * one.rates[2], one.rates[2]
        start = np.array([one.tilt, float(top.thetadot0), float(top.psidot0)])
        move = unlike if sizes.keys() & {"moments", "beside"} else gimballed
        return move(a, b, r0, start, t, **sizes)
    turns = Rotation.from_quat(dop853(one, t)[1][:, :4], scalar_first=True)
    psi, theta, phi = turns.as_euler("ZXZ").T
    return {"theta": theta, "phi": phi, "psi": psi}


def recorded(
    *names: str,
    top: Top = TOP,
    t: Array | None = None,
    rows: int = 50,
    seconds: float = 0.9,
    noise: float = 0.3,
    seed: int,
    sizes: Mapping[str, float] | None = None,
) -> tuple[Array, dict[str, Array]]:
    """Return times and angles within half a turn, with noise in degrees; sizes are a machine's."""
    t = np.linspace(0, seconds, rows) if t is None else t
    exact, rng = motion_of(top, t, **sizes or {}), np.random.default_rng(seed)
    found = {x: exact[x] + rng.normal(scale=noise * DEGREE, size=t.size) for x in names}
    return t, {x: y if x == "theta" else np.angle(np.exp(1j * y)) for x, y in found.items()}


def attitude_of(angles: Mapping[str, Array]) -> Rotation:
    """Return the rotations from the body to space."""
    return Rotation.from_euler("ZXZ", np.stack([angles[x] for x in ("psi", "theta", "phi")], 1))


def axis_of(theta: Array, psi: Array) -> Array:
    """Return the figure axis, shape (n, 3)."""
    flat = np.sin(theta)
    return np.stack([flat * np.sin(psi), -flat * np.cos(psi), np.cos(theta)], axis=-1)


def fitted(t: Array, seen: Mapping[str, Array], **options: Any) -> Outcome:
    """Return the fit of a recording."""
    arrays: dict[str, Any] = dict(seen)
    return fit(t, **arrays, **options)


def pulls(outcome: Outcome, truth: Mapping[str, float]) -> dict[str, float]:
    """Return how far numbers are from the truth, in standard deviations."""
    found = outcome.numbers
    return {x: (found[x].value - y) / found[x].std for x, y in truth.items() if x in found}


def assert_true(outcome: Outcome, truth: Mapping[str, float], *, least: int = 2) -> None:
    """Check that a fit is good, and that its numbers are right."""
    assert outcome.verdict == "good", outcome.failures()
    off = pulls(outcome, truth)
    assert len(off) >= least
    assert all(abs(x) < 4 for x in off.values()), off
