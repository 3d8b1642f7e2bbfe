"""The judge of trajectories: somebody's motion of a top against the exact one."""
