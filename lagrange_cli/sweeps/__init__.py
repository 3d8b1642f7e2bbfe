"""Many tops: grids and files of tops, computed in parts, and searches over them (`find`)."""
