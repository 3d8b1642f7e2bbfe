"""The command line: parse, one library call, one writer."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable
from contextlib import suppress
from fractions import Fraction
from typing import TYPE_CHECKING, Any, NoReturn, TypeVar

import click

from . import __version__
from .motion import Motion, solve
from .output import (
    MAX_TABLE_ROWS,
    CannotWriteError,
    Terminated,
    write_record,
    write_rows,
    write_texts,
)
from .top import (
    LagtopError,
    Number,
    SceneError,
    build_top,
    parse_number,
    read_scene,
    scene_error,
)

if TYPE_CHECKING:
    from .table import Times

F = TypeVar("F", bound=Callable[..., Any])


class BadValue(click.ClickException):
    """A bad option or input."""

    exit_code = 2


class BadScene(click.ClickException):
    """A bad scene file."""

    exit_code = 65


class CannotWrite(click.ClickException):
    """The output could not be written."""

    exit_code = 74


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
        """As click's; errors are one line on standard error."""
        run: Any = super().main
        if not extra.pop("standalone_mode", True):
            return run(*args, standalone_mode=False, **extra)
        try:
            sys.exit(run(*args, standalone_mode=False, **extra) or 0)
        except click.ClickException as error:
            _complain("Error: " + " ".join(error.format_message().split()))
            sys.exit(error.exit_code)
        except BrokenPipeError:
            _die_by("SIGPIPE")
        except OSError as error:  # of the help itself; the writers have their own
            _complain(f"Error: cannot write standard output: {error.strerror}")
            os._exit(CannotWrite.exit_code)  # the interpreter would try to flush it once more
        except (click.Abort, KeyboardInterrupt):
            _die_by("SIGINT")

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; its failures become exit codes or the signal they came from."""
        try:
            return super().invoke(ctx)
        except SceneError as error:
            raise BadScene(str(error)) from None
        except LagtopError as error:
            raise BadValue(str(error)) from None
        except CannotWriteError as error:
            raise CannotWrite(str(error)) from None
        except BrokenPipeError:
            _die_by("SIGPIPE")
        except KeyboardInterrupt:
            _die_by("SIGINT")
        except Terminated as error:
            _die_by(error.number)


def _complain(line: str) -> None:
    """One line on standard error, if there is one that takes it."""
    with suppress(OSError):
        click.echo(line, err=True)


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
            default="-",
            metavar="FILE|-",
            help="Replace FILE when all is written.",
        )(command)
        choice = click.Choice(styles)
        return click.option(
            "--format", "style", type=choice, default=styles[0], show_default=True, help="Output."
        )(command)

    return decorate


def solved(
    scene: str | None, rad: bool, exact: bool, options: dict[str, Fraction | None]
) -> Motion:
    """The motion of the top in a scene file, if any, and in the options, which win."""
    from_file = read_scene(scene) if scene is not None else {}
    given: dict[str, Number] = {key: x for key, x in options.items() if x is not None}
    if "theta0" in given:
        given["theta0_rad" if rad else "theta0_deg"] = given.pop("theta0")
        from_file = {key: x for key, x in from_file.items() if not key.startswith("theta0_")}
    try:
        motion = solve(build_top(from_file | given, exact=exact))
    except LagtopError as error:
        if scene is not None and error.key not in given:
            raise scene_error(scene, error) from None
        raise
    if caveat := motion.top.caveat():
        _complain(f"Warning: {caveat}")
    return motion


@click.group(
    cls=LagtopGroup,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    examples="""
        lagtop solve --theta0 30
        lagtop solve sample_inputs/chrapan-1952.toml --format json
        lagtop table --t-max 1 > out.csv
    """,
)
@click.version_option(__version__, prog_name="lagtop")
@click.pass_context
def main(ctx: click.Context) -> None:
    """The Lagrange top, a heavy symmetric top with a fixed point, in closed form.

    Inputs default to the worked example of J. Chrapan (1952); any consistent units will do.
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())
        sys.stdout.flush()


