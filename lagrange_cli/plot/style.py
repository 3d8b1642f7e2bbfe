"""The look of pictures, light and dark, and the files that hold them.

Tilt is blue, spin orange and precession green, in every picture and on the page.  The colours
follow Okabe and Ito; on white they are darker, so that letters have a contrast of 4.5.
"""

from __future__ import annotations

import io
import logging
import os
import warnings
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

from ..errors import LagtopError, OutOfRangeError, UnavailableError, install
from ..file_bytes import extension
from ..names import listed
from ..output.terminal import one_line

if TYPE_CHECKING:
    from matplotlib.figure import Figure

LEAST_DPI, MOST_DPI, MOST_PIXELS = 20.0, 1000.0, 5e7


class Look(NamedTuple):
    """The colours of a picture on light or on dark paper."""

    paper: str
    ink: str
    quiet: str
    """Colour of circles, axes and mean rates."""
    faint: str
    """Colour of areas."""
    lines: tuple[str, str, str]
    """Colours of tilt, spin and precession."""
    scale: tuple[float, float]
    """The part of viridis that stands out from the paper."""


LIGHT = Look(
    "#ffffff", "#1a1a1a", "#6b6b6b", "#e9eef2", ("#0058a8", "#c04f00", "#008656"), (0, 0.85)
)
DARK = Look(
    "#14181d", "#ececec", "#9a9fa5", "#252c34", ("#56b4e9", "#e69f00", "#3ddc97"), (0.25, 1)
)


@contextmanager
def styled(look: Look) -> Iterator[None]:
    """Draw with our style sheet, whatever the user's own matplotlibrc contains."""
    from matplotlib import rc_context, style

    settings = {
        look.paper: "axes.facecolor figure.facecolor savefig.facecolor",
        look.ink: "axes.labelcolor text.color xtick.labelcolor ytick.labelcolor",
        look.quiet: "axes.edgecolor xtick.color ytick.color",
    }
    colours = {name: colour for colour, names in settings.items() for name in names.split()}
    with rc_context(), warnings.catch_warnings():
        warnings.filterwarnings("ignore", "Glyph .* missing")  # a font of the user has it or not
        style.use(["default", Path(__file__).with_name("lagtop.mplstyle"), colours])
        yield


def plain(text: str) -> str:
    """Return a text from outside that matplotlib draws as it is, on one line."""
    return one_line(text).replace("$", r"\$")


def require_matplotlib() -> None:
    """Raise UnavailableError, with the remedy, if matplotlib is missing or cannot be used."""
    logging.getLogger("matplotlib").setLevel(logging.ERROR)  # such as about its folder of settings
    try:
        import matplotlib  # noqa: F401
    except (ImportError, ValueError, MemoryError) as error:  # such as a wrong MPLBACKEND
        if isinstance(error, ModuleNotFoundError) and error.name == "matplotlib":
            raise UnavailableError(f"pictures need matplotlib: {install('plot')}") from None
        why = str(error) or "out of memory"
        raise UnavailableError(f"cannot import matplotlib: {why}") from None


def check_picture(path: str, formats: tuple[str, ...], report: str = "-") -> str:
    """Return the format that the name of a picture selects.

    Raises LagtopError for another extension, and if the `report` beside the picture has the same
    name.
    """
    if (suffix := extension(path)) not in formats:
        wanted = listed(formats, ".")
        raise LagtopError(f"the name of a picture must end in {wanted}, got {path!r}")
    if os.path.realpath(path) == os.path.realpath(report):
        raise LagtopError(f"the picture must not be the file of the report, got {path!r}")
    require_matplotlib()
    return suffix


def figure_bytes(figure: Figure, fmt: str, dpi: float, title: str, text: str) -> bytes:
    """Return a figure as `png`, `svg` or `pdf`, with its title and a description in words.

    Raises LagtopError for more than 50 million pixels.
    """
    width, height = figure.get_size_inches() * dpi
    if fmt == "png" and width * height > MOST_PIXELS:
        most = (MOST_PIXELS / (width * height)) ** 0.5 * dpi
        raise LagtopError(f"dpi must be at most {most:.0f} for this picture, got {dpi:g}", "dpi")
    about = {"Title": title, "Subject" if fmt == "pdf" else "Description": text}
    about = {name: one_line(words) for name, words in about.items()}
    buffer = io.BytesIO()
    figure.savefig(buffer, format=fmt, dpi=dpi, metadata=about)
    return buffer.getvalue()


@contextmanager
def drawing(look: Look) -> Iterator[None]:
    """Draw for a command, as `styled` does, without warnings of matplotlib.

    Raises LagtopError if matplotlib cannot draw the picture.
    """
    with styled(look):
        warnings.simplefilter("ignore", UserWarning)
        try:
            yield
        except LagtopError as error:
            if not isinstance(error, OutOfRangeError) or error.key == "t":
                raise
            wrong = "numbers of this top are too large or too small for a picture"
            raise OutOfRangeError(f"{wrong}: choose other units") from None
        except (ArithmeticError, LookupError, RuntimeError, ValueError) as error:
            raise LagtopError(f"matplotlib cannot draw this picture: {error}") from error


def report_bytes(path: str, draw: Callable[..., Figure], *args: object) -> bytes:
    """Return the picture that `draw` makes of some arguments, in the format of the file name."""
    with drawing(LIGHT):
        return figure_bytes(draw(*args), extension(path), 150, "lagtop", "a report")
