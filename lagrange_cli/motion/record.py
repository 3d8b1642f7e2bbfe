"""The record of one motion: its regime and its numbers, under their keys."""

# Annotations are evaluated here: as texts, the named tuples would compile each at start-up.

import math
from enum import Enum
from typing import Any, NamedTuple

from ..arithmetic.generic import Arithmetic, Real, where
from ..inputs.top import Top


class Regime(Enum):
    """What kind of motion a scene describes; decided once."""

    REGULAR = "regular"
    STEADY = "steady precession"
    SEPARATRIX = "separatrix"
    SLEEPING = "sleeping"
    HANGING = "hanging"
    TORQUE_FREE = "torque-free"
    NO_SPIN = "no spin"


class Record(NamedTuple):
    """The numbers of one motion.  A number that the regime does not have is None."""

    top: Top
    regime: Regime
    a: Real
    b: Real
    u1: Real | None = None
    u2: Real | None = None
    u3: Real | None = None
    k: Real | None = None
    k_prime: Real | None = None
    modular_angle_deg: Real | None = None
    nome: Real | None = None
    K: Real | None = None
    K_prime: Real | None = None
    E: Real | None = None
    amplitude_deg: Real | None = None
    alpha: Real | None = None
    T_nutation: Real | None = None
    T_spin: Real | None = None
    T_precession: Real | None = None
    u_quarter: Real | None = None
    theta_min_deg: Real | None = None
    theta_max_deg: Real | None = None
    mean_spin_rate: Real | None = None
    mean_precession_rate: Real | None = None
    spin_rate_start: Real | None = None
    spin_rate_half: Real | None = None
    precession_rate_start: Real | None = None
    precession_rate_half: Real | None = None
    path: str | None = None
    """Of the figure axis: `cusped`, `looping` or `wavy`."""
    remark: str | None = None

    def numbers(self) -> dict[str, Real | None]:
        """The numbers by key."""
        return dict(zip(NUMBER_KEYS, self[2:-2], strict=True))

    def record(self, *, radians: bool = False, ar: Arithmetic = math) -> dict[str, Any]:
        """Inputs and results by key, in the order of the paper; `radians` renames _deg to _rad.

        `ar` is the arithmetic of the numbers.
        """
        numbers = self.numbers()
        if radians:
            numbers = dict(_in_radians(ar, key, value) for key, value in numbers.items())
        inputs = self.top.inputs(radians=radians, ar=ar)
        if self.top.is_released:  # it starts at its least tilt, which is the tilt given
            unit = "rad" if radians else "deg"
            numbers[f"theta_min_{unit}"] = inputs[f"theta0_{unit}"]
        texts = {"path": self.path, "remark": self.remark}
        return inputs | {"regime": self.regime.value} | numbers | texts


NUMBER_KEYS = Record._fields[2:-2]


def _in_radians(ar: Arithmetic, key: str, value: Real | None) -> tuple[str, Real | None]:
    if not key.endswith("_deg"):
        return key, value
    return key.removesuffix("deg") + "rad", None if value is None else value * (ar.pi / 180)


def constant_rates(
    tilt_deg: Real, spin_rate: Real, precession_rate: Real | None, two_pi: Real
) -> dict[str, Any]:
    """Numbers of the record of a motion whose tilt and rates do not change."""
    return {
        "theta_min_deg": tilt_deg,
        "theta_max_deg": tilt_deg,
        "T_spin": period_of(spin_rate, two_pi),
        "T_precession": period_of(precession_rate, two_pi),
        "mean_spin_rate": spin_rate,
        "spin_rate_start": spin_rate,
        "mean_precession_rate": precession_rate,
        "precession_rate_start": precession_rate,
    }


def period_of(rate: Real | None, two_pi: Real) -> Real | None:
    """2 pi over a mean rate (section 8); None, or NaN in an array, where it stands still."""
    if hasattr(rate, "all"):
        return two_pi / abs(where(rate == 0, math.nan, rate))
    return two_pi / abs(rate) if rate else None
