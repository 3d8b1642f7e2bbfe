"""Tables and reports: options of files and columns, headings, descriptions, conditions."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import quoted
from ..errors import LagtopError, SomeFailedError
from .app import complain
from .options import Group, Parsed, choice, flag, late, names, option

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.text_lines import Dialect
    from ..motion.solve import Motion
    from ..motion.uncertainty import AngleStds
    from ..output.destination import Output
    from ..output.report import Report


def _mark(**marks: str) -> Any:
    """Declare a delimiter or decimal mark, given by name or as the character."""

    def parse(text: str) -> str:
        if text not in {*marks, *marks.values()}:
            raise LagtopError(f"must be {', '.join(marks)} or the character, got {quoted(text)}")
        return marks.get(text, text)

    kind = Parsed("MARK", parse, lambda: marks)
    return option(kind, f"Input: {', '.join(marks)}.  [default: detected]")


def _dialect(delimiter: str | None, decimal: str | None) -> Dialect:
    from ..inputs.text_lines import Dialect

    if delimiter == decimal == ",":
        raise LagtopError("use --delimiter comma or --decimal comma, not both")
    return Dialect(delimiter or "", decimal or "")


text_options: Any = Group(
    _dialect,
    [
        _mark(comma=",", semicolon=";", tab="\t", blank=" ")("delimiter"),
        _mark(point=".", comma=",")("decimal"),
    ],
)
"""Options that become a `Dialect`."""
header_comments_option = flag(
    "Describe scene, version, units and conventions above the CSV, in # lines."
)
columns_option = names(
    "Names of all columns; axis, quaternion and matrix stand for all of their parts, _ skips a "
    "column.",
    "--columns",
)
euler_option = option(
    Parsed("SEQ", late("inputs.seen", "euler_sequence")),
    "Axes of `euler` as in scipy: xyz for space axes, XYZ for body axes.",
    default="xyz",
    show_default=True,
)


def quaternion_option(default: str | None) -> Any:
    """Declare --quaternion-order; without a default the first row decides."""
    text = f"wxyz or xyzw.  [default: {default or 'from the first row'}]"
    return choice(["wxyz", "xyzw"], text, "ORDER", default=default)


def is_described(out: Output, header_comments: bool) -> bool:
    """Return whether the output has a description: Parquet always, CSV with --header-comments.

    Raises LagtopError for --header-comments with a format that cannot hold a description.
    """
    if header_comments and out.fmt not in {"csv", "parquet"}:
        raise LagtopError(f"--header-comments describes CSV and Parquet, got --format {out.fmt}")
    return header_comments or out.fmt == "parquet"


def warn_no_tops(path: str) -> None:
    """Warn that a file of tops has only a header."""
    from ..inputs.files import shown_path

    complain(f"Warning: {shown_path(path)} holds no tops")


def angle_stds(found: Given, motion: Motion) -> AngleStds | None:
    """Return the uncertainties of the angles over time, if inputs are uncertain.

    If there are none, a warning states the reason.
    """
    if not found.stds:
        return None
    from ..motion.derivatives import NO_DERIVATIVE  # for few tops only
    from ..motion.uncertainty import AngleStds

    stds = AngleStds(motion, found.stds, found.inputs.keys())
    if stds.derivatives.missing:
        complain(f"Warning: no uncertainty of the angles: {NO_DERIVATIVE}")
    return stds


def write_report(out: Output, find: Callable[[], Report]) -> Report:
    """Write a report, and return it.  CSV holds only the rows: its conditions go to stderr."""
    report = out.report(find)
    if out.fmt in {"csv", "ndjson"}:
        for name, text in report.conditions.items():
            complain(f"{name}: {text}")
    return report


def fail_for(failures: Sequence[str], count: int, what: str, *, remedy: str = "") -> None:
    """Raise SomeFailedError if there are failures, with their number and the first one."""
    if failures:
        said = f"{len(failures)} of {count} {what} failed; the first: {failures[0]}"
        raise SomeFailedError(f"{said}; {remedy}" if remedy else said)
