"""`lagtop compare`: trajectories against the exact motion."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING

from ..arithmetic.text import parse_number
from ..errors import LagtopError
from ..inputs.names import split_names
from ..output.destination import Output, write_bytes
from ..output.terminal import with_progress
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
    from ..judge.compare import Comparison
    from ..output.report import Report


def _parse_step_sizes(text: str) -> list[float]:
    return [float(parse_number(name)) for name in split_names(text)]


@opt.command(
    "compare",
    """
    lagtop table looping-top --t-max 5 --columns t,quaternion -o run.csv
    lagtop compare looping-top run.csv --max-error 1e-6 --plot errors.svg
    lagtop table --columns t,axis --r0 -50 | lagtop compare - --exit-zero
    """,
)
def compare_command(
    top: TopOptions = top_options(INPUT, words("[SCENE] TRAJECTORY...", opt.FILE, required=True)),
    names: list[str] | None = columns_option,
    quaternion_order: str | None = quaternion_option(None),
    euler_sequence: str = euler_option,
    rates_frame: str = opt.choice(
        ["body", "space"],
        "Frame of p, q, r: body or space.",
        "FRAME",
        default="body",
        show_default=True,
    ),
    align: list[str] | None = opt.names(
        "Other axes: axis=y, up=y.  From the first row: start (zero of spin and precession), time "
        "(zero of t), body or space (a constant rotation).",
        offered=opt.late("judge.alignment", "WORDS"),
        metavar="WORD,...",
    ),
    step_sizes: list[float] | None = opt.option(
        opt.Parsed("X,...", _parse_step_sizes),
        "Step sizes of the trajectories, for the order of convergence.",
    ),
    max_error: Fraction | None = opt.number(
        "Largest acceptable error in rad.  [default: 0.001]", positive=True
    ),
    exit_zero: bool = opt.flag("Exit with 0 even if a trajectory is not fine."),
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
    from ..inputs.seen import Conventions
    from ..judge.alignment import alignment
    from ..judge.compare import ComparisonRequest, compare_files
    from ..judge.report import comparison_report, failures
    from ..plot.reports import check_plot

    check_plot(plot, out.path)
    if not top.words:
        raise LagtopError("no trajectory: give a file, or - for standard input")
    limit = None if max_error is None else float(max_error)
    conventions = Conventions(quaternion_order, euler_sequence, rates_frame, top.radians).checked()
    request = ComparisonRequest(
        names, conventions, alignment(align or []), limit, step_sizes, dialect
    )
    is_named = top.scene is not None or bool(top.by_key())
    motion, units = top.solved_in_units()

    def find() -> Report:
        comparison = compare_files(motion, top.words, request, with_progress, is_named=is_named)
        for text in comparison.warnings:
            complain(f"Warning: {text}")
        if not is_named and comparison.motion is motion:
            complain("Warning: no scene and no inputs: compared with the worked example")
        if plot:
            _draw(comparison, limit, plot)
        found = comparison_report(comparison.motion, comparison, request)
        return found._replace(conditions=units | found.conditions)

    report = write_report(out, find)
    if not exit_zero:
        remedy = "use --exit-zero to look only"
        fail_for(failures(report), len(report.rows), "trajectories", remedy=remedy)


def _draw(comparison: Comparison, limit: float | None, path: str) -> None:
    from ..judge.judgement import LIMIT
    from ..plot.reports import ErrorCurve, draw_errors

    found = comparison.convergence
    compared = found.errors if found else [None] * len(comparison.judgements)
    curves = [
        ErrorCurve(str(x.file), x.t, x.error, x.step, error)
        for x, error in zip(comparison.judgements, compared, strict=True)
        if x.t is not None and x.error is not None
    ]
    write_bytes(path, partial(draw_errors, curves, limit or LIMIT, path))
