"""`python -m lagrange_cli`, the same as `lagtop`."""

from .cli.group import main

main(prog_name="lagtop")
