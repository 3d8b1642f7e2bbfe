"""Pictures of motions: files, films, a page for the browser, and drawings on axes of your own."""

from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from .on_axes import (
        draw_angles,
        draw_cubic,
        draw_map,
        draw_phase,
        draw_remainders,
        draw_sphere,
    )

__all__ = [
    "draw_angles",
    "draw_cubic",
    "draw_map",
    "draw_phase",
    "draw_remainders",
    "draw_sphere",
]


def __getattr__(name: str) -> Any:
    """Return a function that draws; matplotlib is loaded only now."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from . import on_axes

    return getattr(on_axes, name)
