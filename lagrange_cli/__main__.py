"""`python -m lagrange_cli`, the same as `lagtop`."""

from .cli import main

main(prog_name="lagtop")
