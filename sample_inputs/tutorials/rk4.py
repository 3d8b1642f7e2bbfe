"""An integrator to be tested: Euler's equations of the top by the classical Runge-Kutta method.

`python rk4.py STEP` prints t and the quaternion (w, x, y, z) of the worked example every 0.1 s.
"""

import sys

import numpy as np

m, A, C, s, g, r0, tilt = 1587.0, 39032.0, 17458.0, 4.0, 981.0, 50.0, np.radians(30)


def slope(state):
    """Return the time derivative of the quaternion and of the angular velocity in the body."""
    w, x, y, z, p, q, r = state
    turn = np.array(
        [
            -x * p - y * q - z * r,
            w * p + y * r - z * q,
            w * q + z * p - x * r,
            w * r + x * q - y * p,
        ]
    )
    up_x, up_y = 2 * (x * z - w * y), 2 * (y * z + w * x)  # the vertical, seen from the body
    torque_p, torque_q = m * g * s * up_y, -m * g * s * up_x
    return np.array(
        [*(turn / 2), (torque_p - (C - A) * q * r) / A, (torque_q + (C - A) * p * r) / A, 0]
    )


def step(state, dt):
    """Return the state after one step of RK4."""
    k1 = slope(state)
    k2 = slope(state + dt / 2 * k1)
    k3 = slope(state + dt / 2 * k2)
    k4 = slope(state + dt * k3)
    return state + dt / 6 * (k1 + 2 * k2 + 2 * k3 + k4)


def main(dt):
    """Print the motion for 2 s."""
    state = np.array([np.cos(tilt / 2), np.sin(tilt / 2), 0, 0, 0, 0, r0])
    print("t,qw,qx,qy,qz")
    for row in range(21):
        print(f"{0.1 * row:.1f}", *map(repr, map(float, state[:4])), sep=",")
        for _ in range(round(0.1 / dt)):
            state = step(state, dt)


main(float(sys.argv[1]))
