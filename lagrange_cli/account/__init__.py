"""The summary of a motion, its formulas with numbers, and its uncertainty."""
