"""Further keys and what else the paper computes."""
