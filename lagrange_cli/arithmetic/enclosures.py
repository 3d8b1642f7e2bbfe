"""Balls of Arb: numbers with proved error bounds, rounded once their ball is narrow enough.

A ball of python-flint is an `arb`.  The precision of Arb is global, and only `at_precision` of this
module sets it.  `decided` asks a question with more and more digits until they decide it (Ziv
1991).  A question that the digits leave open raises TooFewDigitsError.

Two numbers that agree to D digits are equal.  D is 1,200, plus ten times the digits of the longest
input or of the output, whichever has more (`equal_digits`).  Nine doubles hold less than 180
digits: numbers computed from them that differ at all differ, for all practical purposes, within
some hundreds of digits.  A sign that D digits leave open is 0 (`sign_to`).  A number that they
cannot round is the simplest fraction in its ball: 0, or a tie between two roundings (`settled`).

    at_precision(40, lambda: arb(2).sqrt())          # a value computed in 40 digits
    kept(lambda digits: ...)                         # the same for any digits, computed once
    sign_to(lambda digits: x(digits), most=D)        # a sign, 0 only if D digits leave it open
    settled("k", lambda digits: x(digits), None, D)  # the nearest double; 20 in place of None: text
    decided(lambda digits: ..., most=D)              # any other question, with `sign` and `nearest`

Rules for code that uses balls:

- Never act on the False of a comparison such as `x > 0`: it may mean "not decided".  Ask `sign(x)`,
  or `x.is_zero()` for the exact zeros that formulas produce.  A test forbids the operators.
- Read a ball (`lower`, `upper`, `float`) inside the precision it was computed at.

Threads: one computation runs at a time.  A host program may change the precision of Arb during it.
A ball is true whatever the precision was, only wider, so no decision rests on a wide ball: more
digits are taken.  A computation after which the precision is another one is repeated once.  The
precision of the host is restored afterwards, also after an exception, Ctrl-C or a fork.
"""

from __future__ import annotations

import math
import os
from collections.abc import Callable, Iterable
from contextlib import suppress
from decimal import ROUND_UP, Context, Decimal
from fractions import Fraction
from functools import cache, partial
from itertools import chain, count, takewhile
from threading import RLock
from typing import Any, NamedTuple, TypeVar

from flint import arb, ctx, fmpq

from ..errors import LagtopError, OutOfRangeError, arg
from .text import NumberText, own_context

T = TypeVar("T")
Exact = Decimal | Fraction

BITS = 3.3219280948873626
"""Bits per decimal digit."""
LARGEST_EXPONENT = 990_000_000_000_000_000
"""The greatest size of an exponent of a number that is printed in decimal."""
_EQUAL_DIGITS = 1_200
"""Least number of digits that equal numbers have in common."""
_LEAST_DIGITS, _GUARD = 16, 22
"""Digits of a double, and the extra digits of the first enclosure."""
_MARGIN = 32
"""Bits of a ball beyond the last place of the number that is rounded from it."""
_TRIES = 5
"""Attempts with the most digits, because the host may disturb any of them."""


class TooFewDigitsError(Exception):
    """A question that cannot be decided with the digits in use."""


# The precision of Arb


class _Precision:
    """The precision of Arb in bits: that of the computation in progress, and that of the host."""

    lock = RLock()
    own = 0
    """0 if nothing is computed."""
    host = 0


_lock = _Precision.lock


def at_precision(digits: int, compute: Callable[[], T], *, checked: bool = True) -> T:
    """Return `compute()`, evaluated with balls of `digits` digits.  Calls may be nested.

    It is evaluated once more if another thread has changed the precision.  A part of a computation
    with as many digits saves the time of this if it need not be `checked` by itself.
    """
    bits = int(digits * BITS) + 2
    with _lock:
        outer = _Precision.own
        if outer == bits and not checked:
            return compute()
        try:  # without a call before it and first in its `finally`: Ctrl-C arrives at calls
            if not outer:
                _Precision.host = ctx.prec
            ctx.prec = _Precision.own = bits
            try:
                found = compute()
            except TooFewDigitsError:
                if ctx.prec == bits:
                    raise
            else:
                if ctx.prec == bits:
                    return found
            _Precision.host = ctx.prec
            ctx.prec = bits
            return compute()
        finally:
            if ctx.prec != _Precision.own:
                _Precision.host = ctx.prec
            _Precision.own = outer
            ctx.prec = outer or _Precision.host


def kept(compute: Callable[[int], T]) -> Callable[[int], T]:
    """Return `compute(digits)` at that precision, computed once for each number of digits.

    A result is kept only after the precision was found unchanged: a wide one would be found again
    at every attempt.
    """
    return cache(lambda digits: at_precision(digits, lambda: compute(digits)))


if hasattr(os, "register_at_fork"):  # a child of another thread has the precision of the host
    os.register_at_fork(
        before=_lock.acquire, after_in_parent=_lock.release, after_in_child=_lock.release
    )


# Balls


