"""Any words on a command line end as documented."""

from __future__ import annotations

import os
from contextlib import chdir
from tempfile import TemporaryDirectory

import click
import pytest
from click.testing import CliRunner
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_cli.cli.app import NAMES, main

CODES = {0, 1, 2, 65, 69, 74}
ODD = [
    *"- 0 -1 1.5 nan inf 1e400 1e-400 480rpm 1(2) 1:2:3 log:1:9:3 1,2 2:1:0 steady comma".split(),
    *"csv table x.toml no/x.csv T_nutation K,k t,axis period 0.8i 2K θ looping-top nosuch".split(),
    *"T_nutation=0.4 r0=1:2:3 start up=y -- /dev/full \udcff \ud800".split(),
    *("", "30 deg", "5 Hz", "\x1b[31m\x07", "x" * 3000),
]


@st.composite
def lines(draw: st.DrawFn) -> list[str]:
    """Return a command with some of its options, and odd values."""
    name = draw(st.sampled_from([x for x in NAMES if x not in {"bench", "stability", "view"}]))
    command = main.get_command(click.Context(main), name)
    flags = [flag for param in command.params for flag in param.opts if flag.startswith("--")]
    line = [name]
    for _ in range(draw(st.integers(0, 4))):
        line += draw(st.sampled_from([[draw(st.sampled_from(flags))], []]))
        text = st.text(st.characters(exclude_characters="\0"), max_size=4)
        line.append(draw(st.sampled_from(ODD) | text))
    if name in {"table", "jacobi", "eta", "sweep"} and "--help" not in line:
        line += ["--format", "csv"]
    return line


@pytest.mark.slow
@settings(max_examples=300)
@given(lines())
def test_any_words_end_as_documented(line: list[str]) -> None:
    with TemporaryDirectory() as folder, chdir(folder):
        ended = CliRunner().invoke(main, line)
        left = [name for name in os.listdir() if name.startswith(".lagtop")]
    assert left == []
    assert ended.exit_code in CODES, ended.exception
    said = ended.stderr.splitlines()
    assert all(x.isprintable() for x in said)
    assert not any("Traceback" in x or ("Warning:" in x and ".py" in x) for x in said)
    assert not ended.exit_code or said[-1].startswith("Error: ")
