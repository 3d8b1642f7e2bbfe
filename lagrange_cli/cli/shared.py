"""Options that several commands share, as decorators of click, and the top that they describe."""

from __future__ import annotations

import os
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from fractions import Fraction
from functools import partial, wraps
from itertools import chain
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar, cast

import click

from ..arithmetic.text import is_decimal, parse_number, quoted
from ..errors import LagtopError, SomeFailedError, arg, marked
from ..file_bytes import extension
from ..names import listed, split_names
from ..output.destination import MOST_ROWS, MOST_UPRIGHT, Output, opened
from ..output.formats import FORMATS, PICTURES, WITH_COMMAS
from ..output.terminal import is_screen
from ..top.inputs import BODY, BODY_UNITS, DECLARED, declared, remark_on
from ..top.units import Units, is_unit
from ..top.values import Value, parse_value, tilt_key
from .app import complain, worded

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from ..output.document import Document
    from ..output.report import Report
    from ..solver.solve import Motion
    from ..top.given import Given
    from ..top.top import Top

F = TypeVar("F", bound=Callable[..., Any])
MOST_RECORD_DIGITS, MOST_TABLE_DIGITS = 1000, 100


class Parsed(click.ParamType):  # type: ignore[type-arg]
    """A parameter type whose value a function parses; errors begin with the option's name."""

    def __init__(self, metavar: str, parse: Callable[[str], Any]) -> None:
        """Take the name of the value in the help, and the function that parses its text."""
        self.name, self.parse = metavar, parse

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Any:
        """Return the value, or raise LagtopError."""
        try:
            return self.parse(value)
        except LagtopError as error:
            text = error.marked.removeprefix(f"{arg(error.key)} " if error.key else "")
            raise LagtopError(f"{param.opts[-1] if param else ''} {text}") from None


class Listed(Parsed):
    """The type of comma-separated values: an option that is given twice has all of them."""


def count(most: float = 1e9) -> Parsed:
    """Return the type of a whole number from 1 to `most`, which may be written as 1e6."""

    def parse(text: str) -> int:
        exact = parse_number(text)
        if exact.denominator != 1:
            raise LagtopError(f"must be a whole number, got {quoted(text)}")
        if not 1 <= exact <= most:
            raise LagtopError(f"must be in [1, {most:.10g}], got {text}")
        return int(exact)

    return Parsed("N", parse)


def parse_positive(text: str) -> float:
    """Return a number above 0."""
    exact = parse_number(text)
    if not exact > 0:
        raise LagtopError(f"must be > 0, got {float(exact)}")
    return float(exact)


def parse_numbers(text: str) -> list[float]:
    """Return the numbers of a comma-separated list."""
    return [float(parse_number(part)) for part in split_names(text)]


def _parse_list(text: str) -> list[str]:
    """Return the names of a comma-separated list.  Raises LagtopError for an empty name."""
    names = split_names(text)
    if "" in names:
        raise LagtopError(f"must be comma-separated names without blanks, got {quoted(text)}")
    return names


NUMBER = Parsed("X", parse_number)
LIST = Listed("NAME,...", _parse_list)
TIME = Parsed("X", partial(parse_value, "t"))
_DOUBLE = Parsed("X", lambda text: float(parse_number(text)))


def option(*names: str, **settings: Any) -> Callable[[F], F]:
    """Declare an option."""
    if isinstance(settings.get("type"), Listed):
        settings |= {"multiple": True, "callback": lambda _, __, lists: [*chain(*lists)] or None}
    return click.option(*names, **settings)


rad = option("--rad", is_flag=True, help="Use radians for all angles, input and output.")
certify = option(
    "--certify",
    is_flag=True,
    help="Also print KEY_radius: a bound on the distance from the double KEY to its exact value.",
)
keys = option("--keys", type=LIST, help="Compute and print only these keys (see lagtop explain).")
plot = option("--plot", metavar="FILE", help=f"Also draw the report: FILE{listed(PICTURES, '.')}.")


def decimal(*, reads: bool = True, writes: bool = False) -> Callable[[F], F]:
    """Declare --decimal, the mark of a file that is read, of CSV that is written, or of both."""
    files = ["of the input file"] * reads + ["of CSV output"] * writes
    comma = "comma (CSV then has semicolons)" if writes else "comma"
    return option(
        "--decimal",
        metavar="MARK",
        type=click.Choice(["point", "comma", ".", ","]),
        callback=lambda _, __, mark: {None: "", "point": ".", "comma": ","}.get(mark, mark),
        help=f"Decimal mark {' and '.join(files)}: point or {comma}."
        + "  [default: detected]" * reads,
    )


