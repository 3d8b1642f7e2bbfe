"""The page of a top for the browser: one HTML file that needs no network and no other file.

Its scripts receive inputs, keys, words, scenes and limits as JSON and repeat none of them.
"""

from __future__ import annotations

import json
import posixpath
import re
import tempfile
import webbrowser
from base64 import b64encode
from collections.abc import Callable
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

from ...errors import LagtopError, check_type
from ...inputs.given import read_scene
from ...inputs.input_keys import DECLARED, NINE, TILT, Input
from ...inputs.scenes import scene_names, scene_remark
from ...inputs.top import Top
from ...motion.explanation import listed
from ...motion.notebook import Document
from ...motion.record import KEYS, requested_keys
from ...motion.solve import Motion, solve
from ...motion.summary import PHRASES
from ..style import DARK, LIGHT, Look

_IMPORT = re.compile(r'^import \{[^}]*\} from "([^"]+)";\n', re.MULTILINE)

HEIGHT, RADIUS, WEDGES = 0.62, 0.34, 24

TITLES: list[tuple[dict[str, Any], str]] = [
    ({"regime": "sleeping", "stable": True}, "sleeping, stable"),
    ({"regime": "sleeping"}, "sleeping, unstable"),
    ({"regime": "hanging"}, "hanging, stable"),
    ({"regime": "torque-free"}, "torque-free"),
    ({"regime": "separatrix"}, "separatrix, rises to upright for ever"),
    ({"regime": "steady precession"}, "steady precession"),
    ({"plane": True}, "plane pendulum"),
    ({"regime": "no spin"}, "no spin"),
    ({"constant": True}, "almost steady precession"),
    ({"fast": True}, "pseudo-regular precession"),
    ({"path": "cusped"}, "cusped path"),
    ({"path": "looping"}, "looping path"),
    ({}, "wavy path"),
]

_TRACES = {LIGHT: "#472d7b", DARK: "#dde318"}
"""Colour of the path of the axis on each paper: an end of viridis, unlike the colours of angles."""

SMALLEST, LARGEST = 1e-30, 1e30
"""Limits of the sizes of inputs; other sizes would leave the range of doubles."""
LEAST_TILT = 9e-13
"""Least tilt (degrees) from the vertical; it allows the double next to 180 - 1e-12."""

FACTOR = "stability_factor"
"""The key on request that the page shows below a and b."""

PageScene = dict[str, float]


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
        "script": joined_script(page_data(motion, unit)),
    }
    hashes = {f"{name}_hash": _hash(parts[name]) for name in ("style", "script")}
    return Document(_filled(_text_of("index.html"), parts | hashes))


def _hash(text: str) -> str:
    """Return the source of a content policy that permits only this style or script."""
    return f"'sha256-{b64encode(sha256(text.encode()).digest()).decode()}'"


def _colours(look: Look) -> str:
    """Return the colours of a look as variables of the style sheet."""
    names = {name: getattr(look, name) for name in ("paper", "ink", "quiet", "faint")}
    names |= dict(zip(("blue", "red", "green"), look.lines, strict=True)) | {"trace": _TRACES[look]}
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

    Their names are all different, as one scope holds them.  `data` is the module `data.js`.
    """
    scripts = {"data.js": data}

    def add(name: str) -> None:
        """Add the script of a module after those of the modules it imports."""
        text = _text_of(name)
        for other in _IMPORT.findall(text):
            path = posixpath.normpath(f"{posixpath.dirname(name)}/{other}")
            if path not in scripts:
                add(path)
        scripts[name] = re.sub(r"^export ", "", _IMPORT.sub("", text), flags=re.MULTILINE)

    add("page/main.js")
    return "".join(scripts.values())


def page_data(motion: Motion, unit: Callable[[str], str]) -> str:
    """Return the constants of `data.js` for a motion; their JSON is safe inside a script.

    `unit` returns the unit of `mass`, `len` and `time` in the inputs.  Raises LagtopError as
    `page_scene` does.
    """
    data = {
        "SCENE": page_scene(motion),
        "UNITS": {name: unit(name) for name in ("mass", "len", "time")},
        "EXAMPLES": {
            name: {"remark": scene_remark(name), "inputs": page_scene(solve(read_scene(name)))}
            for name in scene_names()
        },
        "INPUTS": {_key(name): _input(DECLARED[name]) for name in NINE},
        "KEYS": _keys(),
        "PHRASES": {"title": TITLES} | PHRASES,
        "CONE": {"height": HEIGHT, "radius": RADIUS, "wedges": WEDGES},
        "LIMITS": {"least": SMALLEST, "largest": LARGEST, "tilt": LEAST_TILT},
    }
    texts = {name: json.dumps(value, ensure_ascii=False) for name, value in data.items()}
    return "".join(f"const {x} = {text};\n" for x, text in texts.items()).replace("</", "<\\/")


def page_scene(motion: Motion) -> PageScene:
    """Return the inputs of the page as doubles, with the tilt in degrees.

    Raises LagtopError for inputs out of the range of the page.
    """
    scene = {name: float(value) for name, value in motion.top.inputs().items()}
    tilt = scene[_key(TILT)]
    if 0 < min(tilt, 180 - tilt) < LEAST_TILT:
        raise LagtopError(
            f"theta0_deg must be 0, 180 or 1e-12 from both for a page, got {tilt}", "theta0_deg"
        )
    for name, value in scene.items():
        if name != _key(TILT) and value and not SMALLEST <= abs(value) <= LARGEST:
            raise LagtopError(f"{name} must be from 1e-30 to 1e30 for a page, got {value}", name)
    solve(Top(**scene))  # a tilt in radians may round to the vertical, where nothing precesses
    return scene


def _key(name: str) -> str:
    """Return the key of an input in a scene of the page."""
    return f"{name}_deg" if name == TILT else name


def _keys() -> dict[str, dict[str, str]]:
    """Return the declarations of the keys of the page, each with its formula in symbols.

    They are the keys of a record and the stability factor.
    """
    formulas = {row.name: row.formula for row in listed()}
    keys = KEYS | {FACTOR: requested_keys()[FACTOR]._replace(group=KEYS["a"].group)}
    groups = [key.group for key in keys.values()]
    return {
        name: key._replace(formula=formulas.get(name, ""))._asdict()
        for name, key in sorted(keys.items(), key=lambda item: groups.index(item[1].group))
    }


def _input(declared: Input) -> dict[str, str]:
    """Return symbol, name, unit and allowed sign of an input."""
    signs = {"positive": "positive", "0 or more": "not negative"}
    sign = next((sign for bound, sign in signs.items() if declared.bound.startswith(bound)), "any")
    named = {name: getattr(declared, name) for name in ("symbol", "name", "unit")}
    return named | {"sign": sign}


def _text_of(name: str) -> str:
    """Return the text of a file of this folder."""
    return files(__package__).joinpath(name).read_text(encoding="utf-8")
