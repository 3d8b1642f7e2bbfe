"""Bodies of which some inputs are given and others those of the worked example: said, once."""

from __future__ import annotations

import copy
import warnings
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import Lagtop
from lagtop import MixedBodyWarning, Top, read_scene, sweep

BODY = {"m": 0.35, "A": 8.5e-4, "C": 4e-4, "s": 0.03, "g": 9.81}
WHOLE = " ".join(f"--{name} {value}" for name, value in BODY.items()).split()
PARTS = ["--m", "0.35", "--C", "4e-4", "--g", "9.81"]
SAID = "Warning: A and s default to the worked example, in g, cm and s: --A 39032 --s 4\n"


@pytest.fixture(autouse=True)
def every_warning() -> Any:
    """Let each warning count, which the configuration of the tests leaves out."""
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        yield


@pytest.mark.parametrize(
    "inputs",
    [
        {},
        BODY,
        {name: BODY[name] for name in "mCsg"} | {"A_cm": 5e-4},
        {"g": 0},
        {"s": 0.0, "g": 0, "phidot0": 2},
        Top().as_dict(),
    ],
)
def test_nothing_given_or_a_whole_body_is_silent(inputs: dict[str, Any]) -> None:
    top = Top(**inputs)
    assert top.replace(m=top.m) == top == copy.deepcopy(top)
    sweep(keys=["regime"], **{name: x for name, x in inputs.items() if x is not None})


@pytest.mark.parametrize(
    ("inputs", "said"),
    [
        ({"m": 1}, "A, C, s and g default .*: A=39032, C=17458, s=4, g=981$"),
        ({"A_cm": 1e5}, "m, C, s and g default"),
        ({name: BODY[name] for name in "mACs"}, "^g defaults to the worked example, .*: g=981$"),
    ],
)
def test_parts_of_a_body_are_named_where_they_were_given(
    inputs: dict[str, Any], said: str, tmp_path: Path
) -> None:
    path = tmp_path / "scene.toml"
    path.write_text("".join(f"{name} = {x}\n" for name, x in inputs.items()))
    arrays: dict[str, Any] = {name: np.array([x, x]) for name, x in inputs.items()}
    for ask in (
        partial(Top, **inputs),
        partial(read_scene, str(path)),
        partial(sweep, keys=["m"], **arrays),
    ):
        with pytest.warns(MixedBodyWarning, match=said) as caught:
            ask()
        assert [warning.filename for warning in caught] == [__file__]


def test_the_warning_appears_once_per_grid_and_per_file(tmp_path: Path, lagtop: Lagtop) -> None:
    keys = ["--keys", "m", "--r0"]
    assert lagtop("sweep", *PARTS, *keys, "1:9:5000").stderr == SAID
    assert lagtop("sweep", *WHOLE, *keys, "1:9:3").stderr == ""
    path = tmp_path / "tops.csv"
    path.write_text("m,C,g,r0\n" + "0.35,4e-4,9.81,1\n" * 3)
    assert lagtop("sweep", path).stderr == SAID
    assert lagtop("sweep", path, "--A", "1e-3", "--s", "1").stderr == ""
    objects = '{"r0": 3}\n{"m": 0.35, "C": 4e-4, "g": 9.81}\n'
    assert lagtop("sweep", "-", input=objects).stderr == SAID
