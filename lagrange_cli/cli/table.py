"""`lagtop table`: angles, rates and attitude over time."""

from __future__ import annotations

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

from ..errors import DataError, LagtopError, OutOfRangeError
from ..output.terminal import with_progress
from . import shared as opt

if TYPE_CHECKING:
    from ..account.spread import ColumnSpread
    from ..output.destination import Output
    from ..top.values import Value


@opt.command(
    "table",
    "table --t-max 1 -o angles.csv",
    "table fast-gyroscope --t-max 10 --dt 0.01 --columns t,axis,energy",
    "table --t-max 1e9 --n 3 --digits 30 --certify --format json",
)
@opt.top()
@opt.option("--t-max", type=opt.TIME, help="Last time.  [default: one period; 1 if there is none]")
@opt.option("--t-min", type=opt.TIME, help="First time.  [default: 0]")
@opt.option("--n", type=opt.count(), help="Number of times.  [default: 101]")
@opt.option("--dt", type=opt.TIME, help="Time step, instead of --n.")
@opt.option("--times", metavar="FILE", help="Read the times from a file, one per line.")
@opt.decimal(writes=True)
@opt.option(
    "--columns", type=opt.LIST, help="Columns: see lagtop explain.  [default: t,theta,phi,psi]"
)
@opt.option("--wrap", is_flag=True, help="Keep spin and precession in (-180, 180].")
@opt.digits(opt.MOST_TABLE_DIGITS)
@opt.certify
@opt.output("csv", rows=True)
def table_command(
    top: opt.TopOptions,
    t_max: Value | None,
    t_min: Value | None,
    n: int | None,
    dt: Value | None,
    times: str | None,
    decimal: str,
    columns: list[str] | None,
    wrap: bool,
    digits: int | None,
    certify: bool,
    out: Output,
) -> None:
    """Tabulate tilt, spin, precession or other columns over time.

    Errors of angles are at most 4 units at times up to 2^50 nutation periods.  A unit is 2^-52
    max(1 rad, |angle|), or more if the axis passes near the vertical.  If inputs are uncertain, the
    last columns are the uncertainties of all columns but the time.
    """
    from ..file_bytes import shown_path
    from ..recordings.times import read_times
    from ..solver.columns import DEFAULT_COLUMNS, chosen_columns
    from ..solver.tables import ProvedTable, grid, rows
    from .uncertainty import column_stds, warn_if_nonlinear

    out = opt.with_mark(out, decimal, reads=times is not None)
    opt.exclude(n=n, dt=dt)
    for name, value in {"t_max": t_max, "t_min": t_min, "n": n, "dt": dt}.items():
        opt.exclude(**{"times": times, name: value})
    if top.scene == times == "-":
        raise LagtopError("standard input can be the scene or --times, not both")
    given = {"t_min": t_min, "t_max": t_max, "dt": dt}
    found, proved = top.given(**given), digits is not None or certify
    if found.stds and proved:
        raise LagtopError("--digits and --certify take inputs without uncertainties")
    exact = digits is not None
    motion = opt.motion_of(found, exact=exact)
    names = DEFAULT_COLUMNS if columns is None else columns
    how: Any = {"units": found.units(radians=top.radians), "wrap": wrap}
    parts: Iterable[Any]
    stds: ColumnSpread | None = None
    bounds = {name: x.number for name, x in given.items() if x is not None}
    try:
        if times is None:
            at: Any = grid(motion, n=n, **bounds, exact=exact)
        else:
            at = read_times(times, decimal)
        if proved:
            header, parts = ProvedTable(motion, names, digits, **how).rows(at, radii=certify)
        else:
            stds = column_stds(found, motion, names)
            header, parts = rows(motion, at, names, stds=stds, **how)
        chosen = zip(header, chosen_columns(names).values(), strict=False)
        named = {x: how["units"].named(column.unit) for x, column in chosen}
        shown = opt.with_units(header, named, out)
        out.rows(header, with_progress(parts, "rows", at.count or None, len), shown)
        warn_if_nonlinear(stds)
    except LagtopError as error:
        late = ": use --digits" if isinstance(error, OutOfRangeError) and error.key else ""
        if times is not None and error.key == "t":
            raise DataError.at(shown_path(times), error, late) from None
        if late:
            raise OutOfRangeError(f"{error.marked}{late}", error.key) from None
        raise
