"""Cheap classes: values with named fields, and generic classes over a type of numbers.

A named tuple or a dataclass compiles methods for every class, and `typing.Generic` records its
parameters.  With both, `lagtop solve` would take 7 % more time.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn, Self, dataclass_transform

__all__ = ["Key", "Over", "Values"]

if TYPE_CHECKING:
    from typing import Generic as Over
else:

    class Over:
        """A stand-in for `typing.Generic` at run time, when nobody asks for the parameters."""

        def __class_getitem__(cls, parameters: Any) -> type:
            """Return the class itself."""
            return cls


_SET = object.__setattr__


@dataclass_transform(frozen_default=True)
class Values:
    """Immutable values, one per annotated field of a class, in the order of the annotations.

    A field with a default may be left out.
    """

    __slots__ = ()
    fields: ClassVar[tuple[str, ...]] = ()

    def __init_subclass__(cls) -> None:
        """Take the fields from the annotations."""
        cls.fields = (*cls.fields, *cls.__annotations__)

    def __init__(self, *values: Any, **named: Any) -> None:
        if named or len(values) != len(self.fields):
            values = self._completed(values, named)
        for name, value in zip(self.fields, values, strict=True):
            _SET(self, name, value)

    def _completed(self, values: tuple[Any, ...], named: dict[str, Any]) -> tuple[Any, ...]:
        """Return a value for each field, with defaults for missing ones.

        Raises TypeError for unknown fields, and AttributeError for a missing field without a
        default.
        """
        given = dict(zip(self.fields, values, strict=False)) | named
        if len(given) < len(values) + len(named) or not given.keys() <= set(self.fields):
            raise TypeError(f"the fields of {type(self).__name__} are {', '.join(self.fields)}")
        return tuple(given[x] if x in given else getattr(self, x) for x in self.fields)

    def __iter__(self) -> Iterator[Any]:
        """Yield the values in the order of the fields."""
        return (getattr(self, name) for name in self.fields)

    def as_dict(self) -> dict[str, Any]:
        """Return the values by field."""
        return {name: getattr(self, name) for name in self.fields}

    def replace(self, **changes: Any) -> Self:
        """Return a copy with some values changed."""
        return type(self)(**(self.as_dict() | changes))

    def __setattr__(self, name: str, value: object) -> NoReturn:
        raise AttributeError(f"{type(self).__name__} cannot be changed: use replace()")

    def __delattr__(self, name: str) -> NoReturn:
        raise AttributeError(f"{type(self).__name__} cannot be changed")

    def __eq__(self, other: object) -> bool:
        return type(other) is type(self) and tuple(other) == tuple(self)

    def __hash__(self) -> int:
        return hash(tuple(self))

    def __repr__(self) -> str:
        inside = ", ".join(f"{name}={value!r}" for name, value in self.as_dict().items())
        return f"{type(self).__name__}({inside})"


class Key(Values):
    """The presentation of a number of a record; the unit `angle` stands for degrees or radians."""

    group: str
    symbol: str
    meaning: str
    unit: str = ""
    equation: str = ""
    formula: str = ""
    """The formula, written with names of keys, such as `2*m*g*s/A`; see `motion.explanation`."""
    absent: str = ""
    """The case in which the number does not exist, such as `if r0 = 0`, besides some regimes."""

    def in_units(self, *, radians: bool, named: Callable[[str], str] = str) -> Self:
        """Return the key with its unit as printed; `named` gives the names of units of a system."""
        angle = "rad" if radians else "deg"
        return self.replace(unit=angle if self.unit == "angle" else named(self.unit))
