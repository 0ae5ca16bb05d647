"""What Blender's messages that name nothing of the API are about, and what helps.

Each row was seen in Blender: a test makes it say them all.
"""

from __future__ import annotations

import re
from dataclasses import dataclass
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader
    from kb_serve.recognise.recognition import Recognition

_SURE = 0.97
_T = "bpy.types."
_O = "bpy.ops.object."
_GET = f"{_T}bpy_prop_collection.get"
_FROM_WHERE = (
    "`.get(name)` of a collection finds nothing of that name, a pointer was not set (`obj.active_material`, "
    "`scene.camera`), or a function ended without `return`."
)
_NO_FACTOR = (
    "A tuple or list is no factor: make it a vector first, `matrix @ Vector(value)`, `Vector(value) * 2`; two vectors "
    "are multiplied number by number: `Vector(value) * v`."
)
_NO_CUSTOM_PROPERTIES = (
    "Only data-blocks (objects, scenes, materials …), bones and their collections, nodes, strips, view layers, "
    "property groups, the metadata of assets and geometry-nodes modifiers take custom properties in brackets. "
    "Operators and the "
    'preferences of add-ons do not: their properties are attributes (`self.name`, `hasattr(self, "name")`, '
    "`setattr(self, name, value)`). Nor do other modifiers, constraints or sockets: store the value on their object or "
    "node."
)


@dataclass(frozen=True, slots=True)
class NamelessMessage:
    """The parts of a message that are always the same, the symbols and pages that it is about, most likely first, and
    what helps. A message with one of the parts ``without`` is another one.

    It is told only of a Blender that has the first of the symbols.
    """

    parts: tuple[str, ...]
    paths: tuple[str, ...]
    help: str
    without: tuple[str, ...] = ()

    def is_in(self, query: str) -> bool:
        """Whether a query holds the message."""
        return all(part in query for part in self.parts) and not any(part in query for part in self.without)


