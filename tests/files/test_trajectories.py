"""Trajectories in every form in which engines write them, and the errors for bad ones."""

from __future__ import annotations

import math
import os
import sys
import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pytest
from pyarrow import parquet
from scipy.spatial.transform import Rotation

from lagrange_cli.arithmetic import rotations
from lagrange_cli.errors import DataError
from lagrange_cli.files import binary_tables
from lagrange_cli.recordings.observed import observe, quantities_of
from lagrange_cli.recordings.options import Reading
from lagrange_cli.recordings.quantities import QUANTITIES, expanded, quantities_in
from lagrange_cli.recordings.reading import read_recording
from lagrange_cli.top.units import Units

PI = math.pi


def read(
    path: Path | str, columns: list[str] | None = None, decimal: str = "", *, radians: bool = True
) -> dict[str, Any]:
    """Return every quantity of a file."""
    options = Reading(columns=columns, decimal=decimal, units=Units(radians=radians))
    found = read_recording(str(path), options)
    return {**found.given, "t": found.t[:, np.newaxis]}


def test_a_pipe_that_does_not_wait_is_read_whole(monkeypatch: pytest.MonkeyPatch) -> None:
    """The second half comes later; a read would return None, which looks like the end."""
    receiver, sender = os.pipe()
    os.set_blocking(receiver, False)

    def send() -> None:
        os.write(sender, b"t,theta\n0,1\n1,")
        time.sleep(0.05)
        os.write(sender, b"2\n")
        os.close(sender)

    thread = threading.Thread(target=send)
    with open(receiver) as pipe:
        monkeypatch.setattr(sys, "stdin", pipe)
        thread.start()
        assert read("-")["t"][:, 0].tolist() == [0, 1]
    thread.join()


def test_every_quantity_can_be_named_as_a_whole() -> None:
    for name, quantity in QUANTITIES.items():
        single = expanded([name])
        assert len(single) == quantity.size
        assert list(quantities_in(single)) == [name]
        pairs = {2} if name == "t" else set()  # seconds and nanoseconds
        assert {len(names) for names, _ in quantity.spellings} == {quantity.size} | pairs


def test_a_quantity_that_a_parquet_file_names_twice_is_refused(tmp_path: Path) -> None:
    parquet.write_table(pa.table([[0.0], [1.0], [2.0]], ["t", "theta", "theta"]), tmp_path / "a")
    with pytest.raises(DataError, match="'theta' and 'theta'"):
        read(tmp_path / "a")


def test_a_parquet_file_beyond_the_limit_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A few kilobytes may hold a gigabyte of equal numbers or texts."""
    path, rows = tmp_path / "a", 10_000
    words = pa.array(["x" * 1000] * rows)  # which are not read
    columns = {"t": np.arange(rows), "note": words, "theta": np.zeros(rows)}
    parquet.write_table(pa.table(columns), path, row_group_size=777)
    assert read(path, decimal=",")["t"][:, 0].tolist() == [*range(rows)]
    dated = pa.table({"t": pa.array([0, 1], pa.timestamp("ms")), "theta": [1.0, 2.0]})
    parquet.write_table(dated, tmp_path / "dated")
    assert read(tmp_path / "dated")["t"].ravel().tolist() == [0, 1e-3]
    monkeypatch.setattr(binary_tables, "LARGEST_FILE", 300_000)
    with pytest.raises(DataError, match="must have at most 12500 numbers, has 20000"):
        read(path)


def test_other_columns_may_share_a_name_and_hold_words(tmp_path: Path) -> None:
    path = tmp_path / "a.csv"
    path.write_text('t,note,theta,note,run\n0,"a",1,b,7\n1,"c; ""d""",2,d,8.0\n')
    file = read_recording(str(path), Reading())
    assert sorted(file.given) == ["missing", "t", "theta"]
    assert file.source.unused == ["note", "note", "run"]


def test_conventions_and_masks_of_a_trajectory(tmp_path: Path) -> None:
    """The names of columns imply a frame, but not against one that is given."""
    (tmp_path / "a").write_text("t,omega_body_x,omega_body_y,omega_body_z\n0,1,2,3\n")
    for frame in ("body", "space"):
        file = read_recording(str(tmp_path / "a"), Reading(rates_frame=frame))
        assert file.reading.rates_frame == frame
    (tmp_path / "b").write_text("t,roll,pitch,yaw\n0,1,2,3\n")
    for sequence in ("xyz", "XYZ"):
        file = read_recording(str(tmp_path / "b"), Reading(euler_sequence=sequence))
        assert file.reading.euler_sequence == sequence
    masked = np.ma.masked_array([1.0, 2.0], [False, True])
    assert np.isnan(quantities_of([0, 1], {"theta": masked})["theta"]).ravel().tolist() == [0, 1]


def test_rates_of_angles_turn_the_body() -> None:
    """`comparison` tests all other quantities, as trajectories of integrators."""
    rng, step = np.random.default_rng(2), 1e-6
    angles, rates = rng.uniform(0.1, 3, (9, 3)), np.array([[1.0, 2.0, -3.0]] * 9)
    ahead = [(angles + h * rates)[:, [2, 0, 1]] for h in (-step, step)]
    before, after = (Rotation.from_euler("ZXZ", x) for x in ahead)
    parts = dict(zip(("theta", "phi", "psi"), np.split(angles, 3, axis=1), strict=True))
    given = {"t": np.arange(9.0)[:, np.newaxis], "angle_rates": rates}
    exact = (before.inv() * after).as_rotvec() / (2 * step)
    assert observe(given | parts, Reading()).body_rates == pytest.approx(exact, abs=1e-8)
    tilt = given | {"theta": parts["theta"], "position": after.apply([0, 0, 4])}
    assert observe(tilt, Reading()).angles.keys() == {"theta"}


@pytest.mark.parametrize("bad", [math.inf, math.nan, 1e200])
@pytest.mark.parametrize("key", ["quaternion", "matrix", "rotvec", "axis", "position", "angles"])
def test_a_row_that_is_not_finite_has_no_direction_and_raises_no_warning(
    key: str, bad: float
) -> None:
    names = ["theta", "phi", "psi"] if key == "angles" else [key]
    bad = math.inf if key == "angles" else bad
    given = {name: np.full((1, QUANTITIES[name].size), bad) for name in names}
    seen = observe({"t": np.zeros((1, 1)), **given}, Reading())
    seen = seen.turned(rotations.to_z("y"), rotations.to_z("x"))
    direction = seen.axis if seen.quaternion is None else seen.quaternion
    assert direction is not None
    assert np.isnan(direction).all()
