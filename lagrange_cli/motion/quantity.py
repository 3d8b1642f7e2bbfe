"""A quantity of a motion: a formula that is evaluated when it is asked for, and only once."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, Generic, TypeVar

V = TypeVar("V")


class quantity(Generic[V]):
    """A lazy attribute whose formula runs within the precision of the arithmetic of its object."""

    def __init__(self, formula: Callable[[Any], V]) -> None:
        self.formula = formula
        self.__doc__ = formula.__doc__

    def __set_name__(self, owner: type, name: str) -> None:
        self.name = name

    def __get__(self, motion: Any, owner: type | None = None) -> V:
        """Return the value, from now on an attribute of the object."""
        with motion.ar.working():
            value = self.formula(motion)
        vars(motion)[self.name] = value
        return value
