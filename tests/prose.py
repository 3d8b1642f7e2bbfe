"""The rule of docstrings: full plain sentences, each of which can be read alone."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

Node = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef
Function = ast.FunctionDef | ast.AsyncFunctionDef

LEANING = re.compile(
    r"(?:Also|And|As|But|If so|In|It|Its|Likewise|Of|Or|So|That|The others?|The same|Then|These|"
    r"They|This|Those)\b"
)
"""Beginnings that lean on something said before."""

VERBS = frozenset(
    """
    Abort Accept Add Advance Align Allow Answer Append Apply Arrange Ask Assert Attach Await
    Bind Bound Break Bring Build Call Cancel Carry Catch Change Check Choose Clean Clear Close
    Collect Combine Compare Compute Connect Continue Convert Copy Correct Count Cover Create Cut
    Decide Define Describe Determine Differentiate Divide Do Draw Drop Echo Empty End Ensure
    Enter Estimate Evaluate Exchange Exit Expand Explain Export Fail Feed Fill Find Finish Fit
    Flush Fold Follow Format Forward Gather Generate Get Give Group Guard Hand Hide Hold Ignore
    Import Include Insert Install Integrate Interpolate Invert Iterate Join Judge Keep Kill
    Label Lay Leave Let List Load Look Lose Make Map Mark Mask Match Measure Merge Move Multiply
    Name Normalize Note Offer Open Order Pair Parse Pass Pause Pick Place Plot Poll Prepare
    Print Prove Pull Push Put Raise Read Rebuild Receive Reduce Refine Refuse Register Reject
    Release Remember Remove Rename Render Repeat Replace Report Require Reset Resolve Restore
    Resume Return Round Run Sample Save Say Scale Scan Search Select Send Serve Set Settle Shape
    Shift Show Shut Sign Simulate Skip Solve Sort Space Spare Split Spoil Start State Stop Store
    Stream Strip Subtract Sum Swap Take Tell Test Time Track Transform Translate Try Turn Unwrap
    Update Use Verify Wait Walk Warn Watch Work Wrap Write Yield
    """.split()
)
"""Imperatives that a function's docstring may begin with; further plain ones are welcome."""

NOUN_DECORATORS = {"property", "cached_property", "quantity", "key", "setter"}
NOUN_DECORATORS |= {"constant_key", "angle_key", "rate_key", "step_key", "elementary_key"}
HELP_DECORATORS = {"command", "group"}


class Fault(NamedTuple):
    """A docstring that breaks the rule: where it stands, how it begins, and what is wrong."""

    place: str
    beginning: str
    reason: str


def faults(path: Path, name: str) -> list[Fault]:
    """Return the faulty docstrings of a module, called by a name."""
    tree = ast.parse(path.read_text())
    return [
        Fault(f"{name}:{line}", text[:40].replace("\n", " "), reason)
        for node, line, text in docstrings(tree)
        if (reason := fault(node, text))
    ]


def docstrings(tree: ast.Module) -> Iterator[tuple[ast.AST | None, int, str]]:
    """Yield the docstrings of a module; those of attributes have None for their node."""
    for node in ast.walk(tree):
        if isinstance(node, Node):
            text = ast.get_docstring(node)
            if text is not None:
                yield node, node.body[0].lineno, text
        if isinstance(node, ast.Module | ast.ClassDef):
            yield from _attributes(node)


def _attributes(node: ast.Module | ast.ClassDef) -> Iterator[tuple[None, int, str]]:
    """Yield the texts that stand below assignments."""
    for before, after in zip(node.body, node.body[1:], strict=False):
        match after:
            case ast.Expr(ast.Constant(str(text))) if isinstance(
                before, ast.Assign | ast.AnnAssign
            ):
                yield None, after.lineno, text


def fault(node: ast.AST | None, text: str) -> str | None:
    """Return what is wrong with a docstring, or None."""
    summary, *_ = text.strip().split("\n\n")
    if leaning := LEANING.match(summary):
        return f"begins with {leaning.group()!r}"
    if not summary.rstrip().endswith((".", ".)", ":")):
        return "its first sentence has no full stop"
    if not text.rstrip().endswith((".", ".)", "```", "|")) and ">>>" not in text:
        return "does not end with a full stop"
    if isinstance(node, Function) and needs_verb(node):
        word = re.split(r"\W", summary, maxsplit=1)[0]
        return None if word in VERBS else f"begins with {word!r}, which is no verb of the list"
    return None


def needs_verb(node: Function) -> bool:
    """Return whether a function is neither a property, nor a command, nor a test."""
    names = {_decorator(decorator) for decorator in node.decorator_list}
    return not (names & (NOUN_DECORATORS | HELP_DECORATORS) or node.name.startswith("test_"))


def _decorator(node: ast.expr) -> str:
    """Return the last name of a decorator: `command` for `@main.command("solve")`."""
    if isinstance(node, ast.Call):
        return _decorator(node.func)
    return node.attr if isinstance(node, ast.Attribute) else getattr(node, "id", "")
