"""The page of a top for the browser: one HTML file that needs no network and no other file."""

from __future__ import annotations

import re
import tempfile
import webbrowser
from base64 import b64encode
from collections.abc import Callable
from hashlib import sha256
from importlib.resources import files
from pathlib import Path

from ...errors import LagtopError, check_type
from ...motion.notebook import Document
from ...motion.solve import Motion
from ..style import DARK, LIGHT, Look
from .data import page_data

_IMPORT = re.compile(r'^import (\{[^}]*\}) from "([^"]+)";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:function|class|const) (\w+))", re.MULTILINE)

_TRACES = {LIGHT: "#472d7b", DARK: "#dde318"}
"""Colour of the path of the axis on each paper: an end of viridis, unlike the colours of angles."""


def view(motion: Motion, unit: Callable[[str], str] = str) -> Document:
    """Return the interactive page for the browser: the top in space, its curves and its record.

    `unit` names mass, len and time in the units of the inputs; the default is any consistent units.
    The inputs are rounded to doubles, because sliders need them.  Raises LagtopError for inputs out
    of the range of the page.

    >>> view(solve(Top()))[:15]
    '<!DOCTYPE html>'
    """
    check_type("motion", motion, Motion)
    parts = {
        "style": _filled(_text_of("style.css"), {"light": _colours(LIGHT), "dark": _colours(DARK)}),
        "units": _units_in_words(*map(unit, ("mass", "len", "time"))),
        "script": joined_script(page_data(motion, unit)),
    }
    hashes = {f"{name}_hash": _hash(parts[name]) for name in ("style", "script")}
    return Document(_filled(_text_of("index.html"), parts | hashes))


def _hash(text: str) -> str:
    """Return the source of a content policy that permits only this style or script."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def _units_in_words(mass: str, length: str, time: str) -> str:
    if mass == "mass":
        return "in any consistent units"
    return f"in {mass}, {length} and {time}"


def _colours(look: Look) -> str:
    """Return the colours of a look as variables of the style sheet."""
    blue, red, green = look.lines
    names = {"paper": look.paper, "ink": look.ink, "quiet": look.quiet, "faint": look.faint}
    names |= {"blue": blue, "red": red, "green": green, "trace": _TRACES[look]}
    return " ".join(f"--{name}: {colour};" for name, colour in names.items())


def _filled(text: str, parts: dict[str, str]) -> str:
    """Return a text with its {{names}} replaced."""
    return re.sub(r"\{\{(\w+)\}\}", lambda name: parts[name[1]], text)


def open_page(page: Document, path: str | None) -> None:
    """Open a page in the user's browser, from the file at `path` or from a new temporary file.

    Raises LagtopError if no browser is found.
    """
    if path is None:
        path = str(Path(tempfile.mkdtemp(prefix="lagtop-")) / "top.html")
        page.save(path)
    if not webbrowser.open(Path(path).resolve().as_uri()):
        raise LagtopError(f"open found no browser; the page is {path}", "open")


def joined_script(data: str) -> str:
    """Return the page's main module and all its imports as one script, each import first.

    Each module becomes a function that is called once, so that its names stay local.  The module
    `data.js` is the JSON `data`.
    """
    scripts = {"data.js": f'modules["data.js"] = {data};'}
    _collect("page/main.js", scripts)
    return "\n".join(["const modules = {};", *scripts.values()])


def _collect(name: str, scripts: dict[str, str]) -> None:
    """Add the script of a module after those of the modules it imports."""
    text = _text_of(name)
    for match in _IMPORT.finditer(text):
        path = _resolved(name, match[2])
        if path not in scripts:
            _collect(path, scripts)
    body = _IMPORT.sub(lambda found: _taken(name, *found.groups()), _EXPORT.sub("", text))
    shown = ", ".join(_EXPORT.findall(text))
    scripts[name] = f'modules["{name}"] = (() => {{\n{body}\nreturn {{ {shown} }};\n}})();\n'


def _taken(name: str, names: str, other: str) -> str:
    """Return the line that takes names from a module earlier in the script."""
    return f'const {names} = modules["{_resolved(name, other)}"];'


def _resolved(name: str, other: str) -> str:
    """Return the path of a module that another one imports as `./x.js` or `../room/x.js`."""
    room = name.rpartition("/")[0]
    return other.removeprefix("../") if other.startswith("../") else f"{room}/{other[2:]}"


def _text_of(name: str) -> str:
    """Return the text of a file of this folder."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
