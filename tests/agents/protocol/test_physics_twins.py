"""A simulation and its twins, which show the same motion without any solver: no picture tells them apart, R15 does.

The twins are made from what the baked simulation looks like at each frame: by keyframes (a body's transforms, or, of
what changes its shape, meshes that show themselves for a frame each), and by shape keys.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
import pytest
from PIL import Image
from scenes import build, the_finding, verified
from test_rule_mechanism import DECLARED, LAST, NAMED, SOLVED

from agents.blender.tools.bake import TOOL as BAKE

if TYPE_CHECKING:
    from collections.abc import Iterator

    from _pytest.mark.structures import ParameterSet
    from live_session import LiveSession

pytestmark = pytest.mark.blender

SHOWN = (1, 4, 8, LAST)  # frames
SAME = 0.1  # of how much the first and the last picture of the simulation differ
# What films a scene needs, and drops that can be seen.
STAGE = """
scene.camera = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
scene.camera.location, scene.camera.rotation_euler = (0, -4, 0.9), (math.radians(88), 0, 0)
sun = bpy.data.objects.new("Sun", bpy.data.lights.new("Sun", "SUN"))
sun.rotation_euler = (0.6, 0.3, 0)
for one in (scene.camera, sun):
    scene.collection.objects.link(one)
scene.render.engine, scene.cycles.samples, scene.cycles.device = "CYCLES", 4, "CPU"
scene.render.resolution_x = scene.render.resolution_y = 64
"""
SEEN = {
    "sim_particle": """
drop = ball("Drop", 0.06, at=(0, 0, -50), segments=8)
scene.collection.objects.link(drop)
rain.render_type, rain.instance_object, rain.particle_size = "OBJECT", drop, 1.0
""",
    "sim_fluid": "settings.use_mesh = True\ndrop.hide_render = True\n",
}
FILM = f"""
import bpy
scene = bpy.context.scene

def looks():
    points, faces = [], []
    for one in bpy.context.evaluated_depsgraph_get().object_instances:
        thing, matrix = one.object, one.matrix_world.copy()
        if thing.type != "MESH" or thing.name == "Slab" or (thing.name == "Drop" and not one.is_instance):
            continue
        mesh, count = thing.to_mesh(), len(points)
        points += [matrix @ vertex.co for vertex in mesh.vertices]
        faces += [[count + vertex for vertex in face.vertices] for face in mesh.polygons]
        thing.to_mesh_clear()
    return points, faces

film, places = {{}}, {{}}
for frame in range(1, {LAST} + 1):
    scene.frame_set(frame)
    film[frame] = looks()
    places[frame] = bpy.data.objects["Body"].matrix_world.copy()

def unsolved():
    body = bpy.data.objects["Body"]
    if body.rigid_body:
        with bpy.context.temp_override(object=body, active_object=body, selected_objects=[body]):
            bpy.ops.rigidbody.object_remove()
    for one in bpy.data.objects:
        one.modifiers.clear()

def shown(name, points, faces):
    data = bpy.data.meshes.new(name)
    data.from_pydata(points, [], faces)
    made = bpy.data.objects.new(name, data)
    actor = bpy.data.collections["Actor"]
    actor.objects.link(made)
    made.parent = next(one for one in actor.objects if one.get("is_object_root"))
    return made

def keyed(one, path, values):
    for frame, value in values.items():
        setattr(one, path, value)
        one.keyframe_insert(path, frame=frame)
"""
BY_TRANSFORMS = """
unsolved()
body = bpy.data.objects["Body"]
for frame, matrix in places.items():
    body.matrix_world = matrix
    body.keyframe_insert("location", frame=frame)
    body.keyframe_insert("rotation_euler", frame=frame)
"""
BY_TURNS = """
unsolved()
bpy.data.objects.remove(bpy.data.objects["Body"])
for frame, (points, faces) in film.items():
    one = shown("Body" if frame == 1 else f"Body {frame}", points, faces)
    for path in ("hide_render", "hide_viewport"):
        keyed(one, path, {at: at != frame for at in film})
"""
# Where the mesh has other vertices at each frame, all of them are there, and a key spreads those of its frame.
BY_SHAPES = """
unsolved()
bpy.data.objects.remove(bpy.data.objects["Body"])
is_one_mesh = len({(len(points), str(faces)) for points, faces in film.values()}) == 1
starts, points, faces = {}, [], []
for frame, (theirs, around) in film.items():
    starts[frame] = 0 if is_one_mesh else len(points)
    if frame == 1 or not is_one_mesh:
        faces += [[len(points) + vertex for vertex in face] for face in around]
        points += theirs
body = shown("Body", points if is_one_mesh else [(0, 0, -40)] * len(points), faces)
body.shape_key_add(name="Basis")
for frame, (theirs, _) in film.items():
    shape = body.shape_key_add(name=f"At {frame}")
    for place, point in enumerate(theirs):
        shape.points[starts[frame] + place].co = point
    keyed(shape, "value", {at: float(at == frame) for at in film})
"""
TAKEN = ("sim_rigid", "sim_cloth", "sim_fluid")
WAYS = {"keyframes": BY_TURNS, "shape keys": BY_SHAPES}


def filmed(session: LiveSession, name: str) -> list[np.ndarray]:
    """The rendered frames."""
    session.run(f"""
scene = bpy.context.scene
for frame in {SHOWN}:
    scene.frame_set(frame)
    scene.render.filepath = f"//{name} {{frame}}.png"
    bpy.ops.render.render(write_still=True)
""")
    folder = session.blender.folder.workspace.mount
    return [np.asarray(Image.open(folder / f"{name} {frame}.png").convert("RGB"), float) for frame in SHOWN]


def off(one: np.ndarray, other: np.ndarray) -> float:
    return float(np.abs(one - other).mean())


def cells() -> Iterator[ParameterSet]:
    """(kind, way): both ways of all kinds.

    `make test` takes a body, a surface and what has no vertices of its own, in both ways by turns. That the rule tells
    each kind by its own solver, its own tests show.
    """
    for turn, kind in enumerate(SOLVED):
        for place, way in enumerate(WAYS):
            is_taken = kind in TAKEN and turn % 2 == place
            yield pytest.param(kind, way, marks=() if is_taken else pytest.mark.whole)


@pytest.mark.parametrize(("kind", "way"), [*cells()])
def test_a_twin_that_looks_the_same_is_no_simulation(session: LiveSession, kind: str, way: str) -> None:
    script = f"{DECLARED}\nscene.frame_start, scene.frame_end = 1, {LAST}\n{STAGE}{SOLVED[kind]}{SEEN.get(kind, '')}"
    build(session, f"{script}\ndeclared('Actor', {kind!r}, 'bake')")
    session.use(BAKE)
    real = filmed(session, "real")
    moved = off(real[0], real[-1])
    assert moved > 1.0  # of 255: the pictures show that it moves
    assert verified(session, "R15").passed == ("R15",)
    made = BY_TRANSFORMS if (kind, way) == ("sim_rigid", "keyframes") else WAYS[way]
    session.run(FILM + made)
    for one, other in zip(real, filmed(session, "fake"), strict=True):
        assert off(one, other) < SAME * moved
    found = the_finding(verified(session, "R15"))
    assert (found.rule, found.severity, found.outcome, found.objects) == ("R15", "hard", "broken", ("Actor",))
    assert f"declared {kind}, but has no {NAMED[kind]} that is on" in found.message
    assert found.measured == 0.0