@main.command(
    "solve",
    examples="""
        lagtop solve --theta0 30
        lagtop solve sample_inputs/simo-wong-1991.toml --r0 40
        lagtop solve --r0 -20 --theta0 120 --format json | jq .T_nutation
        lagtop solve --theta0 60 --psidot0 -3 --digits 50
        lagtop solve --rad --theta0 0.05 --format csv -o solved.csv
    """,
)
@scene_options
@digits_option(1000)
@output_options("table", "json", "csv")
def solve_command(
    scene: str | None, rad: bool, digits: int | None, style: str, output: str, **options: Any
) -> None:
    """Roots, moduli, periods and mean rates of one top.

    Every number is the double nearest to its exact value, or has --digits right digits.  JSON and
    CSV hold the same keys; what a regime does not have is null or empty.
    """
    motion = solved(scene, rad, digits is not None, options)
    if digits is None:
        record = motion.record(radians=rad)
    else:
        from .digits import settled_record

        record = settled_record(motion.top, digits, radians=rad)
    write_record(record, style, output)


@main.command(
    "table",
    examples="""
        lagtop table --t-max 1 > out.csv
        lagtop table sample_inputs/fast-gyroscope.toml --t-max 10 --dt 0.01 --wrap
        lagtop table --t-min -5 --t-max 5 --n 1e6 --rad -o angles.csv
        lagtop table --t-max 1 --columns t,axis,energy
        seq 0 0.25 2 | lagtop table --times - --format json
    """,
)
@scene_options
@click.option("--t-max", type=NUMBER, help="Last time.  [default: one nutation period, or 1]")
@click.option("--t-min", type=NUMBER, help="First time.  [default: 0]")
@click.option("--n", "count", type=COUNT, help="Number of times.  [default: 101]")
@click.option("--dt", type=NUMBER, help="Step, instead of --n.")
@click.option(
    "--times",
    type=click.Path(allow_dash=True),
    metavar="FILE|-",
    help="Times from a file, one a line, instead of a grid.",
)
@click.option(
    "--columns",
    metavar="NAMES",
    help="Of t theta phi psi u thetadot phidot psidot p q r axis quaternion energy Lz, with commas "
    "between.  [default: t,theta,phi,psi]",
)
@click.option("--wrap", is_flag=True, help="Spin and precession in (-180, 180].")
@digits_option(100)
@output_options("csv", "json", "table")
def table_command(  # noqa: PLR0917 - click passes them by name
    scene: str | None,
    rad: bool,
    t_max: Fraction | None,
    t_min: Fraction | None,
    count: int | None,
    dt: Fraction | None,
    times: str | None,
    columns: str | None,
    wrap: bool,
    digits: int | None,
    style: str,
    output: str,
    **options: Any,
) -> None:
    """Tilt theta, spin phi and precession psi over time, and more with --columns.

    Right to a few roundings of the angle (or of 1 rad, if that is larger) at any time up to 2^50
    nutation periods away.  Spin and precession count on from 0 at t = 0 unless --wrap.
    """
    from .table import DEFAULT_COLUMNS, digit_rows, grid, read_times, rows

    _exclude({"--n": count, "--dt": dt})
    _exclude({"--columns": columns, "--digits": digits})
    for name, value in {"--t-max": t_max, "--t-min": t_min, "--n": count, "--dt": dt}.items():
        _exclude({"--times": times, name: value})
    motion = solved(scene, rad, digits is not None, options)
    chosen: Times = read_times(times) if times else grid(motion, t_min, t_max, n=count, dt=dt)
    if style == "table" and chosen.count > MAX_TABLE_ROWS:
        raise LagtopError(f"--format table shows at most {MAX_TABLE_ROWS} rows, got {chosen.count}")
    names = columns.replace(",", " ").split() if columns is not None else DEFAULT_COLUMNS
    header, blocks = rows(motion, chosen, names, radians=rad, wrap=wrap)
    if digits is None:
        write_rows(header, blocks, style, output)
    else:
        texts = digit_rows(motion, chosen, digits, radians=rad, wrap=wrap)
        write_texts(header, texts, style, output)


def _exclude(options: dict[str, Any]) -> None:
    given = [name for name, value in options.items() if value is not None]
    if len(given) > 1:
        raise LagtopError(f"{given[0]} and {given[1]} exclude each other: leave one out")


if __name__ == "__main__":
    main()
