"""The formats of documents, of rows and of pictures.

A format is one file in this folder and one row of `FORMATS`, from which `--format`, the extensions,
the help, the pages and the refusal of other names take it.  Its module has a `FORMAT` (see
`base.Format`), and is imported when it is used.
"""

from __future__ import annotations

from typing import NamedTuple


class Row(NamedTuple):
    """What is known of a format before it is imported."""

    extension: str
    """The extension of its files; a format without one is chosen by its name only."""
    holds: str


FORMATS = {
    "table": Row("", "texts and tables for people, drawn"),
    "csv": Row("csv", "the rows"),
    "json": Row("json", "everything"),
    "ndjson": Row("ndjson", "the rows, a JSON object per line"),
    "parquet": Row("parquet", "the rows as doubles and texts; needs pyarrow"),
    "markdown": Row("md", "texts and tables, for a report or an issue"),
}
WITH_COMMAS = {"csv": "csv.WITH_COMMAS"}
"""The forms of formats with decimal commas, which --decimal chooses."""
PICTURES, FILMS = ("png", "svg", "pdf"), ("gif", "mp4")
"""The extensions of pictures and films, which the plotting package writes."""
