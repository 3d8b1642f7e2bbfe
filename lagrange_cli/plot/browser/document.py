"""The page of one top, as a document of HTML that needs no network and no other file."""

from __future__ import annotations

import json
import re
import tempfile
import webbrowser
from collections.abc import Callable
from importlib.resources import files
from pathlib import Path

from ...errors import LagtopError, check_type
from ...inputs.top import Top
from ...motion.notebook import Document
from ...motion.solve import Motion, solve
from ..style import DARK, LIGHT, Look

_IMPORT = re.compile(r'^import (\{[^}]*\}) from "([^"]+)";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:function|class|const) (\w+))", re.MULTILINE)

_TRACES = {LIGHT: "#31688e", DARK: "#35b779"}
"""The colour of the path of the axis on each paper, of viridis as in the other pictures."""

LARGEST, LEAST_TILT = 1e30, 1e-12
"""Sizes of inputs, and the least tilt (degrees) from the vertical, that the page computes with."""


def view(motion: Motion, unit: Callable[[str], str] = str) -> Document:
    """Return the page for the browser: the top in space, its curves and its record, to be turned.

    `unit` names mass, len and time in the units of the inputs; without it these may be any that
    are consistent.  The inputs are rounded to doubles, as sliders need them.  Raises LagtopError
    for inputs that are beyond what the page computes with.
    """
    check_type("motion", motion, Motion)
    parts = {
        "style": _filled(text_of("style.css"), {"light": _colours(LIGHT), "dark": _colours(DARK)}),
        "scene": json.dumps(page_scene(motion)),
        "units": _units_in_words(*map(unit, ("mass", "len", "time"))),
        "script": joined_script(),
    }
    return Document(_filled(text_of("index.html"), parts))


def page_scene(motion: Motion) -> dict[str, float]:
    """Return the inputs of the page as doubles, the tilt in degrees.

    Raises LagtopError for inputs that are beyond what the page computes with.
    """
    scene = {name: float(value) for name, value in motion.top.inputs().items()}
    for name, value in scene.items():
        if abs(value) > LARGEST or (name in {"m", "A", "C"} and value < 1 / LARGEST):
            raise LagtopError(f"{name} must be from 1e-30 to 1e30 for a page, got {value}", name)
    tilt = scene["theta0_deg"]
    if 0 < min(tilt, 180 - tilt) < LEAST_TILT:
        raise LagtopError(
            f"theta0_deg must be 0, 180 or 1e-12 from both for a page, got {tilt}", "theta0_deg"
        )
    solve(Top(**scene))  # a tilt in radians may round to the vertical, where nothing precesses
    return scene


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
    """Return a text with its {{names}} filled in."""
    return re.sub(r"\{\{(\w+)\}\}", lambda name: parts[name[1]], text)


def open_page(page: Document, path: str | None = None) -> None:
    """Open a page that was written to a file, else one of a new file, in the user's browser.

    Raises LagtopError where there is no browser.
    """
    if path is None:
        path = str(Path(tempfile.mkdtemp(prefix="lagtop-")) / "top.html")
        page.save(path)
    if not webbrowser.open(Path(path).resolve().as_uri()):
        raise LagtopError(f"open found no browser; the page is {path}", "open")


def joined_script() -> str:
    """Return the page's main module and all that it imports, each before who needs it, as a script.

    Each becomes a function that is called once, so that its own names stay its own.
    """
    scripts: dict[str, str] = {}
    _collect("page/main.js", scripts)
    return "\n".join(["const modules = {};", *scripts.values()])


def _collect(name: str, scripts: dict[str, str]) -> None:
    """Add the script of a module after those of the modules it imports."""
    text = text_of(name)
    for match in _IMPORT.finditer(text):
        path = _resolved(name, match[2])
        if path not in scripts:
            _collect(path, scripts)
    body = _IMPORT.sub(lambda found: _taken(name, *found.groups()), _EXPORT.sub("", text))
    shown = ", ".join(_EXPORT.findall(text))
    scripts[name] = f'modules["{name}"] = (() => {{\n{body}\nreturn {{ {shown} }};\n}})();\n'


def _taken(name: str, names: str, other: str) -> str:
    """Return the line that takes names from a module that stands before."""
    return f'const {names} = modules["{_resolved(name, other)}"];'


def _resolved(name: str, other: str) -> str:
    """Return the path of a module that another one imports as `./x.js` or `../room/x.js`."""
    room = name.rpartition("/")[0]
    return other.removeprefix("../") if other.startswith("../") else f"{room}/{other[2:]}"


def text_of(name: str) -> str:
    """Return the text of a file of this folder."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
