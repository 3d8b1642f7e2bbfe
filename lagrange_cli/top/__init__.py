"""The inputs of one top: values, units, ranges and scenes."""
