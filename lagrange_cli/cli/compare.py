"""`lagtop compare`: the judge of trajectories."""

from __future__ import annotations

from fractions import Fraction
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from ..arithmetic.text import parse_number
from ..errors import LagtopError
from ..inputs.names import split_names
from .command import ExamplesFirst, complain, fail_for, write_report
from .options import FILE, NAMES, NUMBER, Parsed, exclude, output_options
from .progress import with_progress
from .row_options import dialect, reading_options, text_options
from .top_options import INPUT, input_options, solved

if TYPE_CHECKING:
    from ..judge.compare import Comparison
    from ..output.report import Report


def _write_names(formatter: click.HelpFormatter) -> None:
    """Write the quantities of a trajectory, and the names of columns by which each is known."""
    from ..inputs.trajectory_columns import shown_quantities

    with formatter.section("Columns of a trajectory, by name"):
        formatter.write_dl(list(shown_quantities().items()))


def _parse_steps(text: str) -> list[float]:
    return [float(parse_number(name)) for name in split_names(text)]


@click.command(
    "compare",
    cls=ExamplesFirst,
    shows=_write_names,
    examples="""
        lagtop compare mujoco.csv --m 1.587 --A 3.9032e-3 --C 1.7458e-3 --s 0.04 --g 9.81
        lagtop compare sensor.txt --scene top.toml --align axis=y,start --max-error 1e-6
        lagtop compare h1.csv h2.csv h3.csv --step-sizes 1e-3,5e-4,2.5e-4 --plot errors.svg
        lagtop compare state.npy --columns t,quaternion,_,_,_ --quaternion-order xyzw --format json
        lagtop table --t-max 5 --columns t,quaternion | lagtop compare -
    """,
)
@click.argument(
    "trajectories",
    nargs=-1,
    required=True,
    type=FILE,
    metavar="TRAJECTORY...",
)
@click.option("--scene", type=FILE, metavar="FILE|-", help="Scene file; options win over it.")
@input_options(INPUT)
@reading_options(quaternion=None)
@text_options
@click.option(
    "--rates-frame",
    type=click.Choice(["body", "space"]),
    default="body",
    show_default=True,
    help="Frame of an angular velocity whose names do not tell.",
)
@click.option(
    "--align",
    type=NAMES,
    help="What is done first, with commas between: axis=y (the figure axis is the body's y; x, y, "
    "z, -x, -y or -z), up=y (so is up in space), start (spin and precession count from the first "
    "row), body or space (one rotation of that frame, taken from the first row), time (the first "
    "row is at the time 0).",
)
@click.option(
    "--step-sizes",
    type=Parsed("numbers", _parse_steps),
    help="Steps of the trajectories, with commas between, for the order of convergence.",
)
@click.option(
    "--max-error",
    type=NUMBER,
    help="Greatest error in radians up to which a trajectory is fine.  [default: 0.001]",
)
@click.option(
    "--exit-zero", is_flag=True, help="Exit with 0 even if a trajectory is not fine: look only."
)
@click.option(
    "--plot",
    type=FILE,
    metavar="FILE",
    help="Draw the error too, over time and over the step: FILE.svg or .png.",
)
@output_options("table", "csv", "json")
def command(
    trajectories: tuple[str, ...],
    scene: str | None,
    rad: bool,
    columns: list[str] | None,
    quaternion_order: str | None,
    euler_sequence: str,
    rates_frame: str,
    align: list[str] | None,
    step_sizes: list[float] | None,
    max_error: Fraction | None,
    exit_zero: bool,
    plot: str | None,
    fmt: str,
    output: str,
    **options: Any,
) -> None:
    """Judge trajectories that engines or integrators made, by the exact motion.

    A trajectory is a file (CSV, TSV, text with or without a header, JSON lines, npy, npz or
    Parquet) or - for standard input.  Its columns are known by their names, which stand below.
    Angles are in degrees where neither names nor --rad say otherwise; all errors are in radians.

    The verdict is one of fine, drifts, another top, off from the start and lost.  The exit code is
    1 if a trajectory is not fine, unless --exit-zero is given.
    """
    from ..inputs.seen import Conventions
    from ..judge.alignment import alignment
    from ..judge.compare import ComparisonRequest, compare_files
    from ..judge.report import comparison_report, failures
    from ..plot.files import check_plot

    if max_error is not None and not max_error > 0:
        raise LagtopError(f"--max-error must be > 0, got {float(max_error)}")
    check_plot(plot, output)
    exclude({"--scene -": scene == "-" or None, "the trajectory -": "-" in trajectories or None})
    limit = None if max_error is None else float(max_error)
    conventions = Conventions(quaternion_order, euler_sequence, rates_frame, rad).checked()
    frames = alignment(align or [])
    request = ComparisonRequest(columns, conventions, frames, limit, step_sizes, dialect())
    is_named = scene is not None or any(x is not None for x in options.values())
    motion = solved(scene, rad, False, options)

    def find() -> Report:
        comparison = compare_files(motion, trajectories, request, with_progress, is_named=is_named)
        for text in comparison.warnings:
            complain(f"Warning: {text}")
        if plot:
            _draw(comparison, limit, plot)
        return comparison_report(comparison.motion, comparison, request)

    findings = write_report(find, fmt, output)
    if not exit_zero:
        fail_for(
            failures(findings),
            len(findings.rows),
            "trajectories",
            remedy="use --exit-zero to look only",
        )


def _draw(comparison: Comparison, limit: float | None, path: str) -> None:
    from ..judge.judgement import LIMIT
    from ..output.write import write_bytes
    from ..plot.reports import ErrorCurve, draw_errors

    found = comparison.convergence
    compared = found.errors if found else [None] * len(comparison.judgements)
    curves = [
        ErrorCurve(str(x.file), x.t, x.error, x.step, error)
        for x, error in zip(comparison.judgements, compared, strict=True)
        if x.t is not None and x.error is not None
    ]
    write_bytes(path, partial(draw_errors, curves, limit or LIMIT, path))
