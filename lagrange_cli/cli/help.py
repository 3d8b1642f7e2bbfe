"""Help texts and messages about wrong usage, in one style: at most 60 lines for any command."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import click

from ..errors import LagtopError
from ..inputs.input_keys import BODY, DECLARED
from ..inputs.names import suggestion

_BODY = {"A_cm", *BODY}
_GROUPS = {
    "Body": _BODY,
    "Start": {*DECLARED} - _BODY,
    "Accuracy": {"digits", "certify"},
    "Uncertainty": {"budget", "samples", "seed", "sigma"},
    "Output": {"fmt", "output", "units", "rad", "keys", "columns", "wrap", "plot"},
}
"""Names of the parameters of each group; all others come first, as options of the command."""
_OWN = "Options"
_ORDER = (_OWN, "Body", "Start", "Uncertainty", "Accuracy", "Output")
_WIDTH, _TERM = 80, 26
"""Width of the help, and the column at which the texts of options begin."""


def write_help(
    command: click.Command,
    ctx: click.Context,
    formatter: click.HelpFormatter,
    examples: Sequence[str],
    listed: Mapping[str, Sequence[str]],
) -> None:
    """Write the usage, the description, examples, listed commands, and options in groups."""
    formatter.width = _WIDTH
    command.format_usage(ctx, formatter)
    command.format_help_text(ctx, formatter)
    with formatter.section("Examples"):
        formatter.write("".join(f"  {line}\n" for line in examples))
    for heading, names in listed.items():
        assert isinstance(command, click.Group)
        with formatter.section(heading):
            formatter.write_dl([(name, _first_sentence(command, ctx, name)) for name in names])
    groups: dict[str, list[tuple[str, str]]] = {}
    for param in command.params:
        record = param.get_help_record(ctx)
        if record is not None and isinstance(param, click.Option):
            groups.setdefault(_group_of(param), []).append(record)
    for heading in _ORDER:
        if heading in groups:
            with formatter.section(heading):
                formatter.write_dl(groups[heading], col_max=_TERM, col_spacing=2)


def _group_of(param: click.Parameter) -> str:
    return next((heading for heading, names in _GROUPS.items() if param.name in names), _OWN)


def _first_sentence(group: click.Group, ctx: click.Context, name: str) -> str:
    """Return the first sentence on a command, without its full stop."""
    found = group.get_command(ctx, name)
    assert found is not None
    return " ".join((found.help or "").split("\n\n")[0].split()).partition(". ")[0].rstrip(".")


def usage_message(error: click.ClickException) -> str:
    """Return a message of click in the words of lagtop, with a reference to the help."""
    ctx: Any = getattr(error, "ctx", None)
    text = error.format_message()
    if isinstance(error, click.NoSuchOption):
        options = [name for param in ctx.command.params for name in param.opts] if ctx else []
        text = f"unknown option {error.option_name}{suggestion(error.option_name, options)}"
    elif isinstance(error, click.BadParameter) and isinstance(
        kind := getattr(error.param, "type", None), click.Choice
    ):
        name, wrong = error.param.opts[0], re.match(r"'(.*)' is not", error.message)  # type: ignore[union-attr]
        got = wrong[1] if wrong else error.message
        text = f"{name} must be one of {', '.join(kind.choices)}, got {got!r}"
        text += suggestion(got, kind.choices)
    elif found := re.match(r"Got unexpected extra arguments? \((.*)\)", text):
        text = f"unexpected argument {found[1]}"
    else:
        text = text[:1].lower() + text[1:].rstrip(".")
    return f"{text}: see {ctx.command_path} --help" if ctx else text


def naming_options(error: LagtopError, params: Sequence[click.Parameter]) -> str:
    """Return a message with names of options, such as `--t-max` instead of `t_max`.

    The replaced words are the first word, if it is the key of the error, and words with an
    underscore before the quoted value.
    """
    names = [name for param in params for name in param.opts if name.startswith("--")]
    options = {name[2:].replace("-", "_"): name for name in names}
    if "theta0" in options:  # the one input whose key has a unit
        options |= dict.fromkeys(("theta0_deg", "theta0_rad"), options["theta0"])
    said, got, value = str(error).partition(", got ")
    if error.key in options and re.match(rf"{error.key}\b", said):
        said = options[error.key] + said.removeprefix(error.key)
    said = re.sub(r"(?<![-\w])[a-z]+_\w+", lambda word: options.get(word[0], word[0]), said)
    return said + got + value
