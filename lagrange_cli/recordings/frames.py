"""Constant frames between two motions, by two Wahba problems."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np

from ..arithmetic import rotations
from ..arithmetic.types import Array
from ..top.units import RADIANS
from .observed import Observed
from .options import Alignment, Reading
from .recording import Recording

_RANGE, _TRIALS, _DETERMINED = (1e-2, 1e3), 200, 0.1
"""Of own frames: b over the rate of the axis, and the greatest ratio of two variances."""
_LEAST = 3
"""Least number of rows."""
_NEAR = 0.05
"""Greatest angle between an axis and the direction for which it is taken."""
_ROUNDS = 20
"""Times that each of two frames is found with the other one."""
_ALIKE = 1.5
"""How much less the residual of a mirror must be than that of a rotation."""
Frames = tuple[Array, Array | None]
"""Orthogonal matrices S, B with seen = S exact B; no B if only the figure axis is seen."""


def frames_of(seen: Observed, exact: Array) -> Frames | None:
    """Return the frames in which an exact attitude is seen, None if they are not determined.

    An attitude that is seen in a mirror is also turned; an axis may be in a mirror.
    """
    given = seen.axis if seen.quaternion is None else seen.quaternion
    rows = np.zeros(0, bool) if given is None else np.isfinite(given).all(axis=1)
    if given is None or rows.sum() < _LEAST:
        return None
    given, exact = given[rows], exact[rows]
    if seen.quaternion is None:
        return _wahba(given, rotations.axis_of(exact), hands=(1, -1)), None
    space = _wahba(_turns(given), _turns(exact))
    turned = space @ rotations.to_matrix(exact)
    return space, _nearest(np.einsum("nji,njk->ik", turned, rotations.to_matrix(given)), 1)


def refined(frames: tuple[Array, Array], seen: Observed, exact: Array) -> tuple[Array, Array]:
    """Return frames nearer to those in which an exact attitude is seen.

    Each is a Wahba problem with the other one; an axis shows only that of space.
    """
    space, body = frames
    given = seen.axis if seen.quaternion is None else seen.quaternion
    if given is None:
        return frames
    rows = np.isfinite(given).all(axis=1)
    if seen.quaternion is None:
        return _wahba(given[rows], rotations.axis_of(exact[rows])), body
    turned, given = rotations.to_matrix(exact[rows]), rotations.to_matrix(given[rows])
    for _ in range(_ROUNDS):
        space = _nearest(np.einsum("nij,nkj->ik", given, turned @ body), 1)
        body = _nearest(np.einsum("nji,njk->ik", space @ turned, given), 1)
    return space, body


@np.errstate(all="ignore")  # rows may repeat
def own_frames(seen: Observed) -> tuple[Array, Array] | None:
    """Return the frames of a top in which its figure axis and the vertical are not z, up to signs.

    The rate of spin is constant, so that the rates in the body vary least along its figure axis e.
    The angular momentum over A, e x e' + b e, varies least along the vertical if b is right.
    Returns None if a direction is not determined.
    """
    steps = np.diff(seen.t)[:, np.newaxis]
    if seen.quaternion is not None:
        turn = rotations.product(rotations.conjugate(seen.quaternion[:-1]), seen.quaternion[1:])
        share, figure = _least_varying(_vector(turn) / steps)
        axes = rotations.rotated(seen.quaternion, np.broadcast_to(figure, (len(seen.t), 3)))
    elif seen.axis is not None:
        share, figure = 0.0, np.eye(3)[2]
        axes = seen.axis / np.linalg.norm(seen.axis, axis=1, keepdims=True)
    else:
        return None
    middle, swing = (axes[1:] + axes[:-1]) / 2, np.cross(axes[:-1], axes[1:]) / steps
    size = float(np.nanmedian(np.linalg.norm(swing, axis=1)))
    sizes = size * np.geomspace(*_RANGE, _TRIALS)
    found = [_least_varying(swing + b * middle) for b in (*-sizes, 0.0, *sizes)]
    least, up = min(found, key=lambda x: x[0])
    if not max(share, least) < _DETERMINED:
        return None
    return _with_third(up), _with_third(figure * np.sign(figure[np.argmax(abs(figure))])).T


def _least_varying(vectors: Array) -> tuple[float, Array]:
    """Return the least variance of vectors over the next one, and its direction."""
    kept = vectors[np.isfinite(vectors).all(axis=1)]
    if len(kept) < _LEAST:
        return math.inf, np.eye(3)[2]
    variances, basis = np.linalg.eigh(np.cov(kept.T))
    return float(variances[0] / (variances[1] + 1e-300)), basis[:, 0]


def _with_third(direction: Array) -> Array:
    """Return a rotation matrix whose third column is a direction."""
    basis, _ = np.linalg.qr(np.column_stack([direction, np.eye(3)]))
    return np.column_stack([basis[:, 1], np.cross(direction, basis[:, 1]), direction])


def alignment_of(frames: Frames, *, left: bool = True) -> Alignment | None:
    """Return the axes that point upwards and along the figure axis, None if they are no axes.

    If `left` is true, two negative axes are the positive ones of a left-handed frame.
    """
    space, body = frames
    up, axis = _axis_near(space[:, 2]), "z" if body is None else _axis_near(body[2])
    if not up or not axis:
        return None
    if np.linalg.det(space) < 0:
        return Alignment(up, up, left=True)
    if left and up == axis and up.startswith("-"):
        return Alignment(up[1:], up[1:], left=True)
    return Alignment(axis, up)


def _axis_near(direction: Array) -> str:
    """Return the name of the axis near a direction, empty if there is none."""
    i = int(np.argmax(np.abs(direction)))
    is_near = abs(direction[i]) > math.cos(_NEAR)
    return ("-" if direction[i] < 0 else "") + "xyz"[i] if is_near else ""


def _turns(rotation: Array) -> Array:
    """Return the turns from row to row in space, as vectors of the sine of half the angle."""
    return _vector(rotations.product(rotation[1:], rotations.conjugate(rotation[:-1])))


def _vector(turn: Array) -> Array:
    return turn[:, 1:] * np.where(turn[:, :1] < 0, -1.0, 1.0)


def _wahba(seen: Array, exact: Array, hands: Sequence[int] = (1,)) -> Array:
    """Return the orthogonal matrix of one of the hands that takes exact vectors to those seen."""
    found = [_nearest(seen.T @ exact, hand) for hand in hands]
    rest = [float(np.linalg.norm(seen - exact @ x.T)) for x in found]
    return found[-1] if rest[0] > _ALIKE * rest[-1] + 1e-9 else found[0]


def _nearest(matrix: Array, hand: int) -> Array:
    """Return the orthogonal matrix of a hand that is nearest to a matrix."""
    left, _, right = np.linalg.svd(matrix)
    signs = np.array([1.0, 1.0, hand * np.linalg.det(left @ right)])
    return np.asarray((left * signs) @ right)


def in_frames(recording: Recording, space: Array, body: Array) -> Recording:
    """Return a recording in the frames of the exact motion, as an attitude with rates."""
    turns = (rotations.of_matrix(x.reshape(1, 9))[0][0] for x in (space.T, body))
    seen = recording.observed().turned(*turns)
    motion = {"quaternion": seen.quaternion, "axis": seen.axis, "rates": seen.body_rates}
    given = {x: recording.given[x] for x in ("t", "missing")}
    given |= {key: x for key, x in motion.items() if x is not None}
    return recording._replace(given=given, reading=Reading(units=RADIANS))


def turn_of(matrix: Array) -> str:
    """Return a rotation in words."""
    _, *vector = rotations.of_matrix(matrix.reshape(1, 9))[0][0]
    size = float(np.linalg.norm(vector))
    direction = ", ".join(f"{x / size:.3g}" for x in vector)
    return f"{2 * math.degrees(math.asin(min(size, 1.0))):.4g} degrees about ({direction})"
