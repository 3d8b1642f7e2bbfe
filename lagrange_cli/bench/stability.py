"""The stiff and extreme cases: strata of random scenes, each judged by the many-digit reference."""

from __future__ import annotations

import math
from collections.abc import Sequence
from fractions import Fraction
from typing import Any, NamedTuple

import mpmath
import numpy as np

from ..arithmetic.points import ListedPoints
from ..inputs.names import check_names
from ..inputs.top import Top
from ..motion.solve import Motion, solve
from ..motion.table import rows
from ..output.findings import Field, Findings, short
from .closed_forms import CLOSED_FORMS
from .hard_scenes import STRATA, scene_and_times
from .integrators import TIGHTEST, integrators
from .machine import machine, versions
from .method import FailedError, Method, NotApplicableError
from .reference import EPS, Exact, Reference, angle_units
from .work_precision import Steps

CONTRACT = 4.0
"""Units of an angle, and eps of a key of the record, that are promised."""

DIGITS, MORE_DIGITS = 80, 110
"""Of the reference, and of the one it is checked against."""

TIMES = 4
"""A scene."""
INTEGRATOR = "DOP853-quaternion"
INTEGRATED_PERIODS, INTEGRATOR_SECONDS = (0.7, 2.3, 4.9), 2.0
"""The integrator would never reach the far times: it has times of its own, near the start."""


class Case(NamedTuple):
    """What one scene has shown: worst errors, and where they were."""

    theta: float
    phi: float
    psi: float
    key_eps: float
    key: str
    worst_time: float
    energy_eps: float
    Lz_eps: float
    scipy: float | None
    integrated: float | None
    agreement: float
    """Of the reference at two precisions, in units."""
    top: Top

    @property
    def angle(self) -> float:
        """The worst of the three."""
        return max(self.theta, self.phi, self.psi)

    def command(self) -> str:
        """A command line that shows the worst number of the scene."""
        options = self.top.options()
        if self.key_eps > self.angle:
            return f"lagtop solve {options} --format json  # {self.key}"
        return f"lagtop bench --methods lagtop {options} --n 1 --t-max {self.worst_time!r}"


class Row(NamedTuple):
    """A stratum."""

    stratum: str
    scenes: int
    theta_units: float
    phi_units: float
    psi_units: float
    key_eps: float
    worst_key: str
    energy_eps: float
    Lz_eps: float
    scipy_units: float | None
    """Worst of the scenes it has done; and how many it has not."""
    scipy_failed: int | None
    dop853_units: float | None
    dop853_failed: int | None
    verdict: str
    worst_case: str

    @property
    def angle_units(self) -> float:
        """The worst of the three angles."""
        return max(self.theta_units, self.phi_units, self.psi_units)


FIELDS = [
    Field("stratum", "stratum", is_text=True, names_the_row=True),
    Field("scenes", "scenes"),
    *(Field(f"{angle}_units", angle, lambda x: f"{x:.2f}") for angle in ("theta", "phi", "psi")),
    Field("key_eps", "keys", lambda x: f"{x:.2f}"),
    Field("worst_key"),
    Field("energy_eps", "energy", short),
    Field("Lz_eps", "Lz", short),
    Field("verdict", "verdict", is_text=True),
    Field("scipy_units", "scipy.special", short),
    Field("scipy_failed", "failed"),
    Field("dop853_units", "DOP853", short),
    Field("dop853_failed", "failed"),
    Field("worst_case"),
]


def chosen_strata(names: Sequence[str] | None) -> list[str]:
    """Return the names of the strata, or of all.  Raises LagtopError for an unknown one."""
    return list(STRATA) if names is None else check_names("strata", names, STRATA)


def report(strata: Sequence[str], samples: int, seed: int, steps: Steps) -> Findings:
    """So many scenes of each stratum."""
    cases: dict[str, list[Case]] = {name: [] for name in strata}
    for name, i in steps([(name, i) for name in strata for i in range(samples)], "scenes"):
        cases[name].append(judge(*scene_and_times(name, seed, i, TIMES)))
    found = [_row(name, of_stratum) for name, of_stratum in cases.items()]
    agreement = max(case.agreement for of_stratum in cases.values() for case in of_stratum)
    return Findings(_conditions(samples, seed, agreement), FIELDS, found, _conclusions(found))


def judge(scene: dict[str, float], periods: Sequence[float], *, peers: bool = True) -> Case:
    """One scene at these times, in nutation periods; with other methods or without."""
    top = Top(**scene)
    motion, reference = solve(top), Reference(top, DIGITS)
    times = np.array(periods) * float(motion.T_nutation or 1)
    exact = [reference.at(t) for t in times.tolist()]
    errors = _units(list(zip(*motion.angles(times), strict=True)), exact)
    theta, phi, psi = (max(of_angle) for of_angle in zip(*errors, strict=True))
    key_eps, key = worst_key(motion, reference)
    again = Reference(top, MORE_DIGITS).at(times[0].item())
    energy_eps, Lz_eps = drifts(motion, times)
    return Case(
        theta=theta,
        phi=phi,
        psi=psi,
        key_eps=key_eps,
        key=key,
        worst_time=float(times[int(np.argmax([max(error) for error in errors]))]),
        energy_eps=energy_eps,
        Lz_eps=Lz_eps,
        scipy=peer_units(CLOSED_FORMS["scipy.special"], top, times, exact) if peers else None,
        integrated=_integrated(motion, reference) if peers else None,
        agreement=max(angle_units(again[:3], exact[0])),
        top=top,
    )


def _integrated(motion: Motion, reference: Reference) -> float | None:
    times = np.array(INTEGRATED_PERIODS) * float(motion.T_nutation or 1)
    exact = [reference.at(t) for t in times.tolist()]
    return peer_units(integrators(INTEGRATOR_SECONDS)[INTEGRATOR], motion.top, times, exact)


