"""Scenes in files: the inputs of a top by key in TOML, and descriptions of results.

A description has the scene, the version, the units and the conventions of the numbers.  It is
stored in the metadata of a Parquet schema, or in comments above a text table.
"""

from __future__ import annotations

import math
import os
import re
from collections.abc import Iterable, Mapping
from fractions import Fraction
from typing import TYPE_CHECKING, Any

from ..arithmetic.text import parse_number, quoted, shortened
from ..errors import DataError, LagtopError, SceneError
from .files import read_bytes, shown_path
from .input_keys import TILT
from .names import ANGLES, suggestion
from .top import INPUTS, Top
from .value import STEADY_WORDS, InputPair, Stds, Value, parse_value

if TYPE_CHECKING:
    from .units import System

_MOST_BYTES = 1 << 16
_MOST_DOTS = 20
"""Most dots in one line: the run time of `tomllib` grows with the square of the parts of a key."""
SCENE_KEYS = (*INPUTS, TILT)
_ENDING = ".toml"
_CORRELATIONS = "correlations"
"""The table of the correlations of uncertain inputs."""


def _shipped() -> str:
    """Return the folder of the shipped scenes: inside the package, or beside it in a checkout."""
    package = os.path.dirname(os.path.dirname(__file__))
    inside = os.path.join(package, "scenes")
    return inside if os.path.isdir(inside) else os.path.join(package, "..", "sample_inputs")


def scene_names() -> list[str]:
    """Return the names of the shipped scenes."""
    names = os.listdir(_shipped())
    return sorted(name.removesuffix(_ENDING) for name in names if name.endswith(_ENDING))


def scene_path(name: str) -> str:
    """Return the path of a scene: the given file, or the file of a shipped scene."""
    is_word = name.replace("-", "").isalnum() and not os.path.exists(name)
    path = os.path.join(_shipped(), name + _ENDING) if is_word else name
    return path if os.path.exists(path) else name


def scene_remark(name: str) -> str:
    """Return the first line of a shipped scene, which describes it."""
    with open(scene_path(name), encoding="utf-8") as file:
        return file.readline().removeprefix("#").strip()


def is_scene_file(word: str) -> bool:
    """Return whether a word ends in `.toml` or is the name of a shipped scene."""
    return word.endswith(_ENDING) or scene_path(word) != word


class SceneFile:
    """The contents of a scene file: its inputs, their correlations, and their line numbers."""

    def __init__(self, path: str) -> None:
        """Read a file, or standard input for `-`.  Raises SceneError."""
        import tomllib  # not for descriptions

        self.name, self.text = shown_path(path), ""
        try:
            raw = read_bytes(scene_path(path), _MOST_BYTES)
        except DataError as error:
            raise SceneError(f"{error}{suggestion(path, scene_names())}") from None
        try:
            self.text = raw.decode("utf-8-sig")
            _check_dots(self.text)
            table = tomllib.loads(self.text, parse_float=_parsed)
        except (ValueError, RecursionError) as error:  # broken TOML or UTF-8, too many digits
            is_text = not isinstance(error, UnicodeDecodeError)
            why = f"{error}{_remedy(str(error), self.text)}" if is_text else "it is no UTF-8 text"
            raise SceneError(f"{self.name}: not a TOML file: {why}") from None
        correlated = table.pop(_CORRELATIONS, {})
        found = {key: self._value(key, value) for key, value in table.items()}
        # A tilt without a unit is in degrees, as on the command line.
        degrees = {TILT: f"{TILT}_deg"}
        self.inputs = {x if y.unit else degrees.get(x, x): y for x, y in found.items()}
        try:
            self.correlations = self._correlations(correlated)
        except LagtopError as error:
            raise self.error(LagtopError(f"correlations {error}", _CORRELATIONS)) from None

    def _correlations(self, table: object) -> dict[InputPair, Fraction]:
        """Return correlations by pair of inputs, from tables such as `A = { C = 0.5 }`."""
        if not isinstance(table, dict) or not all(isinstance(x, dict) for x in table.values()):
            raise LagtopError(f"must be tables such as A = {{ C = 0.5 }}, got {_shown(table)}")
        uncertain = {name: 1.0 for name, x in self.inputs.items() if x.std is not None}
        found: dict[InputPair, Fraction] = {}
        for x, y, r in ((x, y, r) for x, row in table.items() for y, r in row.items()):
            if lost := [name for name in (x, y) if name not in uncertain]:
                meant = suggestion(lost[0], uncertain)
                raise LagtopError(f"must be of uncertain inputs, got {quoted(lost[0])}{meant}")
            if not isinstance(r, int | Fraction) or not -1 <= r <= 1 or isinstance(r, bool):
                raise LagtopError(f"must be in [-1, 1], got {_shown(r)} for {x} and {y}")
            if x == y:
                raise LagtopError(f"must be between two inputs, got {x} twice")
            if r != (other := found.setdefault(InputPair((x, y)), Fraction(r))):
                both = f"{float(other)} and {float(r)} for {x} and {y}"
                raise LagtopError(f"must be symmetric, got {both}")
        if found:
            from .uncertain import are_possible  # start-up

            if not are_possible(Stds(uncertain, found).matrix()):
                raise LagtopError("must be positive semidefinite: some contradict others")
        return found

    def _value(self, key: str, value: object) -> Value:
        if key not in SCENE_KEYS:
            meant, known = suggestion(key, SCENE_KEYS), ", ".join(SCENE_KEYS)
            wrong = f"unknown key {quoted(key)}{meant} (known: {known})"
            raise self.error(LagtopError(wrong, key))
        if isinstance(value, str) and not isinstance(value, _NoNumber):
            return self._value_of_text(key, value)
        if isinstance(value, int) and not isinstance(value, bool):
            value = Fraction(value)
        if not isinstance(value, Fraction):
            wrong = f"{key} must be a finite number, got {_shown(value)}"
            raise self.error(LagtopError(wrong, key))
        if key == TILT:
            wrong = f"{key} must have a unit, such as '30 deg', or be called {key}_deg or {key}_rad"
            raise self.error(LagtopError(wrong, key))
        return Value(value)

    def _value_of_text(self, key: str, text: str) -> Value:
        """Return a number with a unit or an uncertainty."""
        try:
            value = parse_value(text, uncertain=True, steady=key == "psidot0")
        except LagtopError as error:
            raise self.error(LagtopError(f"{key} {error}", key)) from None
        is_word = value.number in STEADY_WORDS
        if not value.unit and not is_word and value.std is None:
            wrong = (
                f"{key} must have a unit between quotes, got {quoted(text)}: leave out the quotes"
            )
            raise self.error(LagtopError(wrong, key))
        if value.unit and key.startswith(f"{TILT}_"):
            wrong = f"{key} must be called {TILT} if its value has a unit, got {quoted(text)}"
            raise self.error(LagtopError(wrong, key))
        return value

    def error(self, error: LagtopError) -> SceneError:
        """Return the error prefixed with the name of the file and the line of its key."""
        pattern = re.compile(rf"""\s*\[*\s*["']?{re.escape(error.key or "")}\b""")
        numbered = enumerate(self.text.splitlines(), 1)
        line = next((i for i, text in numbered if error.key and pattern.match(text)), None)
        place = f"{self.name}, line {line}" if line else self.name
        return SceneError(f"{place}: {error}", error.key)


