"""One scene of the battery, judged: the worst errors of its record, angles and quaternion.

Every number of the record is judged against the double nearest to its exact value, every angle and
the quaternion in units (see `reference`), all by the many-digit reference.
"""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from fractions import Fraction
from typing import Any

import numpy as np

from ..arithmetic.numbers import DOUBLES
from ..arithmetic.points import ListedPoints
from ..arithmetic.types import Array
from ..inputs.top import Top
from ..motion.over_time.table import rows
from ..motion.record import NUMBER_KEYS
from ..motion.solve import Motion, solve
from .closed_forms import CLOSED_FORMS
from .hard_scenes import HardScene
from .integrators import integrators
from .method import FailedError, Method, NotApplicableError
from .reference import EPS, ExactAngles, Reference, angle_units, key_ulps, quaternion_units

CONTRACT = 4.0
"""Units of an angle and of the quaternion that are promised."""
KEY_CONTRACT = 0.5 + 1e-9
"""Gaps between doubles that a key may be off: half of one, and a hair where two are as near."""

DIGITS, MORE_DIGITS = 80, 110
"""Digits of the reference, and of the one that it is checked against."""

CONSERVED = ("energy", "Lz")
"""The columns whose changes are reported."""

INTEGRATOR = "DOP853-quaternion"
INTEGRATED_PERIODS, INTEGRATOR_SECONDS = (0.7, 2.3, 4.9), 2.0
"""The integrator would never reach the far times: it has times of its own, near the start."""


@dataclass(frozen=True, kw_only=True)
class Errors:
    """The worst errors of one scene, or of all the scenes of a stratum."""

    theta_units: float
    phi_units: float
    psi_units: float
    quaternion_units: float
    key_ulps: float
    """Worst error of a key, in gaps between doubles."""
    worst_key: str
    energy_eps: float
    """Change of the energy since t = 0, in eps of the sum of its terms."""
    Lz_eps: float
    """Change of the vertical angular momentum, in eps of the sum of its terms."""

    @property
    def angle_units(self) -> float:
        """The worst error of the three angles."""
        return max(self.theta_units, self.phi_units, self.psi_units)

    @property
    def excess(self) -> float:
        """The worst error over what is promised; more than 1 breaks the promise."""
        worst = max(self.angle_units, self.quaternion_units) / CONTRACT
        return max(worst, self.key_ulps / KEY_CONTRACT)


@dataclass(frozen=True, kw_only=True)
class Case(Errors):
    """One scene: its errors, where they were, and those of other methods."""

    top: Top
    worst_time: float
    """Time of the worst angle."""
    worst_attitude_time: float
    """Time of the worst quaternion."""
    scipy: float | None
    """Worst error of scipy.special in units; None where scipy is missing."""
    integrated: float | None
    """Worst error of DOP853 in units; None where scipy is missing."""
    agreement: float
    """Greatest difference of the reference at two precisions, in units."""

    def command(self) -> str:
        """Return a command line that shows the worst number of the scene."""
        options = self.top.options()
        angle, attitude, key = (
            self.angle_units / CONTRACT,
            self.quaternion_units / CONTRACT,
            self.key_ulps / KEY_CONTRACT,
        )
        if key > max(angle, attitude):
            return f"lagtop solve {options} --format json  # {self.worst_key}"
        if attitude > angle:
            t = self.worst_attitude_time
            return f"lagtop table {options} --columns t,quaternion --n 1 --t-min {t!r}"
        return f"lagtop bench --methods lagtop {options} --n 1 --t-max {self.worst_time!r}"


def case_of(
    top: Top,
    times: Sequence[float],
    units: Sequence[Sequence[float]],
    key: tuple[float, str],
    conserved: tuple[float, float],
    *,
    scipy: float | None = None,
    integrated: float | None = None,
    agreement: float = 0.0,
) -> Case:
    """Return a case from its errors: a row of `units` per time, the three angles and quaternion.

    `key` is the worst error of a key and its name, `conserved` the changes of energy and Lz.
    """
    theta, phi, psi, attitude = (max(errors) for errors in zip(*units, strict=True))
    return Case(
        theta_units=theta,
        phi_units=phi,
        psi_units=psi,
        quaternion_units=attitude,
        key_ulps=key[0],
        worst_key=key[1],
        energy_eps=conserved[0],
        Lz_eps=conserved[1],
        top=top,
        worst_time=times[int(np.argmax([max(errors[:3]) for errors in units]))],
        worst_attitude_time=times[int(np.argmax([errors[3] for errors in units]))],
        scipy=scipy,
        integrated=integrated,
        agreement=agreement,
    )


