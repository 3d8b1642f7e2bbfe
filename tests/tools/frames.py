"""The drawing of the frames in `sample_inputs/images`: `python tests/tools/frames.py` writes it."""

from __future__ import annotations

from collections.abc import Iterable
from pathlib import Path

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.spatial.transform import Rotation

PICTURE = Path(__file__).parents[2] / "sample_inputs" / "images" / "frames.svg"
PSI, THETA, PHI = 48.0, 42.0, 30.0
"""Degrees that keep all arcs apart."""
AZIMUTH, ELEVATION = np.radians([20.0, 20.0])
"""Where the drawing is seen from."""
SCALE, LEFT, TOP = 150.0, 222.0, 205.0
BLACK, BLUE, RED = "#222222", "#0072b2", "#d55e00"

Vector = NDArray[np.float64]


def seen(point: ArrayLike) -> tuple[float, float]:
    """Return where a point in space stands on the page."""
    right = [-np.sin(AZIMUTH), np.cos(AZIMUTH), 0]
    up = [
        -np.sin(ELEVATION) * np.cos(AZIMUTH),
        -np.sin(ELEVATION) * np.sin(AZIMUTH),
        np.cos(ELEVATION),
    ]
    x, y = np.dot(right, point), np.dot(up, point)
    return round(LEFT + SCALE * float(x), 1), round(TOP - SCALE * float(y), 1)


def line(points: Iterable[ArrayLike], colour: str, style: str = "") -> str:
    """Return a line through points in space."""
    path = " ".join(f"{x},{y}" for x, y in map(seen, points))
    return f'<polyline points="{path}" fill="none" stroke="{colour}" {style}/>'


def arrow(end: ArrayLike, colour: str) -> str:
    """Return an arrow from the pivot."""
    return line([[0, 0, 0], end], colour, f'stroke-width="1.8" marker-end="url(#{colour[1:]})"')


def arc(first: ArrayLike, second: ArrayLike, radius: float, colour: str) -> str:
    """Return the arc, with a head, from one direction to another."""
    a, b = np.asarray(first, float), np.asarray(second, float)
    angle = np.arccos(np.clip(a @ b, -1, 1))
    across = (b - a * (a @ b)) / np.sin(angle)
    points = [radius * (np.cos(x) * a + np.sin(x) * across) for x in np.linspace(0, angle, 30)]
    return line(points, colour, f'stroke-width="1.4" marker-end="url(#{colour[1:]})"')


def circle(first: Vector, second: Vector, colour: str) -> str:
    """Return the unit circle through two directions at right angles."""
    points = [np.cos(x) * first + np.sin(x) * second for x in np.linspace(0, 2 * np.pi, 91)]
    return line(points, colour, 'stroke-width="0.8" stroke-dasharray="3 3"')


def label(point: ArrayLike, text: str, colour: str, anchor: str = "middle") -> str:
    """Return a text at a point in space."""
    x, y = seen(point)
    return f'<text x="{x}" y="{y + 5}" fill="{colour}" text-anchor="{anchor}">{text}</text>'


def head(colour: str) -> str:
    """Return the definition of an arrow's head."""
    return (
        f'<marker id="{colour[1:]}" viewBox="0 0 10 10" refX="9" refY="5" markerWidth="7" '
        f'markerHeight="7" orient="auto"><path d="M0,1 L10,5 L0,9 z" fill="{colour}"/></marker>'
    )


def middle(first: Vector, second: Vector, radius: float) -> Vector:
    """Return the point between two directions, at a distance from the pivot."""
    between: Vector = first + second
    return radius * between / float(np.linalg.norm(between))


def drawing() -> str:
    """Return the picture: space in black, body in blue, angles in red."""
    x, y, z = np.eye(3)
    body = Rotation.from_euler("ZXZ", [PSI, THETA, PHI], degrees=True).as_matrix().T
    bx, by, bz = body
    node = np.array([np.cos(np.radians(PSI)), np.sin(np.radians(PSI)), 0])
    parts = [
        *(circle(x, y, BLACK), circle(bx, by, BLUE)),
        line([-node, 1.3 * node], RED, 'stroke-width="1" stroke-dasharray="7 3"'),
        *(arrow(1.3 * axis, BLACK) for axis in (x, y, z)),
        *(arrow(1.3 * axis, BLUE) for axis in (bx, by)),
        arrow(1.45 * bz, BLUE),
        *(arc(x, node, 0.55, RED), arc(z, bz, 0.7, RED), arc(node, bx, 0.8, RED)),
        label(1.4 * x, "x", BLACK),
        label(1.4 * y, "y", BLACK),
        label(1.4 * z, "z, up", BLACK),
        label(1.45 * bx, "x, p", BLUE),
        label(1.42 * by, "y, q", BLUE),
        label(1.56 * bz, "z, r0: the figure axis", BLUE),
        label(1.42 * node, "line of nodes", RED, "start"),
        label(middle(x, node, 0.68), "ψ", RED),
        label(middle(z, bz, 0.8), "ϑ", RED),
        label(middle(node, 0.3 * bx, 0.92), "φ", RED),
    ]
    style = 'font-family="DejaVu Sans, Arial, sans-serif" font-size="15"'
    lines = [
        '<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 460 335" width="460" height="335">',
        '<rect width="460" height="335" fill="white"/>',
        f"<defs>{''.join(map(head, (BLACK, BLUE, RED)))}</defs>",
        f"<g {style}>",
        *parts,
        "</g>",
        "</svg>",
    ]
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    PICTURE.write_text(drawing())
