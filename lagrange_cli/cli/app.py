"""The command line: the group of commands, with one-line errors and exit codes."""

from __future__ import annotations

import os
import re
import signal
import sys
from contextlib import suppress
from importlib import import_module
from typing import Any, NoReturn

import click

from .. import __version__
from ..arithmetic.text import quoted
from ..errors import CannotWriteError, LagtopError, Message, UnavailableError
from ..names import listed, suggestion
from ..output.terminal import one_line
from ..top.inputs import DECLARED

NAMES = (
    *("solve", "table", "plot", "view", "explain", "scenes"),
    *("sweep", "find", "fit", "compare"),
    *("jacobi", "eta", "bench", "stability"),
)
"""The commands, in the order of the help."""
_MODULES = {
    "view": "plot",
    "scenes": "explain",
    "find": "sweep",
    "eta": "jacobi",
    "stability": "bench",
}
"""Commands that share the module of another command."""
_MEGABYTES = {"numpy": 100, "scipy": 200}
"""Memory of packages with one thread of OpenBLAS, which suffices here."""
_COMPLETION = "_LAGTOP_COMPLETE"
_LAST_SECOND = 253_402_300_799


def complain(line: str) -> None:
    """Write one line to standard error, safe for any terminal; ignore failures."""
    with suppress(OSError):
        click.echo(one_line(worded(line)), err=True)


def worded(text: str) -> str:
    """Return a message with the options of the command in place of arguments."""
    context = click.get_current_context(silent=True)
    return Message(text).with_options(options_of(context.command) if context else {})


def _lack_of_memory(error: Exception) -> str:
    """Return a message for an error that a lack of memory or threads causes; raise any other."""
    if isinstance(error, MemoryError):
        return "out of memory"
    if not re.search("failed to map segment|allocate memory|start new thread", str(error)):
        raise error
    return f"out of memory or threads: {error}"


class _MemoryCheck:
    """Is asked for each package that is imported, before Python looks for it."""

    @staticmethod
    def find_spec(name: str, *_: object) -> None:
        """Raise UnavailableError if NumPy or SciPy does not fit: OpenBLAS may wait for ever."""
        size = _MEGABYTES.get(name, 0)
        if size and os.name == "posix":
            import mmap  # start-up

            os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
            try:
                mmap.mmap(-1, size << 20, flags=mmap.MAP_PRIVATE | mmap.MAP_ANONYMOUS).close()
            except OSError:
                raise UnavailableError(f"out of memory: {name} needs {size} MB") from None


sys.meta_path.insert(0, _MemoryCheck)


def complain_of_bug(error: Exception) -> None:
    """Write one line that asks for a report, with the name and the place of an exception."""
    from traceback import extract_tb  # start-up

    frames = extract_tb(error.__traceback__)
    own = [x for x in frames if os.path.dirname(os.path.dirname(__file__)) in x.filename]
    where = f"{os.path.basename(own[-1].filename)}, line {own[-1].lineno}" if own else "a package"
    found = f"{type(error).__name__} in {where} ({error})"
    complain(f"Error: this is a bug, please report it with your command: {found}")


def _die_by(name: str, code: int) -> NoReturn:
    """End the program by a signal: a shell loop stops only if its command dies by Ctrl-C itself."""
    if os.name == "posix":  # Windows would end it with code 2
        number = getattr(signal, name)
        signal.signal(number, signal.SIG_DFL)
        os.kill(os.getpid(), number)
    sys.exit(code)


class LagtopGroup(click.Group):
    """The group of commands; a module is imported when its command is called."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        """Return the names, in the order of the help."""
        return list(NAMES)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command:
        """Return a command.  Raises UsageError for an unknown name."""
        if cmd_name not in NAMES:
            hint = suggestion(cmd_name, [*NAMES, "--help", "--version"])
            raise click.UsageError(f"no such command: {cmd_name!r}{hint}", ctx)
        module = import_module(f".{_MODULES.get(cmd_name, cmd_name)}", __package__)
        command: click.Command = getattr(module, f"{cmd_name}_command")
        return command

    def make_context(self, *args: Any, **extra: Any) -> click.Context:
        """Parse the arguments, and print the help or the version."""
        try:
            return super().make_context(*args, **extra)
        except BrokenPipeError:
            _die_by("SIGPIPE", 141)

    def invoke(self, ctx: click.Context) -> Any:
        """Run the command; an error about an argument names its option."""
        try:
            return super().invoke(ctx)
        except LagtopError as error:
            if ctx.invoked_subcommand:
                options = options_of(self.get_command(ctx, ctx.invoked_subcommand))
                error.args = (error.args[0].with_options(options),)
            raise
        except KeyboardInterrupt:
            _die_by("SIGINT", 130)
        except BrokenPipeError:  # the reader has gone away
            _die_by("SIGPIPE", 141)

    def main(self, *args: Any, **extra: Any) -> Any:
        """Run like click's method, but end with one line on standard error and an exit code."""
        run: Any = super().main
        if sys.stderr is None:  # closed by the caller: the next file would get its number
            sys.stderr = os.fdopen(os.open(os.devnull, os.O_WRONLY), "w")
        try:
            _check_environment()
            if sys.stdout is None and {"-h", "--help", "--version"} & {*(sys.argv[1:] or ["-h"])}:
                raise CannotWriteError("cannot write standard output: it is closed")
            sys.exit(run(*args, **extra | {"standalone_mode": False}) or 0)
        except click.ClickException as error:
            text, code = _usage_message(error), error.exit_code
        except click.Abort:
            _die_by("SIGINT", 130)
        except (MemoryError, ImportError, RuntimeError) as error:
            text, code = _lack_of_memory(error), UnavailableError.exit_code
        except OSError as error:  # of a file that no reader or writer has named
            with suppress(OSError, AttributeError):  # what is left in the buffer is lost anyway
                os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            text, code = f"{error.strerror or error}", CannotWriteError.exit_code
            if error.filename:
                text += f": {error.filename}"
            elif isinstance(error, FileNotFoundError):
                text = "the current folder no longer exists"
            else:
                text = f"cannot write standard output: {text}"
        except LagtopError as error:
            text, code = str(error), error.exit_code
        except (KeyError, ValueError) as error:
            text, code = _wrong_words(error), 2
        complain(f"Error: {text}")
        sys.exit(code)