NAMELESS_MESSAGES = (
    # Objects, collections, view layers
    NamelessMessage(
        ("selected because it is not in View Layer",),
        (f"{_T}Object.select_set", f"{_T}CollectionObjects.link"),
        "The object is in no collection of the view layer: `scene.collection.objects.link(obj)` first.",
    ),
    NamelessMessage(
        ("ViewLayer '", "does not contain object '"),
        (f"{_T}LayerObjects.active", f"{_T}CollectionObjects.link"),
        "The object is in no collection of the view layer: `scene.collection.objects.link(obj)` first.",
    ),
    NamelessMessage(
        ("Object '", "already in collection '"),
        (f"{_T}CollectionObjects.link",),
        "Link it only where it is not yet: `if obj.name not in collection.objects:`. What operators add is linked.",
    ),
    NamelessMessage(
        ("Collection '", "already in collection '"),
        (f"{_T}CollectionChildren.link",),
        "Link it only where it is not yet: `if child.name not in collection.children:`.",
    ),
    NamelessMessage(
        ("Object '", "not in collection '"),
        (f"{_T}CollectionObjects.unlink", f"{_T}Object.users_collection"),
        "It is in others: `for collection in obj.users_collection: collection.objects.unlink(obj)`.",
    ),
    NamelessMessage(
        ("has no evaluated mesh data",),
        (f"{_T}Object.ray_cast", f"{_T}Object.closest_point_on_mesh", f"{_T}ID.evaluated_get"),
        "The object must be in the view layer and computed: link it, then `bpy.context.view_layer.update()`.",
    ),
    NamelessMessage(
        ("ID type '", "is not valid for an object"),
        (f"{_T}BlendDataObjects.new", f"{_T}ID.copy"),
        "The second argument is the data, not an object: `bpy.data.objects.new(name, obj.data)`. `obj.copy()` "
        "copies an object.",
    ),
    # Meshes
    NamelessMessage(
        ("Tangent space can only be computed for tris/quads",),
        (f"{_T}Mesh.calc_tangents", "bmesh.ops.triangulate"),
        "A face has more than four corners: triangulate such faces first (`bmesh.ops.triangulate`).",
    ),
    NamelessMessage(
        ("to_mesh(): Mesh '", "is in editmode"),
        ("bmesh.types.BMesh.to_mesh", "bmesh.from_edit_mesh", "bmesh.update_edit_mesh"),
        "Leave Edit Mode first (`bpy.ops.object.mode_set(mode='OBJECT')`), or change the mesh by "
        "`bmesh.from_edit_mesh(mesh)` and `bmesh.update_edit_mesh(mesh)`.",
    ),
    NamelessMessage(
        ("sequence length mismatch given",),
        (f"{_T}bpy_prop_collection.foreach_set", f"{_T}bpy_prop_collection.foreach_get"),
        "It wants as many numbers as elements × values of each (3 for `co`); of none, add elements first "
        "(`mesh.vertices.add(count)`).",
    ),
    NamelessMessage(
        ("internal error setting the array",),
        (f"{_T}bpy_prop_collection.foreach_set",),
        "The list is longer or shorter than elements × values of each (3 for `co`), or of another type.",
    ),
    NamelessMessage(
        ("Vertex not in group",),
        (f"{_T}VertexGroup.weight", f"{_T}MeshVertex.groups"),
        "Ask only for vertices that are in the group: `any(one.group == group.index for one in vertex.groups)`.",
    ),
    NamelessMessage(
        ("Curve sizes must be greater than zero",),
        (f"{_T}Curves.add_curves",),
        "Each size is the number of points in a curve, 1 or more: `curves.add_curves([3, 5])`.",
    ),
    NamelessMessage(
        ("expected 'Mesh' type found 'Object' instead",),
        ("bmesh.types.BMesh.from_mesh", "bmesh.types.BMesh.to_mesh", "bmesh.from_edit_mesh"),
        "Give the data of the object: `bm.from_mesh(obj.data)`, `bm.to_mesh(obj.data)`.",
    ),
    NamelessMessage(
        ("BMElemSeq[index]: index ", " out of range"),
        ("bmesh.types.BMVertSeq", "bmesh.types.BMVertSeq.new"),
        "There are fewer elements, `len(bm.verts)`, and they are counted from 0.",
    ),
    NamelessMessage(
        ("Key ", " is out of range"),
        (f"{_T}GreasePencilDrawing.strokes", f"{_T}GreasePencilDrawing.add_strokes"),
        "There are fewer strokes, or points in a stroke: `drawing.add_strokes([3])` adds a stroke of three points.",
    ),
    NamelessMessage(
        ("spline cannot have points added",),
        (f"{_T}SplinePoints.add", f"{_T}SplineBezierPoints.add"),
        "The points of a Bézier spline are its `bezier_points`: `spline.bezier_points.add(count)`.",
    ),
    NamelessMessage(
        ("not in edit mode, cannot add an editbone",),
        (f"{_T}ArmatureEditBones.new", f"{_O}mode_set"),
        "Edit bones are there in Edit Mode: make the armature's object active, then "
        "`bpy.ops.object.mode_set(mode='EDIT')`.",
    ),
    # Modifiers, transforms
    NamelessMessage(
        ("Modifier cannot be applied to a mesh with shape keys",),
        (f"{_O}modifier_apply", f"{_T}Object.shape_key_clear"),
        "Remove the shape keys first (`obj.shape_key_clear()`), or make a mesh of the result: "
        "`bpy.data.meshes.new_from_object(obj.evaluated_get(depsgraph))`.",
    ),
    NamelessMessage(
        ("Modifier is disabled, skipping apply",),
        (f"{_O}modifier_apply", f"{_T}Modifier.show_viewport"),
        "The modifier lacks what it works with (a Boolean without an object), or is not shown: "
        "`modifier.show_viewport = True`.",
    ),
    NamelessMessage(
        ("Modifiers cannot be applied to multi-user data",),
        (f"{_O}modifier_apply",),
        "Give the object data of its own first: `obj.data = obj.data.copy()`.",
    ),
    NamelessMessage(
        ("Cannot apply to a multi user",),
        (f"{_O}transform_apply",),
        "Give the object data of its own first: `obj.data = obj.data.copy()`.",
    ),
    NamelessMessage(
        ("value to the existing 'Socket_", "IDProperty"),
        (f"{_T}NodesModifier",),
        "An input of a geometry nodes modifier keeps its type: give a value of that type.",
    ),
    # Properties in brackets
    NamelessMessage(
        ("value to the existing '", "Group IDProperty"),
        ("bpy.props.PointerProperty", f"{_T}PropertyGroup", f"{_T}ID.bl_system_properties_get"),
        "The group of a `PointerProperty` cannot be put in another one's place: set its members as attributes "
        "(`target.settings.size = source.settings.size`), or copy all that were set: "
        '`target.bl_system_properties_get()["settings"].update(source.bl_system_properties_get()["settings"])`. '
        "Custom properties of your own do take another type.",
    ),
    NamelessMessage(
        ("value to the existing '", "IDProperty"),
        (f"{_T}ID.bl_system_properties_get", "bpy.props"),
        "What is stored of a property that `bpy.props` registered keeps its type: give a value of that type, best by "
        "the attribute (`scene.count = 3`). Custom properties of your own do take another type.",
        ("Group IDProperty", "existing 'Socket_"),
    ),
    NamelessMessage(
        ("id properties not supported",),
        (f"{_T}bpy_struct.keys", f"{_T}PropertyGroup"),
        _NO_CUSTOM_PROPERTIES,
    ),
    NamelessMessage(
        ("his type doesn't support IDProperties",),
        (f"{_T}bpy_struct.keys", f"{_T}PropertyGroup"),
        _NO_CUSTOM_PROPERTIES,
    ),
    NamelessMessage(
        ("'_PropertyDeferred' object is not subscriptable",),
        ("bpy.props._PropertyDeferred",),
        "What `bpy.props` returns is no tuple since Blender 2.93: `deferred.function` instead of `deferred[0]`, and "
        "`deferred.keywords`, a dictionary, instead of `deferred[1]`.",
    ),
    # Python
    NamelessMessage(
        ("__init__() takes 1 positional argument but ",),
        (f"{_T}Operator", f"{_T}Panel"),
        "Blender gives arguments to the `__init__` of classes that derive from its own (operators, panels, property "
        "groups …): take them and hand them on: `def __init__(self, *args, **kwargs):`, and first in it "
        "`super().__init__(*args, **kwargs)`.",
    ),
    NamelessMessage(
        ("cannot create '", "GPUShader' instances"),
        ("gpu.shader.create_from_info", "gpu.types.GPUShaderCreateInfo", "gpu.shader.from_builtin"),
        "Shaders of one's own are described, not made by calling the class: fill a `gpu.types.GPUShaderCreateInfo()` "
        "(`vertex_in`, `push_constant`, `fragment_out`, `vertex_source`, `fragment_source`), then "
        "`gpu.shader.create_from_info(info)`.",
    ),
    NamelessMessage(
        ('bpy_struct[key]: key "Input_',),
        (f"{_T}NodesModifier", f"{_T}NodeTreeInterfaceSocket.identifier"),
        "Since 4.0 the inputs of a group are called `Socket_2` and so on, not `Input_2`: `item.identifier` of its "
        "`interface.items_tree` tells it.",
    ),
    NamelessMessage(
        ("'builtin_function_or_method' object is not subscriptable",),
        (f"{_T}bpy_struct.items", f"{_T}NodeTreeInterface.items_tree"),
        "What stands before the bracket is a function (`items`, `keys`, `get`): call it, or take the collection that "
        "is meant, as `interface.items_tree`.",
    ),
    NamelessMessage(
        ('bpy_struct[key]: key "Socket_',),
        (f"{_T}NodesModifier", f"{_T}NodeTreeInterfaceSocket.identifier"),
        "The group has no input of that identifier: `item.identifier` of its `interface.items_tree` tells it.",
    ),
    NamelessMessage(
        ("bpy_prop_collection[key]: invalid key, must be",),
        (f"{_T}bpy_prop_collection", f"{_T}bpy_prop_collection.get"),
        "A collection is asked for a name or a whole number: `collection[thing.name]`, `collection[int(number)]`.",
    ),
    NamelessMessage(
        ("'NoneType' object is not subscriptable",),
        (_GET,),
        f"What stands before the bracket is None. {_FROM_WHERE}",
    ),
    NamelessMessage(
        ("'NoneType' object is not iterable",),
        (_GET,),
        f"What the loop, or the function, goes through is None. {_FROM_WHERE}",
    ),
    NamelessMessage(
        ("of type 'NoneType'",),
        (_GET,),
        f"What is counted or searched is None. {_FROM_WHERE}",
    ),
    NamelessMessage(
        ("unsupported operand type(s) for", "'NoneType'"),
        (_GET,),
        f"One of the two values is None. {_FROM_WHERE}",
    ),
    # Vectors
    NamelessMessage(
        ("Vector ", "vectors must have the same dimensions for this operation"),
        ("mathutils.Vector.to_3d", "mathutils.Vector.to_2d", "mathutils.Vector.resized"),
        "One vector has more numbers than the other: `v.to_3d()` adds what lacks, `v.to_2d()` drops what is too much.",
    ),
    NamelessMessage(
        ("Vector ", "invalid type for this operation"),
        ("mathutils.Vector",),
        "Vectors are added to vectors: `v + Vector(value)`, with a value of as many numbers; `Vector((n, n, n))` for "
        "one number.",
    ),
    NamelessMessage(
        ("multiplication: not supported between ", "'tuple'"),
        ("mathutils.Vector", "mathutils.Matrix"),
        _NO_FACTOR,
    ),
    NamelessMessage(
        ("multiplication: not supported between ", "'list'"),
        ("mathutils.Vector", "mathutils.Matrix"),
        _NO_FACTOR,
    ),
    # Nodes
    NamelessMessage(
        ("Cannot add socket to built-in node",),
        (f"{_T}NodeTreeInterface.new_socket",),
        "Sockets of a group's input and output come from its interface: "
        "`tree.interface.new_socket(\"Name\", in_out='INPUT', socket_type='NodeSocketFloat')`.",
    ),
    NamelessMessage(
        ("Same input/output direction of sockets",),
        (f"{_T}NodeLinks.new",),
        "A link goes from an output to an input: `tree.links.new(one.outputs[0], other.inputs[0])`.",
    ),
    # Animation
    NamelessMessage(
        ("the track does not have any space to accommodate this new strip",),
        (f"{_T}NlaStrips.new", f"{_T}NlaTracks.new"),
        "The track has a strip in these frames: give another `start`, or add it to a new track "
        "(`animation_data.nla_tracks.new()`).",
    ),
    NamelessMessage(
        ("keyframe_insert() property", "not found"),
        (f"{_T}bpy_struct.keyframe_insert",),
        'The path is a property of the very thing, as text: `obj.keyframe_insert("location")`; what belongs to its '
        "data is keyed there (`obj.data.keyframe_insert(…)`).",
    ),
    NamelessMessage(
        ('Assign action "', "before calling this function"),
        (f"{_T}Action.fcurve_ensure_for_datablock", f"{_T}AnimData.action"),
        "The object must have the action: `obj.animation_data_create().action = action`.",
    ),
    NamelessMessage(
        ("keyframe_insert() path includes index",),
        (f"{_T}bpy_struct.keyframe_insert",),
        'One number of several is keyed by its index: `obj.keyframe_insert("location", index=0)`.',
    ),
    NamelessMessage(
        ("keyframe_insert()() takes at most 1 positional argument",),
        (f"{_T}bpy_struct.keyframe_insert",),
        'All but the path is given by name: `obj.keyframe_insert("location", frame=10)`.',
    ),
    NamelessMessage(
        ("driver_add(): property", "not found"),
        (f"{_T}bpy_struct.driver_add",),
        'The path is a property of the very thing, as text: `obj.driver_add("location", 0)`; what belongs to its '
        "data is driven there (`obj.data.driver_add(…)`).",
    ),
    NamelessMessage(
        ("Dependency cycle detected",),
        (
            f"{_T}Object.constraints",
            "animation/drivers/troubleshooting",
            f"{_T}Object.parent",
            f"{_T}AnimData.drivers",
        ),
        "Each of the things in the lines below it waits for the next, and the last for the first. The lines name what "
        "links them ('Parent', a constraint, a driver): take one of these links away, or let it read something that "
        "does not depend on what it moves.",
    ),
    # Rendering, baking
    NamelessMessage(
        ("Cannot render, no camera",),
        (f"{_T}Scene.camera", f"{_T}BlendDataCameras.new"),
        "`scene.camera = obj`, an object with a camera as data.",
    ),
    NamelessMessage(
        ("Cannot write a single file with an animation format selected",),
        (
            "bpy.ops.render.render",
            f"{_T}ImageFormatSettings.media_type",
            f"{_T}ImageFormatSettings.file_format",
        ),
        "A video is rendered by `bpy.ops.render.render(animation=True)`. For one image choose a format of images: "
        "`settings = scene.render.image_settings`, `settings.media_type = 'IMAGE'` (since 5.0), "
        "`settings.file_format = 'PNG'`.",
    ),
    NamelessMessage(
        ("Current render engine does not support baking",),
        (f"{_O}bake", f"{_T}RenderSettings.engine"),
        "Cycles does: `scene.render.engine = 'CYCLES'`.",
    ),
    NamelessMessage(
        ("No active ", "image ", "found in material "),
        (f"{_O}bake", f"{_T}Nodes.active"),
        "A bake writes into the image of each material's active node: add one (`nodes.new('ShaderNodeTexImage')`), "
        "give it an image, and make it active: `nodes.active = node`.",
    ),
    NamelessMessage(
        ("No active image found, add a material",),
        (f"{_O}bake", f"{_T}Nodes.active"),
        "The object has no material with an image to bake into: give it one whose active node is an image texture, or "
        "bake with `target='VERTEX_COLORS'` or `save_mode='EXTERNAL'`.",
    ),
    NamelessMessage(
        ("No valid selected objects",),
        (f"{_O}bake", f"{_T}Object.select_set"),
        "Select the objects first (`obj.select_set(True)`), and make one active.",
    ),
    NamelessMessage(
        ("Bake failed: no Fluid modifier found",),
        ("bpy.ops.fluid.bake_all",),
        "The active object must be the fluid's domain: `view_layer.objects.active = domain`.",
    ),
    NamelessMessage(
        ("Bake failed: invalid domain",),
        ("bpy.ops.fluid.bake_all", f"{_T}FluidModifier.fluid_type"),
        "The active object must be the fluid's domain, of `fluid_type = 'DOMAIN'`.",
    ),
    # Registration
    NamelessMessage(
        ("register_class(...): already registered as a subclass",),
        ("bpy.utils.unregister_class", "bpy.utils.register_class"),
        "This very class is registered: `bpy.utils.unregister_class(cls)` first, as an add-on's `unregister()` does.",
    ),
    NamelessMessage(
        ("Error: register_class(...):, missing bl_rna attribute from '",),
        ("bpy.utils.register_class",),
        "Only classes that derive from one of `bpy.types` (Operator, Panel, Menu, PropertyGroup …) can be registered.",
    ),
    NamelessMessage(
        ("unregister_class(...):, missing bl_rna attribute from '",),
        ("bpy.utils.unregister_class", "bpy.utils.register_class"),
        "The class is not registered: it never was, its registration failed, or it was unregistered before.",
    ),
    NamelessMessage(
        ("contain '_PT_' with prefix",),
        (f"{_T}Panel.bl_idname",),
        "The `bl_idname` of a panel, or its class's name where it has none, is like `MY_PT_panel`: capitals, `_PT_`, "
        "a name.",
    ),
    NamelessMessage(
        ("Registering panel class: '", "' has category '"),
        (f"{_T}Panel.bl_region_type", f"{_T}Panel.bl_category"),
        "Only panels of a sidebar have a category, the tab that they stand in: `bl_region_type = 'UI'`. Panels of "
        "other regions have no `bl_category`.",
    ),
    NamelessMessage(
        ("contain '_MT_' with prefix",),
        (f"{_T}Menu.bl_idname",),
        "The `bl_idname` of a menu, or its class's name where it has none, is like `MY_MT_menu`: capitals, `_MT_`, a "
        "name.",
    ),
    NamelessMessage(
        ("Registering operator class '", "invalid bl_idname '"),
        (f"{_T}Operator.bl_idname",),
        "An operator's `bl_idname` is two names with one dot between, in small letters: "
        '`bl_idname = "object.my_tool"`.',
    ),
    NamelessMessage(
        ("Function.result expected a set, not a NoneType",),
        (f"{_T}Operator.execute",),
        "The function ended without a result: `return {'FINISHED'}`, or `{'CANCELLED'}`, at each of its ends.",
    ),
    NamelessMessage(
        ("'_RestrictContext' object has no attribute",),
        ("bpy.app.timers.register", "bpy.app.handlers.load_post"),
        "While add-ons are registered, `bpy.context` holds no scene and no objects: read them in an operator's or "
        "panel's functions, in a `load_post` handler, or soon after: `bpy.app.timers.register(function)`.",
    ),
    NamelessMessage(
        ("'_RestrictData' object has no attribute",),
        ("bpy.app.timers.register", "bpy.app.handlers.load_post"),
        "While add-ons are registered, `bpy.data` holds nothing: read it in an operator's or panel's functions, in a "
        "`load_post` handler, or soon after: `bpy.app.timers.register(function)`.",
    ),
    # Files
    NamelessMessage(
        ("Cannot read '", "No such file or directory"),
        (f"{_T}BlendDataImages.load", "bpy.path.abspath"),
        "There is no such file where Blender looks: `//` begins a path beside the saved .blend; any other relative "
        "path begins where Blender was started.",
    ),
    NamelessMessage(
        ("Image '", "could not be saved to ''"),
        (f"{_T}Image.save", f"{_T}Image.filepath_raw", f"{_T}Image.file_format"),
        "The image has no path: `image.filepath_raw = \"/folder/name.png\"`, `image.file_format = 'PNG'`, then "
        "`image.save()`.",
    ),
    NamelessMessage(
        ("No such file or directory: '//",),
        ("bpy.path.abspath",),
        "Only Blender knows where a path that begins with `//` leads: `open(bpy.path.abspath(path))`.",
    ),
    NamelessMessage(
        ("failed to open blend file",),
        (f"{_T}BlendDataLibraries.load", "bpy.path.abspath"),
        "There is no such .blend where Blender looks: `//` begins a path beside the saved one.",
    ),
    NamelessMessage(
        ("Cannot open file", "for writing: No such file or directory"),
        ("bpy.ops.wm.save_as_mainfile",),
        "The folder does not exist: make it first (`os.makedirs(folder, exist_ok=True)`).",
    ),
    NamelessMessage(
        ('Cannot read file "', "No such file or directory"),
        ("bpy.ops.wm.open_mainfile",),
        "There is no such .blend where Blender looks: a relative path begins where Blender was started.",
    ),
    NamelessMessage(
        ("Unable to save an unsaved file",),
        ("bpy.ops.wm.save_as_mainfile", "bpy.ops.wm.save_mainfile"),
        'A file that was never saved has no path: `bpy.ops.wm.save_as_mainfile(filepath="/folder/name.blend")`.',
    ),
    NamelessMessage(
        ("Please select a file",),
        ("bpy.ops.import_scene.gltf",),
        "There is no file of that path.",
    ),
    NamelessMessage(
        ("OBJ Import: Cannot open file",),
        ("bpy.ops.wm.obj_import",),
        "There is no such file where Blender looks.",
    ),
    NamelessMessage(
        ("Add-on not loaded:", "No module named"),
        ("bpy.ops.preferences.addon_enable", "bpy.utils.refresh_script_paths"),
        "The add-on is not installed under that name; extensions are called `bl_ext.repository.name`.",
    ),
    # Values
    NamelessMessage(
        ("Converting py args to operator properties", "not found in ('OBJECT', 'EDIT'"),
        (f"{_O}mode_set", f"{_T}Object.mode"),
        "The active object has no such mode: its type decides which there are ('POSE' wants an armature). Make the "
        "object that is meant active first.",
    ),
)
_ANYWHERE = (
    (
        " not found in ()",
        "The enumeration has no values at present: they come from other data, such as the Menu Switch that a menu is "
        "linked to.",
    ),
    (
        "expected a set, not a str",
        "An enumeration of flags takes a set of texts: `{'A'}`, `{'A', 'B'}`.",
    ),
    (
        "sequences of dimension 0 should contain",
        "The value has another number of items than the property: a colour with alpha has 4, one without 3.",
    ),
)


_ONE_OF_SEVERAL = re.compile(r"item\.attr = val:\s*$")
_NOT_ONE = (
    "One value was given where several are wanted: a vector `(x, y, z)`, a colour `(r, g, b, a)`, as many as the "
    "property has."
)


def recognise_nameless(query: str, reader: BaseReader, recognition: Recognition) -> None:
    """Adds what a message that names no symbol is about, with what helps."""
    for message in NAMELESS_MESSAGES:
        if message.is_in(query) and reader.entry(message.paths[0]):
            for rank, path in enumerate(message.paths):
                if "/" not in path or reader.is_page(path):
                    recognition.add(path, _SURE - 0.03 * rank, "error message")
            recognition.notes.append(message.help)
    recognition.notes += [note for part, note in _ANYWHERE if part in query]
    if _ONE_OF_SEVERAL.search(query):
        recognition.notes.append(_NOT_ONE)
        recognition.add("bpy.props.FloatVectorProperty", _SURE, "error message")
