"""Motion over time: angles and columns at given times."""
