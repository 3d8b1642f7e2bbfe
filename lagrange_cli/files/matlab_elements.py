"""A check of the data elements of a MATLAB file (version 5), before SciPy reads them.

SciPy trusts their types and sizes, and crashes on a file in which they are damaged.
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator

_HEADER, _TAG, _SMALL = 128, 8, 4
"""Bytes of the header of a file, of a tag, and the most data of an element within its tag."""
_MATRIX, _COMPRESSED, _FLAGS = 14, 15, 6
_NUMBERS = {1, 2, 3, 4, 5, 6, 7, 9, 12, 13}
"""Types of data that are numbers."""
_TYPES = _NUMBERS | {_MATRIX, _COMPRESSED, 16, 17, 18}
_COMPLEX = 0x800
_NESTED, _TEXT, _SPARSE, _NUMERIC = range(1, 4), 4, 5, range(6, 16)
"""Classes of arrays: cells, structs and objects; text; sparse ones; numbers."""
_LARGEST_CLASS = 17


def check_elements(content: bytes, largest: int) -> None:
    """Raise ValueError unless the elements of a file fill it and hold what their types say.

    `largest` is the most bytes that a compressed element may have.
    """
    order = "<" if content[126:_HEADER] == b"IM" else ">"
    for kind, data in _elements(content[_HEADER:], order):
        inner = [(kind, data)]
        if kind == _COMPRESSED:
            inner = [*_elements(zlib.decompressobj().decompress(data, largest), order)]
        for inner_kind, matrix in inner:
            _require(inner_kind == _MATRIX)
            _check_matrix(matrix, order)


def _require(is_sound: bool) -> None:
    if not is_sound:
        raise ValueError("its elements are damaged or cut off")


def _elements(data: bytes, order: str) -> Iterator[tuple[int, bytes]]:
    """Yield the types and the data of elements, which are padded to eight bytes."""
    at = 0
    while at < len(data):
        _require(at + _TAG <= len(data))
        kind, size = struct.unpack_from(order + "II", data, at)
        begin = at + _TAG
        if kind >> 16:
            kind, size, begin = kind & 0xFFFF, kind >> 16, at + _TAG - _SMALL
            _require(size <= _SMALL)
        _require(kind in _TYPES and begin + size <= len(data))
        yield kind, data[begin : begin + size]
        at = begin + size
        at += 0 if kind == _COMPRESSED else -at % 8


def _check_matrix(data: bytes, order: str) -> None:
    """Raise ValueError unless an array has the parts of its class; an empty one has none."""
    parts = [*_elements(data, order)]
    if not parts:
        return
    kind, first = parts[0]
    _require(kind == _FLAGS and len(first) == _TAG)
    (flags,) = struct.unpack_from(order + "I", first)
    kind, more = flags & 0xFF, bool(flags & _COMPLEX)
    _require(1 <= kind <= _LARGEST_CLASS)
    counts = {_TEXT: 4, _SPARSE: 6 + more} | dict.fromkeys(_NUMERIC, 4 + more)
    _require(kind not in counts or len(parts) == counts[kind])
    if kind in _NUMERIC:
        _require(all(x in _NUMBERS for x, _ in parts[3:]))
    if kind in _NESTED:
        for inner, matrix in parts[2:]:
            if inner == _MATRIX:
                _check_matrix(matrix, order)
