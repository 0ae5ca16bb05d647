"""A row of dominoes and a tablecloth that are simulated, and in which everything is right."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from valid_parts import an_object, checked

if TYPE_CHECKING:
    from agents.plan.scene import ScenePlan

DOMINOES = """
scene.frame_start, scene.frame_end = 1, 60
bpy.ops.rigidbody.world_add()
scene.rigidbody_world.substeps_per_frame, scene.rigidbody_world.solver_iterations = 60, 30

def body(one, kind, **settings):
    with bpy.context.temp_override(object=one, active_object=one, selected_objects=[one]):
        bpy.ops.rigidbody.object_add(type=kind)
    one.rigid_body.collision_shape = "CONVEX_HULL"
    one.rigid_body.use_margin, one.rigid_body.collision_margin = True, 0.0
    for name, value in settings.items():
        setattr(one.rigid_body, name, value)

thing("Floor", box("Slab", (-3, -2, -0.1), (3, 2, 0)), system_name="ground")
top = box("Table top", (-1.6, -0.4, 0.7), (1.6, 0.4, 0.75))
thing("Table", top, *legs("Table", (1.5, 0.3), 0.08, 0.7))
body(top, "PASSIVE", friction=0.5)

for number in range(8):
    at = (-0.6 + 0.2 * number, 0, 0.75)
    # A body turns about the origin of its mesh: that is its centre of mass.
    tile = box(f"Tile {number + 1}", (-0.04, -0.1, -0.2), (0.04, 0.1, 0.2), at=(at[0], 0, 0.95))
    thing(f"Domino {number + 1}", tile, system_name="dominoes", at=at)
    bpy.data.collections[f"Domino {number + 1}"]["deformation_kind"] = "sim_rigid"
    bpy.data.collections[f"Domino {number + 1}"]["motion_kind"] = "bake"
    body(tile, "ACTIVE", friction=0.4, restitution=0.0)

at = (-0.9, 0, 0.75)
nose = box("Nose", (0, -0.05, 0.3), (0.15, 0.05, 0.36), at=at)
root = thing("Pusher", box("Rod", (-0.05, -0.1, 0), (0, 0.1, 0.38), at=at), nose, at=at)
bpy.data.collections["Pusher"]["deformation_kind"] = "none"
bpy.data.collections["Pusher"]["motion_kind"] = "keyframe"
touches("Rod", "Table top")
body(nose, "PASSIVE", kinematic=True)
key(root, 6, location=(-0.9, 0, 0.75))
key(root, 14, location=(-0.65, 0, 0.75))
key(root, 20, location=(-0.9, 0, 0.75))
for curve in root.animation_data.action.layers[0].strips[0].channelbags[0].fcurves:
    for point in curve.keyframe_points:
        point.interpolation = "LINEAR"

for name, x in (("Crate", -1.9), ("Chest", 1.95)):
    thing(name, box(f"{name} body", (-0.2, -0.2, 0), (0.2, 0.2, 0.5), at=(x, 0.6, 0)), at=(x, 0.6, 0))
    touches(f"{name} body", "Slab")

stage((0.7, -3.1, 1.6), (0.25, 0, 0.9), 45)
"""

CLOTH = """
scene.frame_start, scene.frame_end = 1, 50

thing("Floor", box("Slab", (-2, -2, -0.1), (2, 2, 0)), system_name="ground")
top = box("Table top", (-0.5, -0.5, 0.7), (0.5, 0.5, 0.75))
thing("Table", top, *legs("Table", (0.4, 0.4), 0.08, 0.7))
top.modifiers.new("Collision", "COLLISION")
top.collision.thickness_outer, top.collision.cloth_friction = 0.001, 20

shape = bmesh.new()
bmesh.ops.create_grid(shape, x_segments=24, y_segments=24, size=0.75)
data = bpy.data.meshes.new("Sheet")
shape.to_mesh(data)
shape.free()
sheet = bpy.data.objects.new("Sheet", data)
sheet.location = (0, 0, 0.8)
bpy.context.view_layer.update()
thing("Tablecloth", sheet, at=(0, 0, 0.8))
bpy.data.collections["Tablecloth"]["deformation_kind"] = "sim_cloth"
bpy.data.collections["Tablecloth"]["motion_kind"] = "bake"
touches("Sheet", "Table top")
cloth = sheet.modifiers.new("Cloth", "CLOTH")
cloth.settings.quality, cloth.settings.air_damping, cloth.settings.mass = 8, 8, 0.3
cloth.settings.bending_stiffness = 1
cloth.collision_settings.distance_min = 0.002
cloth.collision_settings.collision_quality = 4
for name, x, radius in (("Stool", -1.1, 0.18), ("Basket", 1.1, 0.2)):
    at, profile = (x, 0.3, 0), [(0, 0), (radius, 0), (radius, 0.45), (0, 0.45)]
    thing(name, lathe(f"{name} body", profile, at=at), at=at)
    touches(f"{name} body", "Slab")

