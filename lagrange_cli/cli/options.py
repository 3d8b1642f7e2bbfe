"""Options that the commands share, and the types of their parameters."""

from __future__ import annotations

from collections.abc import Callable, Collection
from importlib import import_module
from os.path import splitext
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

MOST_RECORD_DIGITS, MOST_TABLE_DIGITS = 1000, 100

F = TypeVar("F", bound=Callable[..., Any])


class Parsed(click.ParamType):  # type: ignore[type-arg]
    """A parameter type: what a function makes of a text.  Errors begin with the option's name.

    A shell completes it by a list of `completion.py`, where one is named.
    """

    def __init__(self, name: str, parse: Callable[[str], Any], words: str = "") -> None:
        self.name, self.parse, self.words = name, parse, words

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the value; click may hand it in a second time, when it is no text any more."""
        if not isinstance(value, str):
            return value
        try:
            return self.parse(value)
        except LagtopError as error:
            raise click.UsageError(f"{param.opts[0] if param else 'value'} {error}", ctx) from None

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Return the names that go on like what is there."""
        from .completion import completed

        return completed(self.words, incomplete)


def late(module: str, function: str, **how: Any) -> Callable[[str], Any]:
    """Return a function of the package that is imported when it is called, not at start-up."""

    def parse(text: str) -> Any:
        return getattr(import_module(f"...{module}", __name__), function)(text, **how)

    return parse


class FileName(click.ParamType):  # type: ignore[type-arg]
    """A name of a file, which a shell may complete; that of click would look for translations."""

    name = "path"

    def shell_complete(
        self, ctx: click.Context, param: click.Parameter, incomplete: str
    ) -> list[CompletionItem]:
        """Return the request that the shell offers its files."""
        from .completion import files

        return files(incomplete)


def _parse_count(text: str) -> int:
    """Return a whole number, which may be written 1e6."""
    exact = parse_number(text)
    if exact.denominator != 1:
        raise LagtopError(f"must be a whole number, got {text}")
    return int(exact)


def exclude(options: dict[str, Any]) -> None:
    """Raise LagtopError where more than one of these options was given."""
    given = [name for name, value in options.items() if value is not None]
    if len(given) > 1:
        raise LagtopError(f"{given[0]} and {given[1]} exclude each other: leave one out")


def on_command_line(name: str) -> bool:
    """Return whether an option of the command that runs stands on the command line."""
    from click.core import ParameterSource

    return click.get_current_context().get_parameter_source(name) is ParameterSource.COMMANDLINE


FILE = FileName()
NUMBER = Parsed("number", parse_number)
COUNT = Parsed("integer", _parse_count)
NAMES, KEY_NAMES, COLUMN_NAMES, METHOD_NAMES, STRATUM_NAMES = (
    Parsed("names", late("inputs.names", "split_names"), words)
    for words in ("", "keys", "columns", "methods", "strata")
)
PICTURES = Parsed("text", str, "pictures")


def digits_option(most: int) -> Callable[[F], F]:
    """Add the option --digits, from 1 to `most`."""

    def check(_: click.Context, __: click.Parameter, digits: int | None) -> int | None:
        if digits is not None and not 1 <= digits <= most:
            raise LagtopError(f"--digits must be in [1, {most}], got {digits}")
        return digits

    text = f"So many significant digits, 1 to {most}, all of them right; inputs count as decimals."
    return click.option("--digits", type=COUNT, callback=check, metavar="N", help=text)


certify_option = click.option(
    "--certify",
    is_flag=True,
    help="Print KEY_radius as well: a proved bound of the distance from the exact value.",
)


def extension(path: str) -> str:
    """Return the extension of a file, in small letters and without its dot."""
    return splitext(path)[1][1:].lower()


def output_options(*formats: str, extensions: Collection[str] = ()) -> Callable[[F], F]:
    """Add the options --output and --format.

    The default format is that of the extension of the file, or the first one if there is no
    extension, if it is txt, or if it is one of `extensions`.
    """

    def chosen(ctx: click.Context, _: click.Parameter, fmt: str | None) -> str:
        path = ctx.params["output"]
        ending = extension(path)
        if fmt or ending in {"", "txt", *extensions}:
            return fmt or formats[0]
        if ending == "table" or ending not in formats:
            known = f"{ctx.command.name} writes {', '.join(formats)}"
            raise LagtopError(
                f"{known} and no {ending}, got --output {quoted(path)}: "
                "change the extension, or add --format"
            )
        return ending

    def decorate(command: F) -> F:
        command = click.option(
            "-o",
            "--output",
            type=FILE,
            default="-",
            metavar="FILE|-",
            is_eager=True,  # the format looks at it
            help="Output file (replaced only on success).",
        )(command)
        return click.option(
            "--format",
            "fmt",
            type=click.Choice(formats),
            callback=chosen,
            help=f"Output format.  [default: by the extension of FILE, else {formats[0]}]",
        )(command)

    return decorate
