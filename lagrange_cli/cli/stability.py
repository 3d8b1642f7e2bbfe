"""`lagtop stability`: stiff and extreme cases."""

from __future__ import annotations

from typing import TYPE_CHECKING

import click

from .. import __version__
from ..errors import LagtopError
from .options import (
    COUNT,
    NAMES,
    ExamplesFirst,
    exclude,
    output_options,
    write_report,
)
from .progress import with_steps

if TYPE_CHECKING:
    from ..output.findings import Findings

SAMPLES, THOROUGH, MOST_SAMPLES = 8, 200, 100_000
SEED = 1952


@click.command(
    "stability",
    cls=ExamplesFirst,
    examples="""
        lagtop stability
        lagtop stability --strata separatrix,thresholds --samples 50
        lagtop stability --thorough --seed 7 --format csv -o battery.csv
        lagtop stability --plot stability.svg
    """,
)
@click.option("--samples", type=COUNT, help=f"Scenes a stratum.  [default: {SAMPLES}]")
@click.option("--thorough", is_flag=True, help=f"The whole battery: {THOROUGH} scenes a stratum.")
@click.option("--seed", type=COUNT, default=str(SEED), show_default=True, help="Of the scenes.")
@click.option("--strata", type=NAMES, help="Only these, with commas between.")
@click.option("--plot", type=click.Path(), metavar="FILE", help="Draw it too: FILE.svg or .png.")
@click.version_option(__version__, prog_name="lagtop")
@output_options("table", "csv", "json")
@click.pass_context
def command(
    ctx: click.Context,
    samples: int | None,
    thorough: bool,
    seed: int,
    strata: list[str] | None,
    plot: str | None,
    fmt: str,
    output: str,
) -> None:
    """Random scenes of every hard kind, judged by a reference of 80 digits.

    The same scenes go through scipy.special and through DOP853, if scipy is there (extra `bench`).
    Exits with 1 where an error exceeds what is promised: 4 units an angle, 4 eps a key of the
    record.
    """
    exclude({"--samples": samples, "--thorough": thorough or None})
    if samples is not None and not 1 <= samples <= MOST_SAMPLES:
        raise LagtopError(f"--samples must be in [1, {MOST_SAMPLES}], got {samples}")
    from ..bench import stability
    from ..bench.diagrams import check_plot, draw_stability

    check_plot(plot, output)
    chosen, count = stability.chosen_strata(strata), samples or (THOROUGH if thorough else SAMPLES)

    def find() -> Findings:
        found = stability.report(chosen, count, seed, with_steps)
        if plot:
            draw_stability(found, plot)
        return found

    if stability.exceeded(write_report(find, fmt, output)):
        ctx.exit(1)