def _wrong_words(error: KeyError | ValueError) -> str:
    """Return why a file name or a variable of the shell is wrong.  Re-raises any other error."""
    if isinstance(error, UnicodeEncodeError):
        return f"no file can have the name {quoted(str(error.object))}"
    if _COMPLETION not in os.environ:
        raise error
    return f"{_COMPLETION} needs the variables that a shell sets: unset it"


def _check_environment() -> None:
    """Raise an error for variables at which NumPy, matplotlib or click would fail."""
    epoch = os.environ.get("SOURCE_DATE_EPOCH", "0")
    if not (re.fullmatch("[0-9]{1,12}", epoch) and int(epoch) <= _LAST_SECOND):
        wanted = f"a number of seconds up to {_LAST_SECOND} (the end of the year 9999)"
        raise UnavailableError(f"SOURCE_DATE_EPOCH must be {wanted}, got {epoch!r}")
    asked = os.environ.get(_COMPLETION)
    if asked and not re.fullmatch("(bash|zsh|fish)_(source|complete)", asked):
        raise LagtopError(f"{_COMPLETION} must be such as bash_source, got {asked!r}: unset it")


def options_of(command: click.Command) -> dict[str, str]:
    """Return the options by the names of arguments; a tilt with a value has a unit.

    A number beyond the doubles has digits in `solve`, if the command itself has no such option.
    """
    found = {x.opts[-1].lstrip("-").replace("-", "_"): x.opts[-1] for x in command.params}
    if "theta0" in found:
        tilt = found["theta0"]
        found |= {"theta0_deg": tilt, "theta0_rad": tilt, "theta0_rad=": f"--rad {tilt}"}
    options = {name: option for name, option in found.items() if option.startswith("--")}
    return {"digits": "solve --digits"} | options


def _usage_message(error: click.ClickException) -> str:
    """Return the message of click as the end of a sentence, with a reference to the help."""
    text = error.format_message().replace(". (", " (").rstrip(".")
    if isinstance(error, click.NoSuchOption):
        text = f"no such option {error.option_name}{_option_meant(error)}"
    path = error.ctx.command_path if isinstance(error, click.UsageError) and error.ctx else "lagtop"
    return f"{text[:1].lower()}{text[1:]}: see {path} --help"


def _option_meant(error: click.NoSuchOption) -> str:
    """Return a hint with the options that a wrong one means: by its word, then by its letters."""
    params = error.ctx.command.params if error.ctx else []
    known = [x for param in params for x in param.opts if x.startswith("--")]
    name = error.option_name.lstrip("-")
    if error.ctx and error.ctx.parent is None and name in DECLARED:
        return f": put a command in front of it, as in lagtop solve --{name}"
    word = re.sub("^(i[123xyz]*|inertia)$", "moment", name.lower()).replace("omega", "spin")
    named = [f"--{key.replace('_', '-')}" for key, x in DECLARED.items() if word in x.name.split()]
    named += {"get": ["--keys"], "keys": ["--get"]}.get(word, [])
    if found := [x for x in named if x in known]:
        return f" (did you mean {listed(map(repr, found))}?)"
    begun = [x for x in known if x[2].lower() == name[:1].lower()]  # --rad is not --format
    alike = [x for x in begun if (len(x[2:]) == 1) == (len(name) == 1)]  # nor --sigma --s
    return suggestion(f"--{name}", alike)


@click.group(
    "lagtop",
    cls=LagtopGroup,
    invoke_without_command=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog="\b\nExamples:\n  lagtop solve --theta0 30\n  lagtop table --t-max 1 -o angles.csv\n"
    "  lagtop plot looping-top sphere -o loops.svg",
)
@click.version_option(__version__)
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
      70  an unexpected exception: please report it
      74  output cannot be written
      128 + N  ended by signal N

    \b
    Completion with Tab: add to ~/.bashrc (for zsh to ~/.zshrc, with zsh_source):
      eval "$(_LAGTOP_COMPLETE=bash_source lagtop)"

    Use lagtop COMMAND --help for the options of a command.
    """
    if ctx.invoked_subcommand is None:
        click.echo(ctx.get_help())
