"""The top of a command: its options and scene, the motion that they describe, and warnings."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from functools import wraps
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, TypeVar

import click

from ..arithmetic.values import Values
from ..errors import DataError, LagtopError
from .app import complain
from .options import Command, Parsed, late, rad_option

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.input_keys import Input
    from ..inputs.units import System
    from ..inputs.value import Value
    from ..motion.numbers import Numbers
    from ..motion.sensitivity.angle_sensitivities import AngleStds
    from ..motion.solve import Motion

M = TypeVar("M", bound="Numbers")

_scenes = late("inputs.scene_file", "scene_names")
SCENE = Parsed("SCENE", str, _scenes)


def value_type(number: str = "parse_number", **allowed: bool) -> Parsed:
    """Return the type of an input in units; `number` names the reader of its number.

    See `parse_value` for the values of `allowed`.
    """
    read = late("inputs.ranges" if number != "parse_number" else "arithmetic.text", number)
    return Parsed("X", late("inputs.value", "parse_value", parse=read, **allowed))


INPUT = TIME = value_type()
UNCERTAIN = value_type(uncertain=True)


class TopOptions(Values):
    """The options of the top on the command line."""

    options: Mapping[str, Any]
    """The inputs by the names of their options, in the order of the command line."""
    radians: bool = False
    units: str | None = None
    """The system of units of the output, si or cgs."""
    scene: str | None = None

    def by_key(self) -> dict[str, Any]:
        """Return the inputs that were given, by key."""
        tilt = "theta0_rad" if self.radians else "theta0_deg"
        return {
            tilt if name == "theta0" and not x.unit else name: x
            for name, x in self.options.items()
            if x is not None
        }

    def given(self, others: Mapping[str, Value] = MappingProxyType({})) -> Given:
        """Return the inputs of the scene, if any, overridden by the options.

        `others` are further values that are converted to the same units.
        """
        from ..inputs.given import gather  # not for commands without a top

        return gather(self.by_key(), self.scene, system=self.units, others=others)

    def solved(self) -> Motion:
        """Return the motion; warn if uncertainties are not used."""
        return self.solved_in_units()[0]

    def solved_in_units(self) -> tuple[Motion, dict[str, str]]:
        """Return the motion, and the units of its inputs, if any, as a condition of a report."""
        found = self.given()
        warn_unused(found.stds)
        system = found.system
        units = {} if system is None else {"inputs": f"in {system.mass}, {system.length} and s"}
        return motion_of(found), units

    def in_seconds(self, **times: Value | None) -> tuple[TopOptions, dict[str, Any]]:
        """Return the options, and times as numbers, in seconds if they have units.

        A time with a unit requires units of all given inputs, as --units does.
        """
        given = {name: x for name, x in times.items() if x is not None}
        top = self
        if any(x.unit for x in given.values()):
            from ..inputs.units import converted

            top, given = self.replace(units=self.units or "si"), converted(given, None)
        return top, {name: given[name].number if name in given else None for name in times}


def top_options(
    kind: Parsed, *, scene: bool = True, units: bool = True, whole: bool = True
) -> Callable[[Command], Command]:
    """Add the inputs of a top, --rad, --units and SCENE; a command receives a `TopOptions`, `top`.

    Some commands take no `scene` here, or no `units`; a top that is not `whole` has no defaults.
    """
    from ..inputs.input_keys import DECLARED  # not for commands without a top

    names = [name for name in DECLARED if whole or name != "phidot0"]  # which needs a whole start

    one_top = whole and kind in {INPUT, UNCERTAIN}
    steady = value_type(uncertain=kind is UNCERTAIN, steady=True) if one_top else kind

    def decorate(command: Command) -> Command:
        @wraps(command)
        def run(**options: Any) -> Any:
            inputs = {name: options.pop(name) for name in [*options] if name in names}
            rest = (options.pop(name, None) for name in ("units", "scene"))
            top = TopOptions(inputs, options.pop("rad"), *rest)
            return command(top=top, **options)

        decorated: Any = run
        if units:
            text = "Output in si or cgs if inputs have units.  [default: si]"
            choice = click.Choice(["si", "cgs"])
            decorated = click.option("--units", type=choice, metavar="SYSTEM", help=text)(decorated)
        decorated = rad_option(decorated)
        for name in reversed(names):
            text = _help_of(DECLARED[name], shows_default=whole, one_top=one_top)
            flag = f"--{name.replace('_', '-')}"
            read = steady if name == "psidot0" else kind
            decorated = click.option(flag, name, type=read, help=text)(decorated)
        if scene:
            decorated = click.argument("scene", required=False, type=SCENE, metavar="[SCENE]")(
                decorated
            )
        return decorated  # type: ignore[no-any-return]

    return decorate


def _help_of(declared: Input, *, shows_default: bool, one_top: bool) -> str:
    """Return the help of an input, with its unit if it is a rate, its bounds and its default.

    The words that stand for a rate are left out of commands that do not solve one top.
    """
    rate = "rad per unit of time" if declared.unit == "rad/time" else ""
    bound = declared.bound if one_top or "word" not in declared.bound else ""
    text = ", ".join(filter(None, (declared.meaning, rate, bound)))
    ending = f"  [default: {declared.default:g}]" if declared.default is not None else ""
    return f"{text[0].upper()}{text[1:]}.{ending if shows_default else ''}"


def is_scene(word: str) -> bool:
    """Return whether a word among others, such as conditions or kinds of picture, names a scene.

    Scenes are `-`, shipped scenes, words that end in `.toml`, and words with a dot or a slash that
    are no condition.
    """
    return (
        word == "-"
        or word.endswith(".toml")
        or (bool(set(word) & set("./")) and not set(word) & set("=<>"))
        or word in _scenes()
    )


def scene_among(
    words: Sequence[str], is_one: Callable[[str], bool] = is_scene
) -> tuple[str | None, list[str]]:
    """Return the scene among some words, or None, and the other words.

    Raises LagtopError for more than one scene.
    """
    scenes = [word for word in words if is_one(word)]
    if len(scenes) > 1:
        raise LagtopError(f"use one scene, not {' and '.join(scenes)}")
    return scenes[0] if scenes else None, [word for word in words if word not in scenes]


def motion_of(found: Given, *, exact: bool = False) -> Motion:
    """Return the motion of some inputs, which are kept as decimals if `exact`; see `warned`."""
    from ..motion.solve import solve

    return warned(solve(found.top(exact=exact)), found)


def warned(motion: M, found: Given) -> M:
    """Return a motion, after warnings about its inputs.

    They name defaults that are mixed with other inputs, and bodies that cannot be built.
    """
    warn_missing(found)
    if caveat := motion.top.caveat():
        complain(f"Warning: {caveat}")
    return motion


def key_headings(
    names: Sequence[str], system: System | None, fmt: str, *, radians: bool
) -> Sequence[str]:
    """Return the headings of keys: with units in a table for people, if inputs have units."""
    if system is None or fmt not in {"table", "markdown"}:
        return names
    from ..motion.record import shown_keys
    from ..output.report import with_unit

    keys = shown_keys(radians=radians, named=system.named, requested=True)
    return [with_unit(name, keys[name].unit) if name in keys else name for name in names]


def warn_missing(found: Given) -> None:
    """Warn of inputs of the body from the worked example, and of a scene without inputs."""
    if found.empty is not None:
        complain(f"Warning: {found.empty} has no inputs: using the worked example")
    if found.missing:
        from ..inputs.input_keys import example_options, remark_on

        words = example_options(found.missing, units=found.system is not None)
        complain(f"Warning: {remark_on(found.missing, words)}")


def warn_unused(uncertain: Iterable[str]) -> None:
    """Warn of inputs whose uncertainties a command does not use."""
    if names := ", ".join(uncertain):
        used = "solve, table, sweep and plot angles use it"
        complain(f"Warning: the uncertainty of {names} is not used: {used}")


def warn_no_tops(path: str) -> None:
    """Warn that a file of tops has only a header."""
    from ..inputs.files import shown_path

    complain(f"Warning: {shown_path(path)} holds no tops")


def angle_stds(found: Given, motion: Motion) -> AngleStds | None:
    """Return the uncertainties of the angles over time, if inputs are uncertain.

    If there are none, a warning states the reason.
    """
    if not found.stds:
        return None
    from ..motion.sensitivity.angle_sensitivities import AngleStds  # for few tops only

    stds = AngleStds(motion.exact, found.stds, found.inputs.keys())
    if stds.reason:
        complain(f"Warning: no uncertainty of the angles: {stds.reason}")
    return stds


@contextmanager
def blaming(times: str | None) -> Iterator[None]:
    """Raise DataError for a time out of reach in a file of times."""
    try:
        yield
    except LagtopError as error:
        if times is None or error.key != "t":
            raise
        from ..inputs.files import shown_path

        raise DataError(f"{shown_path(times)}: {error}") from None
