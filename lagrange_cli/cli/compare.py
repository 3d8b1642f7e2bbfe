"""`lagtop compare`: trajectories against the exact motion."""

from __future__ import annotations

from typing import TYPE_CHECKING

from ..errors import LagtopError
from ..inputs.scenes import is_scene_file
from . import shared as opt
from .app import complain

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..output.destination import Output
    from ..output.report import Report
    from ..plot.reports import ErrorCurve


@opt.command(
    "compare",
    "table looping-top --t-max 5 --columns t,quaternion -o run.csv",
    "compare looping-top run.csv --max-error 1e-6 --plot errors.svg",
    "table --columns t,axis --r0 -50 | lagtop compare - || true",
)
@opt.top("[SCENE] TRAJECTORY...", required=True, is_scene=is_scene_file)
@opt.columns
@opt.quaternion_order
@opt.euler_sequence
@opt.option(
    "--rates-frame",
    metavar="FRAME",
    type=opt.Choice(["body", "space"]),
    default="body",
    help="Frame of the angular velocity: body or space.",
)
@opt.option(
    "--align",
    metavar="WORD,...",
    type=opt.LIST,
    help="Other axes: axis=y, up=y, left (left-handed).  From the first row: start (zero of spin "
    "and precession), time (zero of t).",
)
@opt.option("--step-sizes", type=opt.NUMBERS, help="Step sizes, for the order of convergence.")
@opt.option("--max-error", type=opt.POSITIVE, help="Acceptable error in rad.  [default: 0.001]")
@opt.decimal
@opt.plot
@opt.output(*opt.REPORT_FORMATS)
def compare_command(
    top: opt.TopOptions,
    words: list[str],
    columns: list[str] | None,
    quaternion_order: str,
    euler_sequence: str,
    rates_frame: str,
    align: list[str] | None,
    step_sizes: list[float] | None,
    max_error: float | None,
    decimal: str,
    plot: str | None,
    out: Output,
) -> None:
    """Compare trajectories with the exact motion.

    A trajectory is a file (CSV, text, JSON lines, npy, npz or Parquet), or - for standard input.
    Its columns are recognised by name, such as t, theta, axis, quaternion or matrix.  Angles are in
    degrees unless their names or --rad say otherwise; errors are in radians.

    The exit code is 1 unless the verdict on every trajectory is fine.
    """
    from ..compare.compare import LIMIT, compared
    from ..compare.differences import Alignment
    from ..compare.report import comparison_report, read, sentence
    from ..inputs.observed import Conventions

    opt.check_plot(plot, out.path)
    if not words:
        raise LagtopError("no trajectory: give a file, or - for standard input")
    if words.count("-") > 1:
        raise LagtopError("standard input can be read once, got - twice")
    limit = LIMIT if max_error is None else max_error
    conventions = Conventions(quaternion_order, euler_sequence, rates_frame, top.radians).checked()
    alignment = Alignment.of(align or [])
    motion = top.motion()
    failed: list[str] = []
    curves: list[ErrorCurve] = []

    def find() -> Report:
        trajectories = [read(x, conventions, alignment, columns, decimal) for x in words]
        results, found = compared(motion, trajectories, limit, step_sizes)
        if top.scene is None and not top.inputs:
            complain("Warning: no scene and no inputs: compared with the worked example")
        failed.extend(sentence(x) for x in results if x.verdict != "fine")
        if plot:
            from ..plot.reports import ErrorCurve

            errors = found.errors if found else [None] * len(results)
            curves.extend(
                ErrorCurve(str(x.file), x.t, x.error, x.step, error)
                for x, error in zip(results, errors, strict=True)
            )
        return comparison_report(motion, results, found, limit)

    def draw(_: Report) -> Figure:
        from ..plot.reports import draw_errors

        return draw_errors(curves, limit)

    report = opt.write_report(out, find, plot, draw)
    opt.fail_for(failed, len(report.rows), "trajectories")
