"""What changes properties that cannot be assigned: a function, an operator, or another property."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T

_CONTEXT = (
    "bpy.context."  # what an editor adds to the context stands there, what is always in it in its class
)
_ACTIVATED = f"{T}LayerObjects.active", "Write `bpy.context.view_layer.objects.active = obj`."
_FILLED = f"{T}Mesh.from_pydata", "`mesh.from_pydata([(x, y, z), …], edges, faces)` fills a new mesh."
_POSED = (
    f"{T}PoseBone.matrix",
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
    return f"{T}EditBone.{name}", (
        "A bone is built in edit mode, with its object active: `bpy.ops.object.mode_set(mode='EDIT')`, then "
        f'`armature.edit_bones["Bone"].{name} = {value}`.'
    )


# Property that takes no keys → the one that is animated in its place.
ANIMATED_BY = {
    f"{T}Object.dimensions": "scale",
    **{f"{T}Camera.{name}": "lens" for name in ("angle", "angle_x", "angle_y")},
}
# Property → (what changes it, how).
CHANGED_BY = {
    f"{T}AnimData.action": (
        f"{T}AnimData.use_tweak_mode",
        "While a strip of the NLA is tweaked no action is given: `anim_data.use_tweak_mode = False` ends that.",
    ),
    f"{T}Paint.brush": (
        "bpy.ops.brush.asset_activate",
        "Brushes are assets: in the mode that paints, `bpy.ops.brush.asset_activate(asset_library_type='ESSENTIALS', "
        "relative_asset_identifier='brushes/essentials_brushes-mesh_sculpt.blend/Brush/Draw')` makes one active, of "
        "Sculpt Mode; other modes have theirs in `-mesh_vertex`, `-mesh_weight`, `-mesh_texture`, `-gp_draw` ….",
    ),
    f"{T}MeshLoop.normal": (
        f"{T}Mesh.normals_split_custom_set",
        "`mesh.normals_split_custom_set([(x, y, z), …])`, one for each corner, sets them all.",
    ),
    f"{T}MeshNormalValue.vector": (
        f"{T}Mesh.normals_split_custom_set",
        "`mesh.normals_split_custom_set([(x, y, z), …])`, one for each corner, sets those of all corners.",
    ),
    f"{T}MeshVertex.normal": (
        f"{T}Mesh.normals_split_custom_set_from_vertices",
        "`mesh.normals_split_custom_set_from_vertices([(x, y, z), …])`, one for each vertex, sets the normals.",
    ),
    f"{T}GreasePencilFrame.frame_number": (
        f"{T}GreasePencilFrames.move",
        "`layer.frames.move(1, 5)` moves a frame to another number, `layer.frames.copy(1, 5)` copies it.",
    ),
    "_bpy_internal.grease_pencil.stroke.GreasePencilStroke.curve_type": (
        f"{T}GreasePencilDrawing.set_types",
        "`drawing.set_types(type='POLY', indices=[0])` sets it.",
    ),
    f"{T}Object.mode": (
        "bpy.ops.object.mode_set",
        "Make the object active, then `bpy.ops.object.mode_set(mode='EDIT')`.",
    ),
    f"{T}Object.type": (
        "bpy.ops.object.convert",
        "It is that of the object's data, for good: `bpy.ops.object.convert(target='MESH')` makes a mesh of a curve or "
        "text.",
    ),
    f"{T}Image.size": (
        f"{T}Image.scale",
        "`image.scale(width, height)` changes it.",
    ),
    f"{T}Modifier.type": (
        f"{T}ObjectModifiers.new",
        "Remove the modifier and add another: `obj.modifiers.new(name, type)`.",
    ),
    f"{T}Mesh.shape_keys": (
        f"{T}Object.shape_key_add",
        '`obj.shape_key_add(name="Key")` makes them.',
    ),
    f"{T}Context.mode": (
        "bpy.ops.object.mode_set",
        "`bpy.ops.object.mode_set(mode='EDIT')` changes that of the active object.",
    ),
    f"{T}Context.scene": (
        f"{T}Window.scene",
        "Write `bpy.context.window.scene = scene`.",
    ),
    f"{T}Context.view_layer": (
        f"{T}Window.view_layer",
        "Write `bpy.context.window.view_layer = view_layer`.",
    ),
    f"{T}Context.object": _ACTIVATED,
    f"{T}Context.active_object": _ACTIVATED,
    f"{T}Context.selected_objects": (
        f"{T}Object.select_set",
        "`obj.select_set(True)` selects one.",
    ),
    f"{T}Scene.objects": (
        f"{T}CollectionObjects.link",
        "`scene.collection.objects.link(obj)` adds one.",
    ),
    **{f"{T}Bone.{name}": _of_edit_bone(name, value) for name, value in _OF_EDIT_BONES.items()},
    f"{T}Bone.head_local": _of_edit_bone("head", "(0, 0, 1)"),
    f"{T}Bone.tail_local": _of_edit_bone("tail", "(0, 0, 2)"),
    f"{T}Bone.matrix_local": _of_edit_bone("matrix", "matrix"),
    f"{T}PoseBone.head": _POSED,
    f"{T}PoseBone.tail": _POSED,
    f"{T}Mesh.vertices": _FILLED,
    f"{T}Mesh.edges": _FILLED,
    f"{T}Mesh.polygons": _FILLED,
}


def changed_by(path: str) -> tuple[str, str]:
    """What changes a property that cannot be assigned, and how; two empty texts where that is not known."""
    member = path.removeprefix(_CONTEXT)
    return CHANGED_BY.get(path if member == path else f"{T}Context.{member}", ("", ""))