def _units(
    found: Sequence[Sequence[Any]], exact: Sequence[Exact], whole_turns: bool = True
) -> list[tuple[float, float, float]]:
    pairs = zip(found, exact, strict=True)
    return [angle_units(angles, true, whole_turns=whole_turns) for angles, true in pairs]


def worst_key(motion: Motion, reference: Reference) -> tuple[float, str]:
    """The worst key of the record: its error over eps and its size (or 1, for u1 and u2)."""
    errors = []
    with mpmath.workdps(DIGITS):
        for key, exact in reference.record().items():
            scale = 1 if key in ("u1", "u2") else abs(exact)
            if key.startswith("precession_rate"):  # 0 at the start of a release from rest
                scale += abs(reference.speed) * mpmath.mpf(10) ** -30
            difference = abs(mpmath.mpf(getattr(motion, key)) - exact)
            errors.append((float(difference / (EPS * scale)), key))
    return max(errors)


def drifts(motion: Motion, times: Any) -> tuple[float, float]:
    """Change of energy and vertical momentum since t = 0, over eps and the size of their terms."""
    exact = [Fraction(0), *map(Fraction, times.tolist())]
    _, blocks = rows(motion, ListedPoints(exact), ("energy", "Lz"))
    top, tilt = motion.top, motion.top.tilt(math)
    around = float(top.psidot0) * tilt.sin
    swing = float(top.thetadot0) ** 2 + around**2 + motion.a * (1 + abs(tilt.cos))
    momentum = float(top.C) * abs(float(top.r0))
    sizes = (
        float(top.A) * swing / 2 + momentum * abs(float(top.r0)) / 2,
        float(top.A) * abs(around) * tilt.sin + 2 * momentum,
    )
    values = np.concatenate(list(blocks))
    energy, Lz = (np.max(abs(values - values[0]), axis=0) / (EPS * np.array(sizes))).tolist()
    return energy, Lz


def peer_units(method: Method, top: Top, times: Any, exact: Sequence[Exact]) -> float | None:
    """The worst error of another method at its tightest setting.

    Infinite where it fails, None where its package is missing.
    """
    try:
        method.check_package()
    except NotApplicableError:
        return None
    try:
        with np.errstate(all="ignore"):
            found = list(zip(*method.prepare(top, method.settings[-1])(times), strict=True))
    except (FailedError, ArithmeticError, ValueError):  # formulas of others in doubles
        return math.inf
    return max(max(error) for error in _units(found, exact, method.whole_turns))


def _row(name: str, cases: Sequence[Case]) -> Row:
    worst = max(cases, key=lambda case: max(case.angle, case.key_eps))
    by_key = max(cases, key=lambda case: case.key_eps)
    fine = max(worst.angle, worst.key_eps) <= CONTRACT
    scipy_units, scipy_failed = _worst_and_failed([case.scipy for case in cases])
    dop853_units, dop853_failed = _worst_and_failed([case.integrated for case in cases])
    return Row(
        stratum=name,
        scenes=len(cases),
        theta_units=max(case.theta for case in cases),
        phi_units=max(case.phi for case in cases),
        psi_units=max(case.psi for case in cases),
        key_eps=by_key.key_eps,
        worst_key=by_key.key,
        energy_eps=max(case.energy_eps for case in cases),
        Lz_eps=max(case.Lz_eps for case in cases),
        scipy_units=scipy_units,
        scipy_failed=scipy_failed,
        dop853_units=dop853_units,
        dop853_failed=dop853_failed,
        verdict="fine" if fine else "EXCEEDED",
        worst_case=worst.command(),
    )


def _worst_and_failed(errors: Sequence[float | None]) -> tuple[float | None, int | None]:
    known = [error for error in errors if error is not None]
    if not known:
        return None, None
    done = [error for error in known if math.isfinite(error)]
    return max(done, default=None), len(known) - len(done)


def exceeded(findings: Findings) -> bool:
    """Whether a stratum exceeds the contract."""
    return any(row.verdict != "fine" for row in findings.rows)


def _conditions(samples: int, seed: int, agreement: float) -> dict[str, str]:
    conditions = {
        "machine": machine(),
        "versions": versions(),
        "scenes": f"{samples} a stratum, seed {seed}; each at {TIMES} times, 1e-9 to 1e12 nutation "
        "periods before or after the start",
        "reference": f"Legendre's third integral by mpmath, {DIGITS} digits; with {MORE_DIGITS} "
        f"digits it differs by {agreement:.0e} units at most",
        "errors": f"worst, in units (angles) and in eps (keys of the record); at most {CONTRACT:g} "
        "are promised",
        "drift": "of energy and Lz since the start, in eps of the sum of their terms",
        "peers": "scipy.special at the same times, from the roots as doubles; DOP853 on a "
        f"quaternion, angles modulo 2 pi, rtol {TIGHTEST:g}, only at {INTEGRATED_PERIODS} periods",
        "failed": f"scenes without a number, or of more than {INTEGRATOR_SECONDS:g} s to integrate",
    }
    try:
        CLOSED_FORMS["scipy.special"].check_package()
    except NotApplicableError as reason:
        conditions["missing"] = f"scipy.special and DOP853: {reason}"
    return conditions


def _conclusions(found: Sequence[Row]) -> list[str]:
    bad = [row.stratum for row in found if row.verdict != "fine"]
    verdict = f"Exceeded in: {', '.join(bad)}." if bad else "All strata are within the contract."
    return [verdict, "", "Worst cases:", *(f"{row.stratum}: {row.worst_case}" for row in found)]
