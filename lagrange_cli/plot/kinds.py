"""The kinds of picture: a table from which the command, its help and the page are generated.

Each kind has a function `NAME_picture(motion, request, places)` in a file of this subpackage.  It
computes the picture, draws it on the axes of a page or of a user, and returns its title.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from importlib import import_module
from typing import TYPE_CHECKING, Any, NamedTuple, TypeAlias

from ..arithmetic.numbers import angle_unit
from ..output.terminal import Progress, silent
from .style import DARK, LIGHT, Look

if TYPE_CHECKING:
    from matplotlib.axes import Axes

    from ..arithmetic.types import Array
    from ..arithmetic.values import Key
    from ..inputs.input_keys import Input
    from ..inputs.units import System
    from ..motion.solve import Motion
    from ..motion.uncertainty import AngleStds, FirstOrder

MAP_KEY = "mean_precession_rate"
"""The key that a map shows by default."""

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
"""A few words on each motion: its path, or its regime if that is more informative.

They are chosen by the rules of `PHRASES`.  Only the browser page knows `plane`, `constant` and
`fast`.
"""


class InputRange(NamedTuple):
    """An input of the top and its values along one axis of a map."""

    name: str
    values: Array
    """Increasing values; a tilt in degrees."""
    logarithmic: bool = False
    """Whether the values grow by equal factors instead of equal steps."""

    def text(self) -> str:
        """Return the range as it is written on the command line."""
        first, last = (repr(float(self.values[i])) for i in (0, -1))
        steps = "log:" if self.logarithmic else ""
        return f"{self.name}={steps}{first}:{last}:{self.values.size}"


class PlotRequest(NamedTuple):
    """The options of a picture of a motion."""

    t_max: float | None = None
    """Last time of the pictures over time; by default each picture chooses its own."""
    radians: bool = False
    """Whether angles are in radians instead of degrees."""
    key: str = MAP_KEY
    """Key of the record that a map shows."""
    x: InputRange | None = None
    """Horizontal axis of a map; by default the spin."""
    y: InputRange | None = None
    """Vertical axis of a map; by default the tilt."""
    system: System | None = None
    """The units of the inputs, if they have units."""
    camera: tuple[float, float] | None = None
    """Azimuth and elevation (radians) of the camera; by default it sees most of the path."""
    colour_limits: tuple[float, float] | None = None
    """Ends of the colour scale of a map; by default all values but the outermost are within."""
    progress: Progress = silent
    """Reports the progress of a map or a film."""
    stds: AngleStds | None = None
    """Uncertainties of the angles, drawn as bands."""
    uncertain: FirstOrder | None = None
    """Uncertainties of the numbers beside several pictures."""
    look: Look = LIGHT
    """The colours."""

    def unit(self, unit: str) -> str:
        """Return a unit such as `rad/time` in the names of the units of the inputs."""
        return self.system.named(unit) if self.system else unit

    def in_words(self, remark: str) -> str:
        """Return a remark on the motion in the names of the units of the inputs."""
        return self.system.in_words(remark) if self.system else remark

    @property
    def time_label(self) -> str:
        """The label of an axis of time."""
        unit = self.unit("time")
        return f"time t ({'unit of the inputs' if unit == 'time' else unit})"

    def unit_of(self, key: Key | Input) -> str:
        """Return the unit of a key of the record or an input, in the units in use."""
        return self.angle_unit if key.unit == "angle" else self.unit(key.unit)

    @property
    def angle_unit(self) -> str:
        """The name of the unit of angles, as on an axis."""
        return angle_unit(radians=self.radians)[1]

    @property
    def per_radian(self) -> float:
        """The size of one radian in the unit of angles."""
        return angle_unit(radians=self.radians)[0]

    def options(self, kinds: Iterable[str]) -> list[str]:
        """Return the settings of some kinds that differ from the defaults, as command options."""
        given = {
            "t_max": self.t_max and repr(self.t_max),
            "key": self.key if self.key != MAP_KEY else None,
            "x": self.x and self.x.text(),
            "y": self.y and self.y.text(),
            "camera": self.camera and ",".join(f"{x * self.per_radian:.10g}" for x in self.camera),
            "colour_limits": self.colour_limits and ":".join(map(repr, self.colour_limits)),
        }
        taken = {name for kind in kinds for name in KINDS[kind].options}
        flags = ["--rad"] * self.radians + ["--dark"] * (self.look is DARK)
        return [f"{flag_of(x)} {y}" for x, y in given.items() if y and x in taken] + flags


def flag_of(name: str) -> str:
    """Return an option as it is written on a command line."""
    return f"--{name.replace('_', '-')}"


Places: TypeAlias = "Callable[[Sequence[float]], Sequence[Axes]]"
"""Returns axes, one below the other, for relative heights; a user may pass fewer axes."""


class PictureKind(NamedTuple):
    """A kind of picture."""

    name: str
    help: str
    """One line for the help of the command."""
    size: tuple[float, float]
    """Width and height (inches) of a page that holds only this picture."""
    options: tuple[str, ...] = ()
    """Fields of `PlotRequest` that the kind uses and others do not."""
    axes: int = 1
    """Number of axes that a user passes; several share the time axis."""
    file: str = ""
    """File that draws the picture; by default the file with the name of the kind."""

    def draw(self, motion: Motion, request: PlotRequest, places: Places) -> str:
        """Draw the picture and return its title; its file, and matplotlib, are loaded here.

        Raises LagtopError for an invalid request, and NothingToDrawError.
        """
        file = import_module(f".{self.file or self.name}", __package__)
        title: str = getattr(file, f"{self.name}_picture")(motion, request, places)
        return title


_OVER_TIME = ("t_max", "radians")
_OF_MAP = ("key", "x", "y", "colour_limits")
_SPHERE, _ANGLES, _REMAINDERS, _PLANE = (6.4, 6.0), (7.0, 6.0), (7, 5), (6.8, 5.0)
_ROWS = [
    PictureKind(
        "sphere", "the path of the figure axis on the unit sphere", _SPHERE, (*_OVER_TIME, "camera")
    ),
    PictureKind("angles", "tilt, spin and precession over time", _ANGLES, _OVER_TIME, axes=3),
    PictureKind(
        *("remainders", "periodic parts of spin and precession", _REMAINDERS, _OVER_TIME),
        axes=2,
        file="angles",
    ),
    PictureKind("cubic", "f(u), its roots, and the band of the motion", _PLANE),
    PictureKind(
        "phase", "tilt rate against tilt, and the separatrix", _PLANE, ("radians",), file="cubic"
    ),
    PictureKind("map", "a key of the record over two inputs", _PLANE, _OF_MAP),
]

KINDS = {kind.name: kind for kind in _ROWS}
"""The kinds by name, in the order of the help."""

SHEET = "all"
"""The name of the sheet, which holds several kinds."""

ON_THE_SHEET = ("sphere", "angles", "remainders", "cubic")
"""The kinds on the sheet, which the command draws by default."""

FILM_OPTIONS = ("t_max", "camera")
"""Fields of `PlotRequest` that a film uses."""


def help_lines() -> list[str]:
    """Return one aligned line per kind, and one for the sheet, for the help of the command."""
    sheet = f"{', '.join(ON_THE_SHEET[:-1])} and {ON_THE_SHEET[-1]}, with the record (default)"
    texts = {name: kind.help for name, kind in KINDS.items()} | {SHEET: sheet}
    width = max(map(len, texts))
    return [f"{name:{width}}  {text}" for name, text in texts.items()]
