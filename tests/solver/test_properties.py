"""A property of all doubles, searched by hypothesis."""

from __future__ import annotations

import math

import numpy as np
import orjson
from hypothesis import given
from hypothesis import strategies as st

from lagrange_cli.arithmetic.text import double_text, value_text
from lagrange_cli.output.formats import block_text
from lagrange_cli.output.text import csv_text


@given(st.floats(allow_nan=False, allow_infinity=False))
def test_a_double_has_one_text_in_every_format(x: float) -> None:
    text = double_text(x)
    assert text.encode() == orjson.dumps(x)
    assert text == value_text(x) == csv_text(x)
    assert f"{text}\n".encode() == block_text([np.array([[x]])], ["x"], "csv")
    assert f'{{"x":{text}}}\n'.encode() == block_text([np.array([[x]])], ["x"], "ndjson")
    assert math.copysign(1, float(text)) == math.copysign(1, x)
    assert float(text) == x
