"""What the commands share: parameter types, options, help, and the way to a motion."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING, Any, TypeVar

import click

from .. import __version__
from ..arithmetic.numbers import Number
from ..arithmetic.text import parse_number
from ..errors import LagtopError
from ..inputs.names import split_names
from ..inputs.top import Top, build_top
from ..motion.solve import Motion, solve
from ..output.terminal import one_line
from ..output.write import write_findings

if TYPE_CHECKING:
    from ..arithmetic.points import Points
    from ..output.findings import Findings
    from ..output.layouts import Line

MOST_RECORD_DIGITS, MOST_TABLE_DIGITS = 1000, 100

F = TypeVar("F", bound=Callable[..., Any])
V = TypeVar("V")


class Parsed(click.ParamType):  # type: ignore[type-arg]
    """A parameter type: what a function makes of a text.  Errors begin with the option's name."""

    def __init__(self, name: str, parse: Callable[[str], Any]) -> None:
        self.name, self.parse = name, parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the value; click may hand it in a second time, when it is no text any more."""
        if not isinstance(value, str):
            return value
        try:
            return self.parse(value)
        except LagtopError as error:
            raise click.UsageError(f"{param.opts[0] if param else 'value'} {error}", ctx) from None


def _parse_count(text: str) -> int:
    """Return a whole number, which may be written 1e6."""
    exact = parse_number(text)
    if exact.denominator != 1:
        raise LagtopError(f"must be a whole number, got {text}")
    return int(exact)


def _parse_range(text: str) -> Points:
    from ..inputs.ranges import parse_range

    return parse_range(text)


class ExamplesFirst(click.Command):
    """A command whose help starts with its examples and may end with keys or columns."""

    def __init__(
        self,
        *args: Any,
        examples: str = "",
        shows: Callable[[click.HelpFormatter], None] | None = None,
        **kwargs: Any,
    ) -> None:
        super().__init__(*args, **kwargs)
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
    from ..output.layouts import Line

    layout: dict[str, list[Line]] = {}
    for name, (group, symbol, meaning, unit, equation, _) in KEYS.items():
        if meaning:
            line = Line(name.removesuffix("_deg"), symbol, meaning, unit, equation)
            layout.setdefault(group, []).append(line)
    return layout


def write_keys(formatter: click.HelpFormatter) -> None:
    """Write the keys of the record of a top, by their groups, with symbol, name and equation."""
    for group, lines in top_layout().items():
        with formatter.section(f"Keys: {group}"):
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
    from ..motion.columns import COLUMNS

    with formatter.section("Columns"):
        formatter.write_dl([(name, column.meaning) for name, column in COLUMNS.items()])


def _naming_options(error: LagtopError, params: Sequence[click.Parameter]) -> str:
    """Return the message with `--t-max` where the library says `t_max`.

    That is its first word, if it is the key of the error, and any word with an underscore before
    the value that is quoted.
    """
    names = [name for param in params for name in param.opts if name.startswith("--")]
    options = {name[2:].replace("-", "_"): name for name in names}
    said, got, value = str(error).partition(", got ")
    if error.key in options and re.match(rf"{error.key}\b", said):
        said = options[error.key] + said.removeprefix(error.key)
    said = re.sub(r"(?<![-\w])[a-z]+_\w+", lambda word: options.get(word[0], word[0]), said)
    return said + got + value


def solved(
    scene: str | None, rad: bool, exact: bool, options: dict[str, Fraction | None]
) -> Motion:
    """Return the motion of the top in a scene file, if any, and in the options, which win."""
    given: dict[str, Number] = dict(by_key(options, radians=rad))
    if scene is None:
        top = build_top(given, exact=exact)
    else:
        from ..inputs.scene_file import read_scene

        top = read_scene(scene, given, exact=exact)
    motion = solve(top)
    if caveat := motion.top.caveat():
        complain(f"Warning: {caveat}")
    return motion


def by_key(options: Mapping[str, V | None], *, radians: bool) -> dict[str, V]:
    """Return the options on the command line by the keys of the inputs."""
    unit = "theta0_rad" if radians else "theta0_deg"
    return {unit if name == "theta0" else name: x for name, x in options.items() if x is not None}


def exclude(options: dict[str, Any]) -> None:
    """Raise LagtopError where more than one of these options was given."""
    given = [name for name, value in options.items() if value is not None]
    if len(given) > 1:
        raise LagtopError(f"{given[0]} and {given[1]} exclude each other: leave one out")


def listed(name: str, single: tuple[Fraction, ...], grid: Points | None) -> Points | None:
    """Return the numbers of --NAME or of --NAME-range, if any.  Raises LagtopError for both."""
    from ..arithmetic.points import ListedPoints

    exclude({f"--{name}": single or None, f"--{name}-range": grid})
    return grid or (ListedPoints(list(single)) if single else None)


def given(name: str) -> bool:
    """Return whether an option of the command that runs stands on the command line."""
    from click.core import ParameterSource

    return click.get_current_context().get_parameter_source(name) is ParameterSource.COMMANDLINE


def write_report(find: Callable[[], Findings], fmt: str, output: str) -> Findings:
    """Make and write it; of CSV, which holds the rows alone, the conditions go to stderr."""
    findings = write_findings(find, fmt, output)
    if fmt == "csv":
        for name, text in findings.conditions.items():
            complain(f"{name}: {text}")
    return findings


def complain(line: str) -> None:
    """Write one line to standard error, if there is one that takes it, safe for any terminal."""
    with suppress(OSError):
        click.echo(one_line(line), err=True)


NUMBER = Parsed("number", parse_number)
COUNT = Parsed("integer", _parse_count)
RANGE = Parsed("range", _parse_range)
NAMES = Parsed("names", split_names)

_SCENE_OPTIONS = [
    ("--m", "Mass."),
    ("--A", "Equatorial moment of inertia about the pivot."),
    ("--C", "Polar moment of inertia, at most 2A."),
    ("--s", "Distance from the pivot to the centre of mass."),
    ("--g", "Gravity."),
    ("--r0", "Total rate about the figure axis, phi' + psi' cos(theta)."),
    ("--theta0", "Tilt of the axis from the upward vertical, 0 to 180 degrees."),
    ("--thetadot0", "Nutation rate at the start."),
    ("--psidot0", "Precession rate at the start."),
]


def input_options(kind: click.ParamType) -> Callable[[F], F]:  # type: ignore[type-arg]
    """Add the options for the inputs of a top, with their defaults, and --rad."""

    defaults = Top().inputs()

    def decorate(command: F) -> F:
        command = click.option("--rad", is_flag=True, help="Angles in radians, in and out.")(
            command
        )
        for name, text in reversed(_SCENE_OPTIONS):
            default = defaults.get(f"{name[2:]}_deg", defaults.get(name[2:]))
            shown = f"{text}  [default: {default:g}]"
            command = click.option(name, name[2:], type=kind, help=shown)(command)
        return click.version_option(__version__, prog_name="lagtop")(command)

    return decorate


def scene_options(command: F) -> F:
    """Add the argument for a scene file and the options that override it."""
    command = input_options(NUMBER)(command)
    return click.argument("scene", required=False, type=click.Path(), metavar="[SCENE.toml]")(
        command
    )


def digits_option(most: int) -> Callable[[F], F]:
    """Add the option --digits, from 1 to `most`."""

    def check(_: click.Context, __: click.Parameter, digits: int | None) -> int | None:
        if digits is not None and not 1 <= digits <= most:
            raise LagtopError(f"--digits must be in [1, {most}], got {digits}")
        return digits

    text = f"So many significant digits, 1 to {most}, all of them right; inputs count as decimals."
    return click.option("--digits", type=COUNT, callback=check, metavar="N", help=text)


def output_options(*formats: str) -> Callable[[F], F]:
    """Add the options --format, whose default is the first one, and --output."""

    def decorate(command: F) -> F:
        command = click.option(
            "-o",
            "--output",
            type=click.Path(allow_dash=True),
            default="-",
            metavar="FILE|-",
            help="Where to write; FILE is replaced when all is written.",
        )(command)
        choice = click.Choice(formats)
        return click.option(
            "--format", "fmt", type=choice, default=formats[0], show_default=True, help="Output."
        )(command)

    return decorate