_READING = """
columns | NAME,... |
    | Names of all columns; axis, quaternion and matrix stand for all of their parts, _ skips a
    column.  A name may have a unit: 't [ms]'.
align | WORD,... | | Frames of the data: up=y (y points up), axis=y (y is the figure axis), left
    (left-handed), conjugate (attitude from space to body).  To count from the first row: start
    (spin and precession), time (t).
quaternion_order | ORDER | wxyz xyzw
    | Order of a quaternion whose names do not show it: wxyz or xyzw.
euler_sequence | SEQ | xyz | Axes of `euler` as in scipy: xyz for space axes, XYZ for body axes.
rates_frame | FRAME | body space | Frame of the angular velocity: body or space.
dt | X | | Time between rows if the file has no times, or between frames if it counts frames.
fps | N | | Frames per unit of time: 1/dt.
t_min | X | | First time to read.
t_max | X | | Last time to read.
"""
"""The options of a reading: argument, metavariable, default and other choices, and help."""


def _scenes_or_files(ctx: click.Context, param: click.Parameter, begun: str) -> list[Any]:
    """Return the built-in scenes that begin with a word, or a request for files."""
    from ..top.scenes import scene_names

    scenes = [name for name in scene_names() if name.startswith(begun)]
    return scenes or list(click.Path().shell_complete(ctx, param, begun))


def recording(function: F) -> F:
    """Declare the options of a reading, which become `reading`."""

    @wraps(function)
    def run(top: TopOptions, **others: Any) -> None:
        from ..recordings.options import Reading  # start-up

        given = {x: others.pop(x) for x in [*names, "decimal"]}
        given = {x: y for x, y in given.items() if y is not None}
        reading = Reading.of(units=Units(radians=top.radians), **given)
        function(top=top, reading=reading, **others)

    names = [name for name, *_ in declared(_READING)]
    found: Any = decimal()(run)
    for name, metavar, words, text in reversed([*declared(_READING)]):
        kind: Any = LIST if "," in metavar else _DOUBLE if metavar in {"X", "N"} else str
        choices = words.split()
        form: dict[str, Any] = {"metavar": metavar, "default": choices[0] if choices else None}
        form["type"] = click.Choice(choices) if len(choices) > 1 else kind
        found = option(f"--{name.replace('_', '-')}", help=text, **form)(found)
    return cast(F, found)


def digits(most: int) -> Callable[[F], F]:
    """Declare --digits, from 1 to `most`."""
    text = f"Print N correct digits, 1 to {most}; inputs are read as exact decimals."
    return option("--digits", type=count(most), help=text)


def command(name: str, *examples: str) -> Callable[[F], click.Command]:
    """Declare a command whose help ends with examples."""
    lines = "".join(f"\n  lagtop {example}" for example in examples)
    settings = {"help_option_names": ["-h", "--help"], "show_default": True}
    return click.command(name, epilog=f"\b\nExamples:{lines}", context_settings=settings)


def exclude(**values: Any) -> None:
    """Raise LagtopError if more than one of some options, by parameter, was given."""
    given = [x for x, y in values.items() if y is not None and y is not False]
    if len(given) > 1:
        first, second = (f"--{name.replace('_', '-')}" for name in given[:2])
        raise LagtopError(f"use {first} or {second}, not both")


class TopOptions(NamedTuple):
    """The inputs of a top on the command line."""

    inputs: Mapping[str, Value]
    """The inputs that were given, by key, in the order of the command line."""
    radians: bool
    scene: str | None

    def given(self, **others: Value | None) -> Given:
        """Return the inputs of the scene, if any, overridden by the options.

        Inputs must have units if one of the `others`, such as a time, has one.
        """
        from ..top.given import gather  # start-up of commands without a top

        return gather(self.inputs, self.scene, others={x: y for x, y in others.items() if y})


def is_scene(word: str) -> bool:
    """Return whether a word among others, such as conditions, names a scene.

    Scenes are `-`, built-in scenes, words that end in `.toml`, and words with a dot or a slash that
    are no condition.
    """
    from ..top.scenes import is_scene_file

    is_path = bool(set(word) & set("./")) and not set(word) & set("=<>")
    return word == "-" or is_path or is_scene_file(word)


