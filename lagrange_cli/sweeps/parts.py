"""A folder with one file for each part of a sweep; repeated runs compute only the missing parts.

The folder holds parts such as `part-000000.csv`, and `_sweep.json`, which describes the sweep.
`_part-000000.json` has the size of a part and counts its tops, rows and errors; it is written after
the part, which is then done.  Readers of folders skip names that begin with `_`.  Any number of
runs of one sweep may fill a folder at once.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from secrets import token_hex
from typing import Any

from .. import __version__
from ..arithmetic.text import shortened
from ..errors import CannotWriteError, LagtopError, arg
from ..file_bytes import read_bytes
from ..output.destination import opened
from ..output.formats import FORMATS
from ..output.formats.base import format_of
from .plan import NumberedBlock, Part, Sweep


def digest_of(path: str, decimal: str = "") -> str:
    """Return the SHA-256 digest of a file of tops, and the decimal mark with which it is read.

    Raises LagtopError for a pipe.
    """
    if path == "-" or (os.path.exists(path) and not os.path.isfile(path)):
        wanted = "a file of tops that can be read again"
        raise LagtopError(f"parts needs {wanted}, got {path}", "parts")
    mark = f" with the decimal mark {decimal}" if decimal else ""
    return f"sha256:{sha256(read_bytes(path)).hexdigest()}{mark}"


class Parts:
    """The folder of one sweep and of no other."""

    def __init__(self, path: str, sweep: Sweep, digest: str = "") -> None:
        """Take a folder for a sweep, or for that of a file of tops with a `digest`.

        Raises CannotWriteError if the folder cannot be made or holds parts of another sweep, and
        LagtopError for an empty name.
        """
        if not path:
            raise LagtopError("parts must name a folder, got ''", "parts")
        self.path, self.sweep, self.found = Path(path), sweep, 0
        description = {"lagtop": __version__, **sweep._asdict(), "file": digest}
        file, text = self.path / "_sweep.json", f"{json.dumps(description, indent=1)}\n".encode()
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            there = file.read_bytes() if file.is_file() else b""
            if not any(self.path.glob("part-*")):
                if there != text and text.startswith(there) and file.is_file():
                    file.unlink()  # a run was killed while it wrote
                if not file.exists():
                    _create(file, text)
                there = file.read_bytes() if file.is_file() else b""
        except OSError as error:
            raise CannotWriteError(f"cannot write {path}: {error.strerror}") from None
        if there != text:
            raise CannotWriteError(
                f"cannot write {path}: it holds parts of another sweep{_difference(there, text)}; "
                "take another folder or empty this one"
            )

    def _files(self, number: int) -> tuple[Path, Path]:
        """Return the file of a part, and the file that describes it."""
        extension = FORMATS[self.sweep.fmt.partition(".")[0]].extension
        part = self.path / f"part-{number:06}.{extension}"
        return part, self.path / f"_part-{number:06}.json"

    def missing(self, blocks: Iterable[NumberedBlock], done: list[Part]) -> Iterator[NumberedBlock]:
        """Yield the blocks whose parts are missing, and add the other parts to `done`."""
        for number, block in blocks:
            part, about = self._files(number)
            found = _described(about) if about.is_file() else None
            if found and part.is_file() and part.stat().st_size == found[0]:
                self.found += 1
                done.append(Part(number, b"", *found[1:]))
            else:
                yield number, block

    def write(self, parts: Iterable[Part]) -> None:
        """Write each part into a file of its own, which appears whole or not at all."""
        for number, text, *counts in parts:
            content = format_of(self.sweep.fmt).part(self.sweep.header, number, text)
            part, about = self._files(number)
            about.unlink(missing_ok=True)  # that of a damaged part
            for path, written in (
                (part, content),
                (about, json.dumps([len(content), *counts]).encode()),
            ):
                with opened(str(path)) as stream:
                    stream.write(written)


def _create(file: Path, content: bytes) -> None:
    """Create a file with its whole content, unless another process has just created it."""
    temporary = file.with_name(f".lagtop-{token_hex(6)}")
    try:
        temporary.write_bytes(content)
        with suppress(FileExistsError):
            try:
                os.link(temporary, file)
            except FileExistsError:
                raise
            except OSError:  # a file system without links
                _write_new(file, content)
    finally:
        temporary.unlink(missing_ok=True)


def _write_new(file: Path, content: bytes) -> None:
    """Create a file that does not exist; it does not stay if it cannot be written as a whole."""
    with file.open("xb") as stream:
        try:
            stream.write(content)
            stream.flush()
        except BaseException:
            file.unlink()
            raise


def _difference(there: bytes, here: bytes) -> str:
    """Return the first entry of `there` that differs from `here`, for a message."""
    try:
        old, new = json.loads(there), json.loads(here)
        name = next(x for x in sorted(new, key="header".__eq__) if old[x] != new[x])
    except (ValueError, LookupError, TypeError, RecursionError, StopIteration):
        return ""
    value = old[name]
    text = ",".join(value) if name in {"keys", "header"} else json.dumps(value)
    option = arg({"fmt": "format"}.get(name, name)) if name in {"keys", "where", "fmt"} else name
    return f", with {option} {shortened(text)}"


def _described(about: Path) -> list[Any] | None:
    """Return the size of the file of a part and its counts, or None for a damaged file."""
    try:
        fields = json.loads(about.read_bytes())
        types = [*map(type, fields)]
    except (OSError, ValueError, TypeError, RecursionError):
        return None
    return fields if types == [int, int, int, int, str, int] else None
