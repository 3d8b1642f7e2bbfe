"""The start of the command: `python -m lagrange_cli` and the script `lagtop`."""

import gc
import signal
import sys


def main() -> None:
    """Run the command line; a signal ends it without a traceback, and removes temporary files.

    Ctrl-C kills at once while modules are imported.  Later it raises KeyboardInterrupt, and TERM
    and HUP raise SystemExit, so that `finally` clauses run.  Ignored signals stay ignored.
    """
    gc.set_threshold(100_000)  # a start makes no garbage: collections take a tenth of its time
    is_interactive = signal.getsignal(signal.SIGINT) == signal.default_int_handler
    if is_interactive:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    from .cli.app import main as run

    for name in ("SIGTERM", "SIGHUP"):
        number = getattr(signal, name, None)  # not every system has each
        if number is not None and signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, _unwind)
    try:
        if is_interactive:
            signal.signal(signal.SIGINT, signal.default_int_handler)
        run(prog_name="lagtop")
    finally:
        if is_interactive:
            signal.signal(signal.SIGINT, signal.SIG_DFL)


def _unwind(number: int, _: object) -> None:
    signal.signal(number, signal.SIG_IGN)  # a second one must not stop the cleaning
    sys.exit(128 + number)


if __name__ == "__main__":
    main()
