"""The numbers of all computations: scalars of many digits, arrays, and pairs of doubles."""
