"""`lagtop stability`: stiff and extreme cases."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from ..errors import LagtopError
from .command import ExamplesFirst, fail_for, write_report
from .options import COUNT, FILE, STRATUM_NAMES, exclude, output_options
from .progress import with_progress
from .row_options import jobs_option

if TYPE_CHECKING:
    from ..output.report import Report

SAMPLES, THOROUGH, MOST_SCENES = 4, 200, 100_000
SEED = 1952


def _write_strata(formatter: click.HelpFormatter) -> None:
    """Write the names of the strata."""
    from ..bench.hard_scenes import STRATA

    with formatter.section("Strata"):
        formatter.write_text(", ".join(STRATA))


@click.command(
    "stability",
    cls=ExamplesFirst,
    shows=_write_strata,
    examples="""
        lagtop stability
        lagtop stability --strata separatrix,thresholds --samples 50
        lagtop stability --thorough --seed 7 --jobs auto -o battery.csv
        lagtop stability --plot stability.svg
    """,
)
@click.option("--samples", type=COUNT, help=f"Scenes per stratum.  [default: {SAMPLES}]")
@click.option("--thorough", is_flag=True, help=f"The whole battery: {THOROUGH} scenes per stratum.")
@click.option(
    "--seed", type=COUNT, default=str(SEED), show_default=True, help="Seed of the random scenes."
)
@click.option("--strata", type=STRATUM_NAMES, help="Only these, with commas between.")
@jobs_option
@click.option(
    "--certify", is_flag=True, help="Print proved upper bounds of lagtop's errors; run no others."
)
@click.option("--plot", type=FILE, metavar="FILE", help="Draw it too: FILE.svg or .png.")
@output_options("table", "csv", "json")
def command(
    samples: int | None,
    thorough: bool,
    seed: int,
    strata: list[str] | None,
    jobs: int | None,
    certify: bool,
    plot: str | None,
    fmt: str,
    output: str,
) -> None:
    """Judge random scenes of every hard kind by a reference of 80 digits.

    Judged are every key of the record, which must be the nearest double, and the angles and the
    quaternion, within 4 units, at times up to 1e14 periods on both sides of the start, some of them
    next to half, quarter and whole periods.  The same scenes go through scipy.special and DOP853.
    The exit code is 1 where a promise is exceeded.
    """
    exclude({"--samples": samples, "--thorough": thorough or None})
    if samples is not None and not 1 <= samples <= MOST_SCENES:
        raise LagtopError(f"--samples must be in [1, {MOST_SCENES}], got {samples}")
    from ..bench import stability
    from ..bench.pictures import draw_stability
    from ..plot.files import check_plot

    check_plot(plot, output)
    chosen, count = stability.chosen_strata(strata), samples or (THOROUGH if thorough else SAMPLES)

    def find() -> Report:
        findings = stability.run_battery(
            chosen, count, seed, with_progress, jobs or 1, certify=certify
        )
        if plot:
            draw_stability(findings, plot)
        return findings

    findings = write_report(find, fmt, output)
    fail_for(stability.exceeded(findings), len(findings.rows), "strata")
