"""Combine the inputs from options and from a scene file into a top."""

from __future__ import annotations

import os
import re
from collections.abc import Collection, Mapping
from fractions import Fraction
from types import MappingProxyType, NoneType
from typing import TYPE_CHECKING, Any, NamedTuple

from ..arithmetic.numbers import Number
from ..errors import LagtopError, check_type
from .inputs import (
    BODY,
    BODY_UNITS,
    EXAMPLE,
    TILT,
    checked_double,
    from_example,
    one_of_each,
    overridden,
    warn_of,
)
from .ranges import Points
from .top import Top
from .values import STEADY_WORDS, Value, values_of

if TYPE_CHECKING:
    from .scenes import SceneFile
    from .units import System


class Given(NamedTuple):
    """Inputs of a top by key, all in SI if one of them has a unit."""

    inputs: Mapping[str, Any]
    """The given numbers; the `Points` of a sweep or the `Span` of a search in their place."""
    others: Mapping[str, Any]
    """Other quantities that may have units, such as times."""
    body: Mapping[str, Number]
    """The body of the worked example, in these units."""
    system: System | None
    """SI; None if the inputs have no units."""
    missing: Mapping[str, float]
    """The body inputs taken from the worked example, in CGS, if only some of the body was given."""
    stds: Mapping[str, float] = {}
    """Standard uncertainties of the inputs that have one, in these units."""
    file: SceneFile | None = None
    options: Collection[str] = ()
    """The inputs that are not from the scene file."""

    @property
    def empty(self) -> str | None:
        """The name of the scene file if it has no inputs, else None."""
        return self.file.name if self.file is not None and not self.file.inputs else None

    def top(self, *, exact: bool = False, without: Collection[str] = ()) -> Top:
        """Return the top, its inputs rounded to doubles or kept `exact`.

        The inputs in `without` are ignored: they default to the worked example.  Raises LagtopError
        for an impossible input, SceneError if it is in a file.
        """
        kept = {key: x for key, x in self.inputs.items() if key not in without}
        numbers = overridden(self.body, kept)
        try:
            if self.system is not None and numbers.get("psidot0") not in STEADY_WORDS:
                from .derived import as_solved  # start-up

                numbers = as_solved(overridden(EXAMPLE, numbers))  # from exact numbers, once
            return Top(
                **{
                    key: x if exact or x in STEADY_WORDS else checked_double(key, x)
                    for key, x in numbers.items()
                }
            )
        except LagtopError as error:
            moments = [name for name in ("A", "C") if name in self.missing]
            if moments and error.key in {"A", "C"}:
                which = f"{' and '.join(moments)} of the worked example"
                error = LagtopError(f"{error} (with {which}: give the whole body)", error.key)
            raise _of_file(self.file, error, self.options) from None


def _of_file(file: SceneFile | None, error: LagtopError, options: Collection[str]) -> LagtopError:
    """Return an error with the file and the line of its input, unless an option gives it."""
    return error if file is None or error.key in options else file.error(error)


def gather(
    given: Mapping[str, Value],
    path: str | None = None,
    *,
    units: bool = False,
    varying: Collection[str] = (),
    others: Mapping[str, Value] = MappingProxyType({}),
) -> Given:
    """Return the `given` inputs and those of a scene file, if any; given inputs override the file.

    Inputs with units are converted to SI, and so are `others`, such as times or the units of
    columns.  If `units` is true, inputs must have units.  `varying` names inputs that are given
    later.  Raises SceneError for a bad file, LagtopError for a bad given input.
    """
    inputs = {TILT if x.unit and name.startswith(TILT) else name: x for name, x in given.items()}
    file: SceneFile | None = None
    if path is not None:
        from .scenes import SceneFile  # start-up

        file = SceneFile(path)
        inputs = overridden(file.inputs, inputs)
    system: System | None = None
    body: Mapping[str, Number] = BODY
    try:
        one_of_each(inputs)
        if units or any(x.unit for x in (*inputs.values(), *others.values())):
            from .units import factor_of  # start-up

            system = system_of(overridden(inputs, others), asked=units)
            inputs, others = converted(inputs), converted(others)
            if system:
                body = {x: Fraction(y) * factor_of(x, BODY_UNITS[x]) for x, y in BODY.items()}
    except LagtopError as error:
        raise _of_file(file, error, given) from None
    stds = {name: float(x.std) for name, x in inputs.items() if x.std is not None}
    numbers, known = ({name: x.number for name, x in values.items()} for values in (inputs, others))
    # The only value of an axis of a sweep counts as a number.
    fixed = {x: y.bounds()[0] if getattr(y, "count", 0) == 1 else y for x, y in numbers.items()}
    missing = from_example(dict.fromkeys(varying) | fixed)
    return Given(numbers, known, body, system, missing, stds, file, given)


def read_scene(
    path: str | os.PathLike[str], given: Mapping[str, Number] | None = None, *, exact: bool = False
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


def converted(inputs: Mapping[str, Value]) -> dict[str, Value]:
    """Return inputs in SI; a tilt with a unit becomes degrees or radians.

    Raises LagtopError for a unit of other dimensions.
    """
    from . import units  # start-up

    found: dict[str, Value] = {}
    for key, value in inputs.items():
        if not value.unit:
            found[key] = value
        elif key == TILT:
            units.factor_of(key, value.unit)  # refuses other dimensions
            wanted = "deg" if units.unit_of_text(value.unit).power_of_pi else "rad"
            found[f"{TILT}_{wanted}"] = value.scaled(units.factor_of(key, value.unit, wanted))
        else:
            found[key] = value.scaled(units.factor_of(key, value.unit))
    return found


def system_of(inputs: Mapping[str, Value], *, asked: bool = False) -> System | None:
    """Return SI if inputs have units, or None if none has one, or only a tilt.

    A tilt, a time and a zero need no unit.  Raises LagtopError for another input without a unit if
    some have one, or if units are `asked` for.
    """
    from . import units  # start-up

    united = [key for key, x in inputs.items() if x.unit and key != TILT]
    named = [x for x in inputs if x in units.UNIT_OF and not x.startswith(TILT)]
    bare = [x for x in named if not (inputs[x].unit or _is_zero(inputs[x].number))]
    if bare and (united or asked):
        why = f"as {united[0]} has" if united else "as a time or a condition has"
        number, example = inputs[bare[0]].number, units.EXAMPLES[units.UNIT_OF[bare[0]]]
        if isinstance(number, Fraction) and number != 1:  # a heading of a file counts as 1
            example = re.sub(r"[\d.e-]*\d", f"{float(number):g}", example, count=1)
        raise LagtopError(f"{bare[0]} must have a unit such as {example}, {why}, got none", bare[0])
    return units.SI if united or asked else None


def _is_zero(number: Any) -> bool:
    """Return whether a number, all points or all elements of an array are 0; a word is, too."""
    if isinstance(number, str | Points):
        return isinstance(number, str) or number.bounds() == [0.0, 0.0]
    return bool(getattr(number == 0, "all", lambda: number == 0)())
