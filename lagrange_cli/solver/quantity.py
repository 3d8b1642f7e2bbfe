"""Lazy quantities of a motion: formulas that are evaluated on first use, and only once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

from ..arithmetic.key import Key

V = TypeVar("V")


class quantity(Generic[V]):
    """A lazy attribute whose formula runs within the precision of the arithmetic of its object."""

    def __init__(self, formula: Callable[[Any], V], key: Key | None = None) -> None:
        self.formula, self.key = formula, key
        self.__doc__ = formula.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, motion: Any, owner: type | None = None) -> V:
        """Return the value and store it as an attribute of the object."""
        with motion.ar.working():
            value = self.formula(motion)
        vars(motion)[self.name] = value
        return value


def key(
    group: str,
    symbol: str,
    meaning: str,
    equation: str,
    formula: str,
    *,
    unit: str = "",
    only: str = "",
) -> Callable[[Callable[[Any], V]], quantity[V]]:
    """Make a method a quantity that is a key of the record; see `Key` for the arguments."""
    shown = Key(group, symbol, meaning, unit, equation, formula, only)

    def decorate(formula: Callable[[Any], V]) -> quantity[V]:
        return quantity(formula, shown)

    return decorate


def declared_keys(
    group: str,
    exists: Callable[[Any], object] = lambda of: True,
    *,
    unit: str = "",
    only: str = "",
) -> Callable[..., quantity[Any]]:
    """Return a function that declares a key of a group by its formula, without a method.

    The returned function takes the texts of `key`, the `value` as a function of the object, and
    keywords that override those given here.  The value is None unless `exists` is true of the
    object.
    """
    usual: dict[str, Any] = {"exists": exists, "unit": unit, "only": only}

    def declare(*texts: str, value: Callable[[Any], V], **changed: Any) -> quantity[V | None]:
        options = usual | changed
        there = options.pop("exists")
        return key(group, *texts, **options)(lambda of: value(of) if there(of) else None)

    return declare


def keys_of(owner: type) -> dict[str, Key]:
    """Return the keys of the record that a class computes, base classes first."""
    return {
        name: attribute.key
        for base in reversed(owner.__mro__)
        for name, attribute in vars(base).items()
        if isinstance(attribute, quantity) and attribute.key is not None
    }


def unit_name(name: str, *, radians: bool) -> str:
    """Return the name of a key in degrees or `radians`: `_deg` becomes `_rad`."""
    return f"{name.removesuffix('_deg')}_rad" if radians and name.endswith("_deg") else name


def degree_name(name: str) -> str:
    """Return the name of a key in degrees: `_rad` becomes `_deg`."""
    return f"{name.removesuffix('_rad')}_deg" if name.endswith("_rad") else name
