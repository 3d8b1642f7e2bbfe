"""Scene files: the inputs of a top by key, in TOML."""

from __future__ import annotations

import re
import tomllib
from fractions import Fraction
from typing import Any

from ..arithmetic.text import parse_number
from ..errors import LagtopError, SceneError
from .top import Top

_MOST_BYTES = 1 << 20
KEYS = Top._fields


class SceneFile:
    """A scene file that has been read: its inputs, and where in it an input stands."""

    def __init__(self, path: str) -> None:
        """Raise SceneError."""
        self.path, self.text = path, ""
        try:
            with open(path, "rb") as file:
                raw = file.read(_MOST_BYTES + 1)
            if len(raw) > _MOST_BYTES:
                raise OSError(None, "more than 1 MiB is no scene file")
            self.text = raw.decode("utf-8-sig")
            table = tomllib.loads(self.text, parse_float=_parsed)
        except OSError as error:
            raise SceneError(f"{path or 'the scene file'}: {error.strerror}") from None
        except (ValueError, RecursionError) as error:  # broken TOML or UTF-8, endless digits
            raise SceneError(f"{path}: not a TOML file: {error}") from None
        self.inputs = {key: self._number(key, value) for key, value in table.items()}

    def _number(self, key: str, value: Any) -> Fraction:
        if key not in KEYS:
            raise self.error(LagtopError(f"unknown key {key!r} (known: {' '.join(KEYS)})", key))
        if isinstance(value, int) and not isinstance(value, bool):
            return Fraction(value)
        if not isinstance(value, Fraction):
            raise self.error(LagtopError(f"{key} must be a finite number, got {value!r}", key))
        return value

    def error(self, error: LagtopError) -> SceneError:
        """The same error, laid at the door of the file, and of its line where the key stands."""
        pattern = re.compile(rf"""\s*\[*\s*["']?{re.escape(error.key or "")}\b""")
        numbered = enumerate(self.text.splitlines(), 1)
        line = next((i for i, text in numbered if error.key and pattern.match(text)), None)
        place = f"{self.path}, line {line}" if line else self.path
        return SceneError(f"{place}: {error}", error.key)


def _parsed(text: str) -> Fraction | str:
    try:
        return parse_number(text.replace("_", ""))
    except LagtopError:
        return text
