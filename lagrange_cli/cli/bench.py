"""Tests of lagtop: `lagtop bench` and `lagtop stability`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from fractions import Fraction
from typing import TYPE_CHECKING

from ..bench.hard_scenes import STRATA, stratum_lines
from ..errors import LagtopError
from ..inputs.names import check_names
from ..output.terminal import with_progress
from . import options as opt
from .tables import fail_for, write_report
from .top import INPUT, SCENE, TopOptions, top_options

if TYPE_CHECKING:
    from ..output.destination import Output
    from ..output.report import Report

SAMPLES, LONG_SAMPLES = 10_000, 1000
MOST_TIMES = 10_000_000
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Environment variables for the number of threads of linear algebra packages."""
SCENES, MOST_SCENES = 1, 100_000
SEED = 1952
STABILITY = """Compare the errors of methods in random stiff and extreme scenes.

Errors are in radians.  Compare them with the condition of a scene: the change caused by half a unit
in the last place of its inputs.  The strata of scenes are:

\b
{strata}

lagtop itself is checked against 80 digits or more, at times up to 1e14 periods.  Its keys must be
correctly rounded, and its angles within 4 units, which lagtop table --help defines.  The exit code
is 1 if a bound is exceeded.
"""


def _methods() -> list[str]:
    from ..bench.measure import all_methods, groups

    return list(dict.fromkeys([*all_methods(1.0), *groups()]))


@opt.command(
    "bench",
    """
    lagtop bench --methods lagtop,DOP853-quaternion --n 1000
    lagtop bench chrapan-1952 stiff-top near-separatrix slow-top --plot p.svg
    lagtop bench --long --methods lagtop,theta-series --n 100
    """,
    exclusive=["--long --t-max"],
)
def bench_command(
    scenes: Sequence[str] = opt.arguments(SCENE, "[SCENE]..."),
    top: TopOptions = top_options(INPUT, None),
    t_max: Fraction | None = opt.number("Last time.  [default: 20.3 nutation periods]"),
    count: int | None = opt.count(
        "Number of times.  [default: 1e4; 1e3 with --long]", "--n", most=MOST_TIMES
    ),
    methods: list[str] | None = opt.names(
        "Methods, or groups such as engines.  [default: all but engines]", offered=_methods
    ),
    timeout: Fraction = opt.number(
        "Time limit of a run, in seconds.", positive=True, default="3", show_default=True
    ),
    is_long: bool = opt.flag("Compare over spans of 1 to 1e6 periods instead.", "--long"),
    plot: str | None = opt.plot,
    out: Output = opt.output(*opt.REPORT_FORMATS),
) -> None:
    """Measure the error of many methods against their run time.

    The methods are closed forms, integrators and physics engines, each on one thread.  The
    reference has 80 digits and shares no formula with lagtop.  The column `setting` holds the
    tolerance of a method, or its number of steps per nutation period.  A * marks the Pareto
    front: no other run is both faster and more accurate.  Several scenes make one table
    and one picture.

    Engines need their packages (pip install 'lagtop[engines]'), and Taylor's method needs heyoka.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))  # before the import of these packages
    from ..bench.compare_methods import compare_methods
    from ..bench.measure import chosen_methods
    from ..bench.pictures import draw_methods
    from ..plot.reports import check_plot

    if t_max == 0:
        raise LagtopError("--t-max must not be 0")
    check_plot(plot, out.path)
    chosen = chosen_methods(methods, float(timeout))
    names: Sequence[str | None] = scenes or [None]
    motions, units = {}, dict[str, str]()
    for name in names:
        motions[name], units = top.replace(scene=name).solved_in_units()

    def find() -> Report:
        report = compare_methods(
            motions,
            chosen,
            count or (LONG_SAMPLES if is_long else SAMPLES),
            t_max=None if t_max is None else float(t_max),
            limit=float(timeout),
            is_long=is_long,
            progress=with_progress,
        )
        if plot:
            draw_methods(report, plot, is_long=is_long)
        return report._replace(conditions=units | report.conditions)

    write_report(out, find)


@opt.command(
    "stability",
    """
    lagtop stability --strata slow,thresholds --samples 1
    lagtop stability --strata slow --samples 2 --seed 7 -o battery.csv
    lagtop stability --strata slow --samples 1 --plot stability.svg
    """,
    exclusive=["--certify --long"],
    text=STABILITY.format(strata="\n".join(stratum_lines())),
)
def stability_command(
    scenes: int = opt.count(  # the help lists it among the options of the command, as `first_seed`
        "Scenes per stratum; 200 make a thorough test.",
        "--samples",
        most=MOST_SCENES,
        default=str(SCENES),
        show_default=True,
    ),
    first_seed: int = opt.count(
        "Seed of the random scenes.", "--seed", default=str(SEED), show_default=True
    ),
    strata: list[str] | None = opt.names(
        "Use only these strata.  [default: all]", offered=opt.late("bench.hard_scenes", "STRATA")
    ),
    jobs: int | None = opt.jobs,
    certify: bool = opt.flag("Print only proven bounds on the errors of lagtop."),
    is_long: bool = opt.flag("Compare over 1e4 periods too.", "--long"),
    plot: str | None = opt.plot,
    out: Output = opt.output(*opt.REPORT_FORMATS),
) -> None:
    """Compare methods in random scenes; STABILITY is the help."""
    from ..bench import stability
    from ..bench.pictures import draw_stability
    from ..plot.reports import check_plot

    check_plot(plot, out.path)
    chosen = list(STRATA) if strata is None else check_names("strata", strata, STRATA)

    def find() -> Report:
        report = stability.run_battery(
            chosen, scenes, first_seed, with_progress, jobs or 1, certify=certify, is_long=is_long
        )
        if plot:
            draw_stability(report, plot)
        return report

    report = write_report(out, find)
    fail_for(stability.exceeded(report), len(chosen), "strata")
