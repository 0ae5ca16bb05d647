"""Scenes with the protocol's tags, built in Blender by short scripts, and what the verifier says of them.

A script is Python for Blender that may use the functions in ``TOOLS``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from agents.blender.checks.verification import verify_scene
from agents.blender.tools.base import Call
from agents.plan.scene import ScenePlan
from agents.protocol.measures.requests import measure
from agents.protocol.rules.catalogue import select_rules
from simworlds.sandbox.replies import unread

if TYPE_CHECKING:
    from live_session import LiveSession

    from agents.protocol.findings import Finding, Report
    from agents.protocol.measures.requests import Answer, Measures, Request

SOON = 150.0
"""Seconds for what takes some where nothing else runs, and hours or all memory where it is done wrongly."""

TOOLS = '''
import math

import bmesh
import bpy
from mathutils import Euler, Matrix, Vector

scene = bpy.context.scene


def system(name):
    """The L2 of that name."""
    made = bpy.data.collections.get(name)
    if made is None:
        made = bpy.data.collections.new(name)
        made["protocol_role"] = "system"
        scene.collection.children.link(made)
    return made


def thing(name, *objects, system_name="set", at=(0, 0, 0), turn=(0, 0, 0)):
    """The L3 of that name: its objects, which stay where they are, below a root at ``at``, turned by degrees."""
    made = bpy.data.collections.new(name)
    made["protocol_role"] = "object"
    system(system_name).children.link(made)
    root = bpy.data.objects.new(name + " root", None)
    root["is_object_root"] = True
    root.matrix_world = Matrix.LocRotScale(Vector(at), Euler([math.radians(one) for one in turn]), None)
    made.objects.link(root)
    for one in objects:
        made.objects.link(one)
        one.parent, one.matrix_parent_inverse = root, root.matrix_world.inverted()
    return root


def mesh(name, points, faces, at=(0, 0, 0), turn=(0, 0, 0)):
    """A mesh whose points are moved to ``at`` and turned by degrees."""
    data = bpy.data.meshes.new(name)
    data.from_pydata([Vector(point) for point in points], [], faces)
    made = bpy.data.objects.new(name, data)
    made.matrix_world = Matrix.LocRotScale(Vector(at), Euler([math.radians(one) for one in turn]), None)
    return made


def box(name, low, high, at=(0, 0, 0), turn=(0, 0, 0)):
    """A closed box between two corners."""
    points = [(x, y, z) for x in (low[0], high[0]) for y in (low[1], high[1]) for z in (low[2], high[2])]
    faces = [(0, 1, 3, 2), (4, 6, 7, 5), (0, 4, 5, 1), (2, 3, 7, 6), (0, 2, 6, 4), (1, 5, 7, 3)]
    return mesh(name, points, faces, at, turn)


def plane(name, low, high, at=(0, 0, 0), turn=(0, 0, 0)):
    """A rectangle at height 0 between two corners (x, y), its normal up."""
    points = [(low[0], low[1], 0), (high[0], low[1], 0), (high[0], high[1], 0), (low[0], high[1], 0)]
    return mesh(name, points, [(0, 1, 2, 3)], at, turn)


def ball(name, radius, at=(0, 0, 0), segments=32):
    """A closed sphere."""
    shape = bmesh.new()
    bmesh.ops.create_uvsphere(shape, u_segments=segments, v_segments=segments // 2, radius=radius)
    data = bpy.data.meshes.new(name)
    shape.to_mesh(data)
    shape.free()
    made = bpy.data.objects.new(name, data)
    made.matrix_world = Matrix.Translation(at)
    return made


def lathe(name, profile, at=(0, 0, 0), turn=(0, 0, 0), segments=48):
    """What a profile of (radius, height) becomes, turned about Z; radius 0 is one point.

    From the outer bottom to the inner one it is a vessel; a closed surface if both ends have radius 0.
    """
    points, rings, faces = [], [], []
    for radius, height in profile:
        count = segments if radius > 0 else 1
        rings.append(range(len(points), len(points) + count))
        for step in range(count):
            turned = 2 * math.pi * step / segments
            points.append((radius * math.cos(turned), radius * math.sin(turned), height))
    for below, above in zip(rings, rings[1:]):
        for step in range(segments):
            after = (step + 1) % segments
            corners = [below[step % len(below)], below[after % len(below)],
                       above[after % len(above)], above[step % len(above)]]
            corners = list(dict.fromkeys(corners))
            if len(corners) > 2:
                faces.append(corners)
    return mesh(name, points, faces, at, turn)


def key(one, frame, **values):
    """Sets properties of an object, and keys them at a frame."""
    for name, value in values.items():
        setattr(one, name, value)
        one.keyframe_insert(name, frame=frame)


def linear(one):
    """Between an object's keys so far everything goes evenly."""
    for curve in one.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
        for point in curve.keyframe_points:
            point.interpolation = "LINEAR"


