"""First-order propagation of uncertainties (GUM 5.1.2), by the exact derivatives of the record."""

from __future__ import annotations

import math
from collections.abc import Collection, Mapping
from typing import Any, NamedTuple

from ..arithmetic.angles import PER_RADIAN, unit_in_radians
from ..inputs.top import Top
from .record import TEXT_KEYS
from .sensitivities import sensitivities


class Contribution(NamedTuple):
    """What one input contributes to the uncertainty of a number, a line of a budget."""

    input: str
    value: float
    std: float
    sensitivity: float
    """The derivative of the number by the input."""
    contribution: float
    """Sensitivity times uncertainty, with its sign."""
    elasticity: float | None
    """By how many parts the number grows where the input grows by one part of itself."""
    share: float | None
    """The part of the variance."""


class FirstOrder:
    """Standard uncertainties of the record of a top, whose inputs are not correlated."""

    def __init__(self, top: Top, stds: Mapping[str, float], given: Collection[str]) -> None:
        """Take the uncertainties of the inputs as they were given, and the names of all inputs.

        Raises LagtopError for a top that has no motion.
        """
        self.top, self.stds, self.by_given = top, stds, by_given(top, given)
        self.sensitivities = sensitivities(top)

    def derivative(self, key: str, name: str) -> float | None:
        """Return the derivative of a key, or an input, by an input that was given.

        None says that the motion has no such key, NaN that it has no derivative.
        """
        by = self.by_given[name]
        if key in self.sensitivities.inputs or key in self.by_given:
            return by.get(key, 0.0)
        row = self.sensitivities.derivatives.get(key)
        return None if row is None else sum(row[one] * x for one, x in by.items())

    def std(self, key: str) -> float | None:
        """Return the standard uncertainty of a key or of an input; None where there is none."""
        parts = [(self.derivative(key, name), std) for name, std in self.stds.items()]
        if any(slope is None or math.isnan(slope) for slope, _ in parts):
            return None
        return math.hypot(*(slope * std for slope, std in parts if slope is not None))

    def budget(self, key: str, value: float, given: Mapping[str, float]) -> list[Contribution]:
        """Return what each uncertain input contributes to a key, the greatest first.

        `value` is that of the key, `given` has those of the inputs.
        """
        whole = self.std(key)
        lines = []
        for name, std in self.stds.items():
            slope = self.derivative(key, name)
            assert slope is not None
            part = slope * std
            elasticity = slope * given[name] / value if value else None
            share = part * part / (whole * whole) if whole else None
            lines.append(Contribution(name, given[name], std, slope, part, elasticity, share))
        return sorted(lines, key=lambda line: -abs(line.contribution))


def by_given(top: Top, given: Collection[str]) -> dict[str, dict[str, float]]:
    """Return the derivatives of the inputs of a solved top by those that were given.

    These are the same but for A = A_cm + m s^2 and r0 = phidot0 + psidot0 cos(theta0).
    """
    tilt = "theta0_deg" if top.theta0_rad is None else "theta0_rad"
    angle = float(top.theta0_rad or 0) if top.theta0_deg is None else math.radians(top.theta0_deg)
    arc = unit_in_radians(radians=top.theta0_deg is None)
    m, s, psi_rate = float(top.m), float(top.s), float(top.psidot0)
    names = ["m", "A", "C", "s", "g", "r0", tilt, "thetadot0", "psidot0"]
    chain = {name: {name: 1.0} for name in names}
    if "A_cm" in given:
        del chain["A"]
        chain["A_cm"] = {"A": 1.0}
        chain["m"]["A"], chain["s"]["A"] = s * s, 2 * m * s
    if "phidot0" in given:
        del chain["r0"]
        chain["phidot0"] = {"r0": 1.0}
        chain["psidot0"]["r0"] = math.cos(angle)
        chain[tilt]["r0"] = -psi_rate * math.sin(angle) * arc
    return chain


def stds_of(record: Mapping[str, Any], uncertain: FirstOrder) -> dict[str, float | None]:
    """Return `KEY_std` for every number of a record, in its units."""
    stds = {}
    for name, value in record.items():
        if isinstance(value, str) or name in TEXT_KEYS:
            continue
        degrees = f"{name.removesuffix('_rad')}_deg" if name.endswith("_rad") else name
        tilt = {"theta0_deg", "theta0_rad"} & uncertain.by_given.keys()
        key = tilt.pop() if degrees == "theta0_deg" else degrees
        std = None if value is None else uncertain.std(key)
        scale = 1.0
        if key != name:  # the other unit of an angle
            scale = 1 / PER_RADIAN if name.endswith("_rad") else PER_RADIAN
        stds[f"{name}_std"] = None if std is None else std * scale
    return stds
