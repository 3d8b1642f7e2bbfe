"""The command `lagtop fit`: a top from data."""

from __future__ import annotations

from collections.abc import Mapping
from functools import partial
from typing import TYPE_CHECKING, Any

import click

from ..arithmetic.numbers import unit_in_radians
from ..errors import LagtopError
from ..inputs.names import split_names
from .command import ExamplesFirst, complain, fail_for, write_report
from .options import FILE, NAMES, Parsed, exclude, extension, output_options
from .progress import with_progress
from .row_options import dialect, reading_options, text_options
from .top_options import UNCERTAIN, by_key, input_options

if TYPE_CHECKING:
    from ..fits.record import Outcome
    from ..fits.recording import Recording
    from ..inputs.top import Top
    from ..inputs.units import System


def _write_names(formatter: click.HelpFormatter) -> None:
    """Write the quantities of a recording, and the names of columns by which each is known."""
    from ..inputs.trajectory_columns import shown_quantities

    with formatter.section("Columns of a recording, by name; NAME_std is a standard deviation"):
        left_out = {"position", "rates", "angle_rates"}
        shown = shown_quantities().items()
        formatter.write_dl([(name, text) for name, text in shown if name not in left_out])


def _parse_sigma(text: str) -> float | dict[str, float]:
    from ..arithmetic.text import parse_number

    parts = [part.partition("=") for part in split_names(text)]
    if len(parts) == 1 and not parts[0][1]:
        return _positive(float(parse_number(parts[0][0])))
    return {name.strip(): _positive(float(parse_number(value))) for name, _, value in parts}


def _positive(value: float) -> float:
    if not value > 0:
        raise LagtopError(f"must be > 0, got {value:g}")
    return value


@click.command(
    "fit",
    cls=ExamplesFirst,
    shows=_write_names,
    examples="""
        lagtop fit sample_inputs/recording.csv
        lagtop fit sample_inputs/recording.csv --sigma theta=0.3,psi=0.5,phi=1 --m 1.587 --g 9.81
        lagtop fit sample_inputs/recording.csv --format json
        lagtop fit sample_inputs/recording.csv --g 9.81 -o fitted.toml
        lagtop table --t-max 2 --n 200 --columns t,axis | lagtop fit -
    """,
)
@click.argument("recording", type=FILE)
@click.option(
    "--scene", type=FILE, metavar="FILE|-", help="Scene file, of which --fix takes what is known."
)
@input_options(UNCERTAIN, units=False, whole=False)
@click.option(
    "--fix",
    type=NAMES,
    help="Inputs of the scene that are known, with commas between; those given by options are.",
)
@click.option(
    "--sigma",
    type=Parsed("sigma", _parse_sigma),
    help="Standard deviation of all angles, or of each, such as theta=0.3,psi=0.5; columns "
    "NAME_std win.  [default: that of what is left]",
)
@click.option("--by", metavar="COLUMN", help="Column that tells several recordings apart.")
@click.option(
    "--together", is_flag=True, help="The recordings of --by are of one body: a and C/A are shared."
)
@reading_options(quaternion="wxyz")
@text_options
@click.option(
    "--plot",
    type=FILE,
    metavar="FILE",
    help="Draw data, motion and what is left: FILE.svg or .png.",
)
@output_options("table", "csv", "json", extensions=["toml"])
def command(
    recording: str,
    scene: str | None,
    rad: bool,
    fix: list[str] | None,
    sigma: float | dict[str, float] | None,
    by: str | None,
    together: bool,
    columns: list[str] | None,
    quaternion_order: str,
    euler_sequence: str,
    plot: str | None,
    fmt: str,
    output: str,
    **options: Any,
) -> None:
    """The top behind a recording: a, b and the start, and what they tell of the body.

    A recording is a file, as of `lagtop compare`, or - for standard input: times, and tilt, spin
    and precession, the axis or the attitude.  Cells may be missing, angles may be wrapped, and psi
    and phi may count from anywhere.  The start is that of the first row.

    Nothing is taken from the worked example: what is known are the inputs given by options, and
    those of the scene that --fix names.  What cannot be told apart is named.

    -o FILE.toml writes a scene that every other command reads, beside the report.  The exit code
    is 1 if a fit has failed, and no scene is written then.
    """
    from ..fits.record import FAILED
    from ..fits.recording import Reading, read_recordings
    from ..inputs.seen import Conventions
    from ..plot.files import check_plot

    check_plot(plot, output)
    exclude({"--scene -": scene == "-" or None, "the recording -": recording == "-" or None})
    if together and by is None:
        raise LagtopError("--together needs --by COLUMN, which tells recordings apart")
    conventions = Conventions(quaternion_order, euler_sequence, "body", rad).checked()
    spread = _in_radians(sigma, rad)
    reading = Reading(columns, conventions, by, spread, dialect())
    recordings = read_recordings(recording, reading)
    given = by_key(options, radians=rad)
    known, stds, system = _known(scene, recordings[0].scene, fix or [], given)
    scene_path = output if extension(output) == "toml" else None
    if scene_path and len(recordings) > 1:
        raise LagtopError(f"--output {output} holds one top, got {len(recordings)} recordings")
    groups = [recordings] if together else [[one] for one in recordings]
    found = _fitted(groups, known, stds, recording, rad)
    failed = [outcome for outcome in found if outcome.verdict == FAILED]
    if scene_path and not failed:
        _write_scene(found[0], recording, scene_path)
    if plot:
        _draw(found, plot, rad)
    _write(found, recording, system, fmt, "-" if scene_path else output)
    if failed and scene_path:
        complain(f"Warning: {scene_path} is not written: the fit has failed")
    fail_for([outcome.failure() for outcome in failed], len(found), "fits")


