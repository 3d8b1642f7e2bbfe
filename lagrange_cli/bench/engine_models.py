"""Models of the top for physics engines, with one function per engine, named after its package.

Each function imports its engine, in a separate process.
"""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import Any

import numpy as np

from ..arithmetic.types import Array
from .engine_simulation import Body, Simulate

IMPLICIT = "GeneralizedAlpha"
DISCRETE = "discrete"
TO_DRAKE = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
"""Rotation from body axes to the axes of the model in Drake: z becomes x."""
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


def mujoco(body: Body, scheme: str, steps: float) -> Simulate:
    """Return the simulation of a body on a ball joint, by an integrator of MuJoCo such as RK4."""
    import mujoco as engine

    moments = f"{body.central!r} {body.central!r} {body.C!r}"
    model = engine.MjModel.from_xml_string(
        f"""<mujoco>
          <compiler balanceinertia="false"/>
          <option integrator="{scheme}" gravity="0 0 {-body.g!r}"/>
          <worldbody><body>
            <joint type="ball" damping="0"/>
            <inertial pos="0 0 {body.s!r}" mass="1" diaginertia="{moments}"/>
          </body></worldbody>
        </mujoco>"""
    )
    data = engine.MjData(model)

    def advance(step: float, count: int) -> None:
        model.opt.timestep = step
        engine.mj_step(model, data, count)

    def attitude() -> Any:
        return data.qpos

    def simulate(times: Array) -> Array:
        engine.mj_resetData(model, data)
        data.qpos[:], data.qvel[:] = body.attitude, body.rates
        return body.stepped(times, steps, advance, attitude)

    return simulate


