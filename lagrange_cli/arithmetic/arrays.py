"""Arrays of real numbers, given in Python; arithmetics of arrays: doubles, and pairs of doubles.

`ARRAYS` is what the functions of `elliptic` take for NumPy arrays; it says nothing of overflow and
0/0, whatever the host's `numpy.errstate` is.
"""

from __future__ import annotations

import sys
from contextlib import AbstractContextManager
from fractions import Fraction
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from ..errors import LagtopError
from .double_double import DoubleDouble
from .scalars import Unenclosed
from .sums_of_doubles import pair
from .text import quoted
from .types import Array


class Arrays(Unenclosed):
    """The arithmetic of float64 arrays, as far as both kinds of arrays share it."""

    is_array = True
    eps, magnitude = 2.0**-52, -15.65
    pi: Any = np.pi
    nan: Any = np.nan

    @staticmethod
    def working() -> AbstractContextManager[object]:
        """Return a context manager in which NumPy says nothing of overflow and 0/0."""
        return np.errstate(all="ignore")

    @staticmethod
    def convert(value: float | Fraction) -> Any:
        """Return the double nearest to an exact value."""
        return float(value)

    @staticmethod
    def sqrt(x: Any) -> Any:
        """Return the square roots."""
        return np.sqrt(x)

    @staticmethod
    def sin(x: Any) -> Any:
        """Return the sines."""
        return np.sin(x)

    @staticmethod
    def cos(x: Any) -> Any:
        """Return the cosines."""
        return np.cos(x)

    @staticmethod
    def atan2(y: Any, x: Any) -> Any:
        """Return the angles of the points (x, y)."""
        return np.arctan2(y, x)

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> Any:
        """Choose element by element."""
        return np.where(condition, yes, no)

    @staticmethod
    def anywhere(condition: Any) -> bool:
        """Return whether a condition holds for some element; NaN compares false, so loops end."""
        return bool(np.any(condition))

    @staticmethod
    def everywhere(condition: Any) -> bool:
        """Return whether a condition holds for every element."""
        return bool(np.all(condition))


class ArrayFunctions(Arrays):
    """The arithmetic of float64 and complex128 arrays, with the functions of NumPy by our names."""

    inf: Any = np.inf
    exp = staticmethod(np.exp)
    expm1 = staticmethod(np.expm1)
    log = staticmethod(np.log)
    log1p = staticmethod(np.log1p)
    sinh = staticmethod(np.sinh)
    cosh = staticmethod(np.cosh)
    asinh = staticmethod(np.arcsinh)
    tanh = staticmethod(np.tanh)
    atan = staticmethod(np.arctan)
    atanh = staticmethod(np.arctanh)
    sign = staticmethod(np.sign)
    nint = staticmethod(np.rint)
    re = staticmethod(np.real)
    im = staticmethod(np.imag)
    conj = staticmethod(np.conj)

    @staticmethod
    def convert(value: Any) -> Any:
        """Return the double nearest to an exact value, or an array of doubles as it is."""
        return value if isinstance(value, np.ndarray) else float(value)

    @staticmethod
    def mpc(real: Array, imag: Array) -> Any:
        """Return the complex numbers with these parts."""
        return np.asarray(real) + 1j * np.asarray(imag)


class Pairs(Arrays):
    """The arithmetic of arrays of pairs of doubles, as far as it is needed."""

    eps, magnitude = 2.0**-104, -31.31
    pi = DoubleDouble(np.array([np.pi]), np.array([1.2246467991473532e-16]))

    @staticmethod
    def convert(value: float | Fraction) -> Any:
        """Return an exact value as a pair with one element, which goes with any array."""
        high, low = pair(Fraction(value))
        return DoubleDouble(np.array([high]), np.array([low]))

    @staticmethod
    def sqrt(x: Any) -> Any:
        """Return the square roots; of a plain number, a double."""
        return x.sqrt() if isinstance(x, DoubleDouble) else np.sqrt(float(x))

    @staticmethod
    def atan2(y: Any, x: Any) -> Any:
        """Return the angles of the points (x, y), as good as doubles are."""
        return DoubleDouble(np.arctan2(y.high, x.high))

    @staticmethod
    def where(condition: Any, yes: Any, no: Any) -> Any:
        """Choose element by element."""
        return DoubleDouble.choose(condition, yes, no)


ARRAYS, PAIRS = ArrayFunctions(), Pairs()


def doubles_of(name: str, values: ArrayLike) -> Array:
    """Return the argument `name` as an array of doubles, infinite if a number is beyond them.

    Raises LagtopError for anything but an array of real numbers, and for masked elements.
    """
    masked = sys.modules.get("numpy.ma")  # start-up: without it no array is masked
    if masked and masked.isMaskedArray(values) and masked.getmaskarray(values).any():
        raise LagtopError(f"{name} must not be masked: fill it or leave the elements out", name)
    try:
        array = np.asarray(values)
        if array.size and array.dtype.kind not in "iufO":
            raise TypeError(array.dtype)
        with np.errstate(over="ignore"):  # of long doubles
            return array.astype(np.float64, copy=False)
    except (TypeError, ValueError, OverflowError):
        raise LagtopError(f"{name} must be real numbers, got {quoted(values)}", name) from None
