"""The command line: the group of commands, with one-line errors, exit codes and signals."""

from __future__ import annotations

import gc
import os
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any, ClassVar, NoReturn

import click

from .. import __version__
from ..errors import CannotWriteError, LagtopError
from ..output.destination import Terminated, opened

if TYPE_CHECKING:
    import signal
else:
    import _signal as signal  # without the enumerations of `signal`, 2 % of `lagtop solve`

COMMANDS = {
    "One top": ("solve", "table", "plot", "view", "explain", "scenes"),
    "Many tops": ("sweep", "find", "fit", "compare"),
    "Functions": ("jacobi", "eta"),
    "Tests of lagtop": ("bench", "stability"),
}
"""Names of the commands, by their groups in the help."""
NAMES = [name for names in COMMANDS.values() for name in names]
_MODULES = {"view": "plot", "scenes": "explain", "find": "sweep", "stability": "bench"}
"""Commands that share the module of another command."""
_CLOSED_PIPE = 13
"""The number of SIGPIPE, which not every system has."""


def complain(line: str) -> None:
    """Write one line to standard error, safe for any terminal; ignore failures."""
    from ..output.terminal import one_line

    with suppress(OSError):
        click.echo(one_line(line), err=True)


def say(text: str) -> None:
    """Write a text of lagtop to standard output.  Raises CannotWriteError."""
    try:
        with opened("-") as stream:
            stream.write(f"{text}\n".encode())
    except BrokenPipeError:  # click would turn it into exit code 1
        _die_by(_CLOSED_PIPE)


@contextmanager
def _interrupts() -> Iterator[None]:
    """Raise KeyboardInterrupt for Ctrl-C while the block runs, so that it can clean up.

    Outside the block Ctrl-C kills at once (see `__main__`), as nothing would catch the exception.
    """
    if signal.getsignal(signal.SIGINT) != signal.SIG_DFL:  # ignored, or handled by a host
        yield
        return
    signal.signal(signal.SIGINT, signal.default_int_handler)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, signal.SIG_DFL)


def _die_by(number: int) -> NoReturn:
    """End the program by a signal, as if nothing had caught it.

    A shell loop stops only if the command inside it dies by the signal itself, not with an exit
    code that looks like one.  A system without SIGPIPE gets the exit code.
    """
    if number == _CLOSED_PIPE and not hasattr(signal, "SIGPIPE"):
        sys.exit(128 + number)
    signal.signal(number, signal.SIG_DFL)
    os.kill(os.getpid(), number)
    raise AssertionError("unreachable")


def _shown_at_once(names: Sequence[str], what: str, text: Callable[[click.Context], str]) -> Any:
    """Return an option that shows a text and ends the command."""

    def show(ctx: click.Context, _: click.Parameter, wanted: bool) -> None:
        if wanted and not ctx.resilient_parsing:
            say(text(ctx))
            ctx.exit()

    return click.Option(
        names, is_flag=True, expose_value=False, is_eager=True, callback=show, help=what
    )


