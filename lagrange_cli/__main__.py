"""The start of the command: `python -m lagrange_cli` and the script `lagtop`."""

import _signal as signal  # type: ignore[import-not-found]  # `signal` itself takes long to import
import _thread
import sys

_ENDING = ("SIGINT", "SIGTERM", "SIGHUP", "SIGQUIT")
"""Signals that end the program; not every system has each."""
_received: list[int] = []


def main() -> None:
    """Run the command line; a signal ends it without a traceback, and removes temporary files.

    Ctrl-C kills at once while modules are imported.  Later it raises KeyboardInterrupt, and the
    other signals raise SystemExit, so that `finally` clauses run.  A second signal does not stop
    them.  Ignored signals stay ignored.
    """
    is_interactive = signal.getsignal(signal.SIGINT) == signal.default_int_handler
    if is_interactive:
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    import gc

    from .cli.app import complain_of_bug
    from .cli.app import main as run

    gc.set_threshold(100_000)  # a start makes no garbage: collections take a tenth of its time
    for number in _numbers():
        if signal.getsignal(number) == signal.SIG_DFL:
            signal.signal(number, _unwind)
    sys.unraisablehook = _repeat
    try:
        run(prog_name="lagtop")
    except (Exception, KeyboardInterrupt) as error:
        if _received:
            signal.signal(_received[0], signal.SIG_DFL)  # C libraries raise errors of their own
            signal.raise_signal(_received[0])
        if not isinstance(error, Exception):
            raise
        complain_of_bug(error)
        sys.exit(70)
    finally:
        if is_interactive:
            signal.signal(signal.SIGINT, signal.SIG_DFL)


def _numbers() -> list[int]:
    return [getattr(signal, name) for name in _ENDING if hasattr(signal, name)]


def _unwind(number: int, _: object) -> None:
    _received.append(number)
    for each in _numbers():
        signal.signal(each, _pass)
    if number == signal.SIGINT:
        raise KeyboardInterrupt
    sys.exit(128 + number)


def _repeat(lost: "sys.UnraisableHookArgs") -> None:
    """Repeat a signal soon if its exception was lost, as in a callback of a weak reference."""
    if _received and lost.exc_type in {KeyboardInterrupt, SystemExit}:
        signal.signal(_received[0], _unwind)
        _thread.start_new_thread(signal.raise_signal, (_received[0],))
    else:
        sys.__unraisablehook__(lost)


def _pass(number: int, _: object) -> None:
    """Do nothing; Python prints a traceback if a signal that is on its way meets SIG_IGN."""


if __name__ == "__main__":
    main()
