"""A folder of parts of one sweep, which runs resume or fill together.

The folder holds parts such as `part-000000.csv`, and `sweep.json`, which describes the sweep.  If
tops of a part have errors, an `errors-000000.json` counts them.  Any number of runs of one sweep
may fill a folder at once.
"""

from __future__ import annotations

import json
import os
import socket
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager, suppress
from copy import copy
from pathlib import Path
from secrets import token_hex
from typing import Any

from ..errors import CannotWriteError
from ..output.destination import opened
from ..output.formats import part_file
from .plan import Make, NumberedBlock, Part, Sweep, Tally

DESCRIPTION = "sweep.json"
_TEMPORARY = ".lagtop-"
_MOST_BYTES = 1 << 24
"""Bytes of a description, which may hold long lists of inputs."""


class Folder:
    """A folder that holds the parts of one sweep and of no other; workers unpickle it."""

    def __init__(self, path: str, sweep: Sweep, description: Mapping[str, Any]) -> None:
        """Take a folder for a sweep, and remove temporary files of killed runs.

        Raises CannotWriteError if the folder cannot be made or holds parts of another sweep.
        """
        self.path, self.sweep = Path(path), sweep
        self.found = 0  # parts of earlier runs
        self._token = ""
        try:
            self.path.mkdir(parents=True, exist_ok=True)
            self._claim(json.loads(json.dumps(description)))
            self._remove_leftovers()
        except OSError as error:
            raise CannotWriteError(f"cannot write {path}: {error.strerror}") from None

    def _part(self, number: int) -> Path:
        """Return the file of a part."""
        return self.path / f"part-{number:06}.{self.sweep.fmt}"

    def _errors(self, number: int) -> Path:
        """Return the file that counts the errors of a part."""
        return self.path / f"errors-{number:06}.json"

    def missing(self, blocks: Iterable[NumberedBlock], tally: Tally) -> Iterator[NumberedBlock]:
        """Yield the blocks whose parts are still missing, and count the others as done."""
        for number, block in blocks:
            if done := self._done(number, block.size):
                self.found += 1
                tally.add(done)
            else:
                yield number, block

    def write(self, parts: Iterable[Part]) -> None:
        """Write the parts that no worker has written."""
        for part in parts:
            if not part.is_written:
                self._write(part)

    def _write(self, part: Part) -> None:
        """Write a part into a file of its own, which appears whole or not at all."""
        if part.failed:  # before the part, because a part that exists counts as done
            errors = {"failed": part.failed, "first": part.first_error}
            with opened(str(self._errors(part.number)), _mark()) as stream:
                stream.write(json.dumps(errors).encode() + b"\n")
        content = part_file(self.sweep.fmt, self.sweep.header, part.number, part.text)
        with opened(str(self._part(part.number)), _mark()) as stream:
            stream.write(content)

    @contextmanager
    def made_by_workers(self) -> Iterator[Make]:
        """Yield the function that computes a part, and writes it on workers that see this folder.

        A file with a random name exists during the block.  Workers recognise the folder by it,
        because another machine may have a folder with the same path.  At the end, the temporary
        files of killed workers of this machine are removed.
        """
        there = copy(self)
        there.path, there._token = self.path.absolute(), f"{_TEMPORARY}{_mark()}{token_hex(8)}"
        token = self.path / there._token
        try:
            token.touch()
        except OSError as error:
            raise CannotWriteError(f"cannot write {self.path}: {error.strerror}") from None
        try:
            yield there._made
        finally:
            with suppress(OSError):
                token.unlink()
                self._remove_leftovers()

    def _made(self, numbered: NumberedBlock) -> Part:
        """Compute a part, and write it if this machine sees the folder and may write to it."""
        part = self.sweep.part(numbered)
        if not ((self.path / self._token).exists() and os.access(self.path, os.W_OK)):
            return part
        self._write(part)
        return part._replace(text=b"", is_written=True)

    def _done(self, number: int, count: int) -> Part | None:
        """Return a part that is complete, without its text, or None if it must be computed.

        If the count of errors is damaged, the part is computed again.
        """
        errors = self._errors(number)
        if not _is_there(self._part(number)):
            return None
        found = {"failed": 0, "first": ""}
        if _is_there(errors):
            found = _object_in(errors) or {}
        failed, first = found.get("failed"), found.get("first")
        if isinstance(failed, int) and isinstance(first, str):
            return Part(number, b"", count, failed, first)
        return None

    def _claim(self, description: Mapping[str, Any]) -> None:
        """Write the description, or compare it with the existing one."""
        file = self.path / DESCRIPTION
        if not _is_there(file):
            if alien := next(self.path.glob("part-*"), None):
                raise CannotWriteError(
                    f"cannot write {self.path}: {alien.name} is there without a {DESCRIPTION}; "
                    "take another folder or empty this one"
                )
            _create(file, f"{json.dumps(description, indent=1)}\n".encode())
        other = _object_in(file)
        if other is None:
            raise CannotWriteError(f"cannot write {self.path}: {DESCRIPTION} describes no sweep")
        if difference := _difference(other, description):
            raise CannotWriteError(
                f"cannot write {self.path}: it holds parts of another sweep, {difference}; "
                "take another folder or empty this one"
            )

    def _remove_leftovers(self) -> None:
        """Remove the temporary files of runs on this machine that have ended."""
        for file in self.path.glob(f"{_TEMPORARY}*@{_host()}@*"):
            pid = file.name.removeprefix(_TEMPORARY).partition("@")[0]
            if pid.isdecimal() and not _is_running(int(pid)):
                file.unlink(missing_ok=True)


