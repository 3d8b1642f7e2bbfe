"""What is said of a body of which some inputs are given and others those of the worked example."""

from __future__ import annotations

import warnings
from collections.abc import Iterable, Mapping, Sequence

from ..errors import MixedBodyWarning

_UNITS = {"m": "g", "A": "g*cm^2", "C": "g*cm^2", "s": "cm", "g": "cm/s^2"}


def remark(missing: Iterable[str], words: Sequence[str]) -> str:
    """Return the line on the inputs that were not given, with the words that would give them."""
    *others, last = missing
    named = f"{', '.join(others)} and {last} are those" if others else f"{last} is that"
    return f"{named} of the worked example, in g, cm and s: {' '.join(words)}"


def options(missing: Mapping[str, float], *, units: bool = False) -> list[str]:
    """Return the options that give what the worked example has, with units or without."""
    if units:
        return [f"--{name} '{value:g} {_UNITS[name]}'" for name, value in missing.items()]
    return [f"--{name} {value:g}" for name, value in missing.items()]


def warn_of(missing: Mapping[str, float], stacklevel: int) -> None:
    """Warn of inputs that were not given, with the arguments that would give them."""
    arguments = ", ".join(f"{name}={value:g}" for name, value in missing.items())
    warnings.warn(remark(missing, [arguments]), MixedBodyWarning, stacklevel)
