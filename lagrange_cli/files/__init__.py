"""Input files of many rows: text tables, trajectories by other programs, files of tops."""
