"""Tests of methods: `lagtop bench` and `lagtop stability`."""

from __future__ import annotations

import os
from collections.abc import Sequence
from typing import TYPE_CHECKING

from ..errors import LagtopError
from ..output.terminal import with_progress
from . import options as opt
from .tables import fail_for, write_report
from .top import SCENE

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..output.destination import Output
    from ..output.report import Report

MOST_TIMES, MOST_SCENES, MOST_PERIODS = 10_000_000, 1000, 1e6
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Environment variables for the number of threads of linear algebra packages."""


def _parse_spans(text: str) -> list[float]:
    """Return increasing spans in nutation periods."""
    from ..arithmetic.text import parse_number
    from ..inputs.names import split_names

    spans = [float(parse_number(each)) for each in split_names(text)]
    if not all(0 < span <= MOST_PERIODS for span in spans) or spans != sorted(set(spans)):
        raise LagtopError(f"must increase from above 0 to {MOST_PERIODS:g} periods, got {text}")
    return spans


def _save(figure: Figure, path: str) -> None:
    """Write a picture of a report."""
    from ..output.destination import opened

    with opened(path) as stream:
        figure.savefig(stream, format=opt.extension(path), dpi=150)


@opt.command(
    "bench",
    """
    lagtop bench --methods lagtop,DOP853 --n 1000
    lagtop bench chrapan-1952 stiff-top near-separatrix slow-top --plot methods.svg
    lagtop bench --spans 1,100 --methods lagtop,scipy.special --n 100
    """,
)
def bench_command(
    scenes: Sequence[str] = opt.arguments(SCENE, "[SCENE]..."),
    spans: list[float] | None = opt.option(
        opt.Parsed("X,...", _parse_spans),
        "Lengths in nutation periods; several show how errors grow.  [default: 20.3]",
    ),
    count: int = opt.count(
        "Number of times.", "--n", most=MOST_TIMES, default="1e4", show_default=True
    ),
    methods: list[str] | None = opt.names(
        "Methods to compare.  [default: all]", offered=opt.late("bench.methods", "METHODS")
    ),
    plot: str | None = opt.plot,
    out: Output = opt.output(*opt.REPORT_FORMATS),
) -> None:
    """Measure the error of methods against their run time.

    The methods are closed forms, integrators and MuJoCo, each on one thread.  The error is the
    greatest rotation (rad) from the exact attitude, which mpmath computes in 50 digits by other
    formulas.  The column `setting` holds the tolerance of a method, or its number of steps per
    nutation period.  A * marks the front: no other row is both faster and more accurate.

    Taylor's method needs heyoka, and MuJoCo its own package; a missing one is named.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))  # before the import of these packages
    from ..bench.pictures import methods_figure
    from ..bench.work_precision import PERIODS, bench
    from ..inputs.given import read_scene
    from ..motion.solve import solve
    from ..plot.reports import check_plot

    check_plot(plot, out.path)
    motions = {name: solve(read_scene(name)) for name in scenes or ["chrapan-1952"]}

    def find() -> Report:
        report = bench(motions, methods, spans or [PERIODS], count, with_progress)
        if plot:
            _save(methods_figure(report), plot)
        return report

    write_report(out, find)


@opt.command(
    "stability",
    """
    lagtop stability
    lagtop stability --kinds slow-spin,near-vertical --samples 5 --seed 7 -o stability.csv
    lagtop stability --kinds slow-spin --plot stability.svg
    """,
)
def stability_command(
    kinds: list[str] | None = opt.names(
        "Use only these kinds of scenes.  [default: all]",
        offered=opt.late("bench.stability", "KINDS"),
    ),
    samples: int = opt.count(
        "Random scenes of each kind.", most=MOST_SCENES, default="1", show_default=True
    ),
    seed: int = opt.count("Seed of the random scenes.", default="1952", show_default=True),
    plot: str | None = opt.plot,
    out: Output = opt.output(*opt.REPORT_FORMATS),
) -> None:
    """Compare methods in stiff and extreme scenes.

    The kinds are fast-spin, slow-spin, near-separatrix, near-vertical, tiny-tilt-with-rates,
    near-steady, near-hanging and extreme-sizes.  Each has a fixed scene and random ones.  Errors
    are the greatest rotations (rad) from the exact attitude, over 1 and 100 nutation periods.
    `input rounding` is the rotation that half an ulp of each input causes: no method whose inputs
    are doubles can do better.  A row shows the worst scene of its kind.

    The exit code is 1 if an error of lagtop exceeds 100 times the input rounding.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    from ..bench.pictures import stability_figure
    from ..bench.stability import failures, stability
    from ..plot.reports import check_plot

    check_plot(plot, out.path)

    def find() -> Report:
        report = stability(kinds, samples, seed, with_progress)
        if plot:
            _save(stability_figure(report), plot)
        return report

    report = write_report(out, find)
    fail_for(failures(report), len(report.rows), "rows")