def _shown(value: object) -> str:
    """Return a value as TOML writes it, for a message; a long one is cut."""
    import json  # for errors

    if isinstance(value, str):
        return quoted(value)
    text = json.dumps(value, default=lambda x: float(x) if isinstance(x, Fraction) else str(x))
    return shortened(text.strip('"'))


def _check_dots(text: str) -> None:
    """Raise ValueError for a key with too many parts."""
    for number, line in enumerate(text.splitlines(), 1):
        if line.count(".") > _MOST_DOTS and not line.lstrip().startswith("#"):
            raise ValueError(f"line {number} has more than {_MOST_DOTS} dots")


def _remedy(wrong: str, text: str) -> str:
    """Return a hint in parentheses about a decimal comma or a repeated key."""
    if "overwrite" in wrong:
        return " (a key is repeated: delete one line)"
    place = re.search(r"at line (\d+)", wrong)
    line = text.splitlines()[int(place[1]) - 1] if place else ""
    return " (write a decimal point, not a comma)" if re.search(r"=.*\d,\d", line) else ""


class _NoNumber(str):
    """A number in TOML that lagtop does not accept, such as nan."""

    __slots__ = ()


def _parsed(text: str) -> Fraction | _NoNumber:
    """Return a number as a fraction, or its text if it is not a decimal number."""
    try:
        return parse_number(text.replace("_", ""))
    except LagtopError:
        return _NoNumber(text)


Description = Mapping[str, str]
"""Texts by the keys `lagtop`, `scene`, `units` and `conventions`; may be empty."""
_KEYS = ("lagtop", "scene", "shared inputs", "units", "conventions")
_FRAMES = (
    f"{ANGLES[0]} is the tilt, {ANGLES[1]} the spin and {ANGLES[2]} the precession; "
    "a quaternion is w, x, y, z and turns the body to space; rates are in radians per unit of time"
)


def describe(
    version: str,
    scene: Mapping[str, str],
    system: System | None,
    *,
    radians: bool,
    is_whole: bool = True,
) -> Description:
    """Return the description of results for one top, or for tops that share some inputs."""
    angles = "radians" if radians else "degrees"
    return {
        "lagtop": version,
        "scene" if is_whole else "shared inputs": ", ".join(
            f"{x} = {scene[x]}" for x in INPUTS if x in scene
        ),
        "units": f"{system.mass}, {system.length}, s" if system else "those of the scene",
        "conventions": f"angles are in {angles}; {_FRAMES}",
    }


def description_in(comments: Iterable[str]) -> Description:
    """Return the description in comments, which may be empty."""
    pairs = (re.fullmatch(r"([a-z ]+): (.*)", x.strip()) for x in comments)
    found = {x[1]: x[2] for x in pairs if x and x[1] in _KEYS}
    return found if "lagtop" in found else {}


def scene_in(description: Description, name: str) -> Top | None:
    """Return the top that a file describes, if any.  Raises DataError for an impossible top."""
    if "scene" not in description:
        return None
    pairs = dict(x.split(" = ", 1) for x in description["scene"].split(", ") if " = " in x)
    try:
        if not pairs or not pairs.keys() <= {*INPUTS}:
            raise LagtopError("it must have inputs by key")
        inputs: dict[str, Any] = {
            key: text if text in STEADY_WORDS else float(parse_number(text))
            for key, text in pairs.items()
        }
        return Top(**inputs)
    except LagtopError as error:
        raise DataError(f"{name}: the scene in its description is invalid: {error}") from None


def difference(found: Top, wanted: Top) -> str:
    """Return the inputs that differ, as in `r0 = -50.0, not 50.0`; empty if the tops are equal."""
    other = wanted.inputs()
    return "; ".join(
        f"{key} = {float(x)}, not {float(other[key])}"
        for key, x in found.inputs().items()
        if not math.isclose(x, other[key], rel_tol=1e-12)
    )
