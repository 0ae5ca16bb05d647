"""Python's own messages that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import COLLECTION
from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_GET = f"{T}bpy_prop_collection.get"
_FROM_WHERE = (
    "`.get(name)` of a collection finds nothing of that name, a pointer was not set (`obj.active_material`, "
    "`scene.camera`), or a function ended without `return`."
)
PLAIN_FUNCTION = (
    "`notify` must be a plain function (`def` or `lambda`): a method, a `functools.partial`, a class or another object "
    "that can be called raises `TypeError: notify expects a function`. Wrap those: "
    "`notify=lambda *args: self.changed(*args)`."
)
_OF_OPERATORS = (
    "Operators return a set, {'FINISHED'}, and not what they make. That is the active object then: "
    "`bpy.ops.mesh.primitive_cube_add()`, and in the next line `cube = bpy.context.object`."
)
_WHOLE = (
    "An index is a whole number; coordinates and what `/` gives are floats: `int(value)`, `round(value)`, "
    "`count // 2`."
)
_REPEATED = (
    "`*` repeats a tuple, list or text, and takes a whole number for that: `count // 2`, `int(value)`. To multiply the "
    "numbers in it, make it a vector: `Vector(value) * 0.5`."
)
_VALUE_CALLED = (
    "What stands before `()` is a value, not a function: a property is read without `()`. Nor is a name of Python's a "
    'function any more once the script has used it for a variable (`max = 3`, `str = "a"`).'
)
# The type of what is called → the class, or where scripts of Blender mostly have a value of Python's from.
_CALLED = {
    "bool": f"{T}Object.hide_render",
    "float": "mathutils.Vector.x",
    "int": f"{T}Scene.frame_current",
    "list": "bpy.context.selected_objects",
    "str": f"{T}ID.name",
    "tuple": f"{T}Object.users_collection",
    "Vector": "mathutils.Vector",
    "Matrix": "mathutils.Matrix",
    "Euler": "mathutils.Euler",
    "bpy_prop_array": f"{T}bpy_prop_array",
}
_PARTS = (
    "a location has three numbers (`x, y, z = obj.location`), a colour four, `vector.xy` two; `scene.ray_cast(…)` "
    "gives six values, `obj.ray_cast(…)` and `obj.closest_point_on_mesh(…)` four."
)
PYTHON = (
    NamelessMessage(
        ("type str doesn't define __round__ method",),
        (f"{T}NodeSocketMenu.default_value",),
        "The value is a text, as that of a menu's socket is: ask `isinstance(value, str)`, or `socket.type == 'MENU'`, "
        "before.",
    ),
    NamelessMessage(
        ("bpy_prop_collection.__contains__: expected a string",),
        (f"{T}bpy_prop_collection.get", f"{T}bpy_prop_collection.values"),
        "`in` asks a collection for names: `thing.name in collection`, or `thing in collection.values()`.",
    ),
    NamelessMessage(
        ("'float' object cannot be interpreted as an integer",),
        (f"{T}Action.frame_range", f"{T}Scene.frame_set"),
        "`range()` and indices take whole numbers: `int(value)`, `count // 2`. Frames of an action are floats: "
        "`range(int(action.frame_range[0]), int(action.frame_range[1]) + 1)`.",
    ),
    NamelessMessage(
        ("missing 1 required positional argument: 'depsgraph'",),
        ("bpy.app.handlers", f"{T}Context.evaluated_depsgraph_get"),
        "Some handlers are called with the scene alone: `def handler(scene, depsgraph=None):`, and in it "
        "`depsgraph = depsgraph or bpy.context.evaluated_depsgraph_get()`.",
    ),
    NamelessMessage(
        ("too many values to unpack (expected ",),
        ("mathutils.Vector", "mathutils.Quaternion"),
        f"The right side has more parts than there are names: {_PARTS}",
    ),
    NamelessMessage(
        ("not enough values to unpack (expected ",),
        ("mathutils.Vector", "mathutils.Quaternion"),
        f"The right side has fewer parts than there are names: {_PARTS}",
    ),
    NamelessMessage(
        ("'bpy_prop_collection' object is not callable",),
        (COLLECTION, f"{T}bpy_prop_collection.get"),
        'A collection is no function: `bpy.data.objects["Cube"]` takes one of its elements, '
        "`for ob in bpy.data.objects:` all.",
    ),
    NamelessMessage(
        ("bpy_prop_collection[key] = value: invalid, expected a 'MaterialSlot'",),
        (f"{T}MaterialSlot.material", f"{T}Mesh.materials"),
        "A slot is not a material, but holds one: `obj.material_slots[0].material = material`. The materials of a "
        "mesh are themselves assigned: `mesh.materials[0] = material`.",
    ),
    NamelessMessage(
        ("expected a string enum in ('INVOKE_DEFAULT'",),
        ("bpy.ops",),
        "By place an operator takes only how it is run and whether it makes an undo step; all else is given by name: "
        "`bpy.ops.object.select_all(action='SELECT')`.",
    ),
    NamelessMessage(
        (" doesn't support None from string types",),
        ("bpy.props.StringProperty",),
        "A text takes no None: give an empty one, `''`.",
    ),
    *(
        NamelessMessage((part,), (f"{T}Context.object", f"{T}Context.active_object"), _OF_OPERATORS)
        for part in ("'set' object has no attribute '", "'set' object is not subscriptable")
    ),
    NamelessMessage(
        ("write() argument 2 must be set, not ",),
        (f"{T}BlendDataLibraries.write",),
        "The data-blocks are given as a set: `bpy.data.libraries.write(path, {obj, material})`, or `set(objects)` of a "
        "list.",
    ),
    NamelessMessage(
        ("__init__() takes 1 positional argument but ",),
        (f"{T}Operator", f"{T}Panel"),
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
        ("notify expects a function, found ",),
        ("bpy.msgbus.subscribe_rna",),
        PLAIN_FUNCTION,
    ),
    NamelessMessage(
        ("function is not registered",),
        ("bpy.app.timers.unregister", "bpy.app.timers.is_registered", "bpy.app.timers.register"),
        "This very function runs in no timer (a second `lambda` or method is another one), or it has returned None, "
        "which ends it: `if bpy.app.timers.is_registered(f): bpy.app.timers.unregister(f)`.",
    ),
    NamelessMessage(
        ("del bpy_prop_collection[key]: not supported",),
        ("bpy.props.CollectionProperty", f"{COLLECTION}_idprop.remove", COLLECTION),
        "Collections have `remove()` instead: one of a `CollectionProperty` takes the index, "
        '`items.remove(items.find("name"))`, those of Blender the thing itself, '
        '`bpy.data.objects.remove(bpy.data.objects["name"])`.',
    ),
    NamelessMessage(
        ("Unknown unit system specified: ",),
        ("bpy.utils.units.to_value", "bpy.utils.units.to_string", "bpy.utils.units.systems"),
        "The unit system comes first, then the category: `to_value('METRIC', 'LENGTH', '3mm')`. Systems are 'NONE', "
        "'METRIC' and 'IMPERIAL'.",
    ),
    NamelessMessage(
        ("Unknown unit category specified: ",),
        ("bpy.utils.units.categories", "bpy.utils.units.to_value", "bpy.utils.units.to_string"),
        "The category comes second, behind the unit system: `to_value('METRIC', 'LENGTH', '3mm')`. The names of "
        "`bpy.utils.units.categories` are all that there are.",
    ),
    NamelessMessage(
        ('bpy_struct[key]: key "Input_',),
        (f"{T}NodesModifier", f"{T}NodeTreeInterfaceSocket.identifier"),
        "Since 4.0 the inputs of a group are called `Socket_2` and so on, not `Input_2`: `item.identifier` of its "
        "`interface.items_tree` tells it.",
    ),
    NamelessMessage(
        ("'builtin_function_or_method' object is not subscriptable",),
        (f"{T}bpy_struct.items", f"{T}NodeTreeInterface.items_tree"),
        "What stands before the bracket is a function (`items`, `keys`, `get`): call it, or take the collection that "
        "is meant, as `interface.items_tree`.",
    ),
    NamelessMessage(
        ('bpy_struct[key]: key "Socket_',),
        (f"{T}NodesModifier", f"{T}NodeTreeInterfaceSocket.identifier"),
        "The group has no input of that identifier: `item.identifier` of its `interface.items_tree` tells it.",
    ),
    NamelessMessage(
        ("slice indices must be integers or None or have an __index__ method",),
        (COLLECTION,),
        "A collection of Blender's takes no step: `vertices[::2]` fails, `vertices[:][::2]` slices the list that `[:]` "
        "makes.",
    ),
    NamelessMessage(
        ("bpy_prop_collection[key]: invalid key, must be",),
        (COLLECTION, f"{T}bpy_prop_collection.get"),
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
    NamelessMessage(
        ("IndexError: list index out of range",),
        ("bpy.context.selected_objects",),
        "A list of Python's is shorter than that: `bpy.context.selected_objects` is empty where nothing is selected, "
        "and what a comprehension finds may be nothing. Test it (`if found:`), or `next(iter(found), None)`.",
    ),
    NamelessMessage(
        ("TypeError: function is not callable",),
        ("bpy.app.timers.register",),
        "Give the function itself, `bpy.app.timers.register(step)`, not what a call of it returns (`step()`).",
    ),
    NamelessMessage(
        ("Object of type ", " is not JSON serializable"),
        ("mathutils.Vector.to_tuple", f"{T}ID.name"),
        "JSON keeps numbers, texts, lists and dictionaries: `list(obj.location)`, `[list(row) for row in "
        "obj.matrix_world]`, and the name of a data-block, `obj.name`.",
    ),
    NamelessMessage(
        ("indices must be integers or slices, not float",),
        ("mathutils.Vector", COLLECTION),
        _WHOLE,
    ),
    NamelessMessage(
        ("can't multiply sequence by non-int of type 'float'",),
        ("mathutils.Vector",),
        _REPEATED,
    ),
    *(
        NamelessMessage((f"'{called}' object is not callable",), (path,), _VALUE_CALLED)
        for called, path in _CALLED.items()
    ),
    NamelessMessage(
        (" does not support string lookups",),
        (COLLECTION, f"{T}MeshVertices"),
        "The elements of this collection have no names: they are found by index, as `mesh.vertices[0]`.",
    ),
    NamelessMessage(
        ("'bpy_lib' object has no attribute",),
        (f"{T}BlendDataLibraries.load", f"{T}BlendData.objects"),
        "What `bpy.data.libraries.load()` gives has the names of the collections of `bpy.data`, in the plural: "
        "`data_from.objects`, `data_from.materials`, `data_from.node_groups`; each is a list of names.",
    ),
    NamelessMessage(
        ("' object attribute '", "' is read-only"),
        (COLLECTION, f"{T}bpy_struct"),
        "What is assigned is a function of the thing, not one of its properties: a property has another name.",
        without=("bpy_struct: attribute",),
    ),
    NamelessMessage(
        ("can only concatenate str (not ",),
        (f"{T}Text.write", COLLECTION),
        'A text is added to a text: `str(value)`, or `f"Objects: {len(bpy.data.objects)}"`.',
    ),
    NamelessMessage(
        ("cannot access local variable ",),
        ("bpy.context.object",),
        "No line of the function that was run has given the variable a value: an error before was passed over, or the "
        "branch that sets it was not taken. Set it before the branches, as `obj = None`.",
    ),
)
