"""Inverse problems: inputs for target values, and the top behind a recording."""
