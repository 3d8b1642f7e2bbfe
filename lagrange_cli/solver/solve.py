"""`solve(top)`: the motion of one top, whose numbers are computed on first use."""

from __future__ import annotations

import warnings
from collections.abc import Callable, Collection, Sequence
from numbers import Integral
from types import NoneType
from typing import TYPE_CHECKING, Any

from ..errors import LagtopError, OutOfRangeWarning, check_type
from ..names import ANGLES, check_names
from ..top.top import Top
from ..top.units import Units
from .attitude import Swing
from .facts import facts_of
from .keys import KEYS, NUMBER_KEYS, NUMBERS, all_keys
from .record import Solution, record_in_range

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from numpy.typing import ArrayLike
    from scipy.spatial.transform import Rotation

    from ..arithmetic.types import Array
    from ..output.notebook import WebPage
    from .sampling import Angles


def solve(top: Top) -> Motion:
    """Return the motion of a top.  Raises LagtopError for an impossible start.

    >>> solve(Top(theta0_deg=30)).T_nutation
    0.4292501244785477
    """
    return Motion(facts_of(top))


class Motion(Solution):
    """The motion of one top: the numbers of its record as attributes, and its angles over time.

    Each number is correctly rounded, as proved by an enclosure on first use.  It is None if the
    regime has no such number.  The attributes are named like the keys of `lagtop solve`: a, b, u1,
    u2, u3, k, T_nutation, mean_precession_rate ... `record` returns all of them.

    >>> motion = solve(Top(theta0_deg=30))
    >>> motion.regime, motion.path, motion.remark
    (<Regime.REGULAR: 'regular'>, 'cusped', None)
    >>> motion.numbers()["k"], motion.record(digits=20, keys=["K"]), motion.top.r0
    (0.7623941363992914, {'K': '1.9298038860786499602'}, 50.0)
    >>> motion.angles([0.0, 0.1]).theta.shape, motion.axis([0.0, 0.1]).shape
    ((2,), (2, 3))
    >>> float(motion.rotation(0.0).magnitude()), list(motion.table(0.1, ["u", "phidot"]))
    (0.5235987755982988, ['u', 'phidot'])
    >>> axes, page = motion.plot("cubic"), motion.view()
    """

    def __dir__(self) -> Sequence[str]:
        """Return the public names: methods, and the keys of the record and further ones."""
        methods = vars(Motion) | vars(Solution)
        public = [name for name in methods if not name.startswith("_")]
        return [*public, "facts", *NUMBERS]

    def __eq__(self, other: object) -> bool:
        """Return whether `other` is the motion of the same top."""
        return isinstance(other, Motion) and other.top == self.top

    def __hash__(self) -> int:
        return hash(self.top)

    def __reduce__(self) -> tuple[Callable[[Top], Motion], tuple[Top]]:
        """Return the constructor and the top, for copies and pickles."""
        return solve, (self.top,)

    @property
    def swing(self) -> Swing | None:
        """The only swing on the separatrix: its `rate`, and the time `lowest`; else None.

        The cosine of the tilt is u = u2 + (1 - u2) tanh^2(rate (t - lowest)).  The rate, in radians
        per unit of time, and the time at which the axis is lowest are correctly rounded.
        """
        if not self.facts.separatrix:
            return None
        found = self.number("swing_rate"), self.number("lowest")
        return Swing(*(0.0 if x is None else float(x.value) for x in found))

    def numbers(self) -> dict[str, float | None]:
        """Return the numbers of the record by key, angles in degrees; see `record`."""
        record = self.record()
        return {name: record[name] for name in NUMBER_KEYS}

    def record(
        self,
        *,
        digits: int | None = None,
        radii: bool = False,
        radians: bool = False,
        keys: Collection[str] | None = None,
    ) -> dict[str, Any]:
        """Return inputs and results by key, in the order of the paper, in degrees or `radians`.

        Numbers are doubles or, with `digits`, texts with that number of significant digits; inputs
        are then taken as decimals.  `radii` adds KEY_radius, a bound on the distance from the
        double KEY, or with `digits` the decimal KEY, to its exact value.  A number beyond the range
        of doubles is None, and an OutOfRangeWarning names it.  `keys` selects some keys; such a
        number then raises OutOfRangeError.  Raises LagtopError for an unknown or repeated key or
        for no key, and if no precision distinguishes a number from 0.
        """
        units = Units(radians)
        if keys is not None:
            keys = check_names("keys", keys, all_keys(units))
        check_type("digits", digits, Integral, NoneType)
        if digits is not None and digits < 1:
            raise LagtopError(f"digits must be at least 1, got {digits}", "digits")
        record, beyond = record_in_range(self, digits=digits, radii=radii, units=units, keys=keys)
        if beyond and keys is not None:
            raise beyond[0]
        if beyond:
            warnings.warn("; ".join(map(str, beyond)), OutOfRangeWarning, stacklevel=2)
        return record

    def __repr__(self) -> str:
        return f"<Motion: {self.regime}, T_nutation = {self.T_nutation}, {self.top}>"

    def _repr_markdown_(self) -> str:
        from ..output.notebook import record_markdown  # start-up

        return record_markdown(self.record(), KEYS)

    def view(self) -> WebPage:
        """Return an animated page of the top, for a notebook or, with `save`, for a browser.

        Raises LagtopError for inputs beyond the range of the page's arithmetic.
        """
        from .. import view  # the face of the package: pictures are drawn by a subpackage above

        page: WebPage = view(self)
        return page

    def angles(self, t: ArrayLike, *, wrap: bool = False) -> Angles:
        """Return tilt, spin and precession (radians) at the times t, in the shape of t.

        Spin and precession are unwrapped and 0 at t = 0; `wrap` reduces them to (-pi, pi].  Raises
        LagtopError for a time that is not finite or is beyond 2^50 nutation periods or, with
        `wrap`, beyond 2^51 turns.
        """
        from .sampling import Angles  # start-up

        if self.sampler().is_ordinary:
            return self.sampler().angles(t, wrap=wrap)
        return Angles(**self.table(t, ANGLES, wrap=wrap))

    def axis(self, t: ArrayLike) -> Array:
        """Return the unit vector along the figure axis in space, of shape (*t.shape, 3).

        Raises LagtopError for a time out of range, as `angles` does.
        """
        import numpy as np

        columns = self.table(t, ["axis"])
        return np.stack([columns[f"axis_{x}"] for x in "xyz"], axis=-1)

    def rotation(self, t: ArrayLike) -> Rotation:
        """Return the rotations from body to space at a time, or at a list of n times.

        The result is a SciPy `Rotation`, single or a stack of n.  Raises LagtopError for a time out
        of range, and for times with more than one dimension.
        """
        import numpy as np
        from scipy.spatial.transform import Rotation  # start-up: heavy

        columns = self.table(t, ["quaternion"])
        quaternion = np.stack([columns[f"quaternion_{x}"] for x in "wxyz"], axis=-1)
        if quaternion.ndim > 2:
            shape = quaternion.shape[:-1]
            raise LagtopError(
                f"t must be a number or have one dimension, got the shape {shape}", "t"
            )
        return Rotation.from_quat(quaternion, scalar_first=True)

    def plot(self, kind: str = "sphere", ax: Any = None, **options: Any) -> list[Axes]:
        """Draw a picture of the motion: sphere, angles, cubic, phase or map; return its axes.

        `ax` is an `Axes` of matplotlib, or a list of them if the kind has several; by default a new
        figure is made.  `options` are those of `lagtop.draw`.  Raises LagtopError for an unknown
        kind, or if there is nothing to draw.
        """
        from .. import draw  # the face of the package: pictures are drawn by a subpackage above

        drawn: list[Axes] = draw(self, kind, ax, **options)
        return drawn

    def table(
        self,
        t: ArrayLike,
        columns: Sequence[str] = ("t", "theta", "phi", "psi"),
        *,
        wrap: bool = False,
    ) -> dict[str, Array]:
        """Return columns of `lagtop table` by name, each a float64 array in the shape of t.

        Angles are in radians, and `wrap` reduces phi and psi to (-pi, pi].  `axis`, `quaternion`,
        `matrix` and `omega` stand for several columns, which may also be named singly.  Raises
        LagtopError for an unknown or repeated column and for a time out of range.
        """
        from ..arithmetic.arrays import doubles_of  # start-up
        from .columns import chosen_columns
        from .tables import columns_at

        times, at = doubles_of("t", t), columns_at(self, columns, Units(radians=True), wrap=wrap)
        found = at(times.reshape(-1)).reshape(-1, *times.shape)
        return dict(zip(chosen_columns(columns), found, strict=True))
