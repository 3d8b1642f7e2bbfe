"""A second solution of the top, in ball arithmetic, for the tests alone."""
