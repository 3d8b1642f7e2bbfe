"""The command line: the group of commands, with our errors, exit codes and deaths by signal."""

from __future__ import annotations

import os
import sys
from importlib import import_module
from typing import Any, NoReturn

import click

from .. import __version__
from ..errors import CannotWriteError, LagtopError
from ..output.destination import Terminated
from .options import ExamplesFirst, complain

COMMANDS = ["solve", "table", "sweep", "plot", "jacobi", "eta", "bench", "stability"]


class LagtopGroup(ExamplesFirst, click.Group):
    """The group of commands, with our errors (one line), exit codes and deaths by signal."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """The names, in the order of the help."""
        return COMMANDS

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """The command, whose module is loaded only now: start-up pays for one command, not all."""
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f".{cmd_name}", __package__).command
        return command

    def main(self, *args: Any, **extra: Any) -> Any:
        """As click's; errors are one line on standard error and an exit code."""
        run: Any = super().main
        if not extra.pop("standalone_mode", True):
            return run(*args, standalone_mode=False, **extra)
        try:
            sys.exit(run(*args, standalone_mode=False, **extra) or 0)
        except click.ClickException as error:
            complain(f"Error: {error.format_message()}")
            sys.exit(error.exit_code)
        except LagtopError as error:
            complain(f"Error: {error}")
            sys.exit(error.exit_code)
        except OSError as error:  # of the help itself; the writers raise CannotWriteError
            complain(f"Error: cannot write standard output: {error.strerror}")
            os._exit(CannotWriteError.exit_code)  # the interpreter would try to flush it once more
        except click.Abort:
            _die_by("SIGINT")

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command.  What ends it from outside is caught here, before click turns it into
        an exit code: a signal must kill as a signal."""
        try:
            return super().invoke(ctx)
        except BrokenPipeError:
            _die_by("SIGPIPE")
        except KeyboardInterrupt:
            _die_by("SIGINT")
        except Terminated as error:
            _die_by(error.number)


def _die_by(which: str | int) -> NoReturn:
    """End by the signal itself: only that stops the shell loop we may be running in."""
    import signal

    number = signal.Signals[which] if isinstance(which, str) else signal.Signals(which)
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    raise AssertionError("unreachable")


@click.group(
    cls=LagtopGroup,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    examples="""
        lagtop solve --theta0 30
        lagtop solve sample_inputs/chrapan-1952.toml --format json
        lagtop table --t-max 1 > out.csv
    """,
)
@click.version_option(__version__, prog_name="lagtop")
@click.pass_context
def main(ctx: click.Context) -> None:
    """The Lagrange top, a heavy symmetric top with a fixed point, in closed form.

    Inputs default to the worked example of J. Chrapan (1952); any consistent units will do.
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())


if __name__ == "__main__":
    main()
