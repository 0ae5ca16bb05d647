"""What properties hold whose type Blender does not tell: those written in Python, and one that holds several kinds."""

from __future__ import annotations

_T = "bpy.types."
_BONES = ("Bone", "EditBone", "PoseBone")
# Property, or the type that its text gives → the type of its list or tuple.
SEQUENCES = {
    "NodeLinks": "tuple[NodeLink, ...]",  # of sockets
    f"{_T}ShapeKey.data": "list[ShapeKeyPoint]",  # of a mesh; those of curves have their `co` as well
    f"{_T}BoneCollection.bones_recursive": "set[Bone]",
    **{
        f"{_T}{bone}.{name}": f"list[{bone}]"
        for bone in _BONES
        for name in ("children_recursive", "children_recursive_basename", "parent_recursive")
    },
    **{f"{_T}{bone}.children": f"list[{bone}]" for bone in ("EditBone", "PoseBone")},
}
# Property → the class of its value.
VALUES = {
    f"{_T}Mesh.edge_creases": f"{_T}FloatAttribute",
    f"{_T}Mesh.vertex_creases": f"{_T}FloatAttribute",
    f"{_T}Mesh.vertex_paint_mask": f"{_T}FloatAttribute",
    **{
        f"{_T}{bone}.{name}": "mathutils.Vector"
        for bone in _BONES
        for name in ("center", "vector", "x_axis", "y_axis", "z_axis")
    },
}
