"""Warnings about an incomplete body, whose missing inputs come from the worked example."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence

from ..errors import MixedBodyWarning
from .input_keys import DECLARED


def remark_on(missing: Iterable[str], words: Sequence[str]) -> str:
    """Return a warning about missing inputs, with the words that set them."""
    *others, last = missing
    named = f"{', '.join(others)} and {last} default" if others else f"{last} defaults"
    return f"{named} to the worked example, in g, cm and s: {' '.join(words)}"


def example_options(missing: Mapping[str, float], *, units: bool = False) -> list[str]:
    """Return the options that set the defaults of the worked example, with units or without."""
    if not units:
        return [f"--{name} {value:g}" for name, value in missing.items()]
    return [
        f"--{name} '{value:g} {_in_cgs(DECLARED[name].unit)}'" for name, value in missing.items()
    ]


def _in_cgs(unit: str) -> str:
    """Return a unit such as `g*cm^2` in place of `mass len²`."""
    for word, of_cgs in (("mass", "g"), ("len", "cm"), ("time", "s"), (" ", "*"), ("²", "^2")):
        unit = unit.replace(word, of_cgs)
    return unit


def warn_of(missing: Mapping[str, float], stacklevel: int) -> None:
    """Warn of missing inputs, with the arguments that set them."""
    arguments = ", ".join(f"{name}={value:g}" for name, value in missing.items())
    warnings.warn(remark_on(missing, [arguments]), MixedBodyWarning, stacklevel)
