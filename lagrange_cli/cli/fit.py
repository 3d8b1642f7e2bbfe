"""The command `lagtop fit`: a top from a recording."""

from __future__ import annotations

from functools import partial
from typing import TYPE_CHECKING, Any

from ..arithmetic.numbers import unit_in_radians
from ..arithmetic.text import json_text, parse_number
from ..errors import LagtopError, SomeFailedError
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
from .top import UNCERTAIN, TopOptions, top_options, words

if TYPE_CHECKING:
    from ..fit.outcome import Outcome
    from ..fit.problem import Known
    from ..inputs.text_lines import Dialect


def _positive(text: str) -> float:
    number = float(parse_number(text))
    if not number > 0:
        raise LagtopError(f"must be > 0, got {number:g}")
    return number


def _parse_sigma(text: str) -> float | dict[str, float]:
    if "=" not in text:
        return _positive(text)
    parts = [part.partition("=") for part in split_names(text)]
    return {name.strip(): _positive(value) for name, _, value in parts}


def _parse_up(text: str) -> str:
    """Return the axis of `up=AXIS`."""
    key, _, axis = text.partition("=")
    if key != "up" or axis.removeprefix("-") not in {"x", "y", "z"}:
        raise LagtopError(f"must be up=x, up=y, up=z, up=-x, up=-y or up=-z, got {text}")
    return axis


@opt.command(
    "fit",
    """
    lagtop table --t-max 2 --n 200 -o recording.csv
    lagtop fit recording.csv --m 1587 --g 981 -o fitted.toml
    lagtop fit recording.csv --sigma 0.3 --plot residuals.svg
    """,
    exclusive=["--window --by", "--window --plot"],
)
def fit_command(
    top: TopOptions = top_options(
        UNCERTAIN, words("RECORDING", opt.FILE, required=True), whole=False, units=False
    ),
    sigma: float | dict[str, float] | None = opt.option(
        opt.Parsed("SIGMA", _parse_sigma),
        "Standard deviation of all angles, or theta=0.3,psi=0.5.  [default: estimated from the "
        "residuals]",
    ),
    window: int | None = opt.count("Fit N equal windows, and the decay of the spin."),
    by: str | None = opt.option(
        opt.Parsed("COLUMN", str), "Column that names the recording of each row."
    ),
    align: str = opt.option(
        opt.Parsed("up=AXIS", _parse_up),
        "Axis of space that points up in the file.",
        default="up=z",
    ),
    names: list[str] | None = columns_option,
    quaternion_order: str = quaternion_option("wxyz"),
    euler_sequence: str = euler_option,
    dialect: Dialect = text_options,
    plot: str | None = opt.plot,
    out: Output = opt.output(*opt.REPORT_FORMATS, extensions=["toml"]),
) -> None:
    """Fit a top to a recording, with uncertainties.

    A recording is a file as in lagtop compare, or - for standard input.  Each row holds a time
    with tilt, spin and precession, or with the axis, or with the attitude.  Cells may be missing,
    and angles may be wrapped.

    Known inputs are the inputs given as options.  If the nutation is below the noise, the mean tilt
    and the mean rates are fitted.  The exit code is 0 if the verdict is good, and 1 if not: the
    last line then says why, and what to try.  With -o FILE.toml a good fit is written as a scene.
    """
    from ..fit.fit import best_fit
    from ..fit.problem import known_inputs
    from ..fit.recording import Reading, read_recordings
    from ..inputs.files import shown_path
    from ..inputs.seen import Conventions
    from ..plot.reports import check_plot

    check_plot(plot, out.path)
    if len(top.words) != 1:
        raise LagtopError(f"fit takes one recording, got {len(top.words)}: use --by COLUMN")
    if top.scene is not None:
        raise LagtopError(f"fit takes no scene, got {top.scene}: give known inputs as options")
    scene_path = out.path if opt.extension(out.path) == "toml" else None
    opt.exclude({"--window": window, f"--output {out.path}": scene_path})
    radians = top.radians
    conventions = Conventions(quaternion_order, euler_sequence, "body", radians).checked()
    reading = Reading(
        names, conventions, by, _in_radians(sigma, radians), dialect.decimal, up=align
    )
    recordings = read_recordings(top.words[0], reading)
    given = top.given()
    known, source = known_inputs(given.inputs, given.stds), shown_path(top.words[0])
    units = " (in kg, m and s)" if given.system else ""
    if scene_path and len(recordings) > 1:
        raise LagtopError(f"a scene holds one top, got {len(recordings)}: fit one recording")
    if window is not None:
        _fit_windows(recordings[0], window, known, source, units, radians, out)
        return
    found = [best_fit(x, known, radians=radians) for x in with_progress(recordings, "fits")]
    if plot:
        _draw(found, plot)
    _write(found, source, units, out._replace(path="-") if scene_path else out)
    failed = [x.failure() for x in found if x.failures()]
    if failed and len(found) == 1:
        raise SomeFailedError(f"the fit has failed: {failed[0]}")
    fail_for(failed, len(found), "fits")
    if scene_path:
        text = found[0].scene(source)
        write_bytes(scene_path, text.encode)


def _in_radians(
    sigma: float | dict[str, float] | None, radians: bool
) -> float | dict[str, float] | None:
    unit = unit_in_radians(radians=radians)
    if isinstance(sigma, dict):
        return {name: value * unit for name, value in sigma.items()}
    return None if sigma is None else sigma * unit


def _write(found: list[Outcome], source: str, units: str, out: Output) -> None:
    """Write a report, or one record for each recording."""
    from ..fit.report import fit_report

    if out.fmt == "table":
        write_report(out, lambda: fit_report(found, source, units))
        return
    records: list[dict[str, Any]] = [x.record() for x in found]
    if len(records) == 1 and out.fmt == "json":
        out.record(records[0], dict)
    else:
        out.rows(records, list(dict.fromkeys(key for record in records for key in record)))
    for x in found:
        name = f"{x.recording.name}: " if x.recording.name else ""
        for note in x.notes:
            complain(f"Note: {name}{note}")


def _fit_windows(
    recording: Any, count: int, known: Known, source: str, units: str, radians: bool, out: Output
) -> None:
    """Fit windows, and write a row for each with the decay, or the record."""
    from ..fit.report import decay_text, windows_record, windows_report
    from ..fit.windows import fit_windows

    found = fit_windows(recording, count, known, radians=radians)
    if out.fmt == "table":
        write_report(out, lambda: windows_report(found, source, units))
    elif out.fmt == "json":
        out.text(f"{json_text(windows_record(found))}\n")
    else:
        rows = windows_record(found)["windows"]
        out.rows(rows, list(dict.fromkeys(key for row in rows for key in row)))
        complain(decay_text(found))
    fail_for([x.failure() for x in found if x.failures()], len(found), "windows")


def _draw(found: list[Outcome], path: str) -> None:
    from ..plot.reports import draw_fit

    curves = [curve for outcome in found for curve in outcome.curves()]
    title = f"lagtop fit: {found[0].verdict}" if len(found) == 1 else ""
    write_bytes(path, partial(draw_fit, curves, found[0].angle, path, title))
