"""What the commands share: parameter types, options, help, errors and exit codes."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sized
from contextlib import suppress
from fractions import Fraction
from typing import Any, NoReturn, TypeVar

import click

from . import __version__
from .output import CannotWriteError, Terminated
from .top import LagtopError, parse_number

EXIT_USAGE, EXIT_CANNOT_WRITE = 2, 74
MOST_RECORD_DIGITS, MOST_TABLE_DIGITS = 1000, 100

F = TypeVar("F", bound=Callable[..., Any])
P = TypeVar("P", bound=Sized)


class DecimalType(click.ParamType):  # type: ignore[type-arg]
    """A decimal number, kept exact."""

    name = "number"

    def convert(
        self, value: Any, param: click.Parameter | None, ctx: click.Context | None
    ) -> Fraction:
        """The exact value of the text."""
        if isinstance(value, Fraction):
            return value
        try:
            return parse_number(str(value))
        except LagtopError as error:
            raise click.UsageError(f"{_option(param)} {error}", ctx) from None


class CountType(DecimalType):
    """A whole number, also as 1e6."""

    name = "integer"

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """The integer."""
        exact = super().convert(value, param, ctx)
        if exact.denominator != 1:
            raise click.UsageError(f"{_option(param)} must be a whole number, got {value}", ctx)
        return int(exact)


def _option(param: click.Parameter | None) -> str:
    return param.opts[0] if param else "value"


class ExamplesFirst(click.Command):
    """A command whose help starts with its examples."""

    def __init__(self, *args: Any, examples: str = "", **kwargs: Any) -> None:
        super().__init__(*args, **kwargs)
        self.examples = [line.strip() for line in examples.strip().splitlines()]

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Examples, then what click writes."""
        formatter.write("Examples:\n")
        formatter.write("".join(f"  {line}\n" for line in self.examples) + "\n")
        super().format_help(ctx, formatter)


class LagtopGroup(ExamplesFirst, click.Group):
    """The group of commands, with our errors (one line), exit codes and deaths by signal."""

    command_class = ExamplesFirst

    def main(self, *args: Any, **extra: Any) -> Any:
        """As click's; errors are one line on standard error and an exit code."""
        run: Any = super().main
        if not extra.pop("standalone_mode", True):
            return run(*args, standalone_mode=False, **extra)
        try:
            sys.exit(run(*args, standalone_mode=False, **extra) or 0)
        except click.ClickException as error:
            complain(f"Error: {error.format_message()}")
            sys.exit(error.exit_code)
        except LagtopError as error:
            complain(f"Error: {error}")
            sys.exit(getattr(error, "exit_code", EXIT_USAGE))
        except CannotWriteError as error:
            complain(f"Error: {error}")
            sys.exit(EXIT_CANNOT_WRITE)
        except OSError as error:  # of the help itself; the writers raise CannotWriteError
            complain(f"Error: cannot write standard output: {error.strerror}")
            os._exit(EXIT_CANNOT_WRITE)  # the interpreter would try to flush it once more
        except click.Abort:
            _die_by("SIGINT")

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command.  What ends it from outside is caught here, before click turns it into
        an exit code: a signal must kill as a signal."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            _die_by("SIGPIPE")
        except KeyboardInterrupt:
            _die_by("SIGINT")
        except Terminated as error:
            _die_by(error.number)


def with_progress(parts: Iterable[P], count: int, long: int) -> Iterator[P]:
    """The parts as they come; a bar on the terminal where `count` rows are `long` work."""
    if count < long or not sys.stderr.isatty():
        yield from parts
        return
    with click.progressbar(length=count, label="rows", file=sys.stderr) as bar:
        for part in parts:
            yield part
            bar.update(len(part))


def complain(line: str) -> None:
    """One line on standard error, if there is one that takes it."""
    with suppress(OSError):
        click.echo(" ".join(line.split()), err=True)


def _die_by(which: str | int) -> NoReturn:
    """End by the signal itself: only that stops the shell loop we may be running in."""
    import signal

    number = signal.Signals[which] if isinstance(which, str) else signal.Signals(which)
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    raise AssertionError("unreachable")


NUMBER, COUNT = DecimalType(), CountType()

_SCENE_OPTIONS = [
    ("--m", "Mass."),
    ("--A", "Equatorial moment of inertia about the pivot."),
    ("--C", "Polar moment of inertia, at most 2A."),
    ("--s", "Distance from the pivot to the centre of mass."),
    ("--g", "Gravity."),
    ("--r0", "Spin: angular velocity about the figure axis."),
    ("--theta0", "Tilt of the axis from the upward vertical, 0 to 180 degrees."),
    ("--thetadot0", "Nutation rate at the start."),
    ("--psidot0", "Precession rate at the start."),
]


def scene_options(command: F) -> F:
    """The scene file and the inputs that override it."""
    for name, text in reversed(_SCENE_OPTIONS):
        command = click.option(name, name[2:], type=NUMBER, help=text)(command)
    command = click.version_option(__version__, prog_name="lagtop")(command)
    command = click.option("--rad", is_flag=True, help="Angles in radians, in and out.")(command)
    return click.argument("scene", required=False, type=click.Path(), metavar="[SCENE.toml]")(
        command
    )


def digits_option(most: int) -> Callable[[F], F]:
    """--digits, up to `most`."""

    def check(_: click.Context, __: click.Parameter, digits: int | None) -> int | None:
        if digits is not None and not 1 <= digits <= most:
            raise LagtopError(f"--digits must be in [1, {most}], got {digits}")
        return digits

    text = f"So many significant digits, 1 to {most}, all of them right; inputs count as decimals."
    return click.option("--digits", type=COUNT, callback=check, metavar="N", help=text)


def output_options(*styles: str) -> Callable[[F], F]:
    """--format and --output; the first style is the default."""

    def decorate(command: F) -> F:
        command = click.option(
            "-o",
            "--output",
            type=click.Path(allow_dash=True),
            default="-",
            metavar="FILE|-",
            help="Where to write; FILE is replaced when all is written.",
        )(command)
        choice = click.Choice(styles)
        return click.option(
            "--format", "style", type=choice, default=styles[0], show_default=True, help="Output."
        )(command)

    return decorate
