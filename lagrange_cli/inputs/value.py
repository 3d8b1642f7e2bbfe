"""The old name of `inputs.values`, until all users import that."""

from .values import (
    LOG,
    STEADY_WORDS,
    Stds,
    Value,
    exact_number,
    parse_value,
    split_unit,
    steady_refused,
    value_of,
    values_of,
)

__all__ = [
    "LOG",
    "STEADY_WORDS",
    "Stds",
    "Value",
    "exact_number",
    "parse_value",
    "split_unit",
    "steady_refused",
    "value_of",
    "values_of",
]
