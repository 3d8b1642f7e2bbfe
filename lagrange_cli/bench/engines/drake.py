"""The top in Drake: a body on a ball joint with three angles, its figure axis along body x.

So the joint's singular attitude is the vertical axis, far from most motions.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from ...arithmetic.types import Array
from .scaled_body import Body
from .serve import Simulate

TO_ENGINE = np.array([[0, 0, 1], [1, 0, 0], [0, 1, 0]])
"""Rotation from our body axes to those of the model: z becomes x."""
DISCRETE = "discrete"


def build(body: Body, scheme: str, setting: float) -> Simulate:
    """Return the simulation by an integrator with error control, or by discrete steps."""
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
        frame = start * Rotation.from_matrix(TO_ENGINE.T)
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
        frames = Rotation.from_euler("ZYX", angles[:, ::-1]) * Rotation.from_matrix(TO_ENGINE)
        found: Array = frames.as_quat(scalar_first=True)
        return found

    return simulate
