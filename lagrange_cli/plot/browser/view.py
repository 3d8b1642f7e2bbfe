"""The page of a top for the browser: one HTML file that needs no network and no other file."""

from __future__ import annotations

import json
import math
import tempfile
import webbrowser
from base64 import b64encode
from collections.abc import Callable
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

from ...account.summary import PHRASES
from ...errors import LagtopError, UnavailableError, check_type
from ...output.notebook import WebPage
from ...solver.keys import NUMBERS
from ...solver.solve import Motion, solve
from ...top.given import read_scene
from ...top.inputs import DECLARED
from ...top.scenes import scene_names

_SHOWN = "symbol", "meaning", "unit"
"""What the page shows of a key."""


def view(motion: Motion, unit: Callable[[str], str] = str) -> WebPage:
    """Return the interactive page for the browser: the top in space, its curves and its numbers.

    `unit` names mass, len and time in the units of the inputs.  The page computes in doubles, to
    1e-7 rad over 20 nutations.  It marks itself as a sketch, with the reason, if doubles do not
    decide its words or lose its numbers.  Raises LagtopError for inputs outside 1e-30 to 1e30.

    >>> view(solve(Top()))[:15]
    '<!DOCTYPE html>'
    """
    check_type("motion", motion, Motion)
    html, style, motion_js, page_js = (
        files(__package__).joinpath(name).read_text(encoding="utf-8")
        for name in ("page.html", "style.css", "motion.js", "page.js")
    )
    data = json.dumps(page_data(motion, unit), ensure_ascii=False).replace("</", "<\\/")
    script = f"const DATA = {data};\n{motion_js.replace('export ', '')}{page_js}"
    for name, part in (("style", style), ("script", script)):
        digest = b64encode(sha256(part.encode()).digest()).decode()
        html = html.replace(f"{{{name} hash}}", f"'sha256-{digest}'")  # permits only this part
        html = html.replace(f"{{{name}}}", part)
    return WebPage(html)


def page_data(motion: Motion, unit: Callable[[str], str]) -> dict[str, Any]:
    """Return the constant DATA of the page."""
    scene = page_scene(motion)
    inputs = {name: DECLARED[name.removesuffix("_deg")] for name in motion.top.inputs()}
    units = {x.unit for x in inputs.values()} | {x.unit for x in NUMBERS.values()}
    return {
        "scene": scene,
        "scenes": {name: page_scene(solve(read_scene(name))) for name in scene_names()},
        "units": {x: unit(x) for x in sorted(units)},
        "phrases": PHRASES,
        "inputs": {name: x._asdict() for name, x in inputs.items()},
        "keys": {x: {z: getattr(y, z) for z in _SHOWN} for x, y in NUMBERS.items()},
    }


def page_scene(motion: Motion) -> dict[str, float]:
    """Return the inputs of a motion as doubles, with the tilt in degrees, and whether it is steady.

    A rate of steady precession that is rounded to a double does not show that.

    Raises LagtopError for an input out of the range of the page.
    """
    scene = {name: float(value) for name, value in motion.top.inputs().items()}
    for name, value in scene.items():
        if name != "theta0_deg" and value and not 1e-30 <= abs(value) <= 1e30:
            raise LagtopError(f"{name} must be from 1e-30 to 1e30 for a page, got {value}", name)
    if not motion.facts.pole:  # a tilt next to the vertical must not become vertical
        scene["theta0_deg"] = min(max(scene["theta0_deg"], 1e-300), math.nextafter(180, 0))
    return scene | {"steady": motion.facts.steady}


def open_page(page: WebPage, path: str | None) -> None:
    """Open a page in the user's browser, from the file at `path` or from a new temporary file.

    Raises UnavailableError if no browser is found.
    """
    if path is None:
        path = str(Path(tempfile.mkdtemp(prefix="lagtop-")) / "top.html")
        page.save(path)
    if not webbrowser.open(Path(path).resolve().as_uri()):
        raise UnavailableError(f"open found no browser; the page is {path}", "open")
