"""What changes properties that cannot be assigned: a function, an operator, or another property."""

from __future__ import annotations

_T = "bpy.types."
_CONTEXT = (
    "bpy.context."  # what an editor adds to the context stands there, what is always in it in its class
)
_ACTIVATED = f"{_T}LayerObjects.active", "Write `bpy.context.view_layer.objects.active = obj`."
_FILLED = f"{_T}Mesh.from_pydata", "`mesh.from_pydata([(x, y, z), …], edges, faces)` fills a new mesh."
_POSED = (
    f"{_T}PoseBone.matrix",
    "A pose moves it by the bone's `location`, `rotation_quaternion`, `scale` or `matrix`.",
)
# What a Bone shows and an EditBone sets, with an example of a value.
_OF_EDIT_BONES = {
    "head": "(0, 0, 1)",
    "tail": "(0, 0, 2)",
    "matrix": "matrix",
    "length": "2",
    "parent": 'armature.edit_bones["Parent"]',
    "use_connect": "True",
}


def _of_edit_bone(name: str, value: str) -> tuple[str, str]:
    return f"{_T}EditBone.{name}", (
        "A bone is built in edit mode, with its object active: `bpy.ops.object.mode_set(mode='EDIT')`, then "
        f'`armature.edit_bones["Bone"].{name} = {value}`.'
    )


# Property → (what changes it, how).
CHANGED_BY = {
    f"{_T}Paint.brush": (
        "bpy.ops.brush.asset_activate",
        "Brushes are assets: in the mode that paints, `bpy.ops.brush.asset_activate(asset_library_type='ESSENTIALS', "
        "relative_asset_identifier='brushes/essentials_brushes-mesh_sculpt.blend/Brush/Draw')` makes one active, of "
        "Sculpt Mode; other modes have theirs in `-mesh_vertex`, `-mesh_weight`, `-mesh_texture`, `-gp_draw` ….",
    ),
    f"{_T}MeshLoop.normal": (
        f"{_T}Mesh.normals_split_custom_set",
        "`mesh.normals_split_custom_set([(x, y, z), …])`, one for each corner, sets them all.",
    ),
    f"{_T}MeshNormalValue.vector": (
        f"{_T}Mesh.normals_split_custom_set",
        "`mesh.normals_split_custom_set([(x, y, z), …])`, one for each corner, sets those of all corners.",
    ),
    f"{_T}MeshVertex.normal": (
        f"{_T}Mesh.normals_split_custom_set_from_vertices",
        "`mesh.normals_split_custom_set_from_vertices([(x, y, z), …])`, one for each vertex, sets the normals.",
    ),
    f"{_T}GreasePencilFrame.frame_number": (
        f"{_T}GreasePencilFrames.move",
        "`layer.frames.move(1, 5)` moves a frame to another number, `layer.frames.copy(1, 5)` copies it.",
    ),
    f"{_T}Object.mode": (
        "bpy.ops.object.mode_set",
        "Make the object active, then `bpy.ops.object.mode_set(mode='EDIT')`.",
    ),
    f"{_T}Object.type": (
        "bpy.ops.object.convert",
        "It is that of the object's data, for good: `bpy.ops.object.convert(target='MESH')` makes a mesh of a curve or "
        "text.",
    ),
    f"{_T}Image.size": (
        f"{_T}Image.scale",
        "`image.scale(width, height)` changes it.",
    ),
    f"{_T}Modifier.type": (
        f"{_T}ObjectModifiers.new",
        "Remove the modifier and add another: `obj.modifiers.new(name, type)`.",
    ),
    f"{_T}Mesh.shape_keys": (
        f"{_T}Object.shape_key_add",
        '`obj.shape_key_add(name="Key")` makes them.',
    ),
    f"{_T}Context.mode": (
        "bpy.ops.object.mode_set",
        "`bpy.ops.object.mode_set(mode='EDIT')` changes that of the active object.",
    ),
    f"{_T}Context.scene": (
        f"{_T}Window.scene",
        "Write `bpy.context.window.scene = scene`.",
    ),
    f"{_T}Context.view_layer": (
        f"{_T}Window.view_layer",
        "Write `bpy.context.window.view_layer = view_layer`.",
    ),
    f"{_T}Context.object": _ACTIVATED,
    f"{_T}Context.active_object": _ACTIVATED,
    f"{_T}Context.selected_objects": (
        f"{_T}Object.select_set",
        "`obj.select_set(True)` selects one.",
    ),
    f"{_T}Scene.objects": (
        f"{_T}CollectionObjects.link",
        "`scene.collection.objects.link(obj)` adds one.",
    ),
    **{f"{_T}Bone.{name}": _of_edit_bone(name, value) for name, value in _OF_EDIT_BONES.items()},
    f"{_T}Bone.head_local": _of_edit_bone("head", "(0, 0, 1)"),
    f"{_T}Bone.tail_local": _of_edit_bone("tail", "(0, 0, 2)"),
    f"{_T}Bone.matrix_local": _of_edit_bone("matrix", "matrix"),
    f"{_T}PoseBone.head": _POSED,
    f"{_T}PoseBone.tail": _POSED,
    f"{_T}Mesh.vertices": _FILLED,
    f"{_T}Mesh.edges": _FILLED,
    f"{_T}Mesh.polygons": _FILLED,
}


def changed_by(path: str) -> tuple[str, str]:
    """What changes a property that cannot be assigned, and how; two empty texts where that is not known."""
    member = path.removeprefix(_CONTEXT)
    return CHANGED_BY.get(path if member == path else f"{_T}Context.{member}", ("", ""))
