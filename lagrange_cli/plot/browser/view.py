"""The page of a top for the browser: one HTML file that needs no network and no other file."""

from __future__ import annotations

import json
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
from ...inputs.input_keys import DECLARED, NINE
from ...inputs.scenes import scene_names, scene_remark
from ...motion.explanation import listed
from ...motion.notebook import Document
from ...motion.record import KEYS
from ...motion.solve import Motion, solve
from ..style import DARK, LIGHT, Look

SHOWN = (
    "a b u1 u2 u3 k T_nutation T_spin T_precession theta_min_deg theta_max_deg mean_spin_rate "
    "mean_precession_rate"
).split()
"""The keys of the record that `motion.js` computes."""
TRACES = {LIGHT: "#472d7b", DARK: "#dde318"}
"""Colour of the path of the axis on each paper."""
SIGNS = {"positive": "be positive", "0 or more": "not be negative"}
"""The words of the page for the bound of an input."""
MOST = 1e30
"""Largest size of an input, and the inverse of the smallest, within the range of doubles."""


def view(motion: Motion, unit: Callable[[str], str] = str) -> Document:
    """Return the interactive page for the browser: the top in space, its curves and its numbers.

    `unit` names mass, len and time in the units of the inputs.  The page computes in doubles, to
    1e-6 rad over 20 nutations, and says where it is only a sketch.  Raises LagtopError for inputs
    outside 1e-30 to 1e30.

    >>> view(solve(Top()))[:15]
    '<!DOCTYPE html>'
    """
    check_type("motion", motion, Motion)
    style, motion_js, page_js, html = (
        files(__package__).joinpath(name).read_text(encoding="utf-8")
        for name in ("style.css", "motion.js", "page.js", "page.html")
    )
    data = json.dumps(page_data(motion, unit), ensure_ascii=False).replace("</", "<\\/")
    scripts = motion_js.replace("export ", "") + page_js
    parts = {
        "style": filled(style, {"light": colours(LIGHT), "dark": colours(DARK)}),
        "script": f"const DATA = {data};\n{scripts}",
    }
    for name, part in list(parts.items()):  # the content policy permits only these
        digest = b64encode(sha256(part.encode()).digest()).decode()
        parts[f"{name}_hash"] = f"'sha256-{digest}'"
    return Document(filled(html, parts))


def page_data(motion: Motion, unit: Callable[[str], str]) -> dict[str, Any]:
    """Return the constant DATA of the page."""
    formulas = {row.name: row.formula for row in listed()}
    inputs = {"theta0_deg" if name == "theta0" else name: DECLARED[name] for name in NINE}

    def described(key: Any, meaning: str, **more: str) -> dict[str, str]:
        unit_text = "°" if key.unit == "angle" else unit(key.unit)
        return {"symbol": key.symbol, "meaning": meaning, "unit": unit_text, **more}

    def sign(key: Any) -> str:
        return next((y for x, y in SIGNS.items() if key.bound.startswith(x)), "")

    return {
        "scene": page_scene(motion),
        "scenes": {
            name: {"remark": scene_remark(name), "inputs": page_scene(solve(read_scene(name)))}
            for name in scene_names()
        },
        "time": unit("time"),
        "inputs": {name: described(x, x.name, sign=sign(x)) for name, x in inputs.items()},
        "keys": {
            name: described(KEYS[name], KEYS[name].meaning, formula=formulas.get(name, ""))
            for name in SHOWN
        },
    }


def page_scene(motion: Motion) -> dict[str, float]:
    """Return the inputs of a motion as doubles, with the tilt in degrees.

    Raises LagtopError for an input out of the range of the page.
    """
    scene = {name: float(value) for name, value in motion.top.inputs().items()}
    for name, value in scene.items():
        if name != "theta0_deg" and value and not 1 / MOST <= abs(value) <= MOST:
            raise LagtopError(f"{name} must be from 1e-30 to 1e30 for a page, got {value}", name)
    return scene


def colours(look: Look) -> str:
    """Return the colours of a look as variables of the style sheet."""
    names = {name: getattr(look, name) for name in ("paper", "ink", "quiet", "faint")}
    names |= dict(zip(("blue", "red", "green"), look.lines, strict=True)) | {"trace": TRACES[look]}
    return " ".join(f"--{name}: {colour};" for name, colour in names.items())


def filled(text: str, parts: dict[str, str]) -> str:
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