def rigid(one, kind="ACTIVE", **settings):
    """Makes an object a rigid body without a margin."""
    if scene.rigidbody_world is None:
        bpy.ops.rigidbody.world_add()
    with bpy.context.temp_override(object=one, active_object=one, selected_objects=[one]):
        bpy.ops.rigidbody.object_add(type=kind)
    one.rigid_body.collision_shape = "CONVEX_HULL"
    one.rigid_body.use_margin, one.rigid_body.collision_margin = True, 0.0
    for name, value in settings.items():
        setattr(one.rigid_body, name, value)


def camera(at, target, lens=50):
    """The scene's camera, looking at a place."""
    made = bpy.data.objects.new("Camera", bpy.data.cameras.new("Camera"))
    made.data.lens = lens
    towards = Vector(target) - Vector(at)
    made.matrix_world = Matrix.LocRotScale(Vector(at), towards.to_track_quat("-Z", "Y"), None)
    system("cameras").objects.link(made)
    scene.camera = made
    return made
'''


def a_plan(*relations: dict[str, Any], **more: Any) -> ScenePlan:
    """A plan of the objects that its relations name; ``more`` are fields of the plan."""
    names: dict[str, set[str]] = {}
    for relation in relations:
        for field, value in relation.items():
            nodes = value if isinstance(value, (list, tuple)) else [value]
            for node in (one for one in nodes if field not in {"kind", "frame", "pattern", "facing"}):
                if isinstance(node, str):
                    owner, _, part = node.partition("/")
                    names.setdefault(owner, set()).update([part] if part else [])
    objects = [
        {
            "name": name,
            "systems": ["set"],
            "dimensions": (1, 1, 1),
            "position": (0, 0, 0),
            "parts": sorted(parts),
        }
        for name, parts in names.items()
    ]
    fields: dict[str, Any] = {
        "title": "A scene",
        "systems": ["ground", "set"],
        "objects": objects,
        "relations": relations,
        "lighting": [{"name": "Sun", "kind": "sun", "energy": 3}],
        "camera": {"position": (5, -5, 3), "target": (0, 0, 0)},
        "render": {"kind": "still"},
    }
    return ScenePlan.model_validate(fields | more)


def a_motion(
    *phases: dict[str, Any],
    last: int = 60,
    roles: dict[str, str] | None = None,
    relations: tuple[dict[str, Any], ...] = (),
    **more: Any,
) -> ScenePlan:
    """A plan of phases from frame 1 to ``last``, their names being actor and number; ``roles`` of its objects."""
    names = dict.fromkeys([phase["actor"] for phase in phases] + [*(roles or {})])
    objects = [
        {
            "name": name,
            "systems": ["set"],
            "dimensions": (1, 1, 1),
            "position": (0, 0, 0),
            "role": (roles or {}).get(name, "keyframed"),
        }
        for name in names
    ]
    named = [{"name": f"{phase['actor']} {place}", **phase} for place, phase in enumerate(phases)]
    fields = {"objects": objects, "frame_end": last, "motion": {"phases": named}}
    return a_plan(*relations, **(fields | {"render": {"kind": "animation"}} | more))


def build(session: LiveSession, script: str) -> None:
    """Runs a script that may use the tools above."""
    session.run(f"{TOOLS}\n{script}\nbpy.context.view_layer.update()")


def verified(session: LiveSession, rules: str, plan: ScenePlan | None = None) -> Report:
    """What rules (``R5,V``) say of the open scene."""
    return verify_scene(session.blender, select_rules(rules.split(",")), plan, Call())


def measures(session: LiveSession, *requests: Request[Any]) -> Measures:
    """What Blender measures in the open scene, in one batch."""

    def ask(requests: list[dict[str, Any]]) -> list[dict[str, Any]]:
        return session.blender.call("measure", {"requests": requests}, unread, timeout=60).value

    return measure(requests, ask)


def measured(session: LiveSession, request: Request[Answer]) -> Answer:
    """What Blender measures in the open scene."""
    return measures(session, request)[request]


def the_finding(report: Report) -> Finding:
    """The only finding of a report."""
    assert len(report.findings) == 1, [one.message for one in report.findings]
    return report.findings[0]
