"""The stability report: strata of random scenes, each judged by the many-digit reference."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from contextlib import closing
from dataclasses import dataclass, fields
from typing import Any

from ..inputs.names import ANGLES, check_names
from ..output.progress import Progress
from ..output.report import Field, Report, short
from ..sweeps.jobs import in_order
from .battery import (
    CONTRACT,
    DIGITS,
    INTEGRATED_PERIODS,
    INTEGRATOR_SECONDS,
    KEY_CONTRACT,
    MORE_DIGITS,
    Case,
    Errors,
    hard_scene,
    judged_case,
)
from .closed_forms import CLOSED_FORMS
from .hard_scenes import STRATA
from .integrators import TIGHTEST
from .measure import common_conditions
from .method import NotApplicableError

TIMES = 2
"""Times anywhere per scene; six more stand next to half, quarter and whole periods."""


@dataclass(frozen=True, kw_only=True)
class StratumRow(Errors):
    """The worst of the scenes of a stratum."""

    stratum: str
    scenes: int
    verdict: str
    scipy_units: float | None
    """Worst of the scenes that scipy.special has done."""
    scipy_failed: int | None
    dop853_units: float | None
    """Worst of the scenes that DOP853 has done."""
    dop853_failed: int | None
    worst_case: str
    """A command line that shows the worst number."""
    proved_units: float | None
    """The worst of the angles and the quaternion, where errors are proved bounds."""


def _hundredths(error: float) -> str:
    return f"{error:.2f}" if error < 1000 else short(error)


FINE = "fine"
PROVED = (
    "enclosures in balls (Arb): every error is an upper bound that is proved; `proved` is the "
    "worst of the angles and the quaternion"
)
STRATUM_FIELDS = [
    Field("stratum", "stratum", is_text=True, names_the_row=True),
    Field("scenes", "scenes"),
    *(Field(f"{angle}_units", angle, _hundredths) for angle in ANGLES),
    Field("quaternion_units", "quat.", _hundredths),
    Field("key_ulps", "keys", _hundredths),
    Field("worst_key"),
    Field("energy_eps", "energy", short),
    Field("Lz_eps", "Lz", short),
    Field("verdict", "verdict", is_text=True),
    Field("proved_units"),
    Field("scipy_units", "scipy.special", short),
    Field("scipy_failed", "failed"),
    Field("dop853_units", "DOP853", short),
    Field("dop853_failed", "failed"),
    Field("worst_case"),
]
PROVED_FIELD = Field("proved_units", "proved", lambda bound: f"<= {_hundredths(bound)}")


def chosen_strata(names: Sequence[str] | None) -> list[str]:
    """Return the names of the strata, or of all.  Raises LagtopError for an unknown one."""
    return list(STRATA) if names is None else check_names("strata", names, STRATA)


def run_battery(
    strata: Sequence[str],
    samples: int,
    seed: int,
    progress: Progress,
    jobs: int = 1,
    *,
    certify: bool = False,
) -> Report:
    """Return the report on so many scenes of each stratum, judged by so many processes.

    With `certify` enclosures are the judge, and errors are proved bounds.  Raises UnavailableError
    where these need a package that is missing.
    """
    if certify:
        from . import proofs  # noqa: F401 - before any work
    cases: dict[str, list[Case]] = {name: [] for name in strata}
    scenes = [(name, seed, i) for name in strata for i in range(samples)]
    with closing(in_order(proved if certify else judged, scenes, jobs)) as found:
        for name, _, _ in progress(scenes, "scenes"):
            cases[name].append(next(found))
    stratum_rows = [
        stratum_row(name, of_stratum, certify=certify) for name, of_stratum in cases.items()
    ]
    agreement = max(case.agreement for of_stratum in cases.values() for case in of_stratum)
    conditions = _conditions(samples, seed, None if certify else agreement)
    fields_shown = STRATUM_FIELDS
    if certify:
        fields_shown = [PROVED_FIELD if x.key == PROVED_FIELD.key else x for x in STRATUM_FIELDS]
    return Report(conditions, fields_shown, stratum_rows, _conclusions(stratum_rows))


def judged(scene: tuple[str, int, int]) -> Case:
    """Return what became of a scene: stratum, seed and number."""
    return judged_case(hard_scene(*scene, TIMES))


def proved(scene: tuple[str, int, int]) -> Case:
    """Return what is proved of a scene: stratum, seed and number."""
    from .proofs import prove

    return prove(hard_scene(*scene, TIMES))


def stratum_row(name: str, cases: Sequence[Case], *, certify: bool = False) -> StratumRow:
    """Return the worst of each error over the cases of a stratum."""
    worst = {field.name: max(getattr(x, field.name) for x in cases) for field in fields(Errors)}
    worst["worst_key"] = max(cases, key=lambda case: case.key_ulps).worst_key
    worst_case = max(cases, key=lambda case: case.excess)
    scipy_units, scipy_failed = worst_and_failed([case.scipy for case in cases])
    dop853_units, dop853_failed = worst_and_failed([case.integrated for case in cases])
    return StratumRow(
        **worst,
        stratum=name,
        scenes=len(cases),
        verdict=FINE if worst_case.excess <= 1 else "EXCEEDED",
        scipy_units=scipy_units,
        scipy_failed=scipy_failed,
        dop853_units=dop853_units,
        dop853_failed=dop853_failed,
        worst_case=worst_case.command(),
        proved_units=_worst_units(worst) if certify else None,
    )


def _worst_units(worst: Mapping[str, Any]) -> float:
    units: float = max(value for name, value in worst.items() if name.endswith("_units"))
    return units


def worst_and_failed(errors: Sequence[float | None]) -> tuple[float | None, int | None]:
    """Return the worst of the finite errors and how many are not finite; None for no errors."""
    known = [error for error in errors if error is not None]
    if not known:
        return None, None
    done = [error for error in known if math.isfinite(error)]
    return max(done, default=None), len(known) - len(done)


def exceeded(findings: Report) -> list[str]:
    """Return the strata that exceed the contract, each with its worst case."""
    return [f"{row.stratum}: {row.worst_case}" for row in findings.rows if row.verdict != FINE]


def _conditions(samples: int, seed: int, agreement: float | None) -> dict[str, str]:
    """Return the conditions; no `agreement` of references stands for proved bounds."""
    conditions = common_conditions() | {
        "scenes": f"{samples} per stratum, seed {seed}; each at {TIMES} times 1e-9 to 1e14 periods "
        "before or after the start, and at the doubles next to a half period on one side "
        "and to a quarter, half or whole number of periods on the other, from 1 to 1e14",
        "reference": PROVED
        if agreement is None
        else f"Legendre's third integral by mpmath, {DIGITS} digits or more; with "
        f"{MORE_DIGITS} digits fewer it differs by {agreement:.0e} units at most",
        "errors": f"worst, in units (angles, quaternion; at most {CONTRACT:g} are promised) and in "
        f"gaps between doubles (every key of the record; at most {KEY_CONTRACT:g}, the nearest)",
        "conserved": "changes of energy and Lz since the start, in eps of the sum of their terms",
    }
    if agreement is None:
        return conditions
    conditions |= {
        "peers": "scipy.special at the same times, from the roots as doubles; DOP853 on a "
        f"quaternion, angles modulo 2 pi, rtol {TIGHTEST:g}, only at {INTEGRATED_PERIODS} periods",
        "failed": f"scenes without a number, or of more than {INTEGRATOR_SECONDS:g} s to integrate",
    }
    try:
        CLOSED_FORMS["scipy.special"].check_package()
    except NotApplicableError as reason:
        conditions["missing"] = f"scipy.special and DOP853: {reason}"
    return conditions


def _conclusions(stratum_rows: Sequence[StratumRow]) -> list[str]:
    bad = [row.stratum for row in stratum_rows if row.verdict != FINE]
    verdict = f"Exceeded in: {', '.join(bad)}." if bad else "All strata are within the contract."
    cases = (f"{row.stratum}: {row.worst_case}" for row in stratum_rows)
    return [verdict, "", "Worst cases:", *cases]
