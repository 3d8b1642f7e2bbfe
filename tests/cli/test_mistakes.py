"""Mistakes of newcomers get one line with the remedy; any words end as documented."""

from __future__ import annotations

import os
from contextlib import chdir
from pathlib import Path
from tempfile import TemporaryDirectory

import click
import pytest
from click.testing import CliRunner
from conftest import Lagtop
from hypothesis import given, settings
from hypothesis import strategies as st

from lagrange_cli.cli.app import NAMES, main

MISTAKES = {
    "solve|--m|2|kg": "put a value with its unit in quotes: --m '2 kg'",
    "solve|--theta0|0.5|rad": "put a value with its unit in quotes: --theta0 '0.5 rad'",
    "solve|--r0|50|rad/s": "put a value with its unit in quotes: --r0 '50 rad/s'",
    "solve|--get|K|--derivation": "use --get or --derivation, not both",
    "solve|r0=50": "an input is not a scene: write --r0 50",
    "solve|rpm.toml": 'line 2, column 9) (write r0 = "50 rpm")',
    "solve|comma.toml": "(write a decimal point, not a comma)",
    "solve|quotes.toml": "r0 must have a unit between quotes, got '3': leave out the quotes",
    "solve|--s|24,0(2) cm": "(write a decimal point, not a comma)",
    "solve|--s|24.0 cm ± 0.2 cm": "must have its unit once, at the end, as in '24.0 ± 0.2 cm'",
    "solve|--A|3 kgm^2": "write kg*m^2)",
    "solve|--r0|3000 1/min": "turns or radians? write rpm or rad/min, turn/h or rad/h",
    "solve|--r0|3000/min": "turns or radians? write rpm",
    "solve|--r0|50 min^-1": "turns or radians? write rpm",
    "solve|--r0|9 1/h": "turns or radians? write rpm or rad/min, turn/h or rad/h",
    "solve|--r0|50Hz": "turns or radians per second? write rpm, turn/s or rad/s",
    "solve|--r0|50RPM": "did you mean 'rpm'?)",
    "solve|--m|0.35kg|--s|0.03": "must have a unit such as m or cm, as the input m has, got none",
    "solve|--m|1,5": "(write a decimal point, not a comma)",
    "solve|--r0|1_000": "(leave out the underscores)",
    "solve|--r0|\u221250": "(write the minus sign as an ASCII hyphen, -)",
    "solve|--spin|50": "--spin (did you mean '--r0', '--phidot0' or '--spin-period'?)",
    "solve|--omega|50": "--omega (did you mean '--r0', '--phidot0' or '--spin-period'?)",
    "solve|--phidot|50": "no such option --phidot (did you mean '--phidot0'?)",
    "solve|-m|5": "no such option -m (did you mean '--m'?): see lagtop solve --help",
    "solve|--mass|5": "no such option --mass (did you mean '--m', '--A-cm' or '--s'?)",
    "solve|--keys|K": "no such option --keys (did you mean '--get'?)",
    "sweep|--get|K": "no such option --get (did you mean '--keys'?)",
    "plot|theta|looping-top|-o|a.svg": "'theta' is neither a kind of picture nor a scene: draw sph",
    "compare|--sigma|1": "no such option --sigma: see lagtop compare --help",
    "--r0|50": "put a command in front of it, as in lagtop solve --r0",
    "slove": "no such command: 'slove' (did you mean 'solve'?)",
    "xyz": "Error: no such command: 'xyz': see lagtop --help",
    "help": "no such command: 'help' (did you mean '--help'?)",
    "version": "no such command: 'version' (did you mean '--version'?)",
    "solve|-o|a.table": "cannot write table: use csv, json, ndjson, parquet, md, txt as extension",
    "fit|rec.csv|-o|a.tex": "cannot write tex: use csv, json, ndjson, parquet, md, txt, toml as",
    "solve|--get|T_nutation,|T_spin": "must be comma-separated names without blanks",
    "solve|nosuch": "No such file or directory (the built-in scenes are ",
    "sweep|--r0|40-60": "--r0 must be a number or a range with its unit once, at the end, as in",
    "sweep|--r0|10..60 rpm": "as in '60:80:3 rpm', got '10..60 rpm'",
    "find|--r0|10-60|T_nutation=1": "as in '60:80 rpm', got '10-60'",
    "find|--r0|1rpm:2rpm|T_nutation=1": "with its unit once, at the end, as in '60:80 rpm'",
    "sweep|recording.csv": "got a recording with the columns t, theta: pass it to fit or compare",
    "solve|recording.csv": ": pass a recording to fit or compare, a table of tops to sweep",
    "solve|long.csv": ": pass a recording to fit or compare, a table of tops to sweep",
    "view|top.html": "nothing to do: give -o FILE.html or --open",
    "plot|sphere|top.svg": "nothing to do: give -o FILE.png or --animate FILE.gif",
    "fit|rec.csv|--sigma|theta:0.2": "--sigma must be one number or theta=0.3,psi=0.5, got 'theta",
    "fit|rec.csv|--sigma|theta=1,psi:2": "must be one number or theta=0.3,psi=0.5, got 'theta=1,ps",
    "fit|rec.csv|--sigma|0.2,0.3,1": "must be one number or theta=0.3,psi=0.5, got '0.2,0.3,1'",
    "solve|--r0|50 U/min": "(write rpm or turn/s)",
    "table|--t-max|1e15": "--digits",
    "find|T_nutation=1": "unknown inputs as ranges, such as --r0 10:200, got 0",
    "compare|bare.csv": "has no header: name its 2 columns, for example --columns t,quaternion",
    "compare|thousands.csv": "use --decimal point or --decimal comma",
}
"""Words of a command line, and the remedy."""
FILES = {
    "rpm.toml": "m = 2\nr0 = 50 rpm\n",
    "comma.toml": "m = 1,5\n",
    "quotes.toml": 'r0 = "3"\n',
    "bare.csv": "0 1\n",
    "recording.csv": "t,theta\n0,30\n1,31\n",
    "long.csv": "t,theta\n" + "0,30\n" * 4000,
    "thousands.csv": "t;theta\n1,234;30\n",
}


@pytest.mark.parametrize("words", MISTAKES)
def test_a_mistake_gets_its_remedy(
    words: str, lagtop: Lagtop, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    for name, text in FILES.items():
        (tmp_path / name).write_text(text)
    found = lagtop(*words.split("|"))
    last = found.stderr.splitlines()[-1]
    assert last.startswith("Error: ")
    assert MISTAKES[words] in last
    is_file = words.rsplit("|", maxsplit=1)[-1] in {*FILES, "nosuch"}
    assert (found.stdout, found.exit_code) == ("", 65 if is_file else 2)


# Any words


CODES = {0, 1, 2, 65, 69, 74}
ODD = [
    *"- 0 -1 1.5 nan inf 1e400 1e-400 480rpm 1(2) 1:2:3 log:1:9:3 1,2 2:1:0 steady comma".split(),
    *"csv table x.toml no/x.csv T_nutation K,k t,axis period 0.8i 2K θ looping-top nosuch".split(),
    *"T_nutation=0.4 r0=1:2:3 start up=y -- /dev/full \udcff".split(),
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
