"""Combine the inputs from options and from a scene file into a top."""

from __future__ import annotations

import os
from collections.abc import Callable, Collection, Mapping
from fractions import Fraction
from types import MappingProxyType, NoneType
from typing import TYPE_CHECKING, Any

from ..arithmetic.numbers import Number
from ..arithmetic.values import Values
from ..errors import LagtopError, check_type
from .input_keys import BODY, TILT, checked_double, from_example, one_of_each, overridden, warn_of
from .top import Top
from .value import STEADY_WORDS, InputPair, Stds, Value, values_of

if TYPE_CHECKING:
    from .scene_file import SceneFile
    from .units import System


class Given(Values):
    """Inputs of a top by key, all in units of one system."""

    inputs: Mapping[str, Any]
    """The given numbers; the `Points` of a sweep or the `Span` of a search in their place."""
    others: Mapping[str, Any]
    """Other quantities that may have units, such as times."""
    body: Mapping[str, Number]
    """The body of the worked example, in these units."""
    system: System | None
    """The system of units; None if the inputs have no units."""
    missing: Mapping[str, float]
    """The body inputs taken from the worked example, in CGS, if only some of the body was given."""
    blame: Callable[[LagtopError], LagtopError]
    """Adds the file and the line to an error about an input of a scene file."""
    stds: Stds = Stds({})
    """Standard uncertainties of the inputs that have one, in these units."""
    empty: str | None = None
    """The name of the scene file if it has no inputs, else None."""

    def top(self, *, exact: bool = False, without: Collection[str] = ()) -> Top:
        """Return the top, its inputs rounded to doubles or kept `exact`.

        The inputs in `without` are ignored: they default to the worked example.  Raises LagtopError
        for an impossible input, SceneError if it is in a file.
        """
        kept = {key: x for key, x in self.inputs.items() if key not in without}
        numbers = overridden(self.body, kept).items()
        try:
            kept = {
                key: x if exact or x in STEADY_WORDS else checked_double(key, x)
                for key, x in numbers
            }
            return Top(**kept)
        except LagtopError as error:
            raise self.blame(_not_given(error, self.missing)) from None


def gather(
    given: Mapping[str, Value],
    path: str | None = None,
    *,
    system: str | None = None,
    varying: Collection[str] = (),
    others: Mapping[str, Value] = MappingProxyType({}),
) -> Given:
    """Return the `given` inputs and those of a scene file, if any; given inputs override the file.

    Inputs with units are converted to a `system`, `si` (the default) or `cgs`.  So are `others`,
    such as times or the units of columns.  `varying` names inputs that are given later.  Raises
    SceneError for a bad file, LagtopError for a bad given input.
    """
    inputs = {TILT if x.unit and name.startswith(TILT) else name: x for name, x in given.items()}
    file: SceneFile | None = None
    correlations: dict[InputPair, Fraction] = {}
    if path is not None:
        from .scene_file import SceneFile  # start-up

        file = SceneFile(path)
        own = file.inputs.keys() - inputs.keys()
        inputs = overridden(file.inputs, inputs)
        own &= inputs.keys()
        correlations = {pair: r for pair, r in file.correlations.items() if pair <= own}

    def blame(error: LagtopError) -> LagtopError:
        return error if file is None or error.key in given else file.error(error)

    units: System | None = None
    body: Mapping[str, Number] = BODY
    try:
        one_of_each(inputs)
        if system or any(x.unit for x in (*inputs.values(), *others.values())):
            from .units import converted, system_of  # start-up

            units = system_of(overridden(inputs, others), system)
            inputs, others = converted(inputs, units), converted(others, units)
            body = units.worked_example() if units else BODY
    except LagtopError as error:
        raise blame(error) from None
    tilt = next((name for name in inputs if name.startswith(f"{TILT}_")), TILT)
    stds = Stds(
        {name: float(x.std) for name, x in inputs.items() if x.std is not None},
        {InputPair(tilt if x == TILT else x for x in pair): r for pair, r in correlations.items()},
    )
    numbers, known = ({name: x.number for name, x in values.items()} for values in (inputs, others))
    missing = from_example(
        dict.fromkeys(varying) | {name: _if_one(x) for name, x in numbers.items()}
    )
    empty = file.name if file is not None and not file.inputs else None
    return Given(numbers, known, body, units, missing, blame, stds, empty)


def _if_one(value: Any) -> Any:
    """Return a number as it is, and the only value of a sweep's axis with one value."""
    return value.bounds()[0] if getattr(value, "count", 0) == 1 else value


def _not_given(error: LagtopError, missing: Collection[str]) -> LagtopError:
    """Return an error about A and C, with a remedy if one of them was not given."""
    moments = [name for name in ("A", "C") if name in missing]
    if not moments or error.key not in {"A", "C"}:
        return error
    which = f"{' and '.join(moments)} of the worked example"
    return LagtopError(f"{error} (with {which}: give the whole body)", error.key)


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
