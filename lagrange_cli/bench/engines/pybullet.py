"""The top in PyBullet: a link on a spherical joint."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

from ...arithmetic.types import Array
from .scaled_body import Body
from .serve import Simulate, stepped

URDF = """<robot name="top">
  <link name="ground">
    <inertial><mass value="0"/><inertia ixx="0" ixy="0" ixz="0" iyy="0" iyz="0" izz="0"/></inertial>
  </link>
  <link name="top">
    <inertial>
      <origin xyz="0 0 {s!r}"/><mass value="1"/>
      <inertia ixx="{A!r}" ixy="0" ixz="0" iyy="{A!r}" iyz="0" izz="{C!r}"/>
    </inertial>
  </link>
  <joint name="pivot" type="spherical"><parent link="ground"/><child link="top"/></joint>
</robot>"""


def build(body: Body, _: str, steps: float) -> Simulate:
    """Return the simulation; PyBullet has one scheme, semi-implicit."""
    import pybullet as engine

    engine.connect(engine.DIRECT)
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "top.urdf"
        path.write_text(URDF.format(s=body.s, A=body.central, C=body.C))
        flags = engine.URDF_USE_INERTIA_FROM_FILE
        top = engine.loadURDF(str(path), useFixedBase=True, flags=flags)
    engine.setGravity(0, 0, -body.g)
    damping = dict.fromkeys(("linearDamping", "angularDamping", "jointDamping"), 0)
    engine.changeDynamics(top, 0, **damping)
    engine.setJointMotorControlMultiDof(  # or a motor would hold the joint
        top, 0, engine.POSITION_CONTROL, targetPosition=[0, 0, 0, 1], force=[0, 0, 0]
    )
    w, *vector = body.attitude

    def advance(step: float, count: int) -> None:
        engine.setTimeStep(step)
        for _ in range(count):
            engine.stepSimulation()

    def attitude() -> Any:
        *xyz, last = engine.getJointStateMultiDof(top, 0)[0]
        return last, *xyz

    def simulate(times: Array) -> Array:
        engine.resetJointStateMultiDof(top, 0, [*vector, w], body.rates)
        return stepped(body, times, steps, advance, attitude)

    return simulate
