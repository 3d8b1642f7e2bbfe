"""A folder with one file for each part of a sweep; repeated runs compute only the missing parts.

The folder holds parts such as `part-000000.csv`, and `sweep.json`, which describes the sweep.  If
tops of a part have errors, `errors-000000.json` counts them.  Any number of runs of one sweep may
fill a folder at once.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path
from secrets import token_hex
from typing import Any

from ..errors import CannotWriteError, LagtopError
from ..output.destination import opened
from ..output.formats import part_file
from .plan import ErrorCount, NumberedBlock, Part, Sweep

DESCRIPTION = "sweep.json"


class Parts:
    """The folder of one sweep and of no other."""

    def __init__(self, path: str, sweep: Sweep, description: Mapping[str, Any]) -> None:
        """Take a folder for a sweep.

        Raises CannotWriteError if the folder cannot be made or holds parts of another sweep, and
        LagtopError for an empty name.
        """
        if not path:
            raise LagtopError("--parts must name a folder, got ''")
        self.path, self.sweep, self.found = Path(path), sweep, 0
        text = f"{json.dumps(description, indent=1)}\n".encode()
        file = self.path / DESCRIPTION
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            if not file.exists() and not next(self.path.glob("part-*"), None):
                _create(file, text)
            is_same = file.exists() and file.read_bytes() == text
        except OSError as error:
            raise CannotWriteError(f"cannot write {path}: {error.strerror}") from None
        if not is_same:
            raise CannotWriteError(
                f"cannot write {path}: it holds parts of another sweep (see {DESCRIPTION} in it); "
                "take another folder or empty this one"
            )

    def _part(self, number: int) -> Path:
        return self.path / f"part-{number:06}.{self.sweep.fmt}"

    def _errors(self, number: int) -> Path:
        return self.path / f"errors-{number:06}.json"

    def missing(self, blocks: Iterable[NumberedBlock], count: ErrorCount) -> Iterator[Any]:
        """Yield the blocks whose parts are missing; `count` the errors of the others."""
        for number, block in blocks:
            try:
                done = self._part(number).exists()
                failed, first = 0, ""
                if self._errors(number).exists():
                    failed, first = json.loads(self._errors(number).read_bytes())
            except (OSError, ValueError, TypeError):  # it is computed again
                done = False
            if done:
                self.found += 1
                count.add(Part(number, b"", block.size, failed, first))
            else:
                yield number, block

    def write(self, parts: Iterable[Part]) -> None:
        """Write each part into a file of its own, which appears whole or not at all."""
        for part in parts:
            if part.failed:  # before the part, because a part that exists is done
                with opened(str(self._errors(part.number))) as stream:
                    stream.write(json.dumps([part.failed, part.first_error]).encode())
            content = part_file(self.sweep.fmt, self.sweep.header, part.number, part.text)
            with opened(str(self._part(part.number))) as stream:
                stream.write(content)


def _create(file: Path, content: bytes) -> None:
    """Write a new file, whole; keep a file that another run has made meanwhile."""
    own = file.with_name(f".lagtop-{token_hex(6)}")
    own.write_bytes(content)
    try:
        os.link(own, file)
    except FileExistsError:
        pass
    except OSError:  # a file system without links
        own.replace(file)
    finally:
        own.unlink(missing_ok=True)
