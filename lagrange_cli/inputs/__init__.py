"""User input: tops, scene files, units, ranges, tables of text and trajectories."""
