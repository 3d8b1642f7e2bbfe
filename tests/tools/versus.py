"""Compare the CPU time of this program with that of commit eec8223; not collected by pytest.

    python tests/tools/versus.py 'solve --format json' 'table --n 100000 -o /dev/null'
    python tests/tools/versus.py -n 15 --snippet 'from lagtop import *' 'solve(Top()).T_nutation'

Each argument is a command line of lagtop, timed as a process of its own with its start-up, or with
--snippet a statement in Python, timed in one process after the set-up and one warm run.  Old and
new take turns, and the ratio is that of the minima.  The old version is taken from the history
into a temporary folder, and runs on the packages of this environment.
"""

from __future__ import annotations

import argparse
import os
import resource
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
OLD = "eec8223"
TIMED = """
import sys, time
setup, statement = map(lambda text: compile(text, "snippet", "exec"), sys.argv[1:])
names = {}
exec(setup, names)
exec(statement, names)
least, runs, start = 1e9, 0, time.process_time()
while runs < 3 or time.process_time() - start < 0.2:
    before = time.process_time()
    exec(statement, names)
    least, runs = min(least, time.process_time() - before), runs + 1
print(least)
"""


def seconds(tree: Path, argument: str, setup: str | None) -> float:
    """Return the CPU time of one run of a command or, least of several, of a snippet."""
    environment = os.environ | {"PYTHONPATH": str(tree)}
    environment.pop("PYTHONDONTWRITEBYTECODE", None)
    if setup is not None:
        command = [sys.executable, "-P", "-c", TIMED, setup, argument]
        return float(subprocess.check_output(command, env=environment).split()[-1])
    command = ["sh", "-c", f'exec "$0" -P -m lagrange_cli {argument}', sys.executable]
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.check_output(command, env=environment)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def main() -> None:
    """Run the command line."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("arguments", nargs="+", help="commands of lagtop, or statements")
    parser.add_argument("-n", type=int, default=9, help="turns of old and new")
    parser.add_argument("--snippet", metavar="SETUP", help="time statements after this set-up")
    options = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        archive = subprocess.check_output(["git", "archive", OLD], cwd=ROOT)
        subprocess.run(["tar", "-x", "-C", folder], input=archive, check=True)
        Path(folder, "lagrange_cli/alias.py").rename(Path(folder, "lagtop.py"))
        for argument in options.arguments:
            trees = Path(folder), ROOT
            turns = [
                [seconds(tree, argument, options.snippet) for tree in trees]
                for _ in range(options.n + 1)  # the first turn writes bytecode
            ]
            old, new = (min(times) for times in zip(*turns[1:], strict=True))
            print(f"{new / old:6.3f}  old {1e3 * old:.2f} ms, new {1e3 * new:.2f} ms  {argument}")


if __name__ == "__main__":
    main()