def top(
    argument: str = "[SCENE]",
    *,
    parse: Callable[..., Any] | None = None,
    whole: bool = True,
    is_scene: Callable[[str], bool] | None = is_scene,
) -> Callable[[F], F]:
    """Declare the inputs of a top and --rad, which become `top`, and the arguments of a command.

    `parse` reads an input (see `parse_value`); by default inputs are numbers that may have an
    uncertainty.  If the `argument` is more than a scene, the command gets the other `words`;
    `is_scene` finds the scene among them, unless it is None.  A top that is not `whole` has no
    defaults.
    """
    names = [*DECLARED]
    several = argument != "[SCENE]"

    def decorate(function: F) -> F:
        @wraps(function)
        def run(rad: bool, words: Any, **others: Any) -> None:
            given = {x: others.pop(x) for x in [*others] if x in names}  # as on the command line
            inputs = {x: value for x, value in given.items() if value is not None}
            inputs = {tilt_key(x, y, radians=rad): y for x, y in inputs.items()}
            for word in words if several else [words]:
                if "CONDITION" not in argument and not ("KEY" in argument and word in names):
                    _check_word(word, inputs)
            if several:
                scenes = [word for word in words if is_scene and is_scene(word)]
                if len(scenes) > 1:
                    raise LagtopError(f"use one scene, not {' and '.join(scenes)}")
                others["words"] = [word for word in words if word not in scenes]
                words = scenes[0] if scenes else None
            function(top=TopOptions(inputs, rad, words), **others)

        found: Any = rad(run)
        for name in reversed(names):
            allowed: Any = {"uncertain": parse is None, "steady": name == "psidot0"}
            kind = Parsed("X", partial(parse_value, name, parse=parse, **allowed))
            flag, text = f"--{name.replace('_', '-')}", _help_of(name, shows_default=whole)
            found = option(flag, name, type=kind, help=text)(found)
        words: Any = {"nargs": -1 if several else 1, "required": False, "metavar": argument}
        return cast(F, click.argument("words", shell_complete=_scenes_or_files, **words)(found))

    return decorate


def _check_word(word: str | None, inputs: Mapping[str, Value]) -> None:
    """Raise LagtopError for a scene that is in fact a number, a unit or an input such as r0=50."""
    if not word or os.path.exists(word):
        return
    if is_decimal(word):
        wrong = f"{word} is not a file, and an option takes one value"
        raise LagtopError(f"{wrong}: write a list for sweep with commas, as in --r0 40,50")
    if not word[0].isalpha() or set(word) & set("-."):
        return
    name, _, value = word.partition("=")
    if name in DECLARED and is_decimal(value):
        raise LagtopError(f"an input is not a scene: write --{name.replace('_', '-')} {value}")
    if is_unit(word):
        bare = [(x, y.number) for x, y in inputs.items() if isinstance(y.number, Fraction)]
        name, number = bare[-1] if bare else ("m", Fraction(2))
        option = f"--{name.removesuffix('_deg').removesuffix('_rad').replace('_', '-')}"
        raise LagtopError(
            f"{word} is not a scene: put a value with its unit in quotes: "
            f"{option} '{float(number):g} {word}'"
        )


def _help_of(name: str, *, shows_default: bool) -> str:
    """Return the help of an input, with its unit if it is a rate, its bounds and its default."""
    about = DECLARED[name]
    rate = "rad per unit of time" if about.unit == "rad/time" else ""
    text = ", ".join(filter(None, (about.meaning, rate, about.bound)))
    has_default = shows_default and about.default is not None
    ending = f"  [default: {about.default:g}]" if has_default else ""
    return f"{text[0].upper()}{text[1:]}.{ending}"


def motion_of(found: Given, *, exact: bool = False, uses_stds: bool = True) -> Motion:
    """Return the motion of some inputs, kept as decimals if `exact`, after warnings about them."""
    from ..solver.solve import solve  # start-up of commands without a top

    try:
        motion = solve(found.top(exact=exact))
    except LagtopError as error:
        if error.key not in BODY:  # it may be due to the rest of the body
            warn(found, uses_stds=uses_stds)
        raise
    warn(found, uses_stds=uses_stds)
    warn_of_body(motion.top)
    return motion


def warn_of_body(top: Top) -> None:
    """Warn of a body that cannot be built."""
    if caveat := top.caveat():
        complain(f"Warning: {caveat}")


def warn(found: Given, *, uses_stds: bool = False) -> None:
    """Warn of a scene without inputs, of defaults for the body, and of unused uncertainties."""
    if found.file is not None and not found.file.inputs:
        complain(f"Warning: {found.file.name} has no inputs: using the worked example")
    if found.file is not None and found.file.hides:
        complain(f"Warning: {found.file.name} is the file in this folder, not the built-in scene")
    if found.missing:
        units = {name: f" {unit}" for name, unit in BODY_UNITS.items()} if found.si else {}
        texts = {name: f"{value:g}{units.get(name, '')}" for name, value in found.missing.items()}
        words = [f"--{name} {quoted(x) if found.si else x}" for name, x in texts.items()]
        complain(f"Warning: {remark_on(found.missing, words)}")
    if found.stds and not uses_stds:
        used = "only solve, table and plot angles (of one scene) use it"
        complain(f"Warning: the uncertainty of {', '.join(found.stds)} is not used: {used}")


