"""Keys on request and what else the paper computes."""
