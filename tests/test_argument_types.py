"""Arguments of any type: LagtopError or TypeError, and nothing else."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import lagtop
import numpy as np
import pytest
from conftest import ROOT
from lagtop import LagtopError, Top, solve

ODD: list[Any] = [None, True, "x", 10**400, float("nan"), object(), [1, 2], np.zeros(2), {}]
TOP, MOTION = Top(), solve(Top())
T = np.linspace(0, 1, 20)
SCENE = str(ROOT / "sample_inputs" / "hanging-top.toml")
CALLS: dict[str, Callable[[Any], Any]] = {
    "Top(m=)": lambda x: Top(m=x),
    "Top(theta0_deg=)": lambda x: Top(theta0_deg=x),
    "Top(A_cm=)": lambda x: Top(A_cm=x),
    "Top.replace": lambda x: TOP.replace(r0=x),
    "solve": solve,
    "view": lagtop.view,
    "draw": lagtop.draw,
    "sensitivities": lagtop.sensitivities,
    "sensitivities(keys)": lambda x: lagtop.sensitivities(TOP, x),
    "read_scene": lagtop.read_scene,
    "read_scene(given)": lambda x: lagtop.read_scene(SCENE, x),
    "angles": MOTION.angles,
    "table": MOTION.table,
    "table(columns)": lambda x: MOTION.table([0.0], x),
    "record(keys)": lambda x: MOTION.record(keys=x),
    "sweep(r0)": lambda x: lagtop.sweep(r0=x, keys=["K"]),
    "sweep(keys)": lambda x: lagtop.sweep(r0=1, keys=x),
    "find": lambda x: lagtop.find(x, r0="10:20"),
    "find(r0)": lambda x: lagtop.find(["T_nutation=0.4"], r0=x),
    "fit": lambda x: lagtop.fit(x, theta=np.cos(T)),
    "fit(theta)": lambda x: lagtop.fit(T, theta=x),
    "fit(sigma)": lambda x: lagtop.fit(T[:5], theta=np.cos(T[:5]), sigma=x),
    "compare": lambda x: lagtop.compare(x, [0.0, 1.0], theta=[1.0, 1.0]),
    "compare(t)": lambda x: lagtop.compare(TOP, x, theta=[1.0, 1.0]),
    "compare(quaternion)": lambda x: lagtop.compare(TOP, [0.0, 1.0], quaternion=x),
}


@pytest.mark.filterwarnings("error", "ignore::lagrange_cli.MixedBodyWarning")
@pytest.mark.parametrize("call", CALLS)
def test_odd_arguments(call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for odd in ODD:
        with suppress(TypeError, LagtopError):
            CALLS[call](odd)
    assert [os.fstat(descriptor) for descriptor in (0, 1, 2)]  # none was closed
    assert list(tmp_path.iterdir()) == []
