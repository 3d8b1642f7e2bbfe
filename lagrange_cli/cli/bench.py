"""`lagtop bench`: error against run time."""

from __future__ import annotations

import os
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from ..errors import LagtopError
from .command import ExamplesFirst, write_report
from .options import COUNT, FILE, METHOD_NAMES, NUMBER, exclude, output_options
from .progress import with_progress
from .top_options import scene_options, solved

if TYPE_CHECKING:
    from ..output.report import Report

SAMPLES, LONG_SAMPLES = 10_000, 1000
PERIODS = 20.3
"""No end at a turning point, where approximations are at their best."""
MOST_TIMES = 10_000_000
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Variables that say how many threads the linear algebra of packages has."""


def _write_methods(formatter: click.HelpFormatter) -> None:
    """Write the names of the methods and of their groups."""
    from ..bench.measure import all_methods, groups

    with formatter.section("Methods"):
        formatter.write_text(", ".join(all_methods(1.0)))
    with formatter.section("Groups of methods"):
        formatter.write_text(", ".join(groups()))


@click.command(
    "bench",
    cls=ExamplesFirst,
    shows=_write_methods,
    examples="""
        lagtop bench
        lagtop bench sample_inputs/stiff-top.toml --plot work-precision.svg
        lagtop bench --methods lagtop,DOP853-quaternion --t-max 100 --n 1e5 --format csv
        lagtop bench --long --plot drift.png
        lagtop bench --methods lagtop,engines --n 1000
    """,
)
@scene_options
@click.option("--t-max", type=NUMBER, help="Last time.  [default: 20.3 nutation periods]")
@click.option("--n", "count", type=COUNT, help="Number of times.  [default: 1e4; 1e3 with --long]")
@click.option(
    "--methods", type=METHOD_NAMES, help="These, with commas between.  [default: all but engines]"
)
@click.option(
    "--timeout",
    "limit",
    type=NUMBER,
    default="3",
    show_default=True,
    help="Seconds a run may take.",
)
@click.option("--long", "is_long", is_flag=True, help="Over spans of 1 to 1e6 periods instead.")
@click.option("--plot", type=FILE, metavar="FILE", help="Draw it too: FILE.svg or .png.")
@output_options("table", "csv", "json")
def command(
    scene: str | None,
    rad: bool,
    t_max: Fraction | None,
    count: int | None,
    methods: list[str] | None,
    limit: Fraction,
    is_long: bool,
    plot: str | None,
    fmt: str,
    output: str,
    **options: Any,
) -> None:
    """Compare closed forms and integrators: error against run time at the same times.

    Every method is judged by a reference of 80 digits that shares no formula with lagtop, and
    timed on one thread.  Taylor's method needs heyoka (extra `bench`), and engines need themselves
    (extra `engines`); a method whose package is missing says so.  The setting of an engine is steps
    per nutation period, or a tolerance.  A * marks the Pareto front: no other run is both faster
    and more accurate.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))  # before these packages are imported
    from ..bench.compare_methods import compare_methods, compare_spans
    from ..bench.measure import check_scene, chosen_methods, reference_period
    from ..bench.pictures import draw_long_spans, draw_work_precision
    from ..plot.files import check_plot

    exclude({"--long": is_long or None, "--t-max": t_max})
    _check(t_max, count, limit)
    check_plot(plot, output)
    chosen = chosen_methods(methods, float(limit))
    motion = solved(scene, rad, False, options)
    check_scene(motion)
    how: dict[str, Any] = {"limit": float(limit), "progress": with_progress}
    end = float(PERIODS * reference_period(motion) if t_max is None else t_max)

    def find() -> Report:
        if is_long:
            findings = compare_spans(motion, count or LONG_SAMPLES, chosen, **how)
        else:
            findings = compare_methods(motion, end, count or SAMPLES, chosen, **how)
        if plot:
            (draw_long_spans if is_long else draw_work_precision)(findings, plot)
        return findings

    write_report(find, fmt, output)


def _check(t_max: Fraction | None, count: int | None, limit: Fraction) -> None:
    if t_max == 0:
        raise LagtopError("--t-max must be other than 0: nothing has moved by then")
    if count is not None and not 1 <= count <= MOST_TIMES:
        raise LagtopError(f"--n must be in [1, {MOST_TIMES}], got {count}")
    if not limit > 0:
        raise LagtopError(f"--timeout must be > 0, got {float(limit)}")
