"""The scene file of a motion that was found."""

from __future__ import annotations

from ..arithmetic.angles import per_radian
from ..output.terminal import one_line
from ..output.uncertain_text import uncertain_text
from .record import Outcome


def scene_text(outcome: Outcome, source: str) -> str:
    """Return a scene file of the motion, which every command reads."""
    lines = [
        f"# Found by `lagtop fit` from {one_line(source)}: the start is its first row, at "
        f"t = {outcome.recording.t_start!r}.",
        *(f"# {text}: one of them is put in." for text in outcome.untold()),
        *(f"# Warning: {text}." for text in outcome.warnings()),
    ]
    spread = {
        **{"theta0_deg" if x == "theta0" else x: (y, z) for x, y, z in outcome.found()},
        **{told.name: (told.value, deviation) for told, deviation in outcome.products()},
    }
    for name, value in outcome.inputs().items():
        found, deviation = spread.get(name, (0.0, 0.0))
        scale = per_radian(radians=name != "theta0_deg")
        told = f"  # {uncertain_text(found * scale, deviation * scale)}" if deviation else ""
        lines.append(f"{name} = {value!r}{told}")
    return "".join(f"{line}\n" for line in lines)