def output(default: str, *, rows: bool = False, extensions: Sequence[str] = ()) -> Callable[[F], F]:
    """Declare --output and --format, which become `out`.

    The extension of the file sets the default format.  Without an extension, or with one of the
    `extensions`, it is the `default`.  On a terminal, `rows` are a table unless they are many.
    """
    named = {x.extension: name for name, x in FORMATS.items() if x.extension}
    usual = default
    if rows:
        few = f"up to {MOST_ROWS} rows, or {MOST_UPRIGHT} if it is too wide"
        usual += f"; on a terminal, a table of {few}, else csv"
    text = f"{', '.join(FORMATS)}.  [default: extension of FILE, or {usual}]"

    def decorate(function: F) -> F:
        @wraps(function)
        def run(output: str, fmt: str | None, **others: Any) -> None:
            ending, plain = extension(output), ("txt", *extensions)
            chosen = fmt or named.get(ending)
            if chosen is None and ending in {"", *plain}:
                chosen = "table" if rows and is_screen(output) else default
            elif chosen is None:
                name = click.get_current_context().command.name
                raise LagtopError(
                    f"{name} cannot write {ending}: use {', '.join([*named, *plain])} as extension "
                    f"of {quoted(output)}, or add --format"
                )
            _check_output(output, others)
            function(out=Output(output, chosen, fmt is not None), **others)

        kind, help_ = click.Choice([*FORMATS]), "Output file (replaced only when complete)."
        found: Any = option("--format", "fmt", metavar="FORMAT", type=kind, help=text)(run)
        found = option("-o", "--output", metavar="FILE", default="-", help=help_)(found)
        return cast(F, found)

    return decorate


def _check_output(path: str, given: Mapping[str, Any]) -> None:
    """Raise LagtopError for an output that is a file among the values of parameters."""
    found = [x for y in given.values() for x in (y if isinstance(y, list | tuple) else [y])]
    for x in found if os.path.isfile(path) else ():  # a scene is in the tuple of the top
        if isinstance(x, str) and os.path.exists(x) and os.path.samefile(x, path):
            raise LagtopError(f"-o must not overwrite an input file, got {quoted(path)}")


def with_mark(out: Output, mark: str, *, reads: bool = False) -> Output:
    """Return an output with a decimal mark: CSV with commas has semicolons between its cells.

    Raises LagtopError if a comma changes nothing, neither here nor in a file that is read.
    """
    if mark != ",":
        return out
    name = "csv" if is_screen(out.path) and not out.is_named else out.fmt
    if name not in WITH_COMMAS and not reads:
        raise LagtopError(f"--decimal comma is for CSV, got --format {name}: leave it out")
    return out._replace(fmt=WITH_COMMAS.get(name, out.fmt))


def with_units(names: Sequence[str], units: Mapping[str, str], out: Output) -> Sequence[str]:
    """Return headings with the units of their names, in a table for people."""
    from ..output.report import with_unit

    people = out.format.is_for_people
    return [with_unit(name, units.get(name)) for name in names] if people else names


def write_report(
    out: Output,
    find: Callable[[], Report],
    plot: str | None = None,
    draw: Callable[[Report], Figure] | None = None,
) -> Report:
    """Write the report that `find` returns, and its picture; return the report.

    Both destinations are opened first, and replaced only if everything is written.  CSV holds only
    the rows: its conditions go to standard error.
    """
    check_plot(plot, out.path)
    with opened(plot) if plot else nullcontext() as picture, opened(out.path) as stream:
        report = find()
        if picture and draw:
            from ..plot.style import report_bytes

            picture.write(report_bytes(plot or "", draw, report))
        document = report.document(worded)
        stream.write(out.bytes_of(document))
    say_asides(out, document)
    return report


def say_asides(out: Output, document: Document) -> None:
    """Write what a format of rows does not hold to standard error."""
    for line in document.asides if out.format.only_rows else ():
        complain(line)


def check_plot(path: str | None, output: str) -> None:
    """Raise LagtopError for a picture of an unknown type, or one over the report."""
    if path is not None:
        from ..plot.style import check_picture

        check_picture(path, PICTURES, output)


def fail_for(failures: Sequence[str], count: int, what: str) -> None:
    """Raise SomeFailedError if there are failures, with their number and the first one."""
    if failures:
        said = f"{len(failures)} of {count} {what} failed; the first: " * (count > 1)
        raise SomeFailedError(said + marked(failures[0]))
