"""The shared parts of scripts that search for faults: options, exit codes and reports."""

from __future__ import annotations

import argparse
import sys
import time
from collections.abc import Iterable
from typing import NoReturn


def options(doc: str | None, **counts: int) -> argparse.ArgumentParser:
    """Return a parser with the first line of a docstring, some counts, and a seed."""
    parser = argparse.ArgumentParser(description=(doc or "").partition("\n")[0])
    for name, default in {**counts, "seed": 1}.items():
        parser.add_argument(f"--{name}", type=int, default=default, help=f"[default: {default}]")
    return parser


def fault_of(code: int, stderr: str, codes: Iterable[int] = (0, 1, 2, 65, 69, 74)) -> str:
    """Return the fault in the end of a command, or an empty text.

    A command must end with a documented exit code.  If it fails, the last line must say why.  No
    line may have a traceback, a warning of a library or control characters.
    """
    said = stderr.splitlines()
    if code not in codes:
        return f"exit code {code}: {stderr[-400:]!r}"
    if any("Traceback" in x or ".py:" in x or not x.isprintable() for x in said):
        return f"says {stderr[-200:]!r}"
    if code and not (said and said[-1].startswith("Error: ")):
        return f"exit code {code} without a reason: {said[-1:]}"
    return ""


def finish(faults: Iterable[str], *, longest: int = 400) -> NoReturn:
    """Print the faults as they come, their number and the time; exit with 1 if there are any."""
    begun, count = time.perf_counter(), 0
    for fault in faults:
        count += 1
        print(ascii(fault)[:longest], flush=True)
    print(f"{count} faults, {time.perf_counter() - begun:.0f} s")
    sys.exit(1 if count else 0)
