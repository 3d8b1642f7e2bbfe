"""The command `lagtop fit`: a top from a recording."""

from __future__ import annotations

import sys
from contextlib import ExitStack
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import quoted
from ..errors import LagtopError, SomeFailedError, marked
from ..file_bytes import extension
from ..names import repeated, split_names
from ..output.destination import Output, opened
from ..output.document import Document
from ..output.terminal import is_screen, is_terminal, one_line
from ..top.inputs import BODY, replaced_by
from . import shared as opt
from .app import worded

if TYPE_CHECKING:
    from ..inverse.outcome import Outcome
    from ..recordings.options import Reading


def _parse_sigma(text: str) -> list[tuple[str, float]]:
    """Return pairs of name and number of `theta=0.3,psi=0.5`; a single number has the name ""."""
    if not text[:1].isalpha() and text.count(",") < 2:
        return [("", opt.parse_positive(text))]
    parts = [part.partition("=") for part in split_names(text)]
    if not all(value for *_, value in parts):
        raise LagtopError(f"must be one number or theta=0.3,psi=0.5, got {quoted(text)}")
    return [(name.strip(), opt.parse_positive(value)) for name, _, value in parts]


def _sigma(pairs: list[tuple[str, float]]) -> float | dict[str, float]:
    """Return a single number, or the numbers by angle.  Raises LagtopError for a repeated name."""
    names = [name for name, _ in pairs]
    if "" in names and len(names) > 1:
        wanted = "one number or theta=0.3,psi=0.5"
        raise LagtopError(f"--sigma must be {wanted}, got {len(names)} values")
    if (twice := repeated(names)) is not None:
        raise LagtopError(f"--sigma must name each angle once, got {quoted(twice)} twice")
    return dict(pairs) if names[0] else pairs[0][1]


@opt.command(
    "fit",
    "table --t-max 2 --n 200 -o recording.csv",
    "fit recording.csv --m 1587 --g 981 -o fitted.toml",
    "fit recording.csv --sigma 0.3 --plot residuals.svg",
)
@opt.top("RECORDING", whole=False, is_scene=None)
@opt.option(
    "--sigma",
    type=opt.Listed("SIGMA", _parse_sigma),
    help="Standard deviation of every angle, or theta=0.3,psi=0.5.  [default: estimated from the "
    "residuals]",
)
@opt.option(
    "--window", type=opt.count(), help="Fit N equal windows separately, and the decay of the spin."
)
@opt.recording
@opt.plot
@opt.output("table", extensions=["toml"])
def fit_command(
    top: opt.TopOptions,
    reading: Reading,
    words: list[str],
    sigma: list[tuple[str, float]] | None,
    window: int | None,
    plot: str | None,
    out: Output,
) -> None:
    """Fit a top to a recording, with uncertainties.

    A recording is a file as in lagtop compare, or - for standard input.  Each row holds a time
    with tilt, spin and precession, or the axis, a marker on it, or the attitude.  Cells may be
    missing, and angles may be wrapped.

    The inputs that you pass are known: the fit fails if the recording contradicts them.  If the
    nutation is below the noise, the mean tilt and the mean rates are fitted.  The exit code is 0 if
    the verdict is good, and 1 if not: the last line on standard error then says why, and what to
    try.  With -o FILE.toml, a good fit is written as a scene.
    """
    from ..file_bytes import shown_path
    from ..inverse.decay import fit_windows
    from ..inverse.fit import fit_recording
    from ..inverse.known import known_inputs
    from ..inverse.measured import measured
    from ..recordings.reading import read_recording

    if len(words) != 1:
        remedy = "fit each file alone" if words else "give a file, or - for standard input"
        raise LagtopError(f"fit takes one recording, got {len(words)}: {remedy}")
    scene_path = out.path if extension(out.path) == "toml" else None
    if window is not None and scene_path:
        raise LagtopError("--window cannot be used with -o FILE.toml")
    opt.check_plot(plot, out.path)
    radians = top.radians
    noise = _sigma(sigma) if sigma else None
    recording = measured(read_recording(words[0], reading), noise)
    given = top.given()
    known, source = known_inputs(given), one_line(shown_path(words[0]))
    body = given._replace(values={x: y for x, y in given.values.items() if replaced_by(x) in BODY})
    if body.values and not body.missing:
        opt.warn_of_body(body.top())
    if window is None:
        found = [fit_recording(recording, known, given.units(radians=radians))]
    else:
        found = fit_windows(recording, window, known, given.units(radians=radians))
    failed = [x.failure() for x in found if x.failures()]
    with ExitStack() as stack:  # a file is replaced only if the report is written
        if scene_path and not failed and found[0].inputs is not None:
            scene = found[0].scene(source)
            stack.enter_context(opened(scene_path)).write(scene.encode())
        if plot:
            from ..plot.reports import draw_decay, draw_fit
            from ..plot.style import report_bytes

            drawn: Any = (draw_fit, found[0]) if window is None else (draw_decay, found)
            picture = report_bytes(plot, *drawn)
            stack.enter_context(opened(plot)).write(picture)
        out = out._replace(path="-") if scene_path else out
        _write(found, source, " (in kg, m and s)" if given.si else "", out)
    if failed and window is None:
        raise SomeFailedError(f"the fit has failed: {marked(failed[0])}")
    opt.fail_for(failed, len(found), "windows")
    if scene_path:
        found[0].scene(source)  # raises AbsentError for a steady precession


def _write(found: list[Outcome], source: str, units: str, out: Output) -> None:
    """Write a report, or a record for each window."""
    from ..inverse.decay import decay_of, decay_text
    from ..inverse.report import fit_report

    rows, whole = [x.record() for x in found], None
    names = list(dict.fromkeys(key for row in rows for key in row))
    asides = [f"Note: {marked(x)}" for x in found[0].remarks]
    if len(found) > 1:
        decay, asides = decay_of(found), [decay_text(found)]
        whole = {"decay": decay and decay._asdict(), "windows": rows}
    is_seen = is_screen(out.path) and is_terminal(sys.stderr)  # beside the last line of stderr
    page = fit_report(found, source, units, omits_first=is_seen).document(worded).page
    document = Document(names, rows, page, whole or rows[0], asides)
    out.document(document)
    opt.say_asides(out, document)
