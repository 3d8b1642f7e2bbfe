"""What is made and said of inputs that are given."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from typing import TYPE_CHECKING, Any

from ..errors import DataError, LagtopError
from ..inputs.files import shown_path
from .command import complain
from .options import inputs_of, motion_of

if TYPE_CHECKING:
    from ..inputs.given import Given
    from ..inputs.value import Value
    from ..motion.sensitivity.angle_uncertainty import AngleStds
    from ..motion.solve import Motion


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
    from ..motion.sensitivity.angle_uncertainty import AngleStds  # for few tops only

    stds = AngleStds(motion.exact, found.stds, found.inputs.keys())
    if stds.reason:
        complain(f"Warning: no uncertainty of the angles: {stds.reason}")
    return stds
