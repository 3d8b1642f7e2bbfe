"""The table in a file: its first bytes determine the format, not its name."""

from __future__ import annotations

from ..file_bytes import decoded, read_bytes, shown_path
from .binary_tables import binary_table
from .text_tables import CountKnown, Table, read_table


def table_in(path: str, known: CountKnown, decimal: str = "", width: int | None = None) -> Table:
    """Return the table in a file, or in standard input for `-` (see `read_table`).

    Raises DataError for a bad file, UnavailableError for Parquet without pyarrow.
    """
    name, content = shown_path(path), read_bytes(path)
    if (table := binary_table(content, name)) is not None:
        return table
    text = decoded(content, name)
    del content  # one copy of a large file is enough
    return read_table(text, name, known, decimal, width)
