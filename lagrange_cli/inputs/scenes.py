"""Scenes: files of TOML with the inputs of a top by key, and the shipped ones."""

from __future__ import annotations

import os
import re
from fractions import Fraction

from ..arithmetic.text import parse_number, quoted, shortened
from ..errors import DataError, LagtopError, SceneError
from .files import decoded, read_bytes, shown_path
from .input_keys import TILT
from .names import suggestion
from .top import INPUTS
from .values import STEADY_WORDS, Value, parse_value

_MOST_BYTES = 1 << 14
"""Most bytes of a scene file, because the run time of `tomllib` may grow with their square."""
SCENE_KEYS = (*INPUTS, TILT)
_ENDING = ".toml"


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
    """The contents of a scene file: its inputs, and the lines of errors about them."""

    def __init__(self, path: str) -> None:
        """Read a file, or standard input for `-`.  Raises SceneError."""
        import tomllib  # start-up

        self.name, self._text = shown_path(path), ""
        try:
            content = read_bytes(scene_path(path), _MOST_BYTES)
            self._text = decoded(content, self.name)
            table = tomllib.loads(self._text, parse_float=_parsed)
        except DataError as error:
            is_word = not os.path.dirname(path) and "." not in path and path != "-"
            hint = suggestion(path, scene_names())
            if is_word and not hint:
                hint = f" (the shipped scenes are {', '.join(scene_names())})"
            raise SceneError(f"{error}{hint}") from None
        except (ValueError, RecursionError) as error:  # broken TOML, or too many digits
            why = f"{error}{_remedy(str(error), self._text)}"
            raise SceneError(f"{self.name}: not a TOML file: {why}") from None
        found = {}
        for key, value in table.items():
            try:
                found[key] = _value(key, value)
            except LagtopError as error:
                raise self.error(LagtopError(str(error), key)) from None
        # A tilt without a unit is in degrees, as on the command line.
        degrees = {TILT: f"{TILT}_deg"}
        self.inputs = {x if y.unit else degrees.get(x, x): y for x, y in found.items()}

    def error(self, error: LagtopError) -> SceneError:
        """Return the error prefixed with the name of the file and the line of its key."""
        pattern = re.compile(rf"""\s*\[*\s*["']?{re.escape(error.key or "")}\b""")
        numbered = enumerate(self._text.split("\n"), 1)
        line = next((i for i, text in numbered if error.key and pattern.match(text)), None)
        place = f"{self.name}, line {line}" if line else self.name
        return SceneError(f"{place}: {error}", error.key)


def _value(key: str, value: object) -> Value:
    """Return the value of a key.  Raises LagtopError."""
    if key not in SCENE_KEYS:
        meant, known = suggestion(key, SCENE_KEYS), ", ".join(SCENE_KEYS)
        raise LagtopError(f"unknown key {quoted(key)}{meant} (known: {known})")
    if isinstance(value, str) and not isinstance(value, _NoNumber):
        return _value_of_text(key, value)
    if isinstance(value, int) and not isinstance(value, bool):
        value = Fraction(value)
    if not isinstance(value, Fraction):
        raise LagtopError(f"{key} must be a finite number, got {_shown(value)}")
    if key == TILT:
        wanted = f"have a unit, such as '30 deg', or be called {key}_deg or {key}_rad"
        raise LagtopError(f"{key} must {wanted}")
    return Value(value)


def _value_of_text(key: str, text: str) -> Value:
    """Return a number with a unit or an uncertainty.  Raises LagtopError."""
    try:
        value = parse_value(text, uncertain=True, steady=key == "psidot0")
    except LagtopError as error:
        raise LagtopError(f"{key} {error}") from None
    if not value.unit and value.number not in STEADY_WORDS and value.std is None:
        wanted = "must have a unit between quotes"
        raise LagtopError(f"{key} {wanted}, got {quoted(text)}: leave out the quotes")
    if value.unit and key.startswith(f"{TILT}_"):
        wanted = f"must be called {TILT} if its value has a unit"
        raise LagtopError(f"{key} {wanted}, got {quoted(text)}")
    return value


def _shown(value: object) -> str:
    """Return a value as TOML writes it, for a message; a long one is cut."""
    import json  # for errors

    if isinstance(value, str):
        return quoted(value)
    text = json.dumps(value, default=lambda x: float(x) if isinstance(x, Fraction) else str(x))
    return shortened(text.strip('"'))


def _remedy(wrong: str, text: str) -> str:
    """Return a hint in parentheses about a decimal comma or a repeated key."""
    if "overwrite" in wrong:
        return " (a key is repeated: delete one line)"
    place = re.search(r"at line (\d+)", wrong)
    line = text.split("\n")[int(place[1]) - 1] if place else ""
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
