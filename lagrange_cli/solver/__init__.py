"""One top in closed form: its regime, its record, its angles and columns over time."""
