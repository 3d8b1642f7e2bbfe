"""The motion of one top: its regime, its record, its angles and its columns over time."""
