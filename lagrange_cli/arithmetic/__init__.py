"""The numbers that everything is computed in: scalars of many digits, arrays, pairs of doubles."""
