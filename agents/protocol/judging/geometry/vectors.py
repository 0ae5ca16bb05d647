"""Vectors, axes and rotations as numpy arrays."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import numpy.typing as npt

if TYPE_CHECKING:
    from agents.protocol.facts import Matrix, Vector

Array = npt.NDArray[np.float64]


def as_vector(place: Array) -> Vector:
    """An array of three numbers as a tuple."""
    return (float(place[0]), float(place[1]), float(place[2]))


def place_and_axes(matrix: Matrix) -> tuple[Array, Array]:
    """(place, unit axes as rows) of a world matrix. An axis of length 0 stays 0."""
    whole = np.array(matrix, dtype=float).reshape(4, 4)
    axes = whole[:3, :3].T.copy()
    lengths = np.linalg.norm(axes, axis=1)
    axes[lengths > 0] /= lengths[lengths > 0, None]
    return whole[:3, 3], axes


def angle_between(a: Array, b: Array) -> float:
    """The angle between two directions in degrees; 180 where one has length 0."""
    lengths = float(np.linalg.norm(a) * np.linalg.norm(b))
    if lengths == 0:
        return 180.0
    return float(np.degrees(np.arccos(np.clip(np.dot(a, b) / lengths, -1.0, 1.0))))


def axes_of_euler(euler: tuple[float, float, float]) -> Array:
    """The axes (rows) of an object rotated by Euler angles in degrees, in Blender's XYZ order."""
    x, y, z = np.radians(euler)
    about_x = np.array([[1, 0, 0], [0, np.cos(x), -np.sin(x)], [0, np.sin(x), np.cos(x)]])
    about_y = np.array([[np.cos(y), 0, np.sin(y)], [0, 1, 0], [-np.sin(y), 0, np.cos(y)]])
    about_z = np.array([[np.cos(z), -np.sin(z), 0], [np.sin(z), np.cos(z), 0], [0, 0, 1]])
    return (about_z @ about_y @ about_x).T


def rotation_between(a: Array, b: Array) -> float:
    """The angle of the rotation that turns the axes ``a`` into ``b``, in degrees."""
    cosine = (np.trace(a @ b.T) - 1) / 2
    return float(np.degrees(np.arccos(np.clip(cosine, -1.0, 1.0))))


def rotated(vector: Array, turn: Array) -> Array:
    """A vector turned about an axis that is as long as the angle, in radians."""
    angle = float(np.linalg.norm(turn))
    if angle == 0:
        return vector
    axis = turn / angle
    along = axis * float(axis @ vector)
    return along + (vector - along) * np.cos(angle) + np.cross(axis, vector) * np.sin(angle)