def _is_there(path: Path) -> bool:
    """Return whether a file exists.  Raises CannotWriteError if it is not a regular one."""
    if path.exists() and not path.is_file():
        raise CannotWriteError(f"cannot write {path}: it is there, and is no regular file")
    return path.exists()


def _object_in(path: Path) -> dict[str, Any] | None:
    """Return the JSON object in a file, or None if the file holds none."""
    with path.open("rb") as file:
        try:
            found = json.loads(file.read(_MOST_BYTES))
        except (ValueError, RecursionError):
            return None
    return found if isinstance(found, dict) else None


def _create(file: Path, content: bytes) -> None:
    """Write a new file, whole; keep a file that another run has made meanwhile."""
    own = file.with_name(f"{_TEMPORARY}{_mark()}{file.name}")
    own.write_bytes(content)
    try:
        os.link(own, file)
    except FileExistsError:
        pass
    except OSError:  # a file system without links
        if not file.exists():
            own.replace(file)
    finally:
        own.unlink(missing_ok=True)


def _difference(one: Mapping[str, Any], other: Mapping[str, Any]) -> str:
    """Return how two descriptions first differ, as text; empty if they agree."""
    for key in dict.fromkeys([*one, *other]):
        there, here = one.get(key), other.get(key)
        if there == here:
            continue
        if isinstance(there, dict) and isinstance(here, dict):
            return _difference(there, here)
        return f"{key} {_shown(there)} there and {_shown(here)} here"
    return ""


def _shown(value: object) -> str:
    text = ",".join(map(str, value)) if isinstance(value, list) else str(value)
    return text if len(text) <= 60 else f"{text[:57]}..."


def _mark() -> str:
    """Return a mark for temporary files of this process: its machine and number."""
    return f"{os.getpid()}@{_host()}@"


def _host() -> str:
    return socket.gethostname().replace(os.sep, "_")


def _is_running(pid: int) -> bool:
    """Return whether a process of this machine is running; True if that cannot be determined."""
    if os.name != "posix":
        return True
    try:
        os.kill(pid, 0)
    except ProcessLookupError:
        return False
    except OSError:
        return True
    return True
