"""Options that commands share, each declared once with its type and its help."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable
from functools import wraps
from importlib import import_module
from os.path import splitext
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError
from ..output.destination import Output
from ..output.terminal import is_terminal

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

MOST_RECORD_DIGITS, MOST_TABLE_DIGITS = 1000, 100
BINARY = ("parquet", "npy")
"""Formats that are not written to a terminal."""

Command = TypeVar("Command", bound=Callable[..., Any])


def late(module: str, name: str, **how: Any) -> Callable[..., Any]:
    """Return a function or constant of the package that is imported on the first call."""

    def call(*args: Any) -> Any:
        found: Any = getattr(import_module(f"...{module}", __name__), name)
        return found(*args, **how) if callable(found) else found

    return call


class Parsed(click.ParamType):  # type: ignore[type-arg]
    """A parameter type whose value a function parses; errors begin with the option's name.

    `names` returns the names for completion in a shell, of which commas may separate several.
    """

    def __init__(
        self,
        metavar: str,
        parse: Callable[[str], Any],
        names: Callable[[], Iterable[str]] | None = None,
    ) -> None:
        self.name, self.parse, self.names = metavar, parse, names

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the value; click may pass it a second time, when it is already converted."""
        if not isinstance(value, str):
            return value
        try:
            return self.parse(value)
        except LagtopError as error:
            name = param.opts[0] if param and param.opts[0].startswith("-") else ""
            raise LagtopError(f"{name} {error}".lstrip()) from None

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Return the names that continue the last word; files if there are no names."""
        from click.shell_completion import CompletionItem

        before, comma, begun = incomplete.rpartition(",")
        known = self.names() if self.names else ()
        found = [CompletionItem(before + comma + x) for x in known if x.startswith(begun)]
        is_file = param.param_type_name == "argument" or self in (FILE, FOLDER)
        return found or ([CompletionItem(incomplete, type="file")] if is_file else [])


def _parse_count(text: str) -> int:
    """Return a whole number, which may be written as 1e6."""
    exact = parse_number(text)
    if exact.denominator != 1:
        raise LagtopError(f"must be a whole number, got {text}")
    return int(exact)


def exclude(options: dict[str, Any]) -> None:
    """Raise LagtopError if more than one of these options was given."""
    given = [name for name, value in options.items() if value is not None and value is not False]
    if len(given) > 1:
        raise LagtopError(f"use {given[0]} or {given[1]}, not both")


def on_command_line(name: str) -> bool:
    """Return whether an option of the running command was given on the command line."""
    from click.core import ParameterSource

    return click.get_current_context().get_parameter_source(name) is ParameterSource.COMMANDLINE


def names_type(
    names: Callable[[], Iterable[str]] | None = None, metavar: str = "NAME,..."
) -> Parsed:
    """Return the type of a list of names; `names` returns those that a shell offers."""
    return Parsed(metavar, late("inputs.names", "split_names"), names)


_all_keys = late("motion.record", "all_keys")
FILE, FOLDER = Parsed("FILE", str), Parsed("DIR", str)
NUMBER = Parsed("X", parse_number)
COUNT = Parsed("N", _parse_count)
RANGE = Parsed("X", late("inputs.ranges", "parse_values"))
ANY_NAMES = names_type()
KEY_NAMES = names_type(_all_keys, "KEY,...")
KEY = Parsed("KEY", str, _all_keys)
COLUMN_NAMES = names_type(late("motion.over_time.columns", "column_names"))


def digits_option(most: int) -> Callable[[Command], Command]:
    """Add the option --digits, from 1 to `most`."""

    def check(_: click.Context, __: click.Parameter, digits: int | None) -> int | None:
        if digits is not None and not 1 <= digits <= most:
            raise LagtopError(f"--digits must be in [1, {most}], got {digits}")
        return digits

    text = f"Print N correct digits, 1 to {most}; inputs are read as exact decimals."
    return click.option("--digits", type=COUNT, callback=check, help=text)


rad_option = click.option("--rad", is_flag=True, help="Use radians for all angles, in and out.")
certify_option = click.option(
    "--certify", is_flag=True, help="Also print KEY_radius, a proven bound on the error."
)
keys_option = click.option(
    "--keys", type=KEY_NAMES, help="Compute and print only these keys (see lagtop explain)."
)


def seed_option(*name: str, **how: Any) -> Callable[[Command], Command]:
    """Add the option --seed, for an argument of another `name` if it has one."""
    return click.option("--seed", *name, type=COUNT, **how)


plot_option = click.option("--plot", type=FILE, help="Also draw the report: FILE.svg or FILE.png.")
jobs_option = click.option(
    "--jobs",
    type=Parsed("N|auto", late("sweeps.jobs", "parse_jobs")),
    help="Number of processes; auto: one per core.  [default: 1]",
)


def extension(path: str) -> str:
    """Return the extension of a file, in lower case and without its dot."""
    return splitext(path)[1][1:].lower()


def output_options(
    *formats: str, extensions: Iterable[str] = (), on_terminal: str = ""
) -> Callable[[Command], Command]:
    """Add the options --output and --format; the command receives an `Output` as `out`.

    The default format is the extension of the file.  Without an extension it is the first of the
    formats, or `on_terminal` if standard output is a terminal.
    """
    default = f"{formats[0]}; on a terminal {on_terminal}" if on_terminal else formats[0]

    def chosen(name: str, path: str, fmt: str | None) -> str:
        ending = extension(path)
        if fmt is None and ending in {"", "txt", *extensions}:
            at_screen = path == "-" and on_terminal and is_terminal(sys.stdout)
            return on_terminal if at_screen else formats[0]
        ending = "markdown" if ending == "md" else ending
        if fmt is None and (ending == "table" or ending not in formats):
            raise LagtopError(
                f"{name} writes {', '.join(formats)} and no {extension(path)}, "
                f"got --output {quoted(path)}: change the extension, or add --format"
            )
        fmt = fmt or ending
        if fmt in BINARY and path == "-" and is_terminal(sys.stdout):
            raise LagtopError(f"--format {fmt} is not for a terminal: use -o FILE.{fmt}")
        return fmt

    def decorate(command: Command) -> Command:
        @wraps(command)
        def run(*args: Any, output: str, fmt: str | None, **options: Any) -> Any:
            name = click.get_current_context().command.name or ""
            return command(*args, out=Output(output, chosen(name, output, fmt)), **options)

        decorated: Any = click.option(
            "--format",
            "fmt",
            type=click.Choice(formats),
            metavar="FORMAT",
            help=f"{', '.join(formats)}.  [default: extension of FILE, or {default}]",
        )(run)
        return click.option(  # type: ignore[no-any-return]
            "-o", "--output", type=FILE, default="-", help="Output file (replaced only on success)."
        )(decorated)

    return decorate


_DELIMITERS = {"comma": ",", "semicolon": ";", "tab": "\t", "blank": " "}
_DECIMALS = {"point": ".", "comma": ","}


def _mark(marks: dict[str, str]) -> Callable[[str], str]:
    """Return a parser for a mark, given by name or as a character."""

    def parse(text: str) -> str:
        if text not in {*marks, *marks.values()}:
            raise LagtopError(f"must be {', '.join(marks)} or the character, got {quoted(text)}")
        return marks.get(text, text)

    return parse


def text_options(command: Command) -> Command:
    """Add --delimiter and --decimal; the command receives a `dialect`."""

    @wraps(command)
    def run(*args: Any, delimiter: str | None, decimal: str | None, **options: Any) -> Any:
        from ..inputs.text_lines import Dialect

        if delimiter == decimal == ",":
            raise LagtopError("use --delimiter comma or --decimal comma, not both")
        return command(*args, dialect=Dialect(delimiter or "", decimal or ""), **options)

    decorated: Any = run
    for name, marks in (("decimal", _DECIMALS), ("delimiter", _DELIMITERS)):
        decorated = click.option(
            f"--{name}",
            type=Parsed("MARK", _mark(marks), lambda marks=marks: marks),  # type: ignore[misc]
            help=f"Input: {', '.join(marks)}.  [default: detected]",
        )(decorated)
    return decorated  # type: ignore[no-any-return]


header_comments_option = click.option(
    "--header-comments",
    is_flag=True,
    help="Describe scene, version, units and conventions above the CSV, in # lines.",
)


def is_described(out: Output, header_comments: bool) -> bool:
    """Return whether the output has a description: Parquet always, CSV with --header-comments.

    Raises LagtopError for --header-comments with a format that cannot hold a description.
    """
    if header_comments and out.fmt not in {"csv", "parquet"}:
        raise LagtopError(f"--header-comments describes CSV and Parquet, got --format {out.fmt}")
    return header_comments or out.fmt == "parquet"


def reading_options(quaternion: str | None) -> Callable[[Command], Command]:
    """Add the options for the columns of a trajectory; `quaternion` is the default order."""
    order = quaternion or "from the first row"

    def decorate(command: Command) -> Command:
        command = click.option(
            "--euler-sequence",
            type=Parsed("SEQ", late("inputs.seen", "euler_sequence")),
            default="xyz",
            show_default=True,
            help="Axes of `euler` as in scipy: xyz for space axes, XYZ for body axes.",
        )(command)
        command = click.option(
            "--quaternion-order",
            type=click.Choice(["wxyz", "xyzw"]),
            metavar="ORDER",
            default=quaternion,
            help=f"wxyz or xyzw.  [default: {order}]",
        )(command)
        return click.option(
            "--columns",
            "names",
            type=ANY_NAMES,
            help="Names of all columns; axis, quaternion and matrix stand for all of their "
            "parts, _ skips a column.",
        )(command)

    return decorate
