"""The top in MuJoCo: a body on a ball joint."""

from __future__ import annotations

from typing import Any

from ...arithmetic.types import Array
from .scaled_body import Body
from .serve import Simulate, stepped


def build(body: Body, scheme: str, steps: float) -> Simulate:
    """Return the simulation by an integrator of MuJoCo, such as RK4."""
    import mujoco

    moments = f"{body.central!r} {body.central!r} {body.C!r}"
    model = mujoco.MjModel.from_xml_string(
        f"""<mujoco>
          <compiler balanceinertia="false"/>
          <option integrator="{scheme}" gravity="0 0 {-body.g!r}"/>
          <worldbody><body>
            <joint type="ball" damping="0"/>
            <inertial pos="0 0 {body.s!r}" mass="1" diaginertia="{moments}"/>
          </body></worldbody>
        </mujoco>"""
    )
    data = mujoco.MjData(model)

    def advance(step: float, count: int) -> None:
        model.opt.timestep = step
        mujoco.mj_step(model, data, count)

    def attitude() -> Any:
        return data.qpos

    def simulate(times: Array) -> Array:
        mujoco.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = body.attitude, body.rates
        return stepped(body, times, steps, advance, attitude)

    return simulate
