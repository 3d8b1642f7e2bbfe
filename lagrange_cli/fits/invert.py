"""`find --from`: a top by the turning points, the period and the mean precession of its motion."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence

from ..arithmetic.numbers import unit_in_radians
from ..errors import AbsentError, LagtopError
from ..inputs.top import Top
from ..motion.quantity import unit_name
from ..motion.solve import Motion, solve
from .conditions import read_conditions
from .implied_body import completed_body, determined_products
from .turning_points import TurningPoints, top_of, with_mean_rate

_SEEN = ("theta_min_deg", "theta_max_deg", "T_nutation", "mean_precession_rate")
_SPIN = "mean_spin_rate"


def invert(
    seen: Sequence[str], *, radians: bool = False, known: Mapping[str, float] | None = None
) -> list[Motion]:
    """Return the motions with these numbers, which start at their least tilt.

    `seen` are KEY=NUMBER of theta_min, theta_max, T_nutation and mean_precession_rate, and may be
    mean_spin_rate; `known` are inputs of the body.  They tell a and b in closed form but for one
    root, and with the spin C/A; what they do not determine is 1, or such that C = A.  Raises
    LagtopError, AbsentError where no top moves so.
    """
    numbers = _numbers(seen, radians)
    unit = unit_in_radians(radians=radians)
    least, greatest, period, rate = (numbers[unit_name(key, radians=radians)] for key in _SEEN)
    nutation = TurningPoints(least * unit, greatest * unit, period).checked(radians=radians)
    known = known or {}
    for name, value in known.items():
        if not value:
            raise LagtopError(f"{name} must not be 0 in a top that nods: leave it out", name)
    spin = known.get("r0")  # of the sign of b
    found = [x for x in with_mean_rate(nutation, rate) if spin is None or spin * float(x.b) > 0]
    if not found:
        raise AbsentError(
            f"no top nods between these tilts in this time and precesses by {rate:g} on average"
            + ("" if spin is None else f" with r0 = {spin:g}")
        )
    tops = [top_of(nutation, one, numbers.get(_SPIN)) for one in found]
    return [solve(_of_body(top, known, _SPIN in numbers)) for top in tops]


def _numbers(seen: Sequence[str], radians: bool) -> Mapping[str, float]:
    """Return the numbers by key.  Raises LagtopError for a wrong set of them."""
    conditions = read_conditions(seen, radians=radians)
    needed = {unit_name(key, radians=radians) for key in _SEEN}
    given = set(conditions.numbers)
    if conditions.words or conditions.bounds or not needed <= given <= needed | {_SPIN}:
        wanted = "=.. ".join([*_SEEN, ""]).replace("_deg", "")
        shown = " ".join(seen)[:100] or "nothing"
        raise LagtopError(f"from must have {wanted}and may have {_SPIN}=.., got {shown}", "from")
    return conditions.numbers


def _of_body(top: Top, known: Mapping[str, float], spins: bool) -> Top:
    """Return a top that moves so and has the inputs of the body that are known."""
    a, b, r0 = 2 * float(top.g), float(top.C) * float(top.r0), float(top.r0)
    numbers = {"a": a, "b": b} | ({"r0": r0} if spins else {})
    inputs = completed_body(numbers, known, determined_products(numbers, known))
    given = ", ".join(f"{name} = {value:g}" for name, value in known.items())
    if not _moves_so(inputs, numbers):
        raise LagtopError(f"{given} must leave the motion open, which has other numbers: give less")
    ratio = inputs["C"] / inputs["A"]
    if not 0 < ratio <= 2:
        raise LagtopError(
            f"the motion with {given} must be that of a body with 0 < C/A <= 2, "
            f"got C/A = {ratio:.6g}"
        )
    return top.replace(**inputs)


def _moves_so(inputs: Mapping[str, float], numbers: Mapping[str, float]) -> bool:
    """Return whether a body has these numbers of a (4,4), b (4,5) and r0 but for rounding."""
    m, A, C, s, g, r0 = (inputs[name] for name in ("m", "A", "C", "s", "g", "r0"))
    has = {"a": 2 * m * g * s / A, "b": C * r0 / A, "r0": r0}
    return all(math.isclose(has[name], x, rel_tol=1e-9) for name, x in numbers.items())
