"""`lagtop compare`: trajectories against the exact motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError
from ..top.scenes import is_scene_file
from . import shared as opt
from .app import complain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..comparison.convergence import Convergence
    from ..output.destination import Output
    from ..output.report import Report
    from ..recordings.options import Reading


def _parse_steps(text: str) -> list[float]:
    """Return comma-separated numbers or ratios such as 1/60."""
    parts = [x.partition("/") for x in text.split(",")]
    if any(slash and parse_number(y) == 0 for _, slash, y in parts):
        raise LagtopError(f"must not divide by 0, got {quoted(text)}")
    return [float(parse_number(x) / (parse_number(y) if y else 1)) for x, _, y in parts]


@opt.command(
    "compare",
    "table looping-top --t-max 5 --columns t,quaternion -o run.csv",
    "compare looping-top run.csv --max-error 1e-6 --plot errors.svg",
    "table --columns t,axis --r0 -50 | lagtop compare - || true",
)
@opt.top("[SCENE] TRAJECTORY...", is_scene=is_scene_file)
@opt.recording
@opt.option(
    "--step-sizes",
    type=opt.Listed("X,...", _parse_steps),
    help="Step sizes such as 0.01 or 1/60, for the order of convergence.",
)
@opt.option(
    "--max-error",
    type=opt.Parsed("X", opt.parse_positive),
    default="0.001",
    help="Acceptable error in rad.",
)
@opt.plot
@opt.output("table")
def compare_command(
    top: opt.TopOptions,
    reading: Reading,
    words: list[str],
    step_sizes: list[float] | None,
    max_error: float,
    plot: str | None,
    out: Output,
) -> None:
    """Compare trajectories with the exact motion.

    A trajectory is a file (CSV, text, JSON, Parquet or .mat), or - for standard input.  Its
    columns are recognised by name, such as t, theta, axis, quaternion or matrix.  Angles are in
    degrees unless their names or --rad say otherwise; errors are in radians.

    The exit code is 1 unless the verdict on every trajectory is fine.
    """
    from ..comparison.compare import compared
    from ..comparison.report import comparison_report, failure
    from ..recordings.reading import read_recording

    if not words:
        raise LagtopError("no trajectory: give a file, or - for standard input")
    if words.count("-") > 1:
        raise LagtopError("standard input can be read only once, got - twice")
    motion = opt.motion_of(top.given(), uses_stds=False)
    found: Convergence | None = None

    def find() -> Report:
        nonlocal found
        trajectories = [read_recording(x, reading) for x in words]
        results, found = compared(motion, trajectories, max_error, step_sizes)
        if top.scene is None and not top.inputs:
            complain("Warning: no scene and no inputs: compared with the worked example")
        return comparison_report(
            motion, results, found, max_error, scene=top.scene, overrides=top.inputs
        )

    def draw(report: Report) -> Figure:
        from ..plot.reports import draw_errors

        return draw_errors(report.rows, max_error, found.errors if found else ())

    report = opt.write_report(out, find, plot, draw)
    failed = [failure(x) for x in report.rows if x.verdict != "fine"]
    opt.fail_for(failed, len(report.rows), "trajectories")
