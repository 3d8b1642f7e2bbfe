"""Scenes: files of TOML with the inputs of a top by key, and the built-in scenes."""

from __future__ import annotations

import os
import re
from contextlib import suppress

from ..arithmetic.text import NumberText, is_decimal, quoted, shortened
from ..errors import DataError, LagtopError, SceneError
from ..file_bytes import decoded, read_bytes, shown_path
from ..names import suggestion
from .inputs import INPUTS, STEADY_WORDS, TILT
from .values import Value, parse_value, tilt_key

_MOST_BYTES = 1 << 14
"""Most bytes of a scene file, because the run time of `tomllib` may grow with their square."""
SCENE_KEYS = (*INPUTS, TILT)
_ENDING = ".toml"
_NO_SCENE = ": pass a recording to fit or compare, a table of tops to sweep"


def _shipped() -> str:
    """Return the folder of the built-in scenes: inside the package, or beside it in a checkout."""
    package = os.path.dirname(os.path.dirname(__file__))
    inside = os.path.join(package, "scenes")
    return inside if os.path.isdir(inside) else os.path.join(package, "..", "sample_inputs")


def scene_names() -> list[str]:
    """Return the names of the built-in scenes."""
    names = os.listdir(_shipped())
    return sorted(name.removesuffix(_ENDING) for name in names if name.endswith(_ENDING))


def scene_path(name: str) -> str:
    """Return the path of a scene: the given file, or the file of a built-in scene."""
    is_word = name.replace("-", "").isalnum() and not os.path.isfile(name)
    path = os.path.join(_shipped(), name + _ENDING) if is_word else name
    return path if os.path.exists(path) else name


def scene_remark(name: str) -> str:
    """Return the first line of a built-in scene, which describes it."""
    with open(scene_path(name), encoding="utf-8") as file:
        return file.readline().removeprefix("#").strip()


def is_scene_file(word: str) -> bool:
    """Return whether a word ends in `.toml` or is the name of a built-in scene."""
    return word.endswith(_ENDING) or scene_path(word) != word


class SceneFile:
    """The contents of a scene file: its inputs, and the lines of errors about them."""

    def __init__(self, path: str) -> None:
        """Read a file, or standard input for `-`.  Raises SceneError."""
        import tomllib  # start-up

        self.name, self._text = shown_path(path), ""
        self.hides = os.path.isfile(path) and path in scene_names()
        """Whether it is a file with the name of a built-in scene."""
        remedy = "" if path.endswith(_ENDING) else _NO_SCENE
        try:
            self._text = decoded(read_bytes(scene_path(path), _MOST_BYTES), self.name)
            table = tomllib.loads(self._text, parse_float=NumberText)
        except DataError as error:
            hint = remedy if os.path.isfile(path) else suggestion(path, scene_names())
            if not hint and path.replace("-", "").isalnum():
                hint = f" (the built-in scenes are {', '.join(scene_names())})"
            raise SceneError(f"{error}{hint}") from None
        except (ValueError, RecursionError) as error:  # broken TOML, or too many digits
            at = re.search(r"at line (\d+)", str(error))
            line = self._text.split("\n")[int(at[1]) - 1] if at else ""
            hint = " (write a decimal point, not a comma)" if re.search(r"=.*\d,\d", line) else ""
            bare = re.match(r"\s*(\w+)\s*=\s*([-+\d.(][^#\"']*)", line)
            if bare and is_decimal(text := bare[2].strip()):
                hint = " (write digits on both sides of the point, and no zero in front)"
            elif bare:
                with suppress(LagtopError):
                    _value(bare[1], text)
                    hint = f' (write {bare[1]} = "{shortened(text)}")'
            wrong = str(error).split("; use sys")[0]  # advice for those who write Python
            raise SceneError(f"{self.name}: not a TOML file: {wrong}{hint}{remedy}") from None
        self.inputs: dict[str, Value] = {}
        for key, value in table.items():
            try:
                found = _value(key, value)
            except LagtopError as error:
                error.key = key
                raise self.error(error) from None
            self.inputs[tilt_key(key, found)] = found

    def error(self, error: LagtopError) -> SceneError:
        """Return the error prefixed with the name of the file and the line of its key."""
        pattern = re.compile(rf"""\s*\[*\s*["']?{re.escape(error.key or "")}\b""")
        numbered = enumerate(self._text.split("\n"), 1)
        line = next((i for i, text in numbered if error.key and pattern.match(text)), None)
        place = f"{self.name}, line {line}" if line else self.name
        found = SceneError(f"{place}: {error}")  # in a file, names are keys and no options
        found.key = error.key
        return found


def _value(key: str, value: object) -> Value:
    if key not in SCENE_KEYS:
        meant, known = suggestion(key, SCENE_KEYS), ", ".join(SCENE_KEYS)
        raise LagtopError(f"unknown key {quoted(key)}{meant} (known: {known})")
    is_text = isinstance(value, str) and not isinstance(value, NumberText)
    try:
        text = str(value)
    except ValueError:  # an integer of thousands of digits, in hexadecimal digits
        raise LagtopError(f"{key} must be at most 1.8e308 in magnitude") from None
    if isinstance(value, bool) or not isinstance(value, int | str):
        raise LagtopError(f"{key} must be a finite number, got {shortened(text)}")
    if not is_text and key == TILT:
        wanted = f"have a unit, such as '30 deg', or be called {key}_deg or {key}_rad"
        raise LagtopError(f"{key} must {wanted}")
    if not is_text:
        return parse_value(key, text.replace("_", ""))
    found = parse_value(key, text, uncertain=True, steady=key == "psidot0")
    if not found.unit and found.number not in STEADY_WORDS and found.std is None:
        wanted = "must have a unit between quotes"
        raise LagtopError(f"{key} {wanted}, got {quoted(value)}: leave out the quotes")
    if found.unit and key.startswith(f"{TILT}_"):
        wanted = f"must be called {TILT} if its value has a unit"
        raise LagtopError(f"{key} {wanted}, got {quoted(value)}")
    return found
