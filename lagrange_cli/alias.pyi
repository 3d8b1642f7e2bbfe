"""Installed as `lagtop-stubs`: type checkers see the public names of `lagrange_cli` in `lagtop`."""

from lagrange_cli import *  # noqa: F403
