"""What a breach of a valid scene is, and what it is made from."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from random import Random

    from valid_scenes import ValidScene

    from agents.plan.scene import PlannedObject

LEAST, MOST = 1.2, 5.0

TOOLS = """
import os
from mathutils import Matrix, Vector

scene = bpy.context.scene

def of(name):
    return bpy.data.collections[name].objects

def root(name):
    return next(one for one in of(name) if one.get("is_object_root"))

def meshes(name):
    return [one for one in of(name) if one.type == "MESH"]

def curves(one):
    return one.animation_data.action.layers[0].strips[0].channelbags[0].fcurves if one.animation_data else []

def move(one, way):
    one.location += Vector(way)
    for curve in curves(one):
        if curve.data_path == "location":
            for point in curve.keyframe_points:
                point.co[1] += way[curve.array_index]
                point.handle_left[1] += way[curve.array_index]
                point.handle_right[1] += way[curve.array_index]

def turn(one, radians, axis):
    one.rotation_euler = (Matrix.Rotation(radians, 3, Vector(axis)) @ one.rotation_euler.to_matrix()).to_euler()

def take_off(one, way):
    one.matrix_world = Matrix.Translation(way) @ one.matrix_world

def poses(one):
    found = []
    for frame in range(scene.frame_start, scene.frame_end + 1):
        scene.frame_set(frame)
        found.append((frame, one.evaluated_get(bpy.context.evaluated_depsgraph_get()).matrix_world.copy()))
    scene.frame_set(scene.frame_start)
    return found

def shapes(one, step):
    found = []
    for frame in range(scene.frame_start, scene.frame_end + 1, step):
        scene.frame_set(frame)
        mesh = one.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        found.append((frame, [vertex.co.copy() for vertex in mesh.vertices]))
    scene.frame_set(scene.frame_start)
    return found

def without_body(one):
    with bpy.context.temp_override(object=one, active_object=one, selected_objects=[one]):
        bpy.ops.rigidbody.object_remove()

def free(points):
    with bpy.context.temp_override(point_cache=points):
        bpy.ops.ptcache.free_bake()
"""


@dataclass(frozen=True, slots=True)
class Mutation:
    """One breach: ``code`` makes it in ``scene``; one of ``owners`` must find it, and name one of ``names``."""

    kind: str
    scene: str
    code: str
    told: str
    owners: tuple[str, ...]
    names: frozenset[str] = frozenset()


@dataclass(frozen=True, slots=True)
class Aim:
    """What a mutation is made from."""

    random: Random
    scene: ValidScene

    @property
    def name(self) -> str:
        """The scene's."""
        return self.scene.name

    def factor(self) -> float:
        """How many times a tolerance."""
        return self.random.uniform(LEAST, MOST)

    def thing(self, *but: str) -> PlannedObject:
        """Any object of the scene."""
        return self.random.choice([one for one in self.scene.plan.objects if one.name not in but])

    def way(self) -> tuple[float, float, float]:
        """Any direction."""
        x, y, z = (self.random.gauss(0, 1) for _ in range(3))
        length = math.sqrt(x * x + y * y + z * z)
        return (x / length, y / length, z / length)


def diagonal(one: PlannedObject) -> float:
    return math.hypot(*one.dimensions)


def names_of(one: PlannedObject) -> frozenset[str]:
    return frozenset({one.name, f"{one.name} root"})