def judged_case(scene: HardScene, *, peers: bool = True) -> Case:
    """Return what one scene shows, with the errors of other methods or without."""
    top = Top(**scene.inputs)
    motion, reference = solve(top), Reference(top, DIGITS)
    times = np.array(scene.times(reference.T))
    exact = [reference.at(t) for t in times.tolist()]
    angles = _angle_errors(list(zip(*motion.angles(times), strict=True)), exact)
    values = tabulated(motion, times.tolist(), ("quaternion", *CONSERVED))
    attitudes = [
        quaternion_units(parts[:4], true)
        for parts, true in zip(values[1:].tolist(), exact, strict=True)
    ]
    again = Reference(top, MORE_DIGITS).at(times[0].item())
    return case_of(
        top,
        times.tolist(),
        [(*errors, attitude) for errors, attitude in zip(angles, attitudes, strict=True)],
        worst_key(motion, reference),
        conserved_changes(top, values[:, -2:]),
        scipy=peer_units(CLOSED_FORMS["scipy.special"], top, times, exact) if peers else None,
        integrated=_integrated(top, reference) if peers else None,
        agreement=max(angle_units(again[:3], exact[0])),
    )


def tabulated(motion: Motion, times: Sequence[float], columns: Sequence[str]) -> Array:
    """Return columns of `lagtop table`, angles in radians: a row for the start and one per time."""
    points = ListedPoints([Fraction(t) for t in (0.0, *times)])
    _, blocks = rows(motion, points, columns, radians=True)
    return np.concatenate(list(blocks))


def worst_key(motion: Motion, reference: Reference) -> tuple[float, str]:
    """Return the worst error of the numbers of a record, in gaps between doubles, and its key.

    A number where the motion has none, or the other way round, is infinitely wrong.
    """
    exact, errors = reference.record(), []
    for key in NUMBER_KEYS:
        value, true = getattr(motion, key), exact[key]
        if value is None or true is None:
            errors.append((0.0 if value is true else math.inf, key))
        else:
            errors.append((key_ulps(value, true, DIGITS), key))
    return max(errors)


def conserved_changes(top: Top, values: Array) -> tuple[float, float]:
    """Return the changes of energy and Lz, the columns of `values`, since its first row, t = 0.

    They are in eps of the sum of the terms.
    """
    tilt = top.tilt(DOUBLES)
    a = 2 * float(top.m) * float(top.g) * float(top.s) / float(top.A)
    around = float(top.psidot0) * tilt.sin
    swing = float(top.thetadot0) ** 2 + around**2 + a * (1 + abs(tilt.cos))
    momentum = float(top.C) * abs(float(top.r0))
    sizes = (
        float(top.A) * swing / 2 + momentum * abs(float(top.r0)) / 2,
        float(top.A) * abs(around) * tilt.sin + 2 * momentum,
    )
    energy, Lz = (np.max(abs(values - values[0]), axis=0) / (EPS * np.array(sizes))).tolist()
    return energy, Lz


def peer_units(
    method: Method, top: Top, times: Array, exact: Sequence[ExactAngles]
) -> float | None:
    """Return the worst error of another method at its tightest setting.

    Infinite where it fails, None where its package is missing.
    """
    try:
        method.check_package()
    except NotApplicableError:
        return None
    try:
        with np.errstate(all="ignore"):
            rows_found = list(zip(*method.prepare(top, method.settings[-1])(times), strict=True))
    except (FailedError, ArithmeticError, ValueError):  # formulas of others in doubles
        return math.inf
    return max(max(error) for error in _angle_errors(rows_found, exact, method.whole_turns))


def _integrated(top: Top, reference: Reference) -> float | None:
    times = np.array(INTEGRATED_PERIODS) * float(reference.T)
    exact = [reference.at(t) for t in times.tolist()]
    return peer_units(integrators(INTEGRATOR_SECONDS)[INTEGRATOR], top, times, exact)


def _angle_errors(
    computed: Sequence[Sequence[Any]], exact: Sequence[ExactAngles], whole_turns: bool = True
) -> list[tuple[float, float, float]]:
    pairs = zip(computed, exact, strict=True)
    return [angle_units(angles, true, whole_turns=whole_turns) for angles, true in pairs]
