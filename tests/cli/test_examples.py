"""Every example of every `--help` runs as it stands, in bash."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from collections.abc import Iterator
from pathlib import Path

import click
import numpy as np
import pytest
from conftest import ROOT
from engines import Body, dop853, rk4
from scipy.spatial.transform import Rotation

from lagrange_cli import Top
from lagrange_cli.cli.command import ExamplesFirst
from lagrange_cli.cli.group import main

SHORTER = {
    "lagtop bench": "lagtop bench --methods lagtop,theta-series --n 3 --limit 0.5",
    "lagtop stability": "lagtop stability --samples 1 --strata fast",
    " --strata separatrix,thresholds --samples 50": "",
    " --thorough": "",
    "--t-max 100 --n 1e5": "--t-max 1 --n 30",
    "--n 1e6": "--n 1e4",
    "--animate top.gif": "--animate top.gif --dpi 30",
    "--methods lagtop,engines --n 1000": "--methods lagtop,mujoco --n 3",
}
"""What a test has no time for: minutes of measurement.  Later options win over these."""
SLOW = ("plot", "bench", "stability")


def commands() -> Iterator[ExamplesFirst]:
    """Yield the group and its commands."""
    context = click.Context(main)
    for command in [main, *(main.get_command(context, x) for x in main.list_commands(context))]:
        assert isinstance(command, ExamplesFirst)
        yield command


EXAMPLES = [
    pytest.param(x, marks=[pytest.mark.slow] if command.name in SLOW else [], id=x)
    for command in commands()
    for x in command.examples
]


JQ = """
import json, sys
options = ("-c",)
key, *files = [word for word in sys.argv[1:] if word not in options]
for line in open(files[0]) if files else sys.stdin:
    print(json.dumps(json.loads(line)[key.removeprefix(".")]))
"""
"""The tool jq, as far as the examples need it: one key of every line."""


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Return a folder with the files that the examples read, and a `lagtop` on the PATH."""
    (tmp_path / "sample_inputs").symlink_to(ROOT / "sample_inputs")
    (tmp_path / "tops.csv").write_text("id,r0,theta0_deg\na,40,20\nb,-60,110\n")
    tops = [{"time": i, "top": {"r0": 40 + i}} for i in range(3)]
    (tmp_path / "log.json").write_text("".join(json.dumps(x) + "\n" for x in tops))
    write_trajectories(tmp_path)
    started = "if __name__ == '__main__':  # as pip writes it: workers import this file\n    main()"
    script(tmp_path / "bin" / "lagtop", f"from lagrange_cli.__main__ import main\n{started}")
    script(tmp_path / "bin" / "jq", JQ)
    return tmp_path


def write_trajectories(folder: Path) -> None:
    """Write the trajectories that the examples of the judge read, and their scene."""
    tops = {"mujoco": Top(m=1.587, A=3.9032e-3, C=1.7458e-3, s=0.04, g=9.81)}
    tops |= dict.fromkeys(("h1", "h2", "h3"), Top())
    for i, (name, top) in enumerate(tops.items()):
        runs = np.column_stack(rk4(Body.of(top), 4e-3 / 2**i, 0.1))
        header = "t,qw,qx,qy,qz,p,q,r"
        np.savetxt(folder / f"{name}.csv", runs, delimiter=",", header=header, comments="")
    np.save(folder / "state.npy", runs[:, [0, 2, 3, 4, 1, 5, 6, 7]])
    (folder / "top.toml").write_text("psidot0 = 1\n")
    t, states = dop853(Body.of(Top(psidot0=1)), np.linspace(0, 1, 20))
    turn = Rotation.from_quat(states[:, :4], scalar_first=True)
    matrices = (turn * Rotation.from_matrix(np.eye(3)[[2, 0, 1]])).as_matrix().reshape(-1, 9)
    comment = "OutputVariableType = RotationMatrix"
    np.savetxt(folder / "sensor.txt", np.column_stack([t, matrices]), delimiter=",", header=comment)


def script(path: Path, code: str) -> None:
    """Write a Python program that can be run."""
    path.parent.mkdir(exist_ok=True)
    path.write_text(f"#!{sys.executable}\n{code}\n")
    path.chmod(0o755)


@pytest.mark.slow
@pytest.mark.parametrize("example", EXAMPLES)
def test_examples_of_the_help_run(example: str, folder: Path) -> None:
    line = example
    for long, short in SHORTER.items():
        line = line.replace(long, short)
    environment = os.environ | {
        "PATH": f"{folder}/bin{os.pathsep}{os.environ['PATH']}",
        "PYTHONPATH": str(ROOT),
        "SLURM_ARRAY_TASK_ID": "7",
        "BROWSER": "true",  # a browser that opens nothing
    }
    before = [*folder.iterdir()]
    done = subprocess.run(
        ["bash", "-e", "-o", "pipefail", "-c", line],
        capture_output=True,
        check=False,
        cwd=folder,
        env=environment,
    )
    assert done.returncode == 0, done.stderr.decode()
    assert b"Error" not in done.stderr
    made = [path for path in folder.iterdir() if path not in before or "> tops" in line]
    assert done.stdout or made or "$(" in line, "it writes nothing"


def test_the_examples_are_so_many() -> None:
    counts = {command.name: len(command.examples) for command in commands()}
    assert counts == {
        **{"main": 3, "solve": 14, "table": 8, "sweep": 9, "find": 5, "fit": 5},
        **{"compare": 5, "plot": 7, "view": 3, "jacobi": 9, "eta": 6, "bench": 5},
        **{"stability": 4},
    }
    assert len(EXAMPLES) == 80 + 3
    lines = [line for command in commands() for line in command.examples]
    assert all(any(long in line for line in lines) for long in SHORTER)
