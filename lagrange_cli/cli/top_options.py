"""Options for the inputs of a top, the motion that they describe, and warnings about them."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

import click

from ..errors import DataError, LagtopError
from .command import complain
from .options import FILE, F, Parsed, late

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.input_keys import Input
    from ..inputs.value import Value
    from ..motion.sensitivity.angle_sensitivities import AngleStds
    from ..motion.solve import Motion


def value_type(name: str, number: str, *, uncertain: bool = False) -> Parsed:
    """Return the type of an input in units; `number` names the reader of its number."""
    read = late("inputs.ranges", number)
    return Parsed(name, late("inputs.value", "parse_value", parse=read, uncertain=uncertain))


INPUT = TIME = Parsed("number", late("inputs.value", "parse_value"))
UNCERTAIN = Parsed("number", late("inputs.value", "parse_value", uncertain=True))


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


def in_seconds(
    options: Mapping[str, Any], **times: Value | None
) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the options and times, these as numbers of seconds where they have units.

    A time with a unit asks for units of all inputs, as --units does.
    """
    given = {name: x for name, x in times.items() if x is not None}
    if any(x.unit for x in given.values()):
        from ..inputs.units import converted

        options, given = {**options, "units": options.get("units") or "si"}, converted(given, None)
    return dict(options), {name: given[name].number if name in given else None for name in times}


@contextmanager
def blaming(times: str | None) -> Iterator[None]:
    """Raise DataError for a time out of reach that stands in a file of times."""
    try:
        yield
    except LagtopError as error:
        if times is None or error.key != "t":
            raise
        from ..inputs.files import shown_path

        raise DataError(f"{shown_path(times)}: {error}") from None


def is_scene(word: str) -> bool:
    """Return whether a word among others, such as conditions or kinds of picture, names a scene.

    That is `-`, one that ends in `.toml`, or one with a dot or a slash that compares nothing.
    """
    return (
        word == "-"
        or word.endswith(".toml")
        or (bool(set(word) & set("./")) and not set(word) & set("=<>"))
    )


def say_no_tops(path: str) -> None:
    """Say that a file of tops holds none, only its header."""
    from ..inputs.files import shown_path

    complain(f"Warning: {shown_path(path)} holds no tops")


def say_unused(uncertain: Iterable[str]) -> None:
    """Name inputs whose uncertainties a command does not use."""
    if names := ", ".join(uncertain):
        used = "solve, table, sweep and plot angles use it"
        complain(f"Warning: the uncertainty of {names} is not used: {used}")


def solved(scene: str | None, rad: bool, exact: bool, options: Mapping[str, Any]) -> Motion:
    """Return the motion of the top in a scene file, if any, and in the options, which win.

    Uncertainties are not used, which a line says.
    """
    found = inputs_of(scene, rad, options)
    say_unused(found.stds)
    return motion_of(found, exact)


def angle_stds(found: Given, motion: Motion) -> AngleStds | None:
    """Return the uncertainties of the angles over time, where inputs have any.

    A line says why there are none.
    """
    if not found.stds:
        return None
    from ..motion.sensitivity.angle_sensitivities import AngleStds  # for few tops only

    stds = AngleStds(motion.exact, found.stds, found.inputs.keys())
    if stds.reason:
        complain(f"Warning: no uncertainty of the angles: {stds.reason}")
    return stds