stage((2.2, -3.5, 2.2), (0, 0, 0.6), 40)
"""

_TILES = tuple(f"Domino {number + 1}" for number in range(8))
# When each tile begins to fall, is on its way no more, and by how much it has turned then.
_FALLS = (
    (9, 34, 69),
    (12, 34, 67),
    (15, 34, 67),
    (18, 34, 67),
    (21, 34, 67),
    (24, 42, 70),
    (26, 44, 78),
    (28, 44, 90),
)


def dominoes_plan() -> ScenePlan:
    """A row of dominoes that a keyed pusher sets off."""
    phases: list[dict[str, Any]] = [
        {
            "name": "push",
            "actor": "Pusher",
            "kind": "translate",
            "start": 6,
            "end": 14,
            "direction": (1, 0, 0),
            "extent": 0.25,
        },
        {
            "name": "return",
            "actor": "Pusher",
            "kind": "translate",
            "start": 14,
            "end": 20,
            "direction": (-1, 0, 0),
            "extent": 0.25,
        },
    ]
    for number, (name, (start, end, turn)) in enumerate(zip(_TILES, _FALLS, strict=True)):
        phases.append(
            {
                "name": f"fall {number + 1}",
                "actor": name,
                "kind": "topple",
                "start": start,
                "end": end,
                "turn": turn,
                "cause": f"fall {number}" if number else "push",
            },
        )
        phases.append(
            {"name": f"rest {number + 1}", "actor": name, "kind": "settle", "start": end + 1, "end": 60}
        )
    return checked(
        title="A row of dominoes",
        frame_end=60,
        systems=["ground", "set", "dominoes", "lighting", "cameras"],
        objects=[
            an_object("Floor", (6, 4, 0.1), (0, 0, 0), "ground", role="ground"),
            an_object("Table", (3.2, 0.8, 0.75), (0, 0, 0), role="collider"),
            an_object("Crate", (0.4, 0.4, 0.5), (-1.9, 0.6, 0)),
            an_object("Chest", (0.4, 0.4, 0.5), (1.95, 0.6, 0)),
            an_object("Pusher", (0.2, 0.2, 0.38), (-0.9, 0, 0.75), role="keyframed"),
            *(
                an_object(
                    name, (0.08, 0.2, 0.4), (round(-0.6 + 0.2 * number, 3), 0, 0.75), "dominoes", role="rigid"
                )
                for number, name in enumerate(_TILES)
            ),
        ],
        relations=[
            {"kind": "SupportedBy", "child": "Table", "parents": ["Floor"]},
            *({"kind": "SupportedBy", "child": name, "parents": ["Table"]} for name in _TILES),
            *({"kind": "Upright", "a": name} for name in (*_TILES, "Pusher")),
            {"kind": "Distributed", "members": _TILES, "pattern": "line", "spacing": 0.2},
            {"kind": "NextTo", "a": "Pusher", "b": "Domino 1", "gap": (0.05, 0.15)},
            {"kind": "LeftOf", "a": "Pusher", "b": "Domino 1"},
        ],
        camera={
            "position": (0.7, -3.1, 1.6),
            "target": (0.25, 0, 0.9),
            "lens": 45,
            "subjects": ["Domino 1", "Domino 8"],
        },
        render={"kind": "animation"},
        motion={"phases": phases},
    )


def cloth_plan() -> ScenePlan:
    """A cloth that falls on a table."""
    return checked(
        title="A tablecloth",
        frame_end=50,
        systems=["ground", "set", "lighting", "cameras"],
        objects=[
            an_object("Floor", (4, 4, 0.1), (0, 0, 0), "ground", role="ground"),
            an_object("Table", (1, 1, 0.75), (0, 0, 0), role="collider"),
            an_object("Tablecloth", (1.5, 1.5, 0.002), (0, 0, 0.8), role="cloth"),
            an_object("Stool", (0.36, 0.36, 0.45), (-1.1, 0.3, 0)),
            an_object("Basket", (0.4, 0.4, 0.45), (1.1, 0.3, 0)),
        ],
        relations=[
            {"kind": "SupportedBy", "child": "Table", "parents": ["Floor"]},
            {"kind": "SupportedBy", "child": "Tablecloth", "parents": ["Table"]},
            {"kind": "OnTopOf", "a": "Tablecloth", "b": "Table"},
            {"kind": "LeftOf", "a": "Stool", "b": "Table"},
            {"kind": "RightOf", "a": "Basket", "b": "Table", "frame": "camera"},
            {"kind": "NextTo", "a": "Stool", "b": "Table", "gap": (0.3, 0.6)},
        ],
        camera={
            "position": (2.2, -3.5, 2.2),
            "target": (0, 0, 0.6),
            "lens": 40,
            "subjects": ["Tablecloth", "Basket"],
        },
        render={"kind": "animation"},
        motion={
            "phases": [
                {"name": "drape", "actor": "Tablecloth", "kind": "deform", "start": 1, "end": 30},
                {"name": "rest", "actor": "Tablecloth", "kind": "settle", "start": 31, "end": 50},
            ]
        },
    )
