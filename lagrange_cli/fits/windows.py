"""A recording in windows: one body, and a spin rate that decays from window to window.

Friction slows a real top, but the closed form has no friction.  Within a short window the loss is
below the noise.  All windows share a and C/A.  Each window has its own start and its own r0, or b
if the spin is not recorded.  A line through the logarithms of r0 (or b) gives the decay time.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from itertools import pairwise
from typing import Any, NamedTuple

import numpy as np

from ..arithmetic.arrays import ARRAYS
from ..errors import LagtopError
from ..inputs.top import Top
from ..motion.solve import solve
from .fit import best_fit
from .least_squares import Fit, fitted_from, reweighted
from .model import STATE, chi2_bounds, inputs_of
from .parameters import FIT_QUANTITIES, KnownInputs
from .record import FAILED, Outcome, flat_numbers
from .recording import LEAST_ROWS, Recording

_STEPS = 30
"""Steps of the fit of each window, from the end of the previous one."""
_SURE = 3.0
"""Number of standard deviations from which a decay is significant."""


class Decay(NamedTuple):
    """The exponential decay of the spin rate, or of b."""

    quantity: str
    rate: float
    rate_std: float
    chi2_dof: float
    """Chi^2 per degree of freedom of the straight line through the logarithms."""

    @property
    def time(self) -> tuple[float, float] | None:
        """The decay time 1/rate and its standard deviation; None if no decay is seen."""
        if self.rate <= _SURE * self.rate_std:
            return None
        return 1 / self.rate, self.rate_std / self.rate**2


class Window(NamedTuple):
    """One window: its outcome, and how well the closed form describes it."""

    outcome: Outcome
    middle: float
    """Time of the middle of the window, on the clock of the recording."""
    chi2_dof: float
    verdict: str
    """`good` or `doubtful`, or `failed` if the fit of all windows has failed."""

    def row(self) -> dict[str, Any]:
        """Return the numbers of the window by key."""
        record = self.outcome.record()
        names = ["r0", "b", self.outcome.shown_as("theta0")[0], "thetadot0", "psidot0"]
        names += ["T_nutation", "T_precession"]
        keys = [key for name in names for key in (name, f"{name}_std") if key in record]
        return {
            "t": self.middle,
            **{key: record[key] for key in ("t_start", "rows", *keys)},
            "chi2_dof": self.chi2_dof,
            "verdict": self.verdict,
        }


class WindowedFit(NamedTuple):
    """The results of a fit in windows."""

    windows: Sequence[Window]
    decay: Decay

    @property
    def verdict(self) -> str:
        """The worst verdict of any window."""
        words = {window.verdict for window in self.windows}
        return next((word for word in (FAILED, "doubtful") if word in words), "good")

    @property
    def is_described(self) -> bool:
        """Whether the closed form leaves only noise in a window; sigma may be wrong."""
        return any(x.verdict != FAILED and x.outcome.leaves_noise for x in self.windows)

    def record(self) -> dict[str, Any]:
        """Return the body, the decay, and the windows, by key."""
        first, decay = self.windows[0].outcome, self.decay
        body = [(x, y, first.deviations[x]) for x, y in first.shown.items() if x not in {"r0", "b"}]
        body += [(x.name, x.value, std) for x, std in first.products() if "r0" not in x.powers]
        time = decay.time or (None, None)
        return {
            **flat_numbers(body),
            "decay_of": decay.quantity,
            **flat_numbers([("decay_time", *time), ("decay_rate", decay.rate, decay.rate_std)]),
            "decay_chi2_dof": decay.chi2_dof,
            "dof": first.fit.dof,
            "chi2_dof": first.chi2_dof,
            "verdict": self.verdict,
            "windows": [window.row() for window in self.windows],
        }


def split(recording: Recording, window: float, *, is_time: bool, where: str) -> list[Recording]:
    """Return a recording in windows: a number of equal windows, or windows of a given duration.

    A shorter last window is merged into the previous one.  Raises LagtopError for a bad window.
    """
    span = float(recording.t[-1])
    count = int(span / window * (1 + 1e-9)) if is_time and window > 0 else window
    if not 2 <= count <= recording.t.size or count != int(count):
        most = recording.t.size
        raise LagtopError(
            f"window must give 2 to {most} windows of {where}, got {count:g}", "window"
        )
    length = window if is_time else span / count
    index = np.minimum((recording.t / length).astype(int), int(count) - 1)
    rows = [np.flatnonzero(index == i) for i in range(int(count))]
    for i, some in enumerate(rows):
        if some.size < LEAST_ROWS:
            raise LagtopError(
                f"window {i + 1} must have {LEAST_ROWS} rows or more, got {some.size}", "window"
            )
    return [recording.part(some, f"window {i + 1}") for i, some in enumerate(rows)]


def fit_windows(
    parts: Sequence[Recording],
    known: KnownInputs,
    where: str,
    *,
    radians: bool = False,
) -> WindowedFit:
    """Fit one body to the windows of a recording.

    The fit of each window starts from the motion of the previous window.  Raises LagtopError,
    DataError for a recording that cannot be fitted.
    """
    if "r0" in known:
        raise LagtopError("r0 is an unknown of a fit in windows: leave it out", "r0")
    with ARRAYS.working():
        starts = [best_fit(parts[0], known, f"{where}, {parts[0].name}").start]
        if starts[0].recording.is_mirrored:
            parts = [part.mirrored for part in parts]
        for before, part in pairwise(parts):
            values = _led_to(starts[-1].values, part.t_start - before.t_start)
            start = starts[0]._replace(recording=part, values=values)
            starts.append(fitted_from([start], known, steps=_STEPS).start)
        fit = reweighted(fitted_from(starts, known))
    fit = fit._replace(noise=())  # harmonics of few rows underestimate the noise
    windows = [_window(Outcome(fit, i, radians=radians)) for i in range(len(parts))]
    return WindowedFit(windows, _decay(windows, fit))


def _led_to(values: Mapping[str, float], t: float) -> dict[str, float]:
    """Return the quantities of a motion, counted from a later time."""
    columns = ["theta", "thetadot", "psidot", "phi", "psi"]
    top = Top(**inputs_of(*(values[name] for name in STATE)))
    at = {name: float(x) for name, x in solve(top).table(t, columns).items()}
    return {
        **values,
        "theta0": at["theta"],
        "thetadot0": at["thetadot"],
        "psidot0": at["psidot"],
        "psi_zero": values["psi_zero"] + at["psi"],
        "phi_zero": values["phi_zero"] + at["phi"] + (values["r0"] - values["b"]) * t,
    }


def _window(outcome: Outcome) -> Window:
    """Return a window with its own chi^2 and its share of the degrees of freedom."""
    fit, recording = outcome.fit, outcome.recording
    rows = np.stack(list(outcome.residuals_by_row.values()))
    known = np.isfinite(rows)
    total = fit.dof + fit.values.size
    freedom = max(round(int(known.sum()) * fit.dof / total), 1)
    chi2_dof = float(np.sum((rows / fit.sigma[outcome.index])[known] ** 2)) / freedom
    low, high = chi2_bounds(freedom)
    within = low <= chi2_dof <= high or not fit.sigma_known
    verdict = "good" if outcome.leaves_noise and within else "doubtful"
    verdict = FAILED if outcome.failures() else verdict
    return Window(outcome, recording.t_start + float(recording.t[-1]) / 2, chi2_dof, verdict)


def _decay(windows: Sequence[Window], fit: Fit) -> Decay:
    """Return the decay, by generalised least squares through the logarithms of r0, or of b."""
    name = "r0" if fit.parameters.spins else "b"
    t = np.array([window.middle for window in windows])
    rates = np.array([window.outcome.values[name] for window in windows])
    slopes = np.stack(
        [
            fit.parameters.quantities(fit.values, i)[1][FIT_QUANTITIES.index(name)] / rate
            for i, rate in enumerate(rates.tolist())
        ]
    )
    spread = np.linalg.cholesky(slopes @ fit.covariance @ slopes.T)
    basis = np.linalg.solve(spread, np.vander(t - t.mean(), 2))
    y = np.linalg.solve(spread, np.log(np.abs(rates)))
    (slope, level), *_ = np.linalg.lstsq(basis, y, rcond=None)
    std = math.sqrt(float(np.linalg.inv(basis.T @ basis)[0, 0]))
    chi2 = float(np.sum((y - basis @ [slope, level]) ** 2))
    return Decay(name, -float(slope), std, chi2 / max(t.size - 2, 1))
