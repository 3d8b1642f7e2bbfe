"""A command of ours: help with its examples first, errors that name options, lines of complaint."""

from __future__ import annotations

import re
import sys
from collections.abc import Callable, Collection, Mapping, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING, Any

import click

from .. import __version__
from ..errors import LagtopError, SomeFailedError
from ..output.destination import opened
from ..output.signals import CLOSED_PIPE, die_by
from ..output.terminal import has_colours, one_line, spelt, view_of

if TYPE_CHECKING:
    from ..motion.quantity import Key
    from ..output.layouts import Layout, Line
    from ..output.report import Report

_COLOURS = {"Error": "red", "Warning": "yellow"}


def complain(line: str) -> None:
    """Write one line to standard error, if that takes it, safe for any terminal.

    A terminal that has colours shows its first word, `Error:` or `Warning:`, in one.
    """
    line = one_line(line)
    word, colon, rest = line.partition(":")
    if word in _COLOURS and has_colours(sys.stderr):
        line = click.style(word + colon, fg=_COLOURS[word]) + rest
    with suppress(OSError):
        click.echo(line, err=True)


def say(text: str) -> None:
    """Write a text of our own to standard output.  Raises CannotWriteError."""
    try:
        with opened("-") as stream:
            stream.write(f"{spelt(text, view_of('-'))}\n".encode())
    except BrokenPipeError:  # which click would turn into exit code 1
        die_by(CLOSED_PIPE)


def write_report(find: Callable[[], Report], fmt: str, output: str) -> Report:
    """Make and write it; of CSV, which holds the rows alone, the conditions go to stderr."""
    from ..output.write import write_findings

    findings = write_findings(find, fmt, output)
    if fmt == "csv":
        for name, text in findings.conditions.items():
            complain(f"{name}: {text}")
    return findings


def fail_for(failures: Sequence[str], count: int, what: str, *, remedy: str = "") -> None:
    """Raise SomeFailedError if some of what a report is about has failed, with the first of it."""
    if failures:
        said = f"{len(failures)} of {count} {what} failed; the first: {failures[0]}"
        raise SomeFailedError(f"{said}; {remedy}" if remedy else said)


def _shown_at_once(names: Sequence[str], what: str, text: Callable[[click.Context], str]) -> Any:
    """Return an option that shows a text and ends the command."""

    def show(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
        if wanted and not ctx.resilient_parsing:
            say(text(ctx))
            ctx.exit()

    return click.Option(
        names, is_flag=True, expose_value=False, is_eager=True, callback=show, help=what
    )


class ExamplesFirst(click.Command):
    """A command whose help starts with its examples and may end with keys or columns.

    The options --version and --help are made here: those of click look for translations, which
    would take 2 % of the run of `lagtop solve`.
    """

    def __init__(
        self,
        *args: Any,
        examples: str = "",
        shows: Callable[[click.HelpFormatter], None] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(*args, **(kwargs | {"add_help_option": False}))
        self.params += [
            _shown_at_once(
                ["--version"],
                "Show the version and exit.",
                lambda _: f"lagtop, version {__version__}",
            ),
            _shown_at_once(
                ["-h", "--help"], "Show this message and exit.", lambda ctx: ctx.get_help()
            ),
        ]
        self.shows = shows
        self.examples = [line.strip() for line in examples.strip().splitlines()]

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the examples, what click writes, and what the command `shows` below."""
        formatter.write("Examples:\n")
        formatter.write("".join(f"  {line}\n" for line in self.examples) + "\n")
        super().format_help(ctx, formatter)
        if self.shows:
            self.shows(formatter)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an error about an argument names its option."""
        try:
            return super().invoke(ctx)
        except LagtopError as error:
            error.args = (_naming_options(error, self.params),)
            raise


def top_layout() -> dict[str, list[Line]]:
    """Return the keys of the record of a top as the lines of a table, by their groups."""
    from ..motion.record import KEYS

    return _grouped({name: key for name, key in KEYS.items() if key.meaning})


def chain_layout() -> dict[str, list[Line]]:
    """Return the keys of the steps of section 8 as the lines of a table, step by step."""
    from ..motion.paper.worked_example import CHAIN
    from ..motion.record import KEYS, requested_keys

    keys = KEYS | requested_keys()
    return {step: [_line(name, keys[name]) for name in names] for step, names in CHAIN.items()}


def _grouped(keys: Mapping[str, Key]) -> dict[str, list[Line]]:
    layout: dict[str, list[Line]] = {}
    for name, key in keys.items():
        layout.setdefault(key.group, []).append(_line(name, key))
    return layout


def in_units(layout: Layout, named: Callable[[str], str]) -> Layout:
    """Return a layout with the units of a system, which `named` gives, in place of mass and len."""
    return {
        group: [line._replace(unit=named(line.unit)) for line in lines]
        for group, lines in layout.items()
    }


def units_of(record: Collection[str], layout: Layout) -> dict[str, str]:
    """Return the units of the keys of a record that have one, by the lines of a layout."""
    units = {}
    for line in (line for lines in layout.values() for line in lines):
        for key, unit in _keys_of(line).items():
            if key in record and unit:
                units[key] = unit
    return units


def _keys_of(line: Line) -> dict[str, str]:
    """Return the keys that a line may stand for, and the unit of each."""
    if line.unit != "angle":
        return {line.key: line.unit}
    return {f"{line.key}_{unit}": unit for unit in ("deg", "rad")}


def _line(name: str, key: Key) -> Line:
    """Return how a table shows a key."""
    from ..output.layouts import Line

    return Line(name.removesuffix("_deg"), key.symbol, key.meaning, key.unit, key.equation)


def write_keys(formatter: click.HelpFormatter) -> None:
    """Write the keys of the record of a top, by their groups, with symbol, name and equation.

    Those on request follow.
    """
    from ..motion.record import requested_keys

    of_record = [(f"Keys: {group}", lines) for group, lines in top_layout().items()]
    groups = _grouped(requested_keys()).items()
    on_request = [(f"Keys on request: {group}", lines) for group, lines in groups]
    for heading, lines in of_record + on_request:
        with formatter.section(heading):
            formatter.write_dl(
                [
                    (f"{line.key}_deg" if line.unit == "angle" else line.key, _meaning(line))
                    for line in lines
                ]
            )


def _meaning(line: Line) -> str:
    """Return the symbol of a key, where it is another word, its name and its equation."""
    symbol = "" if line.symbol in {"", line.key} else f"{line.symbol}: "
    return f"{symbol}{line.name} {line.equation}".rstrip()


def write_columns(formatter: click.HelpFormatter) -> None:
    """Write the columns of a table over time."""
    from ..motion.over_time.columns import COLUMNS

    with formatter.section("Columns"):
        formatter.write_dl([(name, column.meaning) for name, column in COLUMNS.items()])


def _naming_options(error: LagtopError, params: Sequence[click.Parameter]) -> str:
    """Return the message with `--t-max` where the library says `t_max`.

    That is its first word, if it is the key of the error, and any word with an underscore before
    the value that is quoted.
    """
    names = [name for param in params for name in param.opts if name.startswith("--")]
    options = {name[2:].replace("-", "_"): name for name in names}
    if "theta0" in options:  # the one input whose key has a unit
        options |= dict.fromkeys(("theta0_deg", "theta0_rad"), options["theta0"])
    said, got, value = str(error).partition(", got ")
    if error.key in options and re.match(rf"{error.key}\b", said):
        said = options[error.key] + said.removeprefix(error.key)
    said = re.sub(r"(?<![-\w])[a-z]+_\w+", lambda word: options.get(word[0], word[0]), said)
    return said + got + value
