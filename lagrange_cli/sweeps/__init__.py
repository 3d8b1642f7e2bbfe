"""Many tops: grids and files of tops, computed in parts, on one machine or on a cluster."""
