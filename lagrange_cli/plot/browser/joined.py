"""The modules of the page, joined into one script that needs no other file."""

from __future__ import annotations

import re
from importlib.resources import files

_IMPORT = re.compile(r'^import (\{[^}]*\}) from "([^"]+)";$', re.MULTILINE)
_EXPORT = re.compile(r"^export (?=(?:function|class|const) (\w+))", re.MULTILINE)


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
