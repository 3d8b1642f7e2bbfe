"""The command `lagtop find`: inputs that give target values."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from ..errors import LagtopError
from ..output.terminal import with_progress
from . import options as opt
from .app import complain
from .tables import key_headings
from .top import TopOptions, top_options, value_type, warn_missing, warn_unused, words

if TYPE_CHECKING:
    from ..inputs.units import System
    from ..motion.solve import Motion
    from ..output.destination import Output


def _beginnings() -> list[str]:
    """Return completions of words of the command: keys and shipped scenes."""
    from ..inputs.scene_file import scene_names
    from ..motion.record import all_keys

    return [*(f"{key}=" for key in all_keys()), *scene_names()]


CONDITION = opt.Parsed("CONDITION", str, _beginnings)


@opt.command(
    "find",
    """
    lagtop find --r0 10:200 T_precession=2
    lagtop find --r0 10:200 --theta0 5:150 T_precession=0.8 T_nutation=0.43
    lagtop find theta_min=3 theta_max=6 T_nutation=4 mean_precession_rate=5
    """,
)
def find_command(
    top: TopOptions = top_options(
        value_type("parse_number_or_span"), words("[SCENE] CONDITION...", CONDITION), units=False
    ),
    scan: int | None = opt.count(
        "Number of values of each unknown.  [default: 1000, 60 or 20 for 1, 2 or 3 unknowns]",
    ),
    keys: list[str] | None = opt.keys,
    out: Output = opt.output("csv", "ndjson", "json", "table", "markdown", on_terminal="table"),
) -> None:
    """Find the inputs for which results take given values.

    An input given as a range from:to (or log:from:to) is an unknown; up to three are allowed.  Give
    as many conditions KEY=NUMBER as unknowns.  If inputs have units, a condition may have a unit
    too (T_precession=500ms); without one, it is in SI.  Conditions such as regime=regular,
    path=looping or 'theta_max<120' restrict the solutions.

    With one unknown, every solution that the scan brackets is found, to the last bit.  With
    several, Newton's method starts at the best points of the scan and can miss solutions.  The exit
    code is 1 if no solution is found.

    Without an unknown, give theta_min, theta_max, T_nutation and mean_precession_rate, and
    mean_spin_rate if you know it.  They determine a = 2mgs/A and b = C r0/A.  You may also give
    inputs of the body.  lagtop chooses those left open, such as A = 1 and C = A.  Each top found
    starts at its least tilt.
    """
    from ..inputs.names import check_names
    from ..inputs.ranges import Span
    from ..motion.record import all_keys, record_keys

    radians = top.radians
    chosen = record_keys(radians=radians)
    if keys is not None:
        chosen = check_names("keys", keys, all_keys(radians=radians))
    if scan is None and not any(isinstance(x.number, Span) for x in top.by_key().values()):
        motions, system = _inverted(top)
    else:
        motions, system = _found(top, scan)
    _write(motions, system, chosen, radians, out)


def _found(top: TopOptions, count: int | None) -> tuple[list[Motion], System | None]:
    from ..fits.find import find_tops
    from ..fits.search import search_of

    search, given = search_of(top.by_key(), top.words, scene=top.scene, radians=top.radians)
    motions, looked = find_tops(search, count, with_progress)
    warn_missing(given)
    warn_unused(given.stds)
    complain(f"{len(motions)} found; {looked}")
    return motions, given.system


def _inverted(top: TopOptions) -> tuple[list[Motion], System | None]:
    from ..fits.implied_body import BODY_INPUTS
    from ..fits.invert import invert
    from ..fits.search import system_asked

    for name in top.by_key():
        if name not in BODY_INPUTS:
            flag = name.removesuffix("_deg").removesuffix("_rad").replace("_", "-")
            raise LagtopError(f"no input is unknown: give a range, such as --{flag} 10:200")
    found = top.replace(units=system_asked(top.words)).given()
    known = {name: float(x) for name, x in found.inputs.items() if name in BODY_INPUTS}
    warn_unused(name for name in found.stds if name in known)
    motions = invert(top.words, radians=top.radians, known=known, system=found.system)
    return motions, found.system


def _write(
    motions: list[Motion], system: System | None, keys: list[str], radians: bool, out: Output
) -> None:
    """Write the records as `lagtop sweep` does, a row for each motion."""
    from ..motion.numbers import record_in_range

    records: list[dict[str, Any]] = [
        record_in_range(motion, radians=radians, keys=keys)[0] for motion in motions
    ]
    for record in records:
        if system is not None and record.get("remark"):
            record["remark"] = system.in_words(record["remark"])
    out.rows(records, keys, key_headings(keys, system, out.fmt, radians=radians))
