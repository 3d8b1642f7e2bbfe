"""Comparison of trajectories of a top with the exact motion."""
