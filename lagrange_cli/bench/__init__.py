"""Error against run time, hard scenes and their reference."""
