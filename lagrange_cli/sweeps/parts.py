"""A folder with one file for each part of a sweep; repeated runs compute only the missing parts.

The folder holds parts such as `part-000000.csv`, and `sweep.json`, which describes the sweep.  If
tops of a part have errors, `errors-000000.json` counts them.  Any number of runs of one sweep may
fill a folder at once.
"""

from __future__ import annotations

import json
import os
from collections.abc import Iterable, Iterator
from contextlib import suppress
from hashlib import sha256
from pathlib import Path
from secrets import token_hex

from .. import __version__
from ..errors import CannotWriteError, LagtopError
from ..file_bytes import read_bytes
from ..output.destination import opened
from ..output.formats import FORMATS, format_of
from .plan import NumberedBlock, Part, Sweep


def digest_of(path: str) -> str:
    """Return the SHA-256 digest of a file of tops.  Raises LagtopError for a pipe."""
    if path == "-" or (os.path.exists(path) and not os.path.isfile(path)):
        wanted = "a file of tops that can be read again"
        raise LagtopError(f"parts needs {wanted}, got {path}", "parts")
    return f"sha256:{sha256(read_bytes(path)).hexdigest()}"


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
        file, text = self.path / "sweep.json", f"{json.dumps(description, indent=1)}\n".encode()
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            if not (file.exists() or any(self.path.glob("part-*"))):
                _create(file, text)
            is_same = file.exists() and file.read_bytes() == text
        except OSError as error:
            raise CannotWriteError(f"cannot write {path}: {error.strerror}") from None
        if not is_same:
            raise CannotWriteError(
                f"cannot write {path}: it holds parts of another sweep (see sweep.json in it); "
                "take another folder or empty this one"
            )

    def _files(self, number: int) -> tuple[Path, Path]:
        """Return the file of a part, and the file that counts its errors."""
        extension = FORMATS[self.sweep.fmt.removesuffix("_comma")].extension
        part = self.path / f"part-{number:06}.{extension}"
        return part, self.path / f"errors-{number:06}.json"

    def missing(self, blocks: Iterable[NumberedBlock], done: list[Part]) -> Iterator[NumberedBlock]:
        """Yield the blocks whose parts are missing, and add the other parts to `done`."""
        for number, block in blocks:
            part, errors = self._files(number)
            counted = _counted(errors)
            if counted and part.is_file() and part.stat().st_size:
                self.found += 1
                done.append(Part(number, b"", block.size, *counted))
            else:
                yield number, block

    def write(self, parts: Iterable[Part]) -> None:
        """Write each part into a file of its own, which appears whole or not at all."""
        for number, text, _, failed, first, _ in parts:
            part, errors = self._files(number)
            if failed:  # before the part, because a part that exists is done
                with opened(str(errors)) as stream:
                    stream.write(json.dumps([failed, first]).encode())
            else:
                errors.unlink(missing_ok=True)  # that of a damaged part
            with opened(str(part)) as stream:
                stream.write(format_of(self.sweep.fmt).part(self.sweep.header, number, text))


def _create(file: Path, content: bytes) -> None:
    """Create a file with its whole content, unless another process has just created it."""
    temporary = file.with_name(f".lagtop-{token_hex(6)}")
    try:
        temporary.write_bytes(content)
        with suppress(FileExistsError):
            os.link(temporary, file)
    finally:
        temporary.unlink(missing_ok=True)


def _counted(errors: Path) -> tuple[int, str] | None:
    """Return the number of errors of a part and the first one, or None for a damaged file."""
    try:
        failed, first = json.loads(errors.read_bytes())
    except FileNotFoundError:
        return 0, ""
    except (OSError, ValueError, TypeError, RecursionError):
        return None
    return (failed, first) if type(failed) is int and failed > 0 and type(first) is str else None
