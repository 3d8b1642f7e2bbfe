"""The start of the command: `python -m lagrange_cli` and the script `lagtop`."""

import signal


def main() -> None:
    """Run the command line; Ctrl-C during its imports ends it as a signal, without a traceback."""
    if signal.getsignal(signal.SIGINT) == signal.default_int_handler:  # it may be ignored instead
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from .cli.group import main as run

    run(prog_name="lagtop")


if __name__ == "__main__":
    main()
