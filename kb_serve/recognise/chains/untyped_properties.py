"""What properties hold whose type Blender does not tell: those written in Python, and one that holds several kinds."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T

_BONES = ("Bone", "EditBone", "PoseBone")
# Property, or the type that its text gives → the type of its list or tuple.
SEQUENCES = {
    "NodeLinks": "tuple[NodeLink, ...]",  # of sockets
    f"{T}ShapeKey.data": "list[ShapeKeyPoint]",  # of a mesh; those of curves have their `co` as well
    f"{T}BoneCollection.bones_recursive": "set[Bone]",
    **{
        f"{T}{bone}.{name}": f"list[{bone}]"
        for bone in _BONES
        for name in ("children_recursive", "children_recursive_basename", "parent_recursive")
    },
    **{f"{T}{bone}.children": f"list[{bone}]" for bone in ("EditBone", "PoseBone")},
}
# Property → the class of its value.
VALUES = {
    f"{T}Mesh.edge_creases": f"{T}FloatAttribute",
    f"{T}Mesh.vertex_creases": f"{T}FloatAttribute",
    f"{T}Mesh.vertex_paint_mask": f"{T}FloatAttribute",
    **{
        f"{T}{bone}.{name}": "mathutils.Vector"
        for bone in _BONES
        for name in ("center", "vector", "x_axis", "y_axis", "z_axis")
    },
}
