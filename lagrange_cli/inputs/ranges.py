"""The old name of `inputs.values`, until all users import that."""

from .values import (
    InputArrays,
    Multiple,
    Multiples,
    Product,
    Span,
    listed_multiples,
    parse_multiple,
    parse_multiples,
    parse_number_or_span,
    parse_range,
    parse_span,
    parse_values,
    refuse_units_inside,
)

__all__ = [
    "InputArrays",
    "Multiple",
    "Multiples",
    "Product",
    "Span",
    "listed_multiples",
    "parse_multiple",
    "parse_multiples",
    "parse_number_or_span",
    "parse_range",
    "parse_span",
    "parse_values",
    "refuse_units_inside",
]
