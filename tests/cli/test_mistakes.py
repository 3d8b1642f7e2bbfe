"""Mistakes of people who use lagtop for the first time: each gets one line with the remedy."""

from __future__ import annotations

from pathlib import Path

import pytest
from conftest import Lagtop

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
    "solve|--A|3 kgm^2": "(write kg*m^2)",
    "solve|--r0|3000 1/min": "turns or radians? write rpm or rad/min, turn/h or rad/h",
    "solve|--r0|3000/min": "turns or radians? write rpm",
    "solve|--r0|50 min^-1": "turns or radians? write rpm",
    "solve|--r0|9 1/h": "turns or radians? write rpm or rad/min, turn/h or rad/h",
    "solve|--r0|50Hz": "turns or radians per second? write rpm, turn/s or rad/s",
    "solve|--r0|50RPM": "(did you mean 'rpm'?)",
    "solve|--m|0.35kg|--s|0.03": "must have a unit such as m or cm, as the input m has, got none",
    "solve|--m|1,5": "(write a decimal point, not a comma)",
    "solve|--r0|1_000": "(leave out the underscores)",
    "solve|--r0|\u221250": "(write the minus sign as an ASCII hyphen, -)",
    "solve|--theta0|200": "--theta0 must be in [0, 180], got 200.0",
    "solve|--spin|50": "no such option --spin (did you mean '--r0' or '--phidot0'?)",
    "solve|--omega|50": "no such option --omega (did you mean '--r0' or '--phidot0'?)",
    "solve|--phidot|50": "no such option --phidot (did you mean '--phidot0'?)",
    "solve|--theta|3": "no such option --theta (did you mean '--theta0'?)",
    "solve|-m|5": "no such option -m (did you mean '--m'?): see lagtop solve --help",
    "solve|--M|5": "no such option --M (did you mean '--m'?)",
    "solve|--mass|5": "no such option --mass (did you mean '--m' or '--s'?)",
    "solve|--keys|K": "no such option --keys (did you mean '--get'?)",
    "sweep|--get|K": "no such option --get (did you mean '--keys'?)",
    "plot|theta|looping-top|-o|a.svg": "'theta' is neither a kind of picture nor a scene: draw sph",
    "compare|--sigma|1": "no such option --sigma: see lagtop compare --help",
    "--r0|50": "put a command in front of it, as in lagtop solve --r0",
    "slove": "no such command: 'slove' (did you mean 'solve'?)",
    "xyz": "Error: no such command: 'xyz': see lagtop --help",
    "help": "no such command: 'help' (did you mean '--help'?)",
    "version": "no such command: 'version' (did you mean '--version'?)",
    "solve|-o|a.table": "solve cannot write table: use json, csv, ndjson, txt as extension of 'a.",
    "fit|rec.csv|-o|a.tex": "fit cannot write tex: use csv, json, ndjson, txt, toml as extension",
    "solve|--get|T_nutation,|T_spin": "must be comma-separated names without blanks",
    "solve|--get|Tnutation": "did you mean 'T_nutation'",
    "solve|looping": "did you mean 'looping-top'",
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
    "sweep|--r0|60rpm:80rpm:3": "with its unit once, at the end, as in '60:80:3 rpm'",
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
    is_file = words.rsplit("|", maxsplit=1)[-1] in {*FILES, "looping", "nosuch"}
    assert (found.stdout, found.exit_code) == ("", 65 if is_file else 2)
