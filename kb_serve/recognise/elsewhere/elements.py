"""How collections without ``new`` or ``remove`` get and lose elements: the functions that do it lie elsewhere."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import REMOVING_VERBS
from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from kb_serve.lookups.records import SymbolEntry
    from kb_serve.reader import BaseReader

ADDING = frozenset(
    {
        "add",
        "append",
        "assign",
        "connect",
        "create",
        "extend",
        "insert",
        "link",
        "load",
        "new",
        "push",
        "resize",
    }
)
# What is unassigned is there still.
REMOVING = (REMOVING_VERBS - {"unassign"}) | {"destroy", "erase", "pop"}


class Elsewhere(NamedTuple):
    """The function or property that adds or removes elements of a collection, and how it is written."""

    path: str
    how: str


_TO_COLLECTION = Elsewhere(
    f"{T}CollectionObjects.link",
    "Objects are linked to a collection: `bpy.context.collection.objects.link(obj)`.",
)
_OBJECT_REMOVED = Elsewhere(
    f"{T}BlendDataObjects.remove",
    "`bpy.data.objects.remove(obj)` removes an object for good, `collection.objects.unlink(obj)` takes it out of one.",
)
_SHAPE_KEY_ADDED = Elsewhere(
    f"{T}Object.shape_key_add",
    'The object adds them: `obj.shape_key_add(name="Key")`, the first one as the basis.',
)
_BONES_ADDED = Elsewhere(
    f"{T}ArmatureEditBones.new",
    "Bones are made in Edit Mode: with the armature active, `bpy.ops.object.mode_set(mode='EDIT')`, then "
    '`armature.edit_bones.new("Bone")`, which needs a `head` and a `tail` apart; back in Object Mode there is a bone '
    "and a pose bone of that name.",
)
_BONES_REMOVED = Elsewhere(
    f"{T}ArmatureEditBones.remove",
    'Bones are removed in Edit Mode: `armature.edit_bones.remove(armature.edit_bones["Bone"])`.',
)
_WEIGHT_ADDED = Elsewhere(
    f"{T}VertexGroup.add",
    "The object's vertex groups assign vertices: `obj.vertex_groups[\"Group\"].add([vertex.index], 1.0, 'REPLACE')`.",
)
_WEIGHT_REMOVED = Elsewhere(
    f"{T}VertexGroup.remove",
    'The object\'s vertex groups remove vertices: `obj.vertex_groups["Group"].remove([vertex.index])`.',
)
_LINKED = Elsewhere(
    f"{T}NodeLinks.new",
    "The tree links sockets: `node_tree.links.new(from_node.outputs[0], to_node.inputs[0])`.",
)
_UNLINKED = Elsewhere(
    f"{T}NodeLinks.remove",
    "The tree removes links: `node_tree.links.remove(node.inputs[0].links[0])`.",
)
_GEOMETRY_REMOVED = Elsewhere(
    "bmesh.ops.delete",
    "A mesh loses parts in a bmesh: `bm = bmesh.new(); bm.from_mesh(mesh); bm.verts.ensure_lookup_table(); "
    "bmesh.ops.delete(bm, geom=[bm.verts[0]], context='VERTS'); bm.to_mesh(mesh)`.",
)
_LAYER_COLLECTION_ADDED = Elsewhere(
    f"{T}CollectionChildren.link",
    "A layer shows the scene's collections: `scene.collection.children.link(collection)` adds one.",
)
ADDS_BOID_RULE = (
    "`with bpy.context.temp_override(particle_settings=psys.settings): "
    "bpy.ops.boid.rule_add(type='FOLLOW_LEADER')`"
)
_PLANE_TRACK_ADDED = Elsewhere(
    "bpy.ops.clip.create_plane_track",
    "In a clip editor `bpy.ops.clip.create_plane_track()` makes one of four or more tracks that are selected.",
)
_SELECTED = Elsewhere(f"{T}Object.select_set", "An object is selected by itself: `obj.select_set(True)`.")
_DESELECTED = Elsewhere(
    f"{T}Object.select_set", "An object is deselected by itself: `obj.select_set(False)`."
)
_CURVES_ADDED = Elsewhere(
    f"{T}Curves.add_curves",
    "Hair curves are added by how many points each has: `curves.add_curves([4, 4])`.",
)
# Collection → where elements are added.
ADDED_BY = {
    f"{T}Object.children": Elsewhere(
        f"{T}Object.parent", "A child is given its parent: `child.parent = obj`."
    ),
    f"{T}Object.users_collection": _TO_COLLECTION,
    f"{T}LayerObjects.selected": _SELECTED,
    f"{T}PointCloud.points": Elsewhere(
        f"{T}PointCloud.resize",
        "The point cloud sets how many there are: `pointcloud.resize(3)`.",
    ),
    f"{T}Curves.curves": _CURVES_ADDED,
    f"{T}Curves.points": _CURVES_ADDED,
    f"{T}BoidState.rules": Elsewhere(
        "bpy.ops.boid.rule_add",
        f"An operator adds one: {ADDS_BOID_RULE}.",
    ),
    f"{T}DynamicPaintCanvasSettings.canvas_surfaces": Elsewhere(
        "bpy.ops.dpaint.surface_slot_add",
        "An operator adds one to the canvas of the active object: `bpy.ops.dpaint.surface_slot_add()`.",
    ),
    f"{T}MovieTracking.plane_tracks": _PLANE_TRACK_ADDED,
    f"{T}MovieTrackingObject.plane_tracks": _PLANE_TRACK_ADDED,
    f"{T}MovieTrackingStabilization.tracks": Elsewhere(
        "bpy.ops.clip.stabilize_2d_add",
        "In a clip editor `bpy.ops.clip.stabilize_2d_add()` adds the tracks that are selected.",
    ),
    f"{T}ParticleSystem.targets": Elsewhere(
        "bpy.ops.particle.new_target",
        "An operator adds one: `with bpy.context.temp_override(particle_system=psys): bpy.ops.particle.new_target()`.",
    ),
    f"{T}DriverVariable.targets": Elsewhere(
        f"{T}DriverVariable.type",
        "A variable has as many as its type takes: two with `var.type = 'LOC_DIFF'` or `'ROTATION_DIFF'`, else one; "
        "set `var.targets[0].id` and what else that type reads.",
    ),
    f"{T}Object.material_slots": Elsewhere(
        f"{T}IDMaterials.append",
        "The object's data has the materials: `obj.data.materials.append(material)` adds a slot with one.",
    ),
    f"{T}Key.key_blocks": _SHAPE_KEY_ADDED,
    f"{T}BlendData.shape_keys": _SHAPE_KEY_ADDED,
    f"{T}Armature.bones": _BONES_ADDED,
    f"{T}Pose.bones": _BONES_ADDED,
    f"{T}Object.particle_systems": Elsewhere(
        f"{T}ObjectModifiers.new",
        "A modifier brings one: `obj.modifiers.new(\"Particles\", 'PARTICLE_SYSTEM').particle_system`.",
    ),
    f"{T}Scene.objects": _TO_COLLECTION,
    f"{T}ViewLayer.objects": _TO_COLLECTION,
    f"{T}Collection.all_objects": _TO_COLLECTION,
    f"{T}LayerCollection.children": _LAYER_COLLECTION_ADDED,
    f"{T}MeshVertex.groups": _WEIGHT_ADDED,
    f"{T}NodeSocket.links": _LINKED,
    f"{T}Text.lines": Elsewhere(f"{T}Text.write", 'The text gets lines: `text.write("line\\n")`.'),
    f"{T}GreasePencilDrawing.strokes": Elsewhere(
        f"{T}GreasePencilDrawing.add_strokes",
        "The drawing makes strokes, each of so many points: `drawing.add_strokes([4])`.",
    ),
}
# Collection → where elements are removed.
REMOVED_BY = {
    f"{T}Object.children": Elsewhere(f"{T}Object.parent", "A child loses its parent: `child.parent = None`."),
    f"{T}Object.users_collection": Elsewhere(
        f"{T}CollectionObjects.unlink", "A collection lets go of an object: `collection.objects.unlink(obj)`."
    ),
    f"{T}LayerObjects.selected": _DESELECTED,
    f"{T}Object.material_slots": Elsewhere(
        f"{T}IDMaterials.pop",
        "The object's data has the materials: `obj.data.materials.pop(index=0)` removes one with its slot (the last "
        "slot stays, empty), `obj.data.materials.clear()` all.",
    ),
    f"{T}Key.key_blocks": Elsewhere(
        f"{T}Object.shape_key_remove",
        'The object removes them: `obj.shape_key_remove(obj.data.shape_keys.key_blocks["Key"])`.',
    ),
    f"{T}Armature.bones": _BONES_REMOVED,
    f"{T}Pose.bones": _BONES_REMOVED,
    f"{T}Object.particle_systems": Elsewhere(
        f"{T}ObjectModifiers.remove",
        'Remove the modifier that brings it: `obj.modifiers.remove(obj.modifiers["Particles"])`.',
    ),
    f"{T}Scene.objects": _OBJECT_REMOVED,
    f"{T}ViewLayer.objects": _OBJECT_REMOVED,
    f"{T}Collection.all_objects": _OBJECT_REMOVED,
    f"{T}MeshVertex.groups": _WEIGHT_REMOVED,
    f"{T}NodeSocket.links": _UNLINKED,
    f"{T}Mesh.vertices": _GEOMETRY_REMOVED,
    f"{T}Mesh.edges": _GEOMETRY_REMOVED,
    f"{T}Mesh.polygons": _GEOMETRY_REMOVED,
    f"{T}Mesh.loops": _GEOMETRY_REMOVED,
}

# Class → the collection that scripts mean by ``thing["name"]``, which is a custom property of the thing instead.
_MEANT = {
    f"{T}Armature": "bones",
    f"{T}Collection": "objects",
    f"{T}Key": "key_blocks",
    f"{T}NodeTree": "nodes",
    f"{T}Pose": "bones",
}


def meant_by_key(cls: str, reader: BaseReader) -> SymbolEntry | None:
    """The collection of a class that has what ``thing["name"].member`` is probably meant to find."""
    names = (_MEANT.get(entry.path) for entry in reader.lineage(cls))
    name = next(filter(None, names), "")
    return reader.member_of(cls, name) if name else None


def elsewhere(owner: str, name: str, reader: BaseReader) -> Elsewhere | None:
    """What does what a collection lacks a function for; ``owner`` is the property, or the collection's class."""
    table = ADDED_BY if name in ADDING else REMOVED_BY if name in REMOVING else {}
    paths = (owner, *reader.collections_of(owner.removeprefix(T))) if table else ()
    found = next((table[path] for path in paths if path in table), None)
    return found if found and reader.entry(found.path) else None
