"""`fit`: the top behind a recording, with advice if the fit fails."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from dataclasses import replace
from itertools import islice
from types import NoneType
from typing import Any, Unpack

from numpy.typing import ArrayLike

from ..errors import check_type
from ..recordings.recording import Given, recording_of
from ..top.given import gather
from ..top.units import DEGREES, Units
from ..top.values import parse_value, value_of
from .advice import Advice
from .known import Known, known_inputs
from .measured import Measured, measured
from .outcome import Outcome
from .reasons import Kind, Reason
from .rows import frequency_of_parts
from .search import best_fit

_OTHER = 0.15
"""Difference of the logarithms of two frequencies that are not the same."""


def fit_recording(recording: Measured, known: Known, units: Units = DEGREES) -> Outcome:
    """Return the fit of a recording; if it fails, `hints` say what to try.

    Raises DataError for a recording that cannot be fitted.
    """
    outcome, again = best_fit(recording, known, units=units), 0
    if {Kind.OPEN, Kind.MOTION} & outcome.kinds:
        outcome, again = _also_at(frequency_of_parts(recording), outcome, recording, known)
    if Kind.MOTION in outcome.kinds:  # half of the frequency may have been found
        outcome, more = _also_at(2 * outcome.frequency, outcome, recording, known)
        again += more
    advice = Advice(recording, known, outcome, again)
    found: Iterable[Reason] = islice(advice.reasons(), 1)
    if not outcome.failed:
        found = advice.gap() if outcome.late else ()
    hints = [*found]
    return replace(outcome, reasons=[*outcome.reasons, *hints]) if hints else outcome


def _also_at(
    frequency: float, outcome: Outcome, recording: Measured, known: Known
) -> tuple[Outcome, int]:
    """Return the better of a fit and one at another frequency, and the number of further fits."""
    if not frequency or abs(math.log(frequency / outcome.frequency)) <= _OTHER:
        return outcome, 0
    other = best_fit(recording, known, units=outcome.units, frequency=frequency)
    return min(outcome, other, key=lambda x: (x.is_open, x.noisiness)), 1


def fit(
    t: ArrayLike | None = None,
    *,
    sigma: Mapping[str, float] | float | None = None,
    known: Mapping[str, Any] | None = None,
    **recording: Unpack[Given],
) -> Outcome:
    """Fit a top to a recording; the results are in `record()`.

    Pass an attitude, angles, the figure axis or the position of a marker as arrays, and options,
    as to `compare`; rates are not used.  `sigma` is a standard deviation in radians,
    or a mapping by channel; by default it is estimated from the residuals.  `known` are known
    inputs by key, which are tested against the recording.  A text such as `"0.070(5)"`, or a number
    of the package uncertainties, is uncertain.  Units are converted to SI.  Raises LagtopError,
    and DataError for a recording that cannot be fitted.

    >>> t = np.linspace(0, 2, 200)
    >>> noise = np.random.default_rng(2).normal(scale=1e-3, size=(3, 200))
    >>> theta, phi, psi = solve(Top()).angles(t) + noise
    >>> outcome = fit(t, theta=theta, phi=phi, psi=psi, known={"C": 17458})
    >>> outcome.verdict, outcome.failures()
    ('good', [])
    >>> [(key, round(x.value, 1)) for key, x in outcome.numbers.items()][:3]
    [('a', 319.1), ('b', 22.4), ('r0', 50.0)]
    >>> round(outcome.numbers["A"].value, -2), outcome.record()["dof"]
    (39000.0, 592)
    """
    check_type("known", known, Mapping, NoneType)
    seen = measured(recording_of(t, recording), sigma)
    given = {
        name: parse_value(name, x, uncertain=True, steady=name == "psidot0")
        if isinstance(x, str)
        else value_of(name, x)
        for name, x in (known or {}).items()
    }
    return fit_recording(seen, known_inputs(gather(given)))
