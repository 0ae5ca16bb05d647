"""What scripts write for tasks that no symbol tells of by itself: what lies beside an edge, normals in the world."""

from __future__ import annotations

from kb_build.symbols.lines import GET_EVALUATED
from kb_serve.answer.known.told_of import Advice, of, stems

_STALE = (
    "`ob.matrix_world` takes in what a script has set (`ob.location`, a parent, a constraint) only after "
    "`bpy.context.view_layer.update()`."
)
_CONVERTED = (
    "Without an operator, and as its modifiers make it: "
    f'`mesh = bpy.data.meshes.new_from_object(ob{GET_EVALUATED})`, then `bpy.data.objects.new("Mesh", mesh)`.'
)
_NORMAL = (
    "In the world: `(ob.matrix_world.inverted().transposed().to_3x3() @ polygon.normal).normalized()`, which holds for "
    "any scale."
)
_OWN = (
    '`ob["speed"] = 1.0` gives an object a custom property, and so with a scene, a material or any other data-block: '
    'the file keeps it. `ob.get("speed", 0.0)` reads one that may be missing. One that all have, with a default, is '
    "declared: `bpy.types.Object.speed = bpy.props.FloatProperty()`, then `ob.speed`."
)
_ORIGIN = (
    "`bpy.ops.object.origin_set(type='ORIGIN_GEOMETRY')` brings the origins of the selected objects into their middle, "
    "with 'ORIGIN_CURSOR' to the 3D cursor. Without an operator, to `place` in the object's own space: "
    "`ob.data.transform(Matrix.Translation(-place))`, `ob.matrix_world.translation = ob.matrix_world @ place`."
)
_PLACED = "In the world: `[ob.matrix_world @ vertex.co for vertex in ob.data.vertices]`, of the mesh without modifiers."
_LIMITED = (
    'Of a node\'s socket: `limits = socket.bl_rna.properties["default_value"]`, then `limits.hard_min`, `hard_max`, '
    "`soft_min` and `soft_max`, which are of its class; an input of a group has its own: "
    '`tree.interface.items_tree["Size"].min_value`, `max_value`.'
)
_EVALUATED = "`fcurve.evaluate(frame)` is the value of an F-Curve at a frame, between its keys, too."
_UNDER_MOUSE = (
    "What is under the mouse, in an operator's `modal()`: `place = event.mouse_region_x, event.mouse_region_y`, "
    "`view = context.region, context.region_data, place`, `origin = view3d_utils.region_2d_to_origin_3d(*view)`, "
    "`direction = view3d_utils.region_2d_to_vector_3d(*view)`, then `hit, location, normal, index, ob, matrix = "
    "context.scene.ray_cast(context.evaluated_depsgraph_get(), origin, direction)`."
)

_OBJECTS = stems("object objects")
_NODES = stems("geometry modifier node nodes")
TASK_SENTENCES: tuple[Advice, ...] = (
    Advice(
        _EVALUATED,
        wherever=(stems("f-curve fcurve fcurves"), stems("evaluate value values"), stems("frame frames")),
        unless=stems("bake insert modifier range set"),
    ),
    Advice(
        _UNDER_MOUSE,
        wherever=(
            stems("cursor mouse"),
            stems("object point ray raycast surface"),
            stems("cast ray raycast under"),
        ),
        unless=stems("3d node snap"),
    ),
    Advice(
        _PLACED,
        wherever=(
            stems("vertex vertices"),
            stems("global world"),
            stems("co coordinate coordinates location locations position positions"),
        ),
        unless=stems("after cloth deformed evaluated group modifier modifiers node nodes shader simulation"),
    ),
    Advice(
        _LIMITED,
        wherever=(
            stems("socket sockets"),
            stems("limit limits max maximum min minimum range"),
        ),
        unless=stems("group interface panel property"),
    ),
    Advice(
        _STALE,
        of("Object.matrix_world", "ViewLayer.update"),
        asked=stems(
            "after changing identity immediately not old outdated setting stale update updated wrong zero"
        ),
    ),
    Advice(
        _CONVERTED,
        wherever=(stems("curve curves metaball surface text"), stems("mesh"), stems("convert turn")),
        unless=_NODES,
    ),
    Advice(
        _NORMAL,
        wherever=(stems("face normal polygon"), stems("normal normals"), stems("global world")),
        unless=_NODES,
    ),
    Advice(
        _OWN,
        wherever=(
            stems("add assign create define keep save set store"),
            stems("custom own"),
            stems("data properties property values variable"),
        ),
        unless=stems(
            "animate attribute bone callback class collection description driver edit enum export getter group handler "
            "icon keyframe keying layer limit list max menu mesh min node normal normals operator panel precision "
            "range setter slider soft step structure subtype template test tooltip types ui unit update"
        ),
    ),
    Advice(
        _ORIGIN,
        wherever=(
            stems("origin"),
            stems("center centre change move set"),
            stems("geometry mesh object objects"),
        ),
        unless=stems("applied bone collection instance modifiers node pivot text tracking uv world"),
    ),
)
