"""Tests of methods: `lagtop bench` and `lagtop stability`."""

from __future__ import annotations

import os

from ..errors import LagtopError
from ..output.destination import Output
from ..output.terminal import one_line
from . import shared as opt

MOST_TIMES, MOST_SCENES, MOST_PERIODS = 10_000_000, 1000, 1e6
_THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")
"""Environment variables for the number of threads of linear algebra packages."""


def _parse_spans(text: str) -> list[float]:
    """Return increasing spans in nutation periods."""
    spans = opt.parse_numbers(text)
    if not all(0 < span <= MOST_PERIODS for span in spans) or spans != sorted(set(spans)):
        wanted = f"must be increasing numbers above 0, at most {MOST_PERIODS:g}"
        raise LagtopError(f"{wanted}, got {text}")
    return spans


@opt.command(
    "bench",
    "bench --methods lagtop,DOP853 --n 1000",
    "bench slow-top --methods lagtop,DOP853,Taylor --plot methods.svg",
    "bench --r0 60 --methods lagtop --plot methods.svg",
    "bench --spans 1,100 --methods lagtop,scipy.special --n 100",
)
@opt.top("[SCENE]...", is_scene=None)
@opt.option(
    "--spans",
    type=opt.Listed("X,...", _parse_spans),
    help="Lengths in nutation periods; several show how errors grow.  [default: 20.3]",
)
@opt.option("--n", type=opt.count(MOST_TIMES), default="1e4", help="Number of times.")
@opt.option("--methods", type=opt.LIST, help="Methods to compare.  [default: all]")
@opt.plot
@opt.option(
    "--points",
    metavar="FILE",
    help="Add the points of other methods to the picture: CSV with method, error_rad, and "
    "ns_per_sample or evaluations.",
)
@opt.output("table")
def bench_command(
    top: opt.TopOptions,
    words: list[str],
    spans: list[float] | None,
    n: int,
    methods: list[str] | None,
    plot: str | None,
    points: str | None,
    out: Output,
) -> None:
    """Measure the error of methods against their run time.

    The methods are closed forms, integrators and MuJoCo, each on one thread.  The error is the
    greatest rotation (rad) from the exact attitude, which mpmath computes in 50 digits by other
    formulas.  The column `setting` holds the tolerance of a method, or its number of steps per
    nutation period.  A * marks the front: no other row is both faster and more accurate.

    Taylor's method needs heyoka, and MuJoCo its own package; bench names missing packages.  To
    check a method of your own, write its trajectory to a file and use lagtop compare.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))  # before the import of these packages
    from ..bench.points import read_points
    from ..bench.work_precision import PERIODS, bench, methods_figure
    from ..file_bytes import shown_path

    if points is not None and not plot:
        raise LagtopError("--points needs --plot FILE.svg")
    if points is not None and len(spans or [PERIODS]) > 1:
        raise LagtopError("--points needs one span: the picture of several shows no cost")
    cost, others = ("ns_per_sample", []) if points is None else read_points(points)
    scenes = words or ([] if top.inputs else ["chrapan-1952"])
    founds = {one_line(shown_path(x)): top._replace(scene=x).given() for x in scenes}
    founds = founds or {"inputs": top.given()}
    motions = {name: opt.motion_of(found) for name, found in founds.items()}
    opt.write_report(
        out,
        lambda: bench(motions, methods, sorted({*(spans or [PERIODS])}), n),
        plot,
        lambda report: methods_figure(report, cost, others),
    )


@opt.command(
    "stability",
    "stability --kinds extreme-sizes",
    "stability --kinds slow-spin --samples 2 --seed 7 -o slow.csv",
    "stability --kinds slow-spin --plot stability.svg",
)
@opt.option("--kinds", type=opt.LIST, help="Use only these kinds of scenes.  [default: all]")
@opt.option("--samples", type=opt.count(MOST_SCENES), default="1", help="Random scenes per kind.")
@opt.option("--seed", type=opt.count(), default="1952", help="Seed of the random scenes.")
@opt.plot
@opt.output("table")
def stability_command(
    kinds: list[str] | None, samples: int, seed: int, plot: str | None, out: Output
) -> None:
    """Compare methods in stiff and extreme scenes.

    The kinds are fast-spin, slow-spin, near-separatrix, near-vertical, tiny-tilt-with-rates,
    near-steady, near-hanging and extreme-sizes.  Each has a fixed scene and random ones.  Errors
    are the greatest rotations (rad) from the exact attitude, over 1 and 100 nutation periods.
    `input rounding` is the rotation that half an ulp of each input causes: no method whose inputs
    are doubles can guarantee less.  A row shows the worst scene of its kind.

    The exit code is 1 if an error of lagtop exceeds 100 times the input rounding.
    """
    os.environ.update(dict.fromkeys(_THREADS, "1"))
    from ..bench.stability import failures, stability, stability_figure

    report = opt.write_report(out, lambda: stability(kinds, samples, seed), plot, stability_figure)
    opt.fail_for(failures(report), len(report.rows), "rows")