def exact(x: Fraction | float) -> arb:
    """Return a ball that holds a number; its radius is 0 if the number is a double."""
    if isinstance(x, int | float):
        return arb(x)
    return arb(fmpq(x.numerator, x.denominator))


def fraction(x: arb) -> Fraction:
    """Return the value of a ball of radius 0, such as `x.mid()`."""
    ratio = x.fmpq()
    return Fraction(int(ratio.p), int(ratio.q))


def sign(x: arb) -> int:
    """Return the sign of a number; raise TooFewDigitsError if its ball leaves it open."""
    if x.is_zero():
        return 0
    if x > 0:
        return 1
    if x < 0:
        return -1
    raise TooFewDigitsError


def root(x: arb) -> arb:
    """Return the square root of a number that is known not to be negative."""
    return x.nonnegative_part().sqrt() if x.contains(0) else x.sqrt()


def nearest(x: arb) -> int:
    """Return an integer within 3/4 of all numbers in a ball; raise TooFewDigitsError if none is."""
    if not (x.is_finite() and x.rad() <= 0.25):
        raise TooFewDigitsError
    return round(fraction(x.mid()))


def pi_to(digits: int) -> Fraction:
    """Return pi to `digits` significant digits or a few more."""
    return at_precision(digits + 4, lambda: fraction(arb.pi().mid()))


# Questions


def equal_digits(numbers: Iterable[Fraction], digits: int = 0) -> int:
    """Return D for numbers computed from some exact inputs, and printed with `digits` digits."""
    bits = max(max(x.numerator.bit_length(), x.denominator.bit_length()) for x in numbers)
    return _EQUAL_DIGITS + 10 * max(int(bits / BITS), digits)


def decided(
    compute: Callable[[int], T],
    most: int,
    *,
    digits: int | None = 0,
    lost: int = 0,
    what: str = "a number",
) -> T:
    """Return the first `compute(working)` that does not raise TooFewDigitsError.

    It runs with `working` digits: first some more than the output has, at last `most` + `lost` and
    a few more, because the host may have disturbed it.  `lost` is a number of digits that are lost
    in any case, for example to whole turns.  Raises LagtopError, which names the question by
    `what`, if no precision decides it.
    """
    least = max(digits or 0, _LEAST_DIGITS)
    growing = takewhile(lambda x: x < most, (least + _GUARD * 4**i for i in count()))
    for working in chain(growing, range(most, most + _TRIES)):
        with suppress(TooFewDigitsError):
            return at_precision(working + lost, partial(compute, working + lost))
    raise LagtopError(f"{what} cannot be distinguished from 0 or a tie with {most} digits")


def sign_to(number: Callable[[int], arb], most: int) -> int:
    """Return the sign of a number from its balls; 0 if `most` digits leave it open."""

    def attempt(working: int) -> int:
        ball = number(working)
        is_equal = ball.contains(0) and ball.rel_one_accuracy_bits() > most
        return 0 if working >= most and is_equal else sign(ball)

    return decided(attempt, most, what="a sign")


_SMALL, _LEAST_DOUBLE = Decimal("1e-300"), Decimal("5e-324")


class Rounded(NamedTuple):
    """A number as it is printed, and the ball or the fraction that it is rounded from."""

    value: Any
    """A double, or a text with the digits that were requested."""
    exact: arb | Fraction
    bits: int = 0
    """Relative accuracy of the ball, at least."""

    @property
    def radius(self) -> NumberText:
        """Largest possible distance of the exact value from the number, rounded up to two digits.

        It is rounded up so far that the double read from the text is not smaller, and it does not
        depend on the digits in use.
        """
        exact = self.exact
        if isinstance(exact, arb):
            radius = 0 if exact.is_exact() else abs(exact) * arb(2) ** -self.bits
            away = max(_distance(x, self.value) for x in ends_of(arb(exact.mid(), radius)))
        else:
            away = _distance(exact, self.value)
        if 0 < away < _SMALL and isinstance(self.value, float):  # where doubles are far apart
            away = _TWO_DIGITS.add(away, _LEAST_DOUBLE)
        return text_of(_TWO_DIGITS.multiply(away, _A_HAIR_MORE), 2)


def settled(
    what: str, number: Callable[[int], arb | None], digits: int | None, most: int
) -> Rounded | None:
    """Return a number as the nearest double, or with `digits` significant digits; None for None.

    `number` returns a ball of a number of digits.  A ball of `most` digits that still cannot be
    rounded stands for the simplest fraction in it.  Raises LagtopError for a ball that is wide even
    then, and OutOfRangeError for a number that no double holds; both name the number by `what`.
    """
    bits = _MARGIN + int((digits or _LEAST_DIGITS) * BITS)

    def attempt(working: int) -> Rounded | None:
        ball = number(working)
        if ball is None:
            return None
        try:
            if ball.rel_accuracy_bits() < bits:
                raise TooFewDigitsError
            value = _alike(what, ball, digits)
        except TooFewDigitsError:
            if working < most or not ball.rel_one_accuracy_bits() > most:
                raise
            middle, radius = fraction(ball.mid()), fraction(ball.rad())
            tie = simplest_between(middle - radius, middle + radius)
            return Rounded(rounded(what, tie, digits, _MORE_DIGITS), tie)
        return Rounded(value, ball, bits)

    return decided(attempt, most, digits=digits, what=what)


