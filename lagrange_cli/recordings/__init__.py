"""Recordings of a motion: one reading of files and arrays, and what may have been misread."""