def _fitted(
    groups: list[list[Recording]],
    known: Mapping[str, float],
    stds: Mapping[str, float],
    source: str,
    radians: bool,
) -> list[Outcome]:
    from ..fits.fit import fit_recordings
    from ..inputs.files import shown_path

    found: list[Outcome] = []
    for group in with_progress(groups, "fits"):
        found += fit_recordings(group, known, shown_path(source), stds=stds, radians=radians)
    return found


def _known(
    scene: str | None, described: Top | None, fix: list[str], given: Mapping[str, Any]
) -> tuple[dict[str, float], dict[str, float], System | None]:
    """Return known inputs, given or of the scene, their standard deviations, and their units.

    Without a scene file, the scene is the one that the recording describes.  Raises LagtopError.
    """
    from ..fits.parameters import known_inputs
    from ..inputs.given import gather
    from ..inputs.input_keys import overridden
    from ..inputs.measured import moment
    from ..inputs.names import check_names
    from ..inputs.top import Top

    found = gather(given, scene)
    present = dict(found.inputs)
    if described is not None and scene is None and found.system is None:
        present = overridden(described.inputs(), present)
    names = [x for x in present if x in given]
    if {"A_cm", "m", "s"} <= present.keys() and "A_cm" not in given:
        present["A"] = moment(present)  # of the scene: m and s need not be known for that
    for name in fix:
        matching = [x for x in (name, f"{name}_deg", f"{name}_rad") if x in present]
        if not matching:
            check_names("fix", [name], [*Top.fields, "theta0"])
            raise LagtopError(f"--fix {name} must be given by an option or by --scene")
        names.append(matching[0])
    stds = {name: found.stds[name] for name in names if name in found.stds}
    return (*known_inputs({name: present[name] for name in names}, stds), found.system)


def _in_radians(
    sigma: float | dict[str, float] | None, radians: bool
) -> float | dict[str, float] | None:
    unit = unit_in_radians(radians=radians)
    if isinstance(sigma, dict):
        return {name: value * unit for name, value in sigma.items()}
    return None if sigma is None else sigma * unit


def _write(found: list[Outcome], source: str, system: System | None, fmt: str, output: str) -> None:
    """Write a report, or one record for each recording, with units where known inputs have any."""
    from ..fits.report import fit_report, outcome_units

    if fmt == "table":
        from ..inputs.files import shown_path

        write_report(lambda: fit_report(found, shown_path(source), system), fmt, output)
        return
    from ..output.write import block_text, write_record, write_text_blocks

    records = [outcome.record() for outcome in found]
    if system is not None and fmt == "json":
        units = [{"units": outcome_units(outcome, system)} for outcome in found]
        records = [record | unit for record, unit in zip(records, units, strict=True)]
    if len(records) == 1 and fmt == "json":
        write_record(records[0], fmt, output, dict)
    else:
        keys = list(dict.fromkeys(key for record in records for key in record))
        columns = [[record.get(key) for record in records] for key in keys]
        write_text_blocks(fmt, keys, [block_text(columns, keys, fmt)], output)
    for outcome in found:
        name = f"{outcome.recording.name}: " if outcome.recording.name else ""
        notes = [*outcome.notes(), *outcome.undetermined()]
        for word, texts in (("Note", notes), ("Warning", outcome.warnings())):
            if texts:
                complain(f"{word}: {name}{'; '.join(texts)}")


def _write_scene(outcome: Outcome, source: str, path: str) -> None:
    from ..fits.report import scene_text
    from ..output.write import write_bytes

    write_bytes(path, lambda: scene_text(outcome, source).encode())


def _draw(found: list[Outcome], path: str, radians: bool) -> None:
    from ..fits.report import curves_of
    from ..output.write import write_bytes
    from ..plot.reports import FittedCurve, draw_fit

    curves = [FittedCurve(*x) for outcome in found for x in curves_of(outcome)]
    write_bytes(path, partial(draw_fit, curves, "rad" if radians else "deg", path))
