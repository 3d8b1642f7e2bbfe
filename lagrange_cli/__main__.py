"""The start of the command: `python -m lagrange_cli` and the script `lagtop`."""

import gc
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    import signal
else:
    import _signal as signal  # without the enumerations of `signal`, 2 % of `lagtop solve`


def main() -> None:
    """Run the command line; Ctrl-C during its imports ends it as a signal, without a traceback."""
    if signal.getsignal(signal.SIGINT) == signal.default_int_handler:  # unless it is ignored
        signal.signal(signal.SIGINT, signal.SIG_DFL)
    gc.disable()  # until the command is loaded: imports leave no garbage, see `LagtopGroup`
    from .cli.app import main as run

    run(prog_name="lagtop")


if __name__ == "__main__":
    main()
