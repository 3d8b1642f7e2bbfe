"""The command `lagtop fit`: a top from a recording."""

from __future__ import annotations

from contextlib import ExitStack
from typing import TYPE_CHECKING

from ..arithmetic.numbers import unit_in_radians
from ..errors import LagtopError, SomeFailedError
from ..names import split_names
from ..output.destination import Output, opened
from ..output.terminal import with_progress
from ..output.text import json_text
from . import shared as opt
from .app import complain

if TYPE_CHECKING:
    from ..inverse.outcome import Outcome


def _parse_sigma(text: str) -> float | dict[str, float]:
    if "=" not in text:
        return opt.parse_positive(text)
    parts = [part.partition("=") for part in split_names(text)]
    return {name.strip(): opt.parse_positive(value) for name, _, value in parts}


def _parse_up(text: str) -> str:
    """Return the axis of `up=AXIS`."""
    key, _, axis = text.partition("=")
    if key != "up" or axis.removeprefix("-") not in {"x", "y", "z"}:
        raise LagtopError(f"must be up=x, up=y, up=z, up=-x, up=-y or up=-z, got {text}")
    return axis


@opt.command(
    "fit",
    "table --t-max 2 --n 200 -o recording.csv",
    "fit recording.csv --m 1587 --g 981 -o fitted.toml",
    "fit recording.csv --sigma 0.3 --plot residuals.svg",
)
@opt.top("RECORDING", whole=False, is_scene=None)
@opt.option(
    "--sigma",
    type=opt.Parsed("SIGMA", _parse_sigma),
    help="Standard deviation of all angles, or theta=0.3,psi=0.5.  [default: estimated from the "
    "residuals]",
)
@opt.option("--window", type=opt.count(), help="Fit N equal windows, and the decay of the spin.")
@opt.option("--by", metavar="COLUMN", help="Column that names the recording of each row.")
@opt.option(
    "--align",
    metavar="up=AXIS",
    type=opt.Parsed("AXIS", _parse_up),
    default="up=z",
    help="Axis of space that points up in the file.",
)
@opt.columns
@opt.quaternion_order
@opt.euler_sequence
@opt.decimal
@opt.plot
@opt.output(*opt.REPORT_FORMATS, extensions=["toml"])
def fit_command(
    top: opt.TopOptions,
    words: list[str],
    sigma: float | dict[str, float] | None,
    window: int | None,
    by: str | None,
    align: str,
    columns: list[str] | None,
    quaternion_order: str,
    euler_sequence: str,
    decimal: str,
    plot: str | None,
    out: Output,
) -> None:
    """Fit a top to a recording, with uncertainties.

    A recording is a file as in lagtop compare, or - for standard input.  Each row holds a time
    with tilt, spin and precession, or with the axis, or with the attitude.  Cells may be missing,
    and angles may be wrapped.

    Known inputs are the inputs given as options.  If the nutation is below the noise, the mean tilt
    and the mean rates are fitted.  The exit code is 0 if the verdict is good, and 1 if not: the
    last line then says why, and what to try.  With -o FILE.toml a good fit is written as a scene.
    """
    from ..file_bytes import shown_path
    from ..files.observed import Conventions
    from ..inverse.fit import best_fit, fit_windows
    from ..inverse.recording import known_inputs, read_recordings
    from ..plot.reports import draw_fits
    from ..plot.style import report_bytes

    if len(words) != 1:
        remedy = "use --by COLUMN" if words else "give a file, or - for standard input"
        raise LagtopError(f"fit takes one recording, got {len(words)}: {remedy}")
    scene_path = out.path if opt.extension(out.path) == "toml" else None
    if window is not None and (by or plot or scene_path):
        raise LagtopError("--window goes without --by, --plot and -o FILE.toml")
    opt.check_plot(plot, out.path)
    radians = top.radians
    conventions = Conventions(quaternion_order, euler_sequence, "body", radians).checked()
    unit = unit_in_radians(radians=radians)
    spread = (
        {name: value * unit for name, value in sigma.items()}
        if isinstance(sigma, dict)
        else sigma and sigma * unit
    )
    recordings = read_recordings(
        words[0], columns, decimal, by, conventions=conventions, sigma=spread, up=align
    )
    given = top.given()
    known, source = known_inputs(given.inputs, given.stds), shown_path(words[0])
    units = " (in kg, m and s)" if given.si else ""
    if scene_path and len(recordings) > 1:
        raise LagtopError(f"a scene holds one top, got {len(recordings)}: fit one recording")
    if window is not None:
        found = fit_windows(recordings[0], window, known, radians=radians)
    else:
        found = [best_fit(x, known, radians=radians) for x in with_progress(recordings, "fits")]
    failed = [x.failure() for x in found if x.failures()]
    with ExitStack() as stack:  # a file is replaced only if the report is written
        if scene_path and not failed and found[0].inputs is not None:
            stack.enter_context(opened(scene_path)).write(found[0].scene(source).encode())
        if plot:
            picture = report_bytes(plot, draw_fits, found)
            stack.enter_context(opened(plot)).write(picture)
        out = out._replace(path="-") if scene_path else out
        _write(found, source, units, window is not None, out)
    if failed and len(found) == 1:
        raise SomeFailedError(f"the fit has failed: {failed[0]}")
    opt.fail_for(failed, len(found), "fits" if window is None else "windows")
    if scene_path:
        found[0].scene(source)  # raises AbsentError for a steady precession


def _write(found: list[Outcome], source: str, units: str, is_windows: bool, out: Output) -> None:
    """Write a report, or one record for each recording."""
    from ..inverse.outcome import decay_of, decay_text, fit_report

    if out.fmt == "table":
        opt.write_report(out, lambda: fit_report(found, source, units, is_windows=is_windows))
        return
    records = [x.record() for x in found]
    if out.fmt == "json" and is_windows:
        decay = decay_of(found)
        out.text(f"{json_text({'decay': decay and decay._asdict(), 'windows': records})}\n")
    elif out.fmt == "json" and len(records) == 1:
        out.record(records[0], dict)
    else:
        out.rows(records, list(dict.fromkeys(key for record in records for key in record)))
    notes = [f"Note: {x.recording.named(note)}" for x in found for note in x.notes]
    for line in [decay_text(found)] if is_windows else notes:
        complain(line)
