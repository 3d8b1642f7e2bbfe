"""The look of each method in a picture: a hue for its family, and a mark of its own.

The hues are as far from each other, from black and from white as a search could bring them for
normal, protan, deutan and tritan vision; a test simulates these.  Marks tell methods apart within
a family, and everything where there is no colour at all.
"""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any, NamedTuple

from ..plot.style import LIGHT
from .closed_forms import CLOSED_FORMS
from .front import OURS
from .work_precision import all_methods

HUES = {
    OURS: LIGHT.ink,
    "closed forms": "#005000",
    "scipy": "#c8a000",
    "heyoka": "#7828a0",
    "mujoco": "#2800eb",
    "exudyn": "#eb5078",
    "pybullet": "#00c8eb",
    "drake": "#780050",
}
"""Colours of the families, in the order of the legend."""
SHAPES = "os^Dv<>pP*Xhd"
"""Marks, which are first filled, and then empty."""


class Series(NamedTuple):
    """How the line of a method is drawn."""

    family: str
    mark: str
    is_filled: bool
    is_dashed: bool

    def look(self) -> dict[str, Any]:
        """Return the arguments of matplotlib's `plot`."""
        color = HUES.get(self.family, LIGHT.quiet)
        return {
            "color": color,
            "marker": self.mark,
            "markerfacecolor": color if self.is_filled else LIGHT.paper,
            "ls": "--" if self.is_dashed else "-",
            "lw": 2 if self.family == OURS else 1,
            "ms": 5,
        }


def series(names: Iterable[str]) -> dict[str, Series]:
    """Return the look of each method, by name, in the order of the legend.

    The two forms of an integrator share a mark, and that in Euler angles is dashed.
    """
    order = [*HUES, ""]
    listed = sorted(names, key=lambda name: order.index(_family(name)))
    marks = {stem: i for i, stem in enumerate(dict.fromkeys(map(_stem, listed)))}
    found = {}
    for name in listed:
        again, shape = divmod(marks[_stem(name)], len(SHAPES))
        is_dashed = _stem(name) != name and name.endswith("-euler")
        found[name] = Series(_family(name), SHAPES[shape], not again, is_dashed)
    return found


def _family(name: str) -> str:
    """Return the family of a method; "" for one that is not known."""
    method = all_methods(1.0).get(name)
    if name.startswith(OURS):
        return OURS
    if name in CLOSED_FORMS:
        return "closed forms"
    return (method.engine or method.package.partition(".")[0]) if method else ""


def _stem(name: str) -> str:
    """Return the name of an integrator without its form, and any other name as it is."""
    if _family(name) not in {"scipy", "heyoka", ""}:
        return name
    return name.removesuffix("-euler").removesuffix("-quaternion")
