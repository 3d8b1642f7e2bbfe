"""Recordings of a motion: one reading of files and arrays, and its possible misreadings."""
