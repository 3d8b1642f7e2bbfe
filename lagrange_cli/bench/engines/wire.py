"""Messages between the bench and the process of an engine: a line of JSON, and bytes after it."""

from __future__ import annotations

import json
from typing import IO


class EngineError(Exception):
    """The engine could not do it; the message is its own."""


def send(stream: IO[bytes], payload: bytes = b"", error: str = "") -> None:
    """Write a message: bytes, or why there are none."""
    head = json.dumps({"size": len(payload), "error": error})
    stream.write(head.encode() + b"\n" + payload)
    stream.flush()


def receive(stream: IO[bytes]) -> bytes:
    """Read the bytes of a message.

    Raises EngineError if it has an error instead, and EOFError where the other side is gone.
    """
    head = stream.readline()
    if not head.endswith(b"\n"):
        raise EOFError
    message = json.loads(head)
    if message["error"]:
        raise EngineError(message["error"])
    payload = stream.read(message["size"])
    if len(payload) < message["size"]:
        raise EOFError
    return payload
