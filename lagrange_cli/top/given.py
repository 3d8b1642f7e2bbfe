"""The inputs of a top, from options, Python and a scene file."""

from __future__ import annotations

import os
from collections.abc import Collection, Mapping
from fractions import Fraction
from types import MappingProxyType, NoneType
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.numbers import Real
from ..errors import LagtopError, check_type
from .inputs import (
    BODY,
    BODY_UNITS,
    DECLARED,
    FORMS,
    STEADY_WORDS,
    TILT,
    checked_double,
    from_example,
    one_of_each,
    overridden,
    warn_of,
)
from .ranges import Points
from .top import Top
from .units import EXAMPLES, Units, conversion
from .values import Value, tilt_key, values_of

if TYPE_CHECKING:
    from .scenes import SceneFile


class Given(NamedTuple):
    """The inputs of a top that were given, in SI if one of them has a unit other than a tilt."""

    values: Mapping[str, Value]
    """The values by key; the number of one may be the `Points` of a sweep or a `Span`."""
    si: bool
    missing: Mapping[str, float]
    """The body inputs taken from the worked example, in CGS, if only some of the body was given."""
    file: SceneFile | None = None
    options: Collection[str] = ()
    """The inputs that are not from the scene file."""

    @property
    def inputs(self) -> dict[str, Any]:
        """The numbers of the values, by key."""
        return {name: x.number for name, x in self.values.items()}

    @property
    def stds(self) -> dict[str, float]:
        """Standard uncertainties of the values that have one, by key."""
        return {name: float(x.std) for name, x in self.values.items() if x.std is not None}

    @property
    def is_body(self) -> bool:
        """Whether the top must be a body: its inputs have units, or some are of a real body."""
        return self.si or bool(self.missing)

    def units(self, *, radians: bool) -> Units:
        """Return the units of documents about the top."""
        return Units(radians, self.si)

    @property
    def body(self) -> Mapping[str, Real]:
        """The body of the worked example, in SI or CGS."""
        if not self.si:
            return BODY
        return {x: Fraction(y) * conversion(x, BODY_UNITS[x])[0] for x, y in BODY.items()}

    def top(self, *, exact: bool = False, without: Collection[str] = ()) -> Top:
        """Return the top, its inputs rounded to doubles or kept `exact`.

        The inputs in `without` are ignored: they default to the worked example.  Raises LagtopError
        for an impossible input, SceneError if it is in a file.
        """
        kept = {key: x for key, x in self.inputs.items() if key not in without}
        numbers = overridden(self.body, kept)
        is_derived = bool(FORMS.keys() & DECLARED.keys() & numbers.keys())
        exact = exact or (self.si and is_derived)  # then rounded once
        try:
            for key, x in numbers.items() if not exact else ():
                numbers[key] = x if x in STEADY_WORDS else checked_double(key, x)
            top = Top(**numbers)
            if self.is_body:
                self._check_body(top)
            return top
        except LagtopError as error:
            raise self.placed(error) from None

    def _check_body(self, top: Top) -> None:
        """Raise LagtopError for C > 2A; it names the moment that is a default."""
        try:
            top.check_body()
        except LagtopError as error:
            moment = next((name for name in ("A", "C") if name in self.missing), None)
            if moment is None:
                raise
            which = f"{moment} defaults to the worked example: give m, A, C, s and g"
            raise LagtopError(f"{error.marked}; {which}", error.key) from None

    def placed(self, error: LagtopError) -> LagtopError:
        """Return an error with the file and the line of its input, unless an option gives it."""
        return error if self.file is None or error.key in self.options else self.file.error(error)


def gather(
    given: Mapping[str, Value],
    path: str | None = None,
    *,
    units: bool = False,
    varying: Collection[str] = (),
    others: Mapping[str, Value] = MappingProxyType({}),
) -> Given:
    """Return the `given` inputs and those of a scene file, if any; given inputs override the file.

    Either all inputs must have units or none, also if one of the `others` has one, such as a time
    or the heading of a column, and if `units` is true.  `varying` names inputs that are given
    later.  Raises SceneError for a bad file, LagtopError for a bad given input.
    """
    own = {tilt_key(name, x): x for name, x in given.items()}
    file: SceneFile | None = None
    if path is not None:
        from .scenes import SceneFile  # start-up

        file = SceneFile(path)
    found = Given(overridden(file.inputs if file else {}, own), False, {}, file, own)
    try:
        one_of_each(found.values)
        si = have_units(overridden(found.values, others), asked=units)
    except LagtopError as error:
        raise found.placed(error) from None
    # The only value of an axis of a sweep counts as a number.
    fixed = {
        x: y.bounds()[0] if getattr(y, "count", 0) == 1 else y for x, y in found.inputs.items()
    }
    return found._replace(si=si, missing=from_example(dict.fromkeys(varying) | fixed))


def read_scene(
    path: str | os.PathLike[str], given: Mapping[str, Real] | None = None, *, exact: bool = False
) -> Top:
    """Return the top of a scene file; `given` inputs override those of the file.

    Numbers are rounded to doubles, or kept as `exact` decimals.  Numbers with units are converted
    to SI.  A MixedBodyWarning names the defaults if only some of the body is given.  Raises
    SceneError for a bad file, LagtopError for a bad given input.

    >>> read_scene("hanging-top", {"r0": 20}).r0
    20.0
    """
    check_type("given", given, Mapping, NoneType)
    found = gather(values_of(given or {}), os.fsdecode(path))
    top = found.top(exact=exact)
    if found.missing:
        warn_of(found.missing, stacklevel=3)
    return top


def have_units(values: Mapping[str, Value], *, asked: bool = False) -> bool:
    """Return whether inputs have units; a tilt, a time and a zero need none.

    Raises LagtopError for another input without a unit if some have one or units are `asked` for.
    """
    named = {name: x for name, x in values.items() if not name.startswith(TILT)}
    united = [name for name, x in named.items() if x.unit]
    for name, x in named.items() if united or asked else ():
        if name in DECLARED and not (x.unit or _is_zero(x.number)):
            other = f"the input {united[0]}" if united else "a time or a condition"
            example = EXAMPLES[DECLARED[name].unit]
            wanted = f"a unit such as {example}, because {other} has one"
            raise LagtopError(f"{name} must have {wanted}, got none", name)
    return bool(united) or asked


def _is_zero(number: Any) -> bool:
    """Return whether a number, all points or all elements of an array are 0; a word is, too."""
    if isinstance(number, str | Points):
        return isinstance(number, str) or number.bounds() == [0.0, 0.0]
    return bool(getattr(number == 0, "all", lambda: number == 0)())
