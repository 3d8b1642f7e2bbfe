"""The rule of plain English: which sentences of docstrings, help, messages and pages break it."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

MOST_WORDS = 25
"""Words of a sentence; code counts as one."""

BANNED = re.compile(
    r"\b(what is left|what remains|what is not given|told apart|tell \w+ apart|so many"
    r"|nearest to (its|the) exact value|commas between|hangs? on|usual slips?|first order holds"
    r"|wanted numbers?|mean growth|nods|nodding|half a body|rooms?|the house|errands?|whence|anew"
    r"|thereof|and the like)\b"
    r"|\bby --\w",
    re.IGNORECASE,
)
"""Private words, for which the trade has terms of its own."""

LEANING = re.compile(
    r"(?:Also|And|As|But|If so|In|It|Its|Likewise|Of|Or|So|That|The others?|The same|Then|These|"
    r"They|This|Those)\b"
)
"""Beginnings of a docstring that lean on something said before."""

ERRORS = re.compile(r"\w*(Error|Warning)$|^(echo|warn|refused)$")
"""Calls whose texts users read."""

HELP = {"option": 1, "choice": 1, "flag": 0}
"""Declarations of options, and the place of the help among their arguments."""

Node = ast.Module | ast.ClassDef | ast.FunctionDef | ast.AsyncFunctionDef


class Fault(NamedTuple):
    """A sentence that breaks the rule: its place, how it begins, and the reason."""

    place: str
    beginning: str
    reason: str


def faults(path: Path, name: str, *, sentences_too: bool = True) -> list[Fault]:
    """Return the faulty docstrings of a module, called by a name, and its faulty messages."""
    tree = ast.parse(path.read_text())
    texts = list(docstrings(tree))
    found = [(line, text, why) for line, text in texts if (why := bad_docstring(text))]
    for line, text in [*texts, *messages(tree)] if sentences_too else []:
        found += [(line, sentence, why) for sentence, why in bad_sentences(text)]
    return [Fault(f"{name}:{line}", text[:60].replace("\n", " "), why) for line, text, why in found]


def bad_sentences(text: str) -> Iterator[tuple[str, str]]:
    """Yield each faulty sentence of a text, and the reason."""
    for sentence in sentences(text):
        if banned := BANNED.search(sentence):
            yield sentence, f"says {banned.group()!r}"
        if sentence.startswith("What ") and not sentence.endswith("?"):
            yield sentence, "begins with 'What'"
        if (count := len(sentence.split())) > MOST_WORDS:
            yield sentence, f"has {count} words"


def sentences(text: str) -> Iterator[str]:
    """Yield the sentences of a text, without code, formulas, quotations and tables."""
    text = re.sub(r"^```[\s\S]*?^```$|^(?: {4}|\||#|>>>|!\[).*$", "\n\n", text, flags=re.M)
    text = re.sub(r"(?m)^\\x08\n(?:.+\n)*", "\n\n", text.replace("\b", "\\x08"))
    text = re.sub(r"`[^`]*`", "Code", text)
    text = re.sub(r"\]\([^)]*\)", "]", text)
    text = re.sub(r"\"[^\"]*\"|“[^”]*”", "quotation", text)
    for block in re.split(r"\n\s*\n|\n\s*(?:[-*>]|\d+\.)\s|\s·\s", text):
        flat = " ".join(block.split())
        yield from filter(None, re.split(r"(?<=[.!?:;])\s+(?=[A-Z(\"'`*-])", flat))


def bad_docstring(text: str) -> str | None:
    """Return why a docstring cannot be read alone, or None."""
    summary, *_ = text.strip().split("\n\n")
    if leaning := LEANING.match(summary):
        return f"begins with {leaning.group()!r}"
    if not summary.rstrip().endswith((".", ".)", ":")):
        return "its first sentence has no full stop"
    if not text.rstrip().endswith((".", ".)", "```", "|")) and ">>>" not in text:
        return "does not end with a full stop"
    return None


def docstrings(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the docstrings of a module, those of attributes too, with their lines."""
    for node in ast.walk(tree):
        if isinstance(node, Node) and (text := ast.get_docstring(node)) is not None:
            yield node.body[0].lineno, text
        if isinstance(node, ast.Module | ast.ClassDef):
            for before, after in zip(node.body, node.body[1:], strict=False):
                match after:
                    case ast.Expr(ast.Constant(str(text))) if isinstance(
                        before, ast.Assign | ast.AnnAssign
                    ):
                        yield after.lineno, text


def messages(tree: ast.Module) -> Iterator[tuple[int, str]]:
    """Yield the texts of errors, warnings and help, with their lines; values are `X`."""
    for node in ast.walk(tree):
        if not isinstance(node, ast.Call):
            continue
        name = (
            node.func.attr if isinstance(node.func, ast.Attribute) else getattr(node.func, "id", "")
        )
        texts = [x.value for x in node.keywords if x.arg == "help"]
        texts += node.args[:1] if ERRORS.match(name) else []
        texts += node.args[HELP[name] :][:1] if name in HELP else []
        yield from ((x.lineno, _text(x)) for x in texts)


def _text(node: ast.expr) -> str:
    """Return the text of a literal, with X for each value in it."""
    match node:
        case ast.Constant(str(text)):
            return text
        case ast.JoinedStr(values):
            return "".join(str(x.value) if isinstance(x, ast.Constant) else "X" for x in values)
        case ast.BinOp(left, ast.Add(), right):
            return _text(left) + _text(right)
    return ""
