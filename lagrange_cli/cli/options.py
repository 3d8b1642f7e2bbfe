"""Declarations of options, and the options and types that several commands share.

Each parameter of a command declares its option by its default, such as `opt.number("Last time.")`
for a module that imports this one as `opt`.  A `Group` declares several options that become one
value.
"""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterable, Sequence
from fractions import Fraction
from functools import partial
from importlib import import_module
from inspect import signature
from os.path import splitext
from typing import TYPE_CHECKING, Any

import click

from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError
from ..output.destination import Output

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem


def say(text: str) -> None:
    """Write a text of lagtop to standard output."""
    click.echo(text)


def _shown_at_once(names: Sequence[str], what: str, text: Callable[[click.Context], str]) -> Any:
    """Return an option that shows a text and ends the command."""

    def show(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
        if wanted and not ctx.resilient_parsing:
            say(text(ctx))
            ctx.exit()

    return click.Option(
        names, is_flag=True, expose_value=False, is_eager=True, callback=show, help=what
    )


class Command(click.Command):
    """A command whose help has examples and groups of options; an error names its option.

    The options --version and --help are made here, because those of click search for translations.
    That would take 2 % of the run time of `lagtop solve`.
    """

    def __init__(self, *args: Any, examples: str = "", **kwargs: Any) -> None:
        super().__init__(*args, **(kwargs | {"add_help_option": False}))
        self.params.append(
            _shown_at_once(["-h", "--help"], "Show this help.", lambda ctx: ctx.get_help())
        )
        self.examples = [line.strip() for line in examples.strip().splitlines()]

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the usage, the text, the examples, and the options in groups."""
        from .help import write_help  # start-up

        write_help(self, ctx, formatter, self.examples, {})

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an error about an argument names its option."""
        try:
            return super().invoke(ctx)
        except LagtopError as error:
            from .help import naming_options

            error.args = (naming_options(error, self.params),)
            raise


MOST_RECORD_DIGITS, MOST_TABLE_DIGITS = 1000, 100
BINARY = ("parquet",)
"""Formats that are not written to a terminal."""
REPORT_FORMATS = ("table", "csv", "json", "ndjson")


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


class Group:
    """Options that belong together: a command receives the one value that `make` returns."""

    def __init__(self, make: Callable[..., Any], params: Sequence[click.Parameter]) -> None:
        self.make, self.params = make, params


def option(kind: Any, text: str, flag: str = "", **how: Any) -> Any:
    """Declare an option with its help; its flags are `flag`, or the name of the parameter."""

    def declared(name: str) -> click.Option:
        flags = flag.split() or [f"--{name.replace('_', '-')}"]
        return click.Option([*flags, name], type=kind, help=text, **how)

    return declared


def number(text: str, flag: str = "", *, positive: bool = False, **how: Any) -> Any:
    """Declare an option whose value is a decimal number, which may have to be positive."""
    return option(POSITIVE if positive else NUMBER, text, flag, **how)


def count(text: str, flag: str = "", *, most: int | None = None, **how: Any) -> Any:
    """Declare an option whose value is a whole number, from 1 to `most` if that is given."""
    return option(Parsed("N", partial(_parse_count, most=most)), text, flag, **how)


def file(text: str, flag: str = "", **how: Any) -> Any:
    """Declare an option whose value is the name of a file."""
    return option(FILE, text, flag, **how)


def names(
    text: str,
    flag: str = "",
    *,
    offered: Callable[[], Iterable[str]] | None = None,
    metavar: str = "NAME,...",
) -> Any:
    """Declare an option whose value is a list of names; a shell completes those `offered`."""
    return option(Parsed(metavar, late("inputs.names", "split_names"), offered), text, flag)


def flag(text: str, name: str = "") -> Any:
    """Declare an option without a value."""
    return option(None, text, name, is_flag=True)


def choice(names: Sequence[str], text: str, metavar: str, **how: Any) -> Any:
    """Declare an option whose value is one of the given names."""
    return option(click.Choice(names), text, metavar=metavar, **how)


def arguments(kind: Parsed, metavar: str) -> Any:
    """Declare any number of positional arguments."""
    return lambda name: click.Argument([name], type=kind, metavar=metavar, nargs=-1)


def digits(most: int) -> Any:
    """Declare --digits, from 1 to `most`."""
    text = f"Print N correct digits, 1 to {most}; inputs are read as exact decimals."
    return count(text, most=most)


def command(
    name: str, examples: str, *, exclusive: Sequence[str] = (), text: str | None = None
) -> Callable[[Callable[..., None]], Command]:
    """Make a command of a function whose parameters declare options.

    An entry of `exclusive` lists flags of which only one can be given.  `text` replaces the
    docstring.
    """

    def decorate(function: Callable[..., None]) -> Command:
        declared = {name: x.default for name, x in signature(function).parameters.items()}
        groups = {argument: x for argument, x in declared.items() if isinstance(x, Group)}
        params: list[click.Parameter] = []
        for argument, declaration in declared.items():
            one = argument not in groups
            params += [declaration(argument)] if one else groups[argument].params
        names = {flag: str(param.name) for param in params for flag in param.opts}

        def run(**values: Any) -> None:
            for flags in exclusive:
                exclude({x: values[names[x]] for x in flags.split()})
            for argument, group in groups.items():
                own = {param.name for param in group.params}
                in_order = [name for name in values if name in own]  # of the command line
                values[argument] = group.make(**{name: values.pop(name) for name in in_order})
            function(**values)

        return Command(
            name, callback=run, params=params, help=text or function.__doc__, examples=examples
        )

    return decorate


def exclude(options: dict[str, Any]) -> None:
    """Raise LagtopError if more than one of these options was given."""
    given = [
        name
        for name, value in options.items()
        if value is not None and value is not False and value != ()
    ]
    if len(given) > 1:
        raise LagtopError(f"use {given[0]} or {given[1]}, not both")


def _parse_count(text: str, most: int | None = None) -> int:
    """Return a whole number, which may be written as 1e6, from 1 to `most` if that is given."""
    exact = parse_number(text)
    if exact.denominator != 1:
        raise LagtopError(f"must be a whole number, got {text}")
    if most is not None and not 1 <= exact <= most:
        raise LagtopError(f"must be in [1, {most}], got {exact}")
    return int(exact)


def _parse_positive(text: str) -> Fraction:
    exact = parse_number(text)
    if not exact > 0:
        raise LagtopError(f"must be > 0, got {float(exact)}")
    return exact


_all_keys = late("motion.record", "all_keys")
FILE, FOLDER = Parsed("FILE", str), Parsed("DIR", str)
KEY = Parsed("KEY", str, _all_keys)
NUMBER, POSITIVE = Parsed("X", parse_number), Parsed("X", _parse_positive)
key_names = partial(names, offered=_all_keys, metavar="KEY,...")
"""Declares an option whose value is a list of keys."""
rad = flag("Use radians for all angles, in and out.", "--rad")
certify = flag("Also print KEY_radius, a proven bound on the error.")
plot = file("Also draw the report: FILE.svg or FILE.png.")


def extension(path: str) -> str:
    """Return the extension of a file, in lower case and without its dot."""
    return splitext(path)[1][1:].lower()


def output(*formats: str, extensions: Iterable[str] = (), on_terminal: str = "") -> Any:
    """Declare --output and --format, which become an `Output`.

    The extension of the file sets the default format.  Without an extension, the default is the
    first format, or `on_terminal` if standard output is a terminal.
    """
    default = f"{formats[0]}; on a terminal {on_terminal}" if on_terminal else formats[0]

    def is_screen(path: str) -> bool:
        from ..output.terminal import is_terminal

        return path == "-" and is_terminal(sys.stdout)

    def chosen(path: str, fmt: str | None) -> str:
        ending = extension(path)
        if fmt is None and ending in {"", "txt", *extensions}:
            return on_terminal if on_terminal and is_screen(path) else formats[0]
        if fmt is None and (ending == "table" or ending not in formats):
            name = click.get_current_context().command.name
            raise LagtopError(
                f"{name} writes {', '.join(formats)} and no {extension(path)}, "
                f"got --output {quoted(path)}: change the extension, or add --format"
            )
        fmt = fmt or ending
        if fmt in BINARY and is_screen(path):
            raise LagtopError(f"--format {fmt} is not for a terminal: use -o FILE.{fmt}")
        return fmt

    to = file("Output file (replaced only on success).", "-o --output", default="-")
    named = choice(
        formats,
        f"{', '.join(formats)}.  [default: extension of FILE, or {default}]",
        "FORMAT",
        flag="--format",
    )
    return Group(
        lambda output, fmt: Output(output, chosen(output, fmt), fmt is not None),
        [to("output"), named("fmt")],
    )
