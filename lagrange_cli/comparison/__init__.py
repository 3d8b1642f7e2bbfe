"""Comparison of trajectories by other programs with the exact motion."""