def _alike(what: str, ball: arb, digits: int | None) -> Any:
    """Return the number to which both ends of a ball are rounded, or raise TooFewDigitsError."""
    if digits is None:
        low, high = float(ball.lower()), float(ball.upper())
        if low == high and low and math.isfinite(low):
            return low
    low, high = (rounded(what, end, digits, _MORE_DIGITS) for end in ends_of(ball))
    if low != high:
        raise TooFewDigitsError
    return low


# Decimal numbers


_EXACT = own_context(1_000_000)
"""More digits than any ball has."""
_SHORT, _OUTWARDS = own_context(20), own_context(20, ROUND_UP)
_TWO_DIGITS = own_context(2, ROUND_UP)
_A_HAIR_MORE = Decimal("1.000000000001")
_MORE_DIGITS = f"use {arg('digits', 'N')}"


def ends_of(ball: arb) -> tuple[Decimal, Decimal]:
    """Return decimals below and above all numbers in a finite ball.

    Raises OutOfRangeError for a number whose size is not between 1e-990000000000000000 and
    1e+990000000000000000.
    """
    bits = max(80, ball.bits(), 0 if ball.is_exact() else ball.rel_accuracy_bits())
    middle, radius, exponent = map(int, ball.mid_rad_10exp(int(bits / BITS) + 8))
    if abs(exponent) > LARGEST_EXPONENT and (middle or radius):
        raise OutOfRangeError(
            "the size of a value is not between 1e-990000000000000000 and 1e+990000000000000000, "
            f"the limits of {arg('digits', 'N')}: take a smaller argument"
        )
    low, high = Decimal(middle - radius), Decimal(middle + radius)
    return _EXACT.scaleb(low, exponent), _EXACT.scaleb(high, exponent)


def rounded(what: str, value: Exact, digits: int | None, remedy: str = "change the units") -> Any:
    """Return a number as the nearest double, or as a text with `digits` significant digits.

    Raises OutOfRangeError, with the remedy, for a number beyond the doubles, or smaller than all
    doubles but 0.
    """
    if digits is not None:
        return text_of(value, digits)
    try:
        found = float(value) + 0.0  # never -0.0
    except OverflowError:  # of a fraction; a decimal becomes infinite
        found = math.inf
    if math.isinf(found) or (value and not found):
        bound = "within 1.8e308" if found else "0 or at least 5e-324"
        shown = _decimal(value, _SHORT)
        raise OutOfRangeError(f"{what} must be {bound} in magnitude, got {shown:.3e}: {remedy}")
    return found


def text_of(value: Exact, digits: int) -> NumberText:
    """Return a number with `digits` significant digits, in full if its size is ordinary."""
    context = own_context(digits)
    found = _decimal(value, context)
    if not found:
        return NumberText("0.0")
    found = found.normalize(context)
    style = "f" if -5 < found.adjusted() < 16 else "e"
    figures, e, exponent = f"{found:{style}}".partition("e")
    point = "" if "." in figures else ".0"
    return NumberText(f"{figures}{point}{e}{exponent}")


def decimal_text(value: Fraction, digits: int) -> NumberText:
    """Return a number as a decimal, exactly if it is one, else with `digits` significant digits."""
    scaled = value * 10 ** value.denominator.bit_length()  # more places than a decimal has
    return text_of(value, len(str(abs(int(scaled)))) if scaled.denominator == 1 else digits)


def _decimal(value: Exact, context: Context) -> Decimal:
    """Return a number as a decimal, rounded in a context."""
    if isinstance(value, Fraction):
        return context.divide(Decimal(value.numerator), Decimal(value.denominator))
    return context.plus(value)


def _distance(end: Exact, value: float | NumberText) -> Decimal:
    """Return the distance of two numbers in 20 digits, rounded up."""
    if isinstance(end, Fraction):
        return _decimal(abs(end - Fraction(value)), _OUTWARDS)
    shown = Decimal(value) if isinstance(value, str) else Decimal.from_float(value)
    return _OUTWARDS.subtract(end, shown).copy_abs()


def simplest_between(low: Fraction, high: Fraction) -> Fraction:
    """Return the fraction with the smallest denominator in an interval, by continued fractions."""
    if low <= 0 <= high:
        return Fraction(0)
    if high < 0:
        return -simplest_between(-high, -low)
    terms = []
    while math.ceil(low) > high:
        terms.append(math.floor(low))
        low, high = 1 / (high - terms[-1]), 1 / (low - terms[-1])
    value = Fraction(math.ceil(low))
    for term in reversed(terms):
        value = term + 1 / value
    return value
