"""Scenes for the pictures of what is checked of rigid and soft bodies."""

from making import bake, body
from picture_parts import A, B, Shot, box


def fixed(thing, shape="BOX"):
    """A passive rigid body."""
    body(thing, "PASSIVE").collision_shape = shape
    return thing


def rigid_type(holds):
    fixed(box("B", (0, 0, 0), (1.2, 0.8, 0.2), B))
    body(box("A", (0, 0, 0.9), (0.35, 0.35, 0.35), A), "ACTIVE" if holds else "PASSIVE")
    bake()


SHOTS = {
    "rigid_type": Shot(rigid_type, (30,)),
}
