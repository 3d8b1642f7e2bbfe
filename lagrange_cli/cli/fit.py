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
    from ..fits.parameters import KnownInputs
    from ..fits.record import Outcome
    from ..fits.windows import WindowedFit
    from ..inputs.text_lines import Dialect
    from ..inputs.top import Top
    from ..inputs.units import System


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


def _parse_window(text: str) -> tuple[float, bool]:
    """Return the number of windows or their duration, and whether it is a duration."""
    return _positive(text), not text.strip().isdigit()


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
        UNCERTAIN, words("[SCENE] RECORDING", opt.FILE, required=True), whole=False
    ),
    fix: list[str] | None = opt.names("Inputs of the scene that are known, such as m,g."),
    sigma: float | dict[str, float] | None = opt.option(
        opt.Parsed("SIGMA", _parse_sigma),
        "Standard deviation of all angles, or theta=0.3,psi=0.5; columns NAME_std override it.  "
        "[default: estimated from the residuals]",
    ),
    window: tuple[float, bool] | None = opt.option(
        opt.Parsed("N|TIME", _parse_window),
        "Fit N windows, or windows of TIME, which needs a decimal point (2.0).  All share one "
        "body; the spin may decay.",
    ),
    by: str | None = opt.option(
        opt.Parsed("COLUMN", str), "Column that names the recording of each row."
    ),
    together: bool = opt.flag("Fit one body to all recordings of --by."),
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

    Known inputs are the inputs given as options, and the inputs of a scene that --fix names.
    With -o FILE.toml the fitted top is written as a scene, unless the fit fails.
    """
    from ..fits.fit import fit_recordings
    from ..fits.record import FAILED
    from ..fits.recording import Reading, read_recordings
    from ..fits.report import scene_text
    from ..fits.windows import fit_windows, split
    from ..inputs.files import shown_path
    from ..inputs.seen import Conventions
    from ..plot.reports import check_plot

    check_plot(plot, out.path)
    if len(top.words) != 1:
        raise LagtopError(f"fit takes one recording, got {len(top.words)}: use --by COLUMN")
    recording, radians = top.words[0], top.radians
    if together and by is None:
        raise LagtopError("--together needs --by COLUMN")
    scene_path = out.path if opt.extension(out.path) == "toml" else None
    opt.exclude({"--window": window, f"--output {out.path}": scene_path})
    conventions = Conventions(quaternion_order, euler_sequence, "body", radians).checked()
    reading = Reading(names, conventions, by, _in_radians(sigma, radians), dialect)
    recordings = read_recordings(recording, reading)
    known, system = _known(top, recordings[0].scene, fix or [])
    if scene_path and len(recordings) > 1:
        raise LagtopError(f"--output {out.path} holds one top, got {len(recordings)} recordings")
    source = shown_path(recording)
    if window:
        parts = split(recordings[0], window[0], is_time=window[1], where=source)
        windows = fit_windows(parts, known, source, radians=radians)
        _write_windows(windows, source, system, out)
        return
    groups = [recordings] if together else [[one] for one in recordings]
    found: list[Outcome] = []
    for group in with_progress(groups, "fits"):
        found += fit_recordings(group, known, source, radians=radians)
    failed = [outcome for outcome in found if outcome.verdict == FAILED]
    if scene_path and not failed:
        write_bytes(scene_path, lambda: scene_text(found[0], recording, system).encode())
        _note_assumed(found[0], scene_path)
    if plot:
        _draw(found, plot)
    _write(found, source, system, out.replace(path="-") if scene_path else out)
    if failed and scene_path:
        complain(f"Warning: {scene_path} is not written: the fit has failed")
    fail_for([outcome.failure() for outcome in failed], len(found), "fits")


def _known(
    top: TopOptions, described: Top | None, fix: list[str]
) -> tuple[KnownInputs, System | None]:
    """Return known inputs from options or a scene, and their units.

    Without a scene file, the scene is the one that the recording describes.  Raises LagtopError.
    """
    from ..fits.parameters import known_inputs
    from ..inputs.derived_inputs import moment
    from ..inputs.input_keys import overridden
    from ..inputs.names import check_names
    from ..inputs.top import Top

    found, given = top.given(), top.by_key()
    present = dict(found.inputs)
    if described is not None and top.scene is None and found.system is None:
        present = overridden(described.inputs(), present)
    names = [x for x in present if x in given]
    if {"A_cm", "m", "s"} <= present.keys() and "A_cm" not in given:
        present["A"] = moment(present)  # of the scene, because m and s need not be known
    for name in fix:
        matching = [x for x in (name, f"{name}_deg", f"{name}_rad") if x in present]
        if not matching:
            check_names("fix", [name], [*Top.fields, "theta0"])
            raise LagtopError(f"--fix {name} needs {name}: give it as an option or in a scene")
        names.append(matching[0])
    stds = found.stds.only(names)
    return known_inputs({name: present[name] for name in names}, stds), found.system


def _in_radians(
    sigma: float | dict[str, float] | None, radians: bool
) -> float | dict[str, float] | None:
    unit = unit_in_radians(radians=radians)
    if isinstance(sigma, dict):
        return {name: value * unit for name, value in sigma.items()}
    return None if sigma is None else sigma * unit


def _write(found: list[Outcome], source: str, system: System | None, out: Output) -> None:
    """Write a report, or one record for each recording, with units if known inputs have any."""
    from ..fits.report import fit_report, outcome_units

    if out.fmt == "table":
        write_report(out, lambda: fit_report(found, source, system))
        return
    records: list[dict[str, Any]] = [outcome.record() for outcome in found]
    if system is not None and out.fmt != "csv":
        for outcome, record in zip(found, records, strict=True):
            record["units"] = outcome_units(outcome, system)
    if len(records) == 1 and out.fmt == "json":
        out.record(records[0], dict)
    else:
        out.rows(records, list(dict.fromkeys(key for record in records for key in record)))
    for outcome in found:
        name = f"{outcome.recording.name}: " if outcome.recording.name else ""
        notes = [*outcome.notes(), *outcome.undetermined()]
        for word, texts in (("Note", notes), ("Warning", outcome.warnings())):
            if texts:
                complain(f"{word}: {name}{'; '.join(texts)}")


def _write_windows(found: WindowedFit, source: str, system: System | None, out: Output) -> None:
    """Write the report on a fit in windows, or its record, or a row for each window."""
    from ..fits.record import FAILED
    from ..fits.report import windows_report

    rows = [window.row() for window in found.windows]
    if out.fmt == "table":
        write_report(out, lambda: windows_report(found, source, system))
    elif out.fmt == "json":
        out.text(f"{json_text(found.record())}\n")
    else:
        out.rows(rows, list(rows[0]))
    failed = [window.outcome for window in found.windows if window.verdict == FAILED]
    fail_for([outcome.failure() for outcome in failed], len(rows), "windows")
    if not found.is_described:
        raise SomeFailedError(f"{source}: no window is described: use shorter windows")


def _note_assumed(outcome: Outcome, path: str) -> None:
    """Name the inputs of a scene that the recording does not determine alone, and a remedy."""
    if products := [x for x in outcome.determined if len(x.powers) > 1]:
        complain(
            f"Note: {path} has assumed inputs, because {' and '.join(x.name for x in products)} "
            f"are known only as products: give the inputs that you know, such as "
            f"--{[*products[0].powers][-1]}"
        )


def _draw(found: list[Outcome], path: str) -> None:
    from ..fits.report import curves_of
    from ..plot.reports import draw_fit

    curves = [curve for outcome in found for curve in curves_of(outcome)]
    write_bytes(path, partial(draw_fit, curves, found[0].angle, path))
