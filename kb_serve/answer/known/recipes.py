"""What scripts write for tasks that take several calls, none of which says so: copies, lasting normals, whole turns."""

from __future__ import annotations

from kb_build.symbols.lines import GET_EVALUATED
from kb_serve.answer.known.advice import Advice, of, stems

_STALE = (
    "`ob.matrix_world` takes in what a script has set (`ob.location`, a parent, a constraint) only after "
    "`bpy.context.view_layer.update()`."
)
_COPIED = (
    "`new = ob.copy()` is in no collection and shares its data and its action with `ob`: "
    "`new.data = ob.data.copy()` gives it data of its own, `bpy.context.collection.objects.link(new)` shows it."
)
_CONVERTED = (
    "Without an operator, and as its modifiers make it: "
    f'`mesh = bpy.data.meshes.new_from_object(ob{GET_EVALUATED})`, then `bpy.data.objects.new("Mesh", mesh)`.'
)
_SHARP = (
    "`mesh.shade_smooth()`, then `mesh.set_sharp_from_angle(angle=math.radians(30))` need no operator; selected "
    "objects get the same by `bpy.ops.object.shade_smooth_by_angle(angle=math.radians(30))`."
)
_WEIGHTED = (
    "The {0} of edges is an attribute: "
    "`attribute = mesh.attributes.get(\"{1}\") or mesh.attributes.new(\"{1}\", 'FLOAT', 'EDGE')`, "
    "`attribute.data[edge.index].value = 1.0`; in a BMesh, before its edges are taken, "
    '`layer = bm.edges.layers.float.get("{1}") or bm.edges.layers.float.new("{1}")`, `edge[layer] = 1.0`.'
)
_TURNED = (
    'An environment is turned by a Mapping node: `mapping = nodes.new("ShaderNodeMapping")`, '
    '`links.new(nodes.new("ShaderNodeTexCoord").outputs["Generated"], mapping.inputs["Vector"])`, '
    '`links.new(mapping.outputs["Vector"], environment.inputs["Vector"])`, '
    '`mapping.inputs["Rotation"].default_value[2] = math.radians(90)`.'
)
_APPLIED = (
    "Without an operator: `ob.data.transform(ob.matrix_basis)`, then `ob.matrix_basis.identity()`; data that other "
    "objects share changes for them, too."
)
_AIMED = (
    "A camera looks along its -Z: "
    "`camera.rotation_euler = (target - camera.location).to_track_quat('-Z', 'Y').to_euler()`."
)
_APART = (
    "`(a.matrix_world.translation - b.matrix_world.translation).length` is how far apart two objects are."
)
_BOUNDED = "In the world: `[ob.matrix_world @ Vector(corner) for corner in ob.bound_box]`."
_NORMAL = (
    "In the world: `(ob.matrix_world.inverted().transposed().to_3x3() @ polygon.normal).normalized()`, which holds for "
    "any scale."
)
_ROTATED = (
    "Around an axis of the world, in place: `ob.rotation_euler.rotate(Matrix.Rotation(angle, 3, 'Z'))`."
)
_BY_TYPE = (
    "By its type, whatever its name is: "
    '`next(n for n in material.node_tree.nodes if n.bl_idname == "ShaderNodeBsdfPrincipled")`; `n.type` of it is '
    "'BSDF_PRINCIPLED'."
)

_OBJECTS = stems("object objects")
_NODES = stems("geometry modifier node nodes")
RECIPES: tuple[Advice, ...] = (
    Advice(
        _STALE,
        of("Object.matrix_world", "ViewLayer.update"),
        asked=stems(
            "after changing identity immediately not old outdated setting stale update updated wrong zero"
        ),
    ),
    Advice(
        _COPIED,
        wherever=(
            stems("clone copy duplicate"),
            _OBJECTS,
            stems("copy data link mesh object python script"),
        ),
        unless=stems(
            "animation another attributes bone bpy collection constraint custom driver file from location material "
            "modifier paste properties rotation settings transforms uv weights"
        ),
    ),
    Advice(
        _CONVERTED,
        wherever=(stems("curve curves metaball surface text"), stems("mesh"), stems("convert turn")),
        unless=_NODES,
    ),
    Advice(
        _SHARP,
        wherever=(stems("auto edges normals shade shading"), stems("smooth"), stems("angle degree degrees")),
        unless=stems("modifier node nodes vertices"),
        needs="bpy.types.Mesh.set_sharp_from_angle",
    ),
    Advice(
        _WEIGHTED.format("bevel weight", "bevel_weight_edge"),
        wherever=(stems("bevel"), stems("edge edges"), stems("weight weights")),
        unless=_NODES,
        since=(4, 0),
    ),
    Advice(
        _WEIGHTED.format("crease", "crease_edge"),
        wherever=(stems("crease creases"), stems("edge edges")),
        unless=_NODES,
        since=(4, 0),
    ),
    Advice(
        _TURNED,
        wherever=(stems("environment hdr hdri"), stems("rotate rotation turn")),
        unless=stems("viewport studio preview"),
    ),
    Advice(
        _APPLIED,
        wherever=(
            stems("apply"),
            stems("rotation scale transform transforms"),
            stems("operator without"),
        ),
    ),
    Advice(
        _AIMED,
        wherever=(stems("camera"), stems("aim look point"), stems("at target")),
        unless=stems("constraint follow keep track"),
    ),
    Advice(
        _APART,
        wherever=(stems("distance"), stems("between"), _OBJECTS),
        unless=stems("driver limit node nodes"),
    ),
    Advice(_BOUNDED, wherever=(stems("bound bounding bounds"), stems("box corners"), stems("global world"))),
    Advice(
        _NORMAL,
        wherever=(stems("face normal polygon"), stems("normal normals"), stems("global world")),
        unless=_NODES,
    ),
    Advice(
        _ROTATED,
        wherever=(stems("rotate turn"), stems("axis"), stems("global world")),
        unless=stems("bone hdri"),
    ),
    Advice(
        _BY_TYPE, wherever=(stems("find get look"), stems("node"), stems("type")), unless=stems("geometry")
    ),
)
