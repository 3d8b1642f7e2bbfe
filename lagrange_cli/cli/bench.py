"""Tests of lagtop: `lagtop bench` and `lagtop stability`."""

from __future__ import annotations

import os
from fractions import Fraction
from typing import TYPE_CHECKING, Any

import click

from ..errors import LagtopError
from .app import Command, fail_for, write_report
from .options import (
    COUNT,
    NUMBER,
    exclude,
    jobs_option,
    late,
    names_type,
    output_options,
    plot_option,
    seed_option,
)
from .progress import with_progress
from .top import INPUT, TopOptions, top_options

if TYPE_CHECKING:
    from ..output.destination import Output
    from ..output.report import Report

SAMPLES, LONG_SAMPLES = 10_000, 1000
PERIODS = 20.3
"""Default end in periods, not at a turning point, at which approximations are best."""
MOST_TIMES = 10_000_000
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Environment variables for the number of threads of linear algebra packages."""
SCENES, MOST_SCENES = 1, 100_000
SEED = 1952


def _methods() -> list[str]:
    from ..bench.measure import all_methods, groups

    return list(dict.fromkeys([*all_methods(1.0), *groups()]))


@click.command(
    "bench",
    cls=Command,
    examples="""
        lagtop bench --methods lagtop,DOP853-quaternion --n 1000
        lagtop bench stiff-top --methods lagtop,theta-series --n 100 --plot p.svg
        lagtop bench --long --methods lagtop,theta-series --n 100
    """,
)
@top_options(INPUT)
@click.option("--t-max", type=NUMBER, help="Last time.  [default: 20.3 nutation periods]")
@click.option("--n", "count", type=COUNT, help="Number of times.  [default: 1e4; 1e3 with --long]")
@click.option(
    "--methods",
    type=names_type(_methods),
    help="Methods, or groups such as engines.  [default: all but engines]",
)
@click.option(
    "--timeout",
    type=NUMBER,
    default="3",
    show_default=True,
    help="Time limit of a run, in seconds.",
)
@click.option(
    "--long", "is_long", is_flag=True, help="Compare over spans of 1 to 1e6 periods instead."
)
@plot_option
@output_options("table", "csv", "json", "ndjson", "markdown")
def bench_command(
    top: TopOptions,
    t_max: Fraction | None,
    count: int | None,
    methods: list[str] | None,
    timeout: Fraction,
    is_long: bool,
    plot: str | None,
    out: Output,
) -> None:
    """Measure the error of many methods against their run time.

    The methods are closed forms, integrators and physics engines, each on one thread.  The
    reference has 80 digits and shares no formula with lagtop.  The setting of an engine is steps
    per nutation period, or a tolerance.  A * marks the Pareto front: no other run is both faster
    and more accurate.

    Engines need their packages (pip install 'lagtop[engines]'), and Taylor's method heyoka.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))  # before the import of these packages
    from ..bench.compare_methods import compare_methods, compare_spans
    from ..bench.measure import check_scene, chosen_methods, reference_period
    from ..bench.pictures import draw_long_spans, draw_work_precision
    from ..plot.files import check_plot

    exclude({"--long": is_long, "--t-max": t_max})
    if t_max == 0:
        raise LagtopError("--t-max must not be 0")
    if count is not None and not 1 <= count <= MOST_TIMES:
        raise LagtopError(f"--n must be in [1, {MOST_TIMES}], got {count}")
    if not timeout > 0:
        raise LagtopError(f"--timeout must be > 0, got {float(timeout)}")
    check_plot(plot, out.path)
    chosen = chosen_methods(methods, float(timeout))
    motion = top.solved()
    check_scene(motion)
    how: dict[str, Any] = {"limit": float(timeout), "progress": with_progress}
    end = float(PERIODS * reference_period(motion) if t_max is None else t_max)

    def find() -> Report:
        if is_long:
            report = compare_spans(motion, count or LONG_SAMPLES, chosen, **how)
        else:
            report = compare_methods(motion, end, count or SAMPLES, chosen, **how)
        if plot:
            (draw_long_spans if is_long else draw_work_precision)(report, plot)
        return report

    write_report(out, find)


@click.command(
    "stability",
    cls=Command,
    examples="""
        lagtop stability --strata slow,thresholds --samples 1
        lagtop stability --strata slow --samples 2 --seed 7 -o battery.csv
        lagtop stability --strata slow --samples 1 --plot stability.svg
    """,
)
@click.option(
    "--samples",
    type=COUNT,
    default=str(SCENES),
    show_default=True,
    help="Scenes per stratum; 200 make a thorough test.",
)
@seed_option(default=str(SEED), show_default=True, help="Seed of the random scenes.")
@click.option(
    "--strata",
    type=names_type(late("bench.hard_scenes", "STRATA")),
    help="Only these kinds of scenes.  [default: all]",
)
@jobs_option
@click.option("--certify", is_flag=True, help="Print only proved bounds of the errors of lagtop.")
@click.option("--long", "is_long", is_flag=True, help="Compare over 1e4 periods too.")
@plot_option
@output_options("table", "csv", "json", "ndjson", "markdown")
def stability_command(
    samples: int,
    seed: int,
    strata: list[str] | None,
    jobs: int | None,
    certify: bool,
    is_long: bool,
    plot: str | None,
    out: Output,
) -> None:
    """Compare methods in random stiff and extreme scenes, and test lagtop there in 80 digits.

    Errors are in radians.  Compare them with the condition of the scene: the change that half a
    unit in the last place of its inputs makes.

    lagtop must round every key of the record correctly.  Its angles and its quaternion must be
    within 4 units, at times up to 1e14 periods before and after the start.  Some times are next to
    half, quarter and whole periods.  The exit code is 1 if a bound is exceeded.
    """
    exclude({"--certify": certify, "--long": is_long})
    if not 1 <= samples <= MOST_SCENES:
        raise LagtopError(f"--samples must be in [1, {MOST_SCENES}], got {samples}")
    from ..bench import stability
    from ..bench.pictures import draw_stability
    from ..plot.files import check_plot

    check_plot(plot, out.path)
    chosen = stability.chosen_strata(strata)

    def find() -> Report:
        report = stability.run_battery(
            chosen, samples, seed, with_progress, jobs or 1, certify=certify, is_long=is_long
        )
        if plot:
            draw_stability(report, plot)
        return report

    report = write_report(out, find)
    fail_for(stability.exceeded(report), len(chosen), "strata")
