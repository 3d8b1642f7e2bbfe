"""Trajectories that real engines write in the test run itself.

The scene is the worked example in SI.  Engines take moments about the mass centre.
"""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from lagtop import Judgement, Top, solve

from lagrange_cli.judge.compare import ComparisonRequest, compare_files

M, A, C, S, G, R0 = 1.587, 3.9032e-3, 1.7458e-3, 0.04, 9.81, 50.0
TOP = Top(m=M, A=A, C=C, s=S, g=G, r0=R0)
END = 2.0


def verdicts(paths: list[Path], steps: list[float]) -> list[Judgement]:
    session = compare_files(
        solve(TOP), [str(path) for path in paths], ComparisonRequest(step_sizes=steps)
    )
    return list(session.judgements)


@pytest.fixture
def mujoco() -> Any:
    return pytest.importorskip("mujoco", reason="MuJoCo is not installed")


Run = Callable[[str, float, float], Path]


@pytest.fixture
def simulated(mujoco: Any, tmp_path: Path) -> Run:
    """Return a function that writes the trajectory of a ball joint at some step."""

    def run(integrator: str, h: float, moment: float) -> Path:
        model = mujoco.MjModel.from_xml_string(
            f"""<mujoco><option gravity="0 0 {-G}" timestep="{h}" integrator="{integrator}"/>
            <worldbody><body><joint type="ball" damping="0"/><inertial pos="0 0 {S}" mass="{M}"
            diaginertia="{moment} {moment} {C}"/></body></worldbody></mujoco>"""
        )
        data = mujoco.MjData(model)
        data.qpos[:4] = np.cos(np.pi / 12), np.sin(np.pi / 12), 0, 0
        data.qvel[2] = R0
        rows = []
        for i in range(round(END / h) + 1):
            rows.append([i * h, *data.qpos, *data.qvel])
            mujoco.mj_step(model, data)
        names = [*(f"qpos_{i}" for i in range(4)), *(f"qvel_{i}" for i in range(3))]
        path = tmp_path / f"{integrator}-{h}.npy"
        np.save(path, np.rec.fromarrays(np.array(rows).T, names=["t", *names]))  # type: ignore[call-overload]
        return path

    return run


def test_runge_kutta_of_mujoco(simulated: Run) -> None:
    """Seen with MuJoCo 4.0.0: order 4.2, 8.0e-7 rad at 1 ms; 3.3.7 was of order 2."""
    steps = [4e-3, 2e-3, 1e-3]
    rows = verdicts([simulated("RK4", h, A - M * S**2) for h in steps], steps)
    assert rows[-1].order is not None
    assert rows[-1].order > 1.7
    assert rows[-1].verdict in {"fine", "drifts"}
    assert rows[-1].energy_drift is not None
    assert rows[-1].energy_drift < 1e-3


def test_the_default_of_mujoco_loses_the_phase(simulated: Run) -> None:
    """Seen: 1.1 to 3.1 rad off, and the order, 1.04, shows all the same."""
    steps = [1e-3, 5e-4, 2.5e-4]
    rows = verdicts([simulated("Euler", h, A - M * S**2) for h in steps], steps)
    assert {row.verdict for row in rows} == {"drifts"}
    assert all(row.attitude_error_max is not None and row.attitude_error_max > 0.5 for row in rows)
    assert rows[0].order == pytest.approx(1, abs=0.2)


@pytest.mark.slow
def test_a_model_with_the_moment_about_the_pivot(simulated: Run) -> None:
    steps = [2e-3, 1e-3]
    rows = verdicts([simulated("RK4", h, A) for h in steps], steps)
    assert {row.verdict for row in rows} == {"another top"}
    assert rows[1].explained_by is not None
    assert "(A + m s^2)" in rows[1].explained_by


EXUDYN = f"""
import sys
import numpy as np
import exudyn as exu
from exudyn.utilities import *

step, folder = float(sys.argv[1]), sys.argv[2]
system = exu.SystemContainer().AddSystem()
node = system.AddNode(NodeRigidBodyRotVecLG(
    referenceCoordinates=[0, 0, 0, np.radians(30), 0, 0], initialVelocities=[0, 0, 0, 0, 0, {R0}]))
body = system.AddObject(ObjectRigidBody(
    physicsMass={M}, physicsInertia=[{A}, {A}, {C}, 0, 0, 0], nodeNumber=node))
for height, force in ((0, 1), ({S}, -1)):  # a couple: the pivot stays where it is
    marker = system.AddMarker(MarkerBodyPosition(bodyNumber=body, localPosition=[0, 0, height]))
    system.AddLoad(Force(markerNumber=marker, loadVector=[0, 0, force * {M * G}]))
for kind, height in (("RotationMatrix", 0), ("Rotation", 0), ("AngularVelocity", 0),
                     ("AngularVelocityLocal", 0), ("Position", {S})):
    system.AddSensor(SensorBody(
        bodyNumber=body, localPosition=[0, 0, height], fileName=f"{{folder}}/{{kind}}.txt",
        outputVariableType=getattr(exu.OutputVariableType, kind)))
system.Assemble()
settings = exu.SimulationSettings()
settings.timeIntegration.endTime = {END}
settings.timeIntegration.numberOfSteps = round({END} / step)
settings.solutionSettings.writeSolutionToFile = False
settings.solutionSettings.sensorsWritePeriod = 0.01
settings.timeIntegration.explicitIntegration.useLieGroupIntegration = True
exu.SolveDynamic(system, solverType=exu.DynamicSolverType.RK44, simulationSettings=settings)
"""


@pytest.fixture
def sensors(tmp_path: Path) -> Callable[[float], Path]:
    """Return a function that lets EXUDYN write its sensor files, in a process of its own."""
    pytest.importorskip("exudyn", reason="EXUDYN is not installed")

    def run(step: float) -> Path:
        folder = tmp_path / str(step)
        folder.mkdir()
        command = [sys.executable, "-W", "ignore", "-c", EXUDYN, str(step), str(folder)]
        subprocess.run(command, check=True, capture_output=True, cwd=tmp_path)
        return folder

    return run


@pytest.mark.slow
def test_sensor_files_of_exudyn_as_they_are(sensors: Callable[[float], Path]) -> None:
    """Seen with EXUDYN 1.13.6: order 4.2, 8.0e-7 rad at 1 ms; its files have ten digits."""
    steps = [4e-3, 2e-3, 1e-3]
    folders = [sensors(h) for h in steps]
    rows = verdicts([folder / "RotationMatrix.txt" for folder in folders], steps)
    assert rows[0].order == pytest.approx(4, abs=0.7)
    for kind in ("Rotation", "AngularVelocity", "AngularVelocityLocal", "Position"):
        (row,) = verdicts([folders[-1] / f"{kind}.txt"], [1e-3])
        assert row.verdict == "fine", kind
        assert row.error_max is not None
        assert row.error_max < 1e-5
