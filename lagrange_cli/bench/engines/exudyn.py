"""The top in EXUDYN: a free body under a couple, or one on a joint for the implicit scheme."""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arithmetic.types import Array
from .scaled_body import Body
from .serve import Simulate

IMPLICIT = "GeneralizedAlpha"


def build(body: Body, scheme: str, steps: float) -> Simulate:
    """Return the simulation by an explicit scheme such as RK67, or by the generalised alpha."""
    import exudyn
    from scipy.spatial.transform import Rotation

    implicit = scheme == IMPLICIT
    system = exudyn.SystemContainer().AddSystem()
    sensor = _jointed(system, body) if implicit else _under_a_couple(system, body)
    system.Assemble()
    settings = exudyn.SimulationSettings()
    time = settings.timeIntegration
    settings.solutionSettings.writeSolutionToFile = False
    time.explicitIntegration.useLieGroupIntegration = True
    solver = getattr(exudyn.DynamicSolverType, scheme)

    def simulate(times: Array) -> Array:
        gap = float(times[0] or times[-1] / (times.size - 1))
        time.endTime = times[-1]
        count = body.steps(gap, steps)
        time.numberOfSteps = round(times[-1] / gap) * count
        early = 0.5 / time.numberOfSteps  # half a step at the end: rounding makes no row late
        settings.solutionSettings.sensorsWritePeriod = gap * (1 - early)
        exudyn.SolveDynamic(system, solverType=solver, simulationSettings=settings)
        rows = system.GetSensorStoredData(sensor)
        found = np.searchsorted(rows[:, 0], times - gap / count / 2)  # it may write the end twice
        rows = rows[np.minimum(found, len(rows) - 1)]
        if not np.isfinite(rows).all():
            raise ArithmeticError("it gave what is not a number")
        if np.abs(rows[:, 0] - times).max() > 0.1 * gap / count:
            raise ValueError("it has changed its step, and misses the times")
        matrices = rows[:, 1:].reshape(-1, 3, 3)
        attitudes: Array = Rotation.from_matrix(matrices).as_quat(scalar_first=True)
        return attitudes

    return simulate


def _under_a_couple(system: Any, body: Body) -> Any:
    """Add the body at its pivot, pulled down at the mass centre and up at the pivot.

    Such a couple leaves the pivot where it is, so that no joint is needed: explicit schemes have
    none.  The moments of this body are about the pivot.
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
    return _sensor(system, number)


def _jointed(system: Any, body: Body) -> Any:
    """Add the body at its mass centre, with Euler parameters, on a spherical joint."""
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
    return _sensor(system, number)


def _sensor(system: Any, number: Any) -> Any:
    """Add a sensor of the rotation matrix."""
    import exudyn
    from exudyn import utilities as add

    return system.AddSensor(
        add.SensorBody(
            bodyNumber=number,
            storeInternal=True,
            outputVariableType=exudyn.OutputVariableType.RotationMatrix,
        )
    )
