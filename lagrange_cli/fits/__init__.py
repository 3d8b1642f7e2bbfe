"""Backwards: inputs that make a top do what is wanted, and the top behind a recording."""