def pybullet(body: Body, _: str, steps: float) -> Simulate:
    """Return the simulation of a link on a spherical joint, by PyBullet's semi-implicit scheme."""
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
    engine.setJointMotorControlMultiDof(  # otherwise a motor would hold the joint
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
        return body.stepped(times, steps, advance, attitude)

    return simulate


def drake(body: Body, scheme: str, setting: float) -> Simulate:
    """Return the simulation of a body on a joint with three angles, by Drake.

    Its figure axis lies along body x, so that the singular attitude of the joint is the vertical
    axis, far from most motions.
    """
    from pydrake.multibody.plant import MultibodyPlant
    from pydrake.multibody.tree import BallRpyJoint, RotationalInertia, SpatialInertia
    from pydrake.systems.analysis import ResetIntegratorFromFlags, Simulator
    from scipy.spatial.transform import Rotation

    start = Rotation.from_quat(body.attitude, scalar_first=True)
    moments = RotationalInertia(body.C, body.central, body.central)

    def simulator(step: float) -> tuple[Any, Any]:
        """Return a simulator at the start, and the pivot."""
        plant = MultibodyPlant(time_step=step)
        inertia = SpatialInertia.MakeFromCentralInertia(1.0, [body.s, 0, 0], moments)
        top = plant.AddRigidBody("top", inertia)
        pivot = plant.AddJoint(BallRpyJoint("pivot", plant.world_frame(), top.body_frame()))
        plant.mutable_gravity_field().set_gravity_vector([0, 0, -body.g])
        plant.Finalize()
        made = Simulator(plant)
        context = made.get_mutable_context()
        frame = start * Rotation.from_matrix(TO_DRAKE.T)
        pivot.set_angles(context, frame.as_euler("ZYX")[::-1])
        pivot.set_angular_velocity(context, start.apply(body.rates))
        if not step:
            integrator = ResetIntegratorFromFlags(made, scheme, body.period)
            integrator.set_target_accuracy(setting)
        made.Initialize()
        return made, pivot

    def simulate(times: Array) -> Array:
        gap = float(times[0] or times[-1] / (times.size - 1))
        step = gap / body.steps(gap, setting) if scheme == DISCRETE else 0.0
        made, pivot = simulator(step)
        context, angles = made.get_mutable_context(), np.empty((times.size, 3))
        for i, t in enumerate(times.tolist()):
            made.AdvanceTo(t)
            angles[i] = pivot.get_angles(context)
        frames = Rotation.from_euler("ZYX", angles[:, ::-1]) * Rotation.from_matrix(TO_DRAKE)
        found: Array = frames.as_quat(scalar_first=True)
        return found

    return simulate


def exudyn(body: Body, scheme: str, steps: float) -> Simulate:
    """Return the simulation of a free body under a couple, or of a body on a joint.

    Explicit schemes such as RK67 use the free body.  The implicit scheme, the generalised alpha,
    uses the joint.
    """
    import exudyn as engine
    from exudyn import utilities as add
    from scipy.spatial.transform import Rotation

    system = engine.SystemContainer().AddSystem()
    add_body = _jointed if scheme == IMPLICIT else _under_a_couple
    matrix = engine.OutputVariableType.RotationMatrix
    sensor = system.AddSensor(
        add.SensorBody(
            bodyNumber=add_body(system, body), storeInternal=True, outputVariableType=matrix
        )
    )
    system.Assemble()
    settings = engine.SimulationSettings()
    time = settings.timeIntegration
    settings.solutionSettings.writeSolutionToFile = False
    time.explicitIntegration.useLieGroupIntegration = True
    solver = getattr(engine.DynamicSolverType, scheme)

    def simulate(times: Array) -> Array:
        gap = float(times[0] or times[-1] / (times.size - 1))
        time.endTime = times[-1]
        count = body.steps(gap, steps)
        time.numberOfSteps = round(times[-1] / gap) * count
        early = 0.5 / time.numberOfSteps  # half a step more, so that rounding delays no row
        settings.solutionSettings.sensorsWritePeriod = gap * (1 - early)
        engine.SolveDynamic(system, solverType=solver, simulationSettings=settings)
        rows = system.GetSensorStoredData(sensor)
        found = np.searchsorted(rows[:, 0], times - gap / count / 2)  # the end may be written twice
        rows = rows[np.minimum(found, len(rows) - 1)]
        if not np.isfinite(rows).all():
            raise ArithmeticError("it returned values that are not finite")
        if np.abs(rows[:, 0] - times).max() > 0.1 * gap / count:
            raise ValueError("it changed its step, and misses the times")
        matrices = rows[:, 1:].reshape(-1, 3, 3)
        attitudes: Array = Rotation.from_matrix(matrices).as_quat(scalar_first=True)
        return attitudes

    return simulate


def _under_a_couple(system: Any, body: Body) -> Any:
    """Add the body at its pivot, pulled down at the mass centre and up at the pivot; return it.

    Such a couple keeps the pivot fixed without a joint, which explicit schemes do not support.  The
    moments of this body are about the pivot.
    """
    from exudyn import utilities as add

    turned = [2 * np.arctan2(body.attitude[1], body.attitude[0]), 0, 0]
    node = add.NodeRigidBodyRotVecLG(
        referenceCoordinates=[0, 0, 0, *turned],
        initialVelocities=[0, 0, 0, *body.rates],
    )
    moment = body.central + body.s**2
    top = add.ObjectRigidBody(
        physicsMass=1,
        physicsInertia=[moment, moment, body.C, 0, 0, 0],
        nodeNumber=system.AddNode(node),
    )
    number = system.AddObject(top)
    for height, force in ((0, body.g), (body.s, -body.g)):
        marker = add.MarkerBodyPosition(bodyNumber=number, localPosition=[0, 0, height])
        load = add.Force(markerNumber=system.AddMarker(marker), loadVector=[0, 0, force])
        system.AddLoad(load)
    return number


def _jointed(system: Any, body: Body) -> Any:
    """Add the body at its mass centre, with Euler parameters, on a spherical joint; return it."""
    from exudyn import utilities as add
    from scipy.spatial.transform import Rotation

    attitude = Rotation.from_quat(body.attitude, scalar_first=True)
    turning = attitude.apply(body.rates)
    height = attitude.apply([0, 0, body.s])
    inertia = add.RigidBodyInertia(mass=1, inertiaTensor=np.diag([body.central] * 2 + [body.C]))
    number = system.CreateRigidBody(
        inertia=inertia,
        referencePosition=height,
        referenceRotationMatrix=attitude.as_matrix(),
        initialVelocity=np.cross(turning, height),
        initialAngularVelocity=turning,
        gravity=[0, 0, -body.g],
    )
    system.CreateSphericalJoint(
        bodyNumbers=[system.CreateGround(), number], position=[0, 0, 0], show=False
    )
    return number
