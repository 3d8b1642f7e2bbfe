"""Error against run time, hard scenes and the reference that judges them."""
