"""What is said of a body of which some inputs are given and others those of the worked example."""

from __future__ import annotations

import warnings
from collections.abc import Sequence

from ..errors import MixedBodyWarning
from .top import BODY

_UNITS = {"m": "g", "A": "g*cm^2", "C": "g*cm^2", "s": "cm", "g": "cm/s^2"}


def remark(missing: Sequence[str], words: Sequence[str]) -> str:
    """Return the line on the inputs that were not given, with the words that would give them."""
    *others, last = missing
    named = f"{', '.join(others)} and {last} are those" if others else f"{last} is that"
    return f"{named} of the worked example, in g, cm and s: {' '.join(words)}"


def options(missing: Sequence[str], *, units: bool = False) -> list[str]:
    """Return the options that give what the worked example has, with units or without."""
    if units:
        return [f"--{name} '{BODY[name]:g} {_UNITS[name]}'" for name in missing]
    return [f"--{name} {BODY[name]:g}" for name in missing]


def warn_of(missing: Sequence[str], stacklevel: int) -> None:
    """Warn of inputs that were not given, with the arguments that would give them."""
    arguments = ", ".join(f"{name}={BODY[name]:g}" for name in missing)
    warnings.warn(remark(missing, [arguments]), MixedBodyWarning, stacklevel)
