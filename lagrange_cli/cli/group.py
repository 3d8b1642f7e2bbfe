"""The command line: the group of commands, with our errors, exit codes and deaths by signal."""

from __future__ import annotations

import gc
import os
import sys
from importlib import import_module
from typing import Any

import click

from ..errors import CannotWriteError, LagtopError
from ..output.signals import CLOSED_PIPE, INTERRUPT, Terminated, die_by, interrupts
from .command import ExamplesFirst, complain, say

COMMANDS = [
    *("solve", "table", "sweep", "find", "fit", "compare", "plot", "view"),
    *("jacobi", "eta", "bench", "stability"),
]


class LagtopGroup(ExamplesFirst, click.Group):
    """The group of commands, with our errors (one line), exit codes and deaths by signal."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names, in the order of the help."""
        return COMMANDS

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command, whose module is loaded only now: start-up pays for one, not for all.

        What `__main__` has loaded so far is never looked through for garbage, here and at the end:
        that would take 10 % of `lagtop solve`.  Imports within the command leave no garbage either:
        Python's own threshold of 700 objects would add 15 % to the import of matplotlib.
        """
        if cmd_name not in COMMANDS:
            return None
        command: click.Command = import_module(f".{cmd_name}", __package__).command
        if not gc.isenabled():
            gc.freeze()
            gc.set_threshold(100_000)
            gc.enable()
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command of the arguments.  Raises UsageError with the name that was meant."""
        word = args[0]
        if word not in COMMANDS and not word.startswith("-"):
            raise click.UsageError(f"No such command {word!r}.{_suggestion(word)}", ctx)
        return super().resolve_command(ctx, args)

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run like click's method, but end with one line on standard error and an exit code."""
        _open_standard_error()
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
        except OSError as error:  # of what no reader or writer has named
            place = f": {error.filename}" if error.filename else ""
            complain(f"Error: {error.strerror or error}{place}")
            sys.exit(CannotWriteError.exit_code)
        except click.Abort:
            die_by(INTERRUPT)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command.  What ends it from outside is caught here, before click turns it into
        an exit code: a signal must kill as a signal."""
        try:
            with interrupts():
                return super().invoke(ctx)
        except BrokenPipeError:
            number = CLOSED_PIPE
        except KeyboardInterrupt:
            number = INTERRUPT
        except Terminated as error:
            number = error.number
        return die_by(number)  # here, where the frames of the command are gone and have cleaned up


def _open_standard_error() -> None:
    """Send errors to the null device if the caller closed standard error.

    Otherwise the next file that is opened would take its number, and receive the errors.
    """
    if sys.stderr is None:
        sys.stderr = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")


def _suggestion(word: str) -> str:
    """Return a question with the command that is spelt nearly like the word, if there is one."""
    from difflib import get_close_matches

    near = get_close_matches(word, COMMANDS, 1)
    return f" Did you mean {near[0]!r}?" if near else ""


@click.group(
    cls=LagtopGroup,
    invoke_without_command=True,
    examples="""
        lagtop solve --theta0 30
        lagtop solve sample_inputs/chrapan-1952.toml --format json
        lagtop table --t-max 1 > out.csv
    """,
)
@click.pass_context
def main(ctx: click.Context) -> None:
    """The Lagrange top, a heavy symmetric top with a fixed point, in closed form.

    theta is the tilt, phi the spin and psi the precession; most books swap phi and psi.

    \b
    Exit codes:
      0   fine
      1   a top or a check failed, a number does not exist, nothing was found, or a promise
          was broken
      2   bad usage or a bad value
      65  a file cannot be read or has bad data
      69  a cluster, a method or a package is not available
      74  the output cannot be written
      128 + N  ended by the signal N

    \b
    Completion, in ~/.bashrc (in ~/.zshrc with zsh_source):
      eval "$(_LAGTOP_COMPLETE=bash_source lagtop)"
    and for fish:
      _LAGTOP_COMPLETE=fish_source lagtop > ~/.config/fish/completions/lagtop.fish

    Inputs default to the worked example of J. Chrapan (1952); any consistent units will do.  A
    scene is a TOML file that holds some of them, or - for standard input.
    """
    if ctx.invoked_subcommand is None:
        say(ctx.get_help())
