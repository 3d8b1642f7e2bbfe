"""Real physics engines as methods of the comparison, each in a process of its own."""
