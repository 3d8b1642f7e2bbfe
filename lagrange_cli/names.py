"""Names of numbers: how they are presented, parsed, and checked against the known names."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable
from typing import NamedTuple

from .arithmetic.text import quoted
from .errors import LagtopError

ANGLES = ("theta", "phi", "psi")
"""Tilt, spin and precession, in the order used everywhere."""
RADIUS = "_radius"
"""The end of the name of a bound, which follows the key of its number."""
_MOST_CHARACTERS, _FIRST = 240, 12
"""The most characters of a list in a message, and the number of names shown of a longer list."""


class Key(NamedTuple):
    """The presentation of a number of a record; the unit `angle` stands for degrees or radians."""

    group: str
    symbol: str
    meaning: str
    unit: str = ""
    equation: str = ""
    formula: str = ""
    """The formula, written with names of keys, such as `2*m*g*s/A`; see `account.explanation`."""
    only: str = ""
    """The condition of the number, such as `if r0 is not 0`; some regimes lack it too."""
    evaluated: str = ""
    """The form of the formula that the solver evaluates."""
    relative_to: str = ""
    """What its error is relative to: `1` for a cosine, else its size."""
    lacking: str = ""
    """The kinds of motion that lack the number, of `steady vertical separatrix`."""


def split_names(text: str) -> list[str]:
    """Return the names in a comma-separated text."""
    return [name.strip() for name in text.split(",")]


def check_names(key: str, names: Iterable[str], known: Iterable[str]) -> list[str]:
    """Return the names of the argument `key` as a list.

    Raises LagtopError for anything but an iterable of texts, for an empty one, and for an
    unknown or repeated name.  The message suggests the name that was probably meant and lists known
    names.
    """
    if isinstance(names, str) or not isinstance(names, Iterable):
        raise LagtopError(f"{key} must be a list of names, got {quoted(names)}", key)
    known, names = list(known), list(names)
    wrong = [x for x in names or [""] if not (isinstance(x, str) and x in known)]
    if wrong:
        hint = f"got {quoted(wrong[0])}{suggestion(wrong[0], known)}"
        got = hint if names else "got an empty list"
        if len(listed := ", ".join(known)) <= _MOST_CHARACTERS:
            raise LagtopError(f"{key} must be one of {listed}, {got}", key)
        first = known.index("regime") if "regime" in known else 0  # the results of a record
        some = f"{', '.join(known[first:][:_FIRST])} and {len(known) - _FIRST} more"
        more = ", see lagtop explain" if "T_nutation" in known else ""  # a list of keys
        raise LagtopError(f"{key} must be one of {len(known)} names, {got}: {some}{more}", key)
    if (twice := repeated(names)) is not None:
        raise LagtopError(f"{key} must not repeat a name, got {twice!r} twice", key)
    return names


def repeated(names: Iterable[str]) -> str | None:
    """Return the first repeated name, or None."""
    return next((name for name, count in Counter(names).items() if count > 1), None)


def listed(names: Iterable[str], before: str = "") -> str:
    """Return names as a list in a sentence, each with a text `before` it."""
    *others, last = (f"{before}{name}" for name in names)
    return f"{', '.join(others)} or {last}" if others else last


def suggestion(name: object, known: Iterable[str]) -> str:
    """Return ` (did you mean 'x'?)` with the known names closest to a wrong one, or an empty text.

    A name without its unit of an angle, or with its words in another order, comes first.  Then come
    names that contain the words of the wrong one, then names that begin with it or are similar.
    """
    from difflib import get_close_matches

    known, wrong = list(known), str(name)[:80]
    same = [x for x in known if wrong in (f"{x}_deg", f"{x}_rad") or _words(x) == _words(wrong)]
    words = [x for x in known if _words(wrong) <= _words(x)]
    longer = [x for x in known if len(wrong) > 2 and x.startswith(wrong)]
    nearest = same[:1] or words[:3] or longer[:1] or get_close_matches(wrong, known, 1)
    return f" (did you mean {listed(map(repr, nearest))}?)" if nearest else ""


def _words(name: str) -> set[str]:
    """Return the words of a name; a period is T in the names of keys."""
    return set(name.lower().replace("period", "t").split("_"))
