"""Options for inputs that may be uncertain, and what becomes of them over time."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any, TypeVar

from ..arithmetic.text import is_decimal, parse_number
from .options import Parsed, input_options, scene_argument

if TYPE_CHECKING:
    from collections.abc import Callable

    from ..inputs.given import Given
    from ..motion.angle_uncertainty import AngleStds
    from ..motion.solve import Motion

F = TypeVar("F", bound="Callable[..., Any]")


def parse_uncertain_input(text: str) -> Any:
    """Return a number, one with an uncertainty, or either in a unit."""
    if is_decimal(text.strip()):
        return parse_number(text)
    from ..inputs.quantity_text import parse_quantity
    from ..inputs.uncertain import parse_uncertain

    return parse_quantity(text, parse_uncertain)


UNCERTAIN = Parsed("number", parse_uncertain_input)


def uncertain_scene_options(command: F) -> F:
    """Add the argument for a scene file and options that may be uncertain and override it."""
    return scene_argument(input_options(UNCERTAIN)(command))


def angle_stds(found: Given, motion: Motion) -> AngleStds | None:
    """Return the uncertainties of the angles over time, where inputs have any."""
    if not found.stds:
        return None
    from ..inputs.uncertain import by_given
    from ..motion.angle_uncertainty import AngleStds

    return AngleStds(motion.exact, found.stds, by_given(motion.top, found.inputs.keys()))
