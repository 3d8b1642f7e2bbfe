"""What the commands share: parameter types, options, help, and the way to a motion."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping
from functools import partial
from os.path import splitext
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..arithmetic.text import parse_number, quoted
from ..errors import LagtopError
from .command import complain

if TYPE_CHECKING:
    from click.shell_completion import CompletionItem

    from ..inputs.given import Given
    from ..inputs.input_keys import Input
    from ..inputs.value import Value
    from ..motion.solve import Motion

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


def _parse_input(text: str, *, uncertain: bool = False) -> Value:
    from ..inputs.value import parse_value  # not for commands without a top

    return parse_value(text, uncertain=uncertain)


def _split_names(text: str) -> list[str]:
    from ..inputs.names import split_names

    return split_names(text)


def inputs_of(scene: str | None, rad: bool, options: Mapping[str, Any]) -> Given:
    """Return the inputs of a scene file, if any, and of the options, which win."""
    from ..inputs.given import gather  # not for commands without a top

    given = by_key(options, radians=rad)
    return gather(given, scene, system=given.pop("units", None))


def motion_of(found: Given, exact: bool) -> Motion:
    """Return the motion of the top of some inputs.

    A line each names inputs of the worked example among others, and a body that cannot be built.
    """
    from ..motion.solve import solve

    motion = solve(found.top(exact=exact))
    say_missing(found)
    if caveat := motion.top.caveat():
        complain(f"Warning: {caveat}")
    return motion


def say_missing(found: Given) -> None:
    """Name the inputs of the body that are those of the worked example, and a scene without any."""
    if found.empty is not None:
        complain(
            f"Warning: {found.empty} has no inputs: what is not given is as in the worked example"
        )
    if found.missing:
        from ..inputs.input_keys import example_options, remark_on

        words = example_options(found.missing, units=found.system is not None)
        complain(f"Warning: {remark_on(found.missing, words)}")


def by_key(options: Mapping[str, Any], *, radians: bool) -> dict[str, Any]:
    """Return the options on the command line by the keys of the inputs."""
    tilt = "theta0_rad" if radians else "theta0_deg"
    return {
        tilt if name == "theta0" and not x.unit else name: x
        for name, x in options.items()
        if x is not None
    }


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
INPUT = TIME = Parsed("number", _parse_input)
UNCERTAIN = Parsed("number", partial(_parse_input, uncertain=True))
COUNT = Parsed("integer", _parse_count)
NAMES, KEY_NAMES, COLUMN_NAMES, METHOD_NAMES, STRATUM_NAMES = (
    Parsed("names", _split_names, words) for words in ("", "keys", "columns", "methods", "strata")
)
PICTURES = Parsed("text", str, "pictures")


def input_options(
    kind: click.ParamType,  # type: ignore[type-arg]
    *,
    units: bool = True,
    whole: bool = True,
) -> Callable[[F], F]:
    """Add options for the inputs of a top, or of one not known in whole, --units and --rad."""
    from ..inputs.input_keys import DECLARED  # not for commands without a top

    def decorate(command: F) -> F:
        if units:
            text = "Units of the output, where inputs have units.  [default: si]"
            command = click.option("--units", type=click.Choice(["si", "cgs"]), help=text)(command)
        command = click.option("--rad", is_flag=True, help="Angles in radians, in and out.")(
            command
        )
        for name in reversed(DECLARED):
            if whole or name != "phidot0":  # which needs a whole start
                option = f"--{name.replace('_', '-')}"
                text = _help_of(DECLARED[name], shows_default=whole)
                command = click.option(option, name, type=kind, help=text)(command)
        return command

    return decorate


def _help_of(declared: Input, *, shows_default: bool) -> str:
    """Return the help of an input, with its bounds and its default."""
    text = ", ".join(filter(None, (declared.meaning, declared.bound)))
    ending = f"  [default: {declared.default:g}]" if declared.default is not None else ""
    return f"{text[0].upper()}{text[1:]}.{ending if shows_default else ''}"


def scene_options(command: F) -> F:
    """Add the argument for a scene file and the options that override it."""
    return scene_argument(input_options(INPUT)(command))


def scene_argument(command: F) -> F:
    """Add the argument for a scene file."""
    return click.argument("scene", required=False, type=FILE, metavar="[SCENE.toml|-]")(command)


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