class Command(click.Command):
    """A command whose help has examples and groups of options; an error names its option.

    The options --version and --help are made here, because those of click search for translations.
    That would take 2 % of the run time of `lagtop solve`.
    """

    listed: ClassVar[Mapping[str, Sequence[str]]] = {}
    """The commands of a group, by heading."""

    def __init__(self, *args: Any, examples: str = "", **kwargs: Any) -> None:
        super().__init__(*args, **(kwargs | {"add_help_option": False}))
        self.params.append(
            _shown_at_once(["-h", "--help"], "Show this help.", lambda ctx: ctx.get_help())
        )
        self.examples = [line.strip() for line in examples.strip().splitlines()]

    def format_help(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        """Write the usage, the text, the examples, and the options in groups."""
        from .help import write_help  # start-up

        write_help(self, ctx, formatter, self.examples, self.listed)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an error about an argument names its option."""
        try:
            return super().invoke(ctx)
        except LagtopError as error:
            from .help import naming_options

            error.args = (naming_options(error, self.params),)
            raise


class LagtopGroup(Command, click.Group):
    """The group of commands, with one-line errors, exit codes and deaths by signal."""

    listed = COMMANDS

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names, in the order of the help."""
        return NAMES

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command | None:
        """Return a command; its module is loaded only now, to speed up the start.

        Objects loaded so far are excluded from garbage collection, which would take 10 % of `lagtop
        solve`.  Imports within the command leave no garbage either.  Python's own threshold of 700
        objects would add 15 % to the import of matplotlib.
        """
        if cmd_name not in NAMES:
            return None
        module = import_module(f".{_MODULES.get(cmd_name, cmd_name)}", __package__)
        command: click.Command = getattr(module, f"{cmd_name}_command")
        if not gc.isenabled():
            gc.freeze()
            gc.set_threshold(100_000)
            gc.enable()
        return command

    def resolve_command(
        self, ctx: click.Context, args: list[str]
    ) -> tuple[str | None, click.Command | None, list[str]]:
        """Return the command of the arguments.  Raises UsageError for an unknown name."""
        word = args[0]
        if word not in NAMES and not word.startswith("-"):
            from ..inputs.names import suggestion

            raise click.UsageError(f"unknown command {word!r}{suggestion(word, NAMES)}", ctx)
        return super().resolve_command(ctx, args)

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run like click's method, but end with one line on standard error and an exit code."""
        if sys.stderr is None:  # closed by the caller: the next file would get its number
            sys.stderr = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")
        run: Any = super().main
        if not extra.pop("standalone_mode", True):
            return run(*args, standalone_mode=False, **extra)
        try:
            sys.exit(run(*args, standalone_mode=False, **extra) or 0)
        except click.ClickException as error:
            from .help import usage_message

            complain(f"Error: {usage_message(error)}")
            sys.exit(error.exit_code)
        except LagtopError as error:
            complain(f"Error: {error}")
            sys.exit(error.exit_code)
        except OSError as error:  # of a file that no reader or writer has named
            place = f": {error.filename}" if error.filename else ""
            complain(f"Error: {error.strerror or error}{place}")
            sys.exit(CannotWriteError.exit_code)
        except click.Abort:
            _die_by(signal.SIGINT)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command, and end the program by a signal if the command was ended by one.

        Signals are caught here, before click turns them into an exit code.
        """
        try:
            with _interrupts():
                return super().invoke(ctx)
        except BaseException as error:
            number = _signal_of(error)
            if number is None:
                raise
        # By now the command has been unwound and has cleaned up.
        return _die_by(number)


def _signal_of(error: BaseException) -> int | None:
    """Return the number of the signal that ended a command, or None for any other error."""
    if isinstance(error, Terminated):
        return error.number
    if isinstance(error, KeyboardInterrupt):
        return signal.SIGINT
    return _CLOSED_PIPE if isinstance(error, BrokenPipeError) else None


@click.group(
    "lagtop",
    cls=LagtopGroup,
    invoke_without_command=True,
    examples="""
        lagtop solve --theta0 30
        lagtop table --t-max 1 -o angles.csv
        lagtop plot looping-top sphere -o loops.svg
    """,
    params=[
        _shown_at_once(
            ["--version"], "Show the version.", lambda _: f"lagtop, version {__version__}"
        )
    ],
)
@click.pass_context
def main(ctx: click.Context) -> None:
    """Solve the Lagrange top, a heavy symmetric top, in closed form.

    theta is the tilt, phi the spin and psi the precession: most books swap phi and psi.  Inputs you
    omit default to the worked example of Chrapan (1952) in CGS units.  Rates are in rad per unit of
    time.  A scene is a name that `lagtop scenes` lists, a TOML file with inputs, or - for standard
    input.

    \b
    Exit codes:
      0   success
      1   a top or a check failed, a quantity is undefined, or nothing was found
      2   wrong usage or a bad value
      65  a file cannot be read or holds bad data
      69  a package, an engine or a cluster is not available
      74  output cannot be written
      128 + N  ended by signal N

    \b
    Completion with Tab: add to ~/.bashrc (for zsh to ~/.zshrc, with zsh_source):
      eval "$(_LAGTOP_COMPLETE=bash_source lagtop)"
    For fish, run:
      _LAGTOP_COMPLETE=fish_source lagtop > ~/.config/fish/completions/lagtop.fish

    Use lagtop COMMAND --help for the options of a command.
    """
    if ctx.invoked_subcommand is None:
        say(ctx.get_help())
