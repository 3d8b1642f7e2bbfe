"""`lagtop compare`: trajectories against the exact motion."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ..arithmetic.text import parse_number
from ..errors import LagtopError
from ..inputs.names import split_names
from ..output.destination import Output, write_bytes
from . import options as opt
from .app import complain
from .tables import (
    columns_option,
    euler_option,
    fail_for,
    quaternion_option,
    text_options,
    write_report,
)
from .top import INPUT, TopOptions, top_options, words

if TYPE_CHECKING:
    from ..inputs.text_lines import Dialect
    from ..output.report import Report


def _parse_step_sizes(text: str) -> list[float]:
    return [float(parse_number(name)) for name in split_names(text)]


@opt.command(
    "compare",
    """
    lagtop table looping-top --t-max 5 --columns t,quaternion -o run.csv
    lagtop compare looping-top run.csv --max-error 1e-6 --plot errors.svg
    lagtop table --columns t,axis --r0 -50 | lagtop compare - || true
    """,
)
def compare_command(
    top: TopOptions = top_options(INPUT, words("[SCENE] TRAJECTORY...", opt.FILE, required=True)),
    names: list[str] | None = columns_option,
    quaternion_order: str | None = quaternion_option(None),
    euler_sequence: str = euler_option,
    rates_frame: str = opt.choice(
        ["body", "space"],
        "Frame of the angular velocity: body or space.",
        "FRAME",
        default="body",
        show_default=True,
    ),
    align: list[str] | None = opt.names(
        "Other axes: axis=y, up=y, left (left-handed).  From the first row: start (zero of spin "
        "and precession), time (zero of t).",
        offered=opt.late("compare.differences", "WORDS"),
        metavar="WORD,...",
    ),
    step_sizes: list[float] | None = opt.option(
        opt.Parsed("X,...", _parse_step_sizes),
        "Step sizes of the trajectories, for the order of convergence.",
    ),
    max_error: Fraction | None = opt.number(
        "Largest acceptable error in rad.  [default: 0.001]", positive=True
    ),
    dialect: Dialect = text_options,
    plot: str | None = opt.plot,
    out: Output = opt.output(*opt.REPORT_FORMATS),
) -> None:
    """Compare computed or measured trajectories with the exact motion.

    A trajectory is a file (CSV, text, JSON lines, npy, npz or Parquet), or - for standard input.
    Its columns are recognised by name, such as t, theta, axis, quaternion or matrix.  Angles are in
    degrees unless their names or --rad say otherwise; errors are in radians.

    The exit code is 1 unless the verdict on every trajectory is fine.
    """
    from ..compare.compare import LIMIT, compared
    from ..compare.differences import Alignment
    from ..compare.report import comparison_report, failures, read
    from ..inputs.seen import Conventions
    from ..plot.reports import ErrorCurve, check_plot, draw_errors

    check_plot(plot, out.path)
    if not top.words:
        raise LagtopError("no trajectory: give a file, or - for standard input")
    if list(top.words).count("-") > 1:
        raise LagtopError("standard input can be read once, got - twice")
    limit = LIMIT if max_error is None else float(max_error)
    conventions = Conventions(quaternion_order, euler_sequence, rates_frame, top.radians).checked()
    alignment = Alignment.of(align or [])
    motion, units = top.solved_in_units()
    failed: list[str] = []

    def find() -> Report:
        trajectories = [read(x, conventions, alignment, names, dialect.decimal) for x in top.words]
        results, found = compared(motion, trajectories, limit, step_sizes)
        if top.scene is None and not top.by_key():
            complain("Warning: no scene and no inputs: compared with the worked example")
        if plot:
            errors = found.errors if found else [None] * len(results)
            curves = [
                ErrorCurve(str(x.file), x.t, x.error, x.step, error)
                for x, error in zip(results, errors, strict=True)
                if x.t is not None and x.error is not None
            ]
            write_bytes(plot, partial(draw_errors, curves, limit, plot))
        failed.extend(failures(results))
        report = comparison_report(motion, results, found, limit)
        return report._replace(conditions=units | report.conditions)

    report = write_report(out, find)
    fail_for(failed, len(report.rows), "trajectories")
