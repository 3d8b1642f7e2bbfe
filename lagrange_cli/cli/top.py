"""The top of a command: its options and scene, and the motion that they describe."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from types import MappingProxyType
from typing import TYPE_CHECKING, Any, NamedTuple, TypeVar

import click

from ..errors import LagtopError
from .app import complain
from .options import FILE, Group, Parsed, choice, late, option, rad

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.input_keys import Input
    from ..inputs.values import Value
    from ..motion.numbers import Numbers
    from ..motion.solve import Motion

M = TypeVar("M", bound="Numbers")

_scenes = late("inputs.scenes", "scene_names")
SCENE = Parsed("SCENE", str, _scenes)


def value_type(number: str = "parse_number", **allowed: bool) -> Parsed:
    """Return the type of an input in units; `number` names the reader of its number.

    See `parse_value` for the values of `allowed`.
    """
    read = late("inputs.values" if number != "parse_number" else "arithmetic.text", number)
    return Parsed("X", late("inputs.values", "parse_value", parse=read, **allowed))


INPUT = TIME = value_type()
UNCERTAIN = value_type(uncertain=True)


class TopOptions(NamedTuple):
    """The options of the top on the command line."""

    options: Mapping[str, Any]
    """The inputs by the names of their options, in the order of the command line."""
    radians: bool
    units: str | None
    """The system of units of the output, si or cgs."""
    scene: str | None
    words: Sequence[str]
    """The words besides the scene, such as conditions or files."""

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

    def solved_in_units(self) -> tuple[Motion, dict[str, str]]:
        """Return the motion, and the units of its inputs, if any, as a condition of a report.

        A warning names the inputs whose uncertainties are not used.
        """
        found = self.given()
        warn_unused(found.stds)
        system = found.system
        units = {} if system is None else {"inputs": "in kg, m and s"}
        return motion_of(found), units

    def in_seconds(self, **times: Value | None) -> tuple[TopOptions, dict[str, Any]]:
        """Return the options, and times as numbers, in seconds if they have units.

        A time with a unit requires units of all given inputs, as --units does.
        """
        given = {name: x for name, x in times.items() if x is not None}
        top = self
        if any(x.unit for x in given.values()):
            from ..inputs.units import converted

            top, given = self._replace(units=self.units or "si"), converted(given)
        return top, {name: given[name].number if name in given else None for name in times}


def words(metavar: str, kind: Parsed, *, required: bool = False) -> click.Argument:
    """Return the positional argument for words, one of which may be a scene."""
    return click.Argument(["words"], nargs=-1, type=kind, metavar=metavar, required=required)


ONE_SCENE = click.Argument(["words"], required=False, type=SCENE, metavar="[SCENE]")


def top_options(
    kind: Parsed,
    scene: click.Argument | None = ONE_SCENE,
    *,
    units: bool = True,
    whole: bool = True,
) -> Any:
    """Declare the inputs of a top, --rad, --units and a scene, which become a `TopOptions`.

    Some commands take no `scene` here, or no `units`; a top that is not `whole` has no defaults.
    """
    from ..inputs.input_keys import DECLARED  # not for commands without a top

    names = [name for name in DECLARED if whole or name != "phidot0"]  # which needs a whole start
    one_top = whole and kind in {INPUT, UNCERTAIN}
    kinds = dict.fromkeys(names, kind)
    if one_top:
        kinds["psidot0"] = value_type(uncertain=kind is UNCERTAIN, steady=True)

    def made(
        rad: bool, units: str | None = None, words: Any = None, **inputs: Value | None
    ) -> TopOptions:
        if not isinstance(words, tuple):  # the scene of ONE_SCENE, or None
            return TopOptions(inputs, rad, units, words, ())
        are_files = scene is not None and scene.type is FILE
        return TopOptions(inputs, rad, units, *_scene_among(words, are_files=are_files))

    params: list[click.Parameter] = [scene] if scene else []
    for name, read in kinds.items():
        text = _help_of(DECLARED[name], shows_default=whole, one_top=one_top)
        params.append(option(read, text)(name))
    params.append(rad("rad"))
    if units:
        text = "Output in si or cgs if inputs have units.  [default: si]"
        params.append(choice(["si", "cgs"], text, "SYSTEM")("units"))
    return Group(made, params)


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


def _scene_among(words: Sequence[str], *, are_files: bool) -> tuple[str | None, list[str]]:
    """Return the scene among some words, or None, and the other words.

    Words that are files are scenes only if they end in `.toml` or are shipped.  Raises LagtopError
    for more than one scene.
    """
    from ..inputs.scenes import is_scene_file

    scenes = [word for word in words if (is_scene_file if are_files else is_scene)(word)]
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
