"""The arithmetic of radii: six digits, rounded outwards."""

from __future__ import annotations

import decimal

from .decimals import TRAPS, own_context

SHORT = 6
"""Digits of a radius."""


def _rounded(rounding: str) -> decimal.Context:
    context = own_context(SHORT, TRAPS)
    context.rounding = rounding
    return context


UP, DOWN = _rounded(decimal.ROUND_UP), _rounded(decimal.ROUND_DOWN)
FLOOR, CEILING = _rounded(decimal.ROUND_FLOOR), _rounded(decimal.ROUND_CEILING)
add_up, multiply_up, fma_up, divide_up = UP.add, UP.multiply, UP.fma, UP.divide
