# SPDX-License-Identifier: GPL-3.0-or-later
"""Short facts about the scene as other servers' clients expect them: plain numbers, nothing evaluated."""

import math

import bpy
from mathutils import Vector

from simworlds.sandbox.inside.refusal import Refused

from ..blend.names import nearest

_USERS = 3  # named of a material


def scene_summary(arguments, report):
    """The scene's ``name``, how many objects and materials there are, and the first ``most`` objects."""
    del report
    scene = bpy.context.scene
    objects = list(scene.objects)
    return {
        "name": scene.name,
        "object_count": len(objects),
        "objects": [
            {"name": obj.name, "type": obj.type, "location": _numbers(obj.location, 2)}
            for obj in objects[: arguments["most"]]
        ],
        "materials_count": len(bpy.data.materials),
    }


def object_summary(arguments, report):
    """The transform, materials and mesh of the object ``name``; ``box`` is that of a mesh in the world."""
    del report
    name = arguments["name"]
    obj = bpy.data.objects.get(name)
    if obj is None:
        near = nearest(name, bpy.data.objects.keys(), 4)
        hint = f" Nearest: {', '.join(map(repr, near))}." if near else ""
        raise Refused(f"Object not found: {name[:200]}.{hint}")
    bpy.context.view_layer.update()
    mesh = obj.data if obj.type == "MESH" else None
    corners = [obj.matrix_world @ Vector(corner) for corner in obj.bound_box] if mesh else []
    return {
        "name": obj.name,
        "type": obj.type,
        "location": _numbers(obj.location),
        "rotation": _numbers(obj.rotation_euler),
        "scale": _numbers(obj.scale),
        "visible": obj.visible_get(),
        "materials": [slot.material.name for slot in obj.material_slots if slot.material],
        "box": [
            _numbers(pick(corner[axis] for corner in corners) for axis in range(3)) for pick in (min, max)
        ]
        if corners
        else None,
        "mesh": [len(mesh.vertices), len(mesh.edges), len(mesh.polygons)] if mesh else None,
    }


def _numbers(values, digits=7):
    """Rounded numbers; None for what is not finite."""
    return [round(value, digits) if math.isfinite(value) else None for value in values]


def named_items(arguments, report):
    """Objects, materials and collections whose name has ``query`` in it (those that begin with it first), at most
    ``limit``, and how many there are."""
    del report
    query = arguments["query"].strip().lower()
    found = [item for item in _items(bpy.context.scene) if query in item["name"].lower()]
    found.sort(key=lambda item: not item["name"].lower().startswith(query))
    return {"items": found[: arguments["limit"]], "total": len(found)}


def _items(scene):
    users = {}
    for obj in scene.objects:
        collections = [collection.name for collection in obj.users_collection]
        where = f" in {collections[0]}" if collections else ""
        yield {"kind": "object", "name": obj.name, "detail": f"{obj.type.lower()}{where}"}
        for slot in obj.material_slots:
            if slot.material:
                users.setdefault(slot.material.name, []).append(obj.name)
    for material in bpy.data.materials:
        names = users.get(material.name, [])
        more = f" and {len(names) - _USERS} more" if len(names) > _USERS else ""
        detail = f"used by {', '.join(names[:_USERS])}{more}" if names else "not used in this scene"
        yield {"kind": "material", "name": material.name, "detail": detail}
    for collection in bpy.data.collections:
        count = len(collection.all_objects)
        yield {"kind": "collection", "name": collection.name, "detail": f"{count} objects"}
