"""Arguments of any type: the public functions raise LagtopError or TypeError, and nothing else."""

from __future__ import annotations

import os
from collections.abc import Callable
from contextlib import suppress
from decimal import Decimal
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from conftest import ROOT
from lagtop import (
    LagtopError,
    Top,
    compare,
    draw,
    draw_outcome,
    find,
    fit,
    read_scene,
    sensitivities,
    solve,
    sweep,
    sweep_angles,
    view,
)
from matplotlib.figure import Figure

import lagrange_cli as package

ODD: dict[str, Any] = {
    **{repr(x): x for x in (None, True, False, "x", "", "\udcff", b"x", 1j, -1, 0, 1.5)},
    "{}": {},
    "[]": [],
    **{f"{x}": x for x in (Decimal("NaN"), Decimal("sNaN"), Decimal("Infinity"), float)},
    "an object": object(),
    "a generator": (x for x in [1.0]),
    "a large int": 10**400,
    "inf": float("inf"),
    "nan": float("nan"),
    "an array of no dimension": np.array(1.0),
    "an array of two": np.array([1.0, 2.0]),
    "an array of objects": np.array([None, 1], object),
    "a structured array": np.zeros(2, [("a", "f8")]),
    "a truth value of NumPy": np.True_,
    "a long double": np.longdouble("1e400"),
    "a half": np.float16(1),
    "a masked number": np.ma.masked,
    "a date": np.datetime64("2020-01-01"),
    "a list of two": [1, 2],
    "a ragged list": [[1], [1, 2]],
    "texts": ["a", "b"],
    "a set": {1.0},
    "far apart": [1e308, -1e308],
}
TOP, MOTION = Top(), solve(Top())
T = np.linspace(0, 1, 20)
TILT = np.cos(T)
SCENE = str(ROOT / "sample_inputs" / "hanging-top.toml")
CALLS: dict[str, Callable[[Any], Any]] = {
    "Top(m=)": lambda x: Top(m=x),
    "Top(theta0_deg=)": lambda x: Top(theta0_deg=x),
    "Top(A_cm=)": lambda x: Top(A_cm=x),
    "Top(phidot0=)": lambda x: Top(phidot0=x),
    "Top.replace": lambda x: TOP.replace(r0=x),
    "solve": solve,
    "view": view,
    "draw": draw,
    "draw_outcome": draw_outcome,
    "draw(kind)": lambda x: draw(MOTION, x, Figure().add_subplot()),
    "rotation": MOTION.rotation,
    "axis": MOTION.axis,
    "sensitivities": sensitivities,
    "sensitivities(keys)": lambda x: sensitivities(TOP, x),
    "read_scene": read_scene,
    "read_scene(given)": lambda x: read_scene(SCENE, x),
    "angles": MOTION.angles,
    "table": MOTION.table,
    "table(columns)": lambda x: MOTION.table([0.0], x),
    "record(keys)": lambda x: MOTION.record(keys=x),
    "sweep(r0)": lambda x: sweep(r0=x, keys=["K"]),
    "sweep(keys)": lambda x: sweep(r0=1, keys=x),
    "sweep_angles": lambda x: sweep_angles(x, r0=50),
    "sweep_angles(r0)": lambda x: sweep_angles([0.0, 1.0], r0=x),
    "find": lambda x: find(x, r0="10:20"),
    "find(mapping)": lambda x: find({"T_nutation": x}, r0=(10, 20)),
    "find(pair)": lambda x: find(["T_nutation=0.4"], r0=(x, 60)),
    "find(r0)": lambda x: find(["T_nutation=0.4"], r0=x),
    "find(scan)": lambda x: find(["T_nutation=0.4"], scan=x, r0="40:60"),
    "fit": lambda x: fit(x, theta=TILT),
    "fit(theta)": lambda x: fit(T, theta=x),
    "fit(sigma)": lambda x: fit(T, theta=TILT, sigma=x),
    "fit(known)": lambda x: fit(T, theta=TILT, known=x),
    "compare": lambda x: compare(x, [0.0, 1.0], theta=[1.0, 1.0]),
    "compare(t)": lambda x: compare(TOP, x, theta=[1.0, 1.0]),
    "compare(theta)": lambda x: compare(TOP, [0.0, 1.0], theta=x),
    "compare(quaternion)": lambda x: compare(TOP, [0.0, 1.0], quaternion=x),
    "compare(align)": lambda x: compare(TOP, [0.0, 1.0], theta=[0.5, 0.6], align=x),
}


@pytest.mark.filterwarnings("error", "ignore::lagrange_cli.MixedBodyWarning")
@pytest.mark.parametrize("call", CALLS)
def test_odd_arguments(call: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)
    for odd in ODD.values():
        with suppress(TypeError, LagtopError):
            CALLS[call](odd)
    assert [os.fstat(descriptor) for descriptor in (0, 1, 2)]  # none was closed
    assert list(tmp_path.iterdir()) == []


def test_every_public_function_has_an_example_call() -> None:
    functions = {name for name in package.__all__ if name[0].islower()}
    assert functions <= {name.partition("(")[0] for name in CALLS}


@pytest.mark.parametrize(
    ("call", "odd", "said"),
    [
        ("solve", None, "top must be a Top, got NoneType"),
        ("view", TOP, "motion must be a Motion, got Top"),
        ("compare", {}, "top must be a Top or Motion, got dict"),
        ("read_scene", True, "expected str, bytes or os.PathLike object, not bool"),
        ("Top(m=)", np.array(1.0), "m must be a real number, got array(1.)"),
        ("Top(m=)", np.longdouble("1e400"), "m must be within 1e100 in size, got np.longdouble("),
        ("fit(sigma)", "1", "sigma must be a real number, got '1'"),
    ],
)
@pytest.mark.filterwarnings("error")
def test_words_about_wrong_types(call: str, odd: Any, said: str) -> None:
    with pytest.raises((TypeError, LagtopError)) as error:
        CALLS[call](odd)
    assert str(error.value).startswith(said)


def test_a_scene_may_be_named_by_a_path() -> None:
    assert read_scene(Path(SCENE)) == read_scene(SCENE) == read_scene(os.fsencode(SCENE))  # type: ignore[arg-type]
