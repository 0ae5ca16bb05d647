"""Messages of properties in brackets that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import STRUCT
from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.chains.subscripts import PROPERTIES_OF_MODIFIER
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_TAKING = (
    "Only data-blocks (objects, scenes, materials …), bones and their collections, nodes, strips, view layers, "
    "property groups"
)
_OPERATORS = (
    "Operators and the "
    'preferences of add-ons do not: their properties are attributes (`self.name`, `hasattr(self, "name")`, '
    "`setattr(self, name, value)`)."
)
_ELSEWHERE = "constraints or sockets: store the value on their object or node."
_NO_CUSTOM_PROPERTIES = (
    f"{_TAKING}, the metadata of assets and geometry-nodes modifiers take custom properties in brackets. {_OPERATORS} "
    f"Nor do other modifiers, {_ELSEWHERE}"
)
_NOR_MODIFIERS = (
    f"{_TAKING} and the metadata of assets take custom properties in brackets. A geometry-nodes modifier does not: its "
    f"inputs are `modifier.properties.inputs.Socket_2.value`. {_OPERATORS} Nor do other modifiers, {_ELSEWHERE}"
)
_KEYS = (f"{T}bpy_struct.keys", f"{T}PropertyGroup")
_UNSUPPORTED = "id properties not supported", "his type doesn't support IDProperties"
_ONLY_DEFINED = (
    "A property that a class got by `size = bpy.props.IntProperty()` is only its definition. Write an annotation, "
    "`size: bpy.props.IntProperty()`, register the class, and read the value from an instance: `self.size` of an "
    "operator, `scene.settings.size` of a property group."
)
_KEPT = (f"{T}bpy_struct.id_properties_ensure", f"{T}bpy_struct.id_properties_ui")
_AS_TEXT = "Keep anything else as a text: `str(value)`, or `json.dumps(value)` and `json.loads(…)`."
CUSTOM_PROPERTIES = (
    NamelessMessage(
        ("the length of IDProperty names is limited to",),
        (f"{T}bpy_struct.keys", f"{T}bpy_struct.get"),
        "The name of a custom property has at most 63 bytes, in which a letter beyond ASCII takes two or more.",
    ),
    NamelessMessage(
        ("invalid id-property type ", " not supported"),
        _KEPT,
        "A custom property keeps a number, a text, bytes, a data-block, a list of numbers (no set), or a dictionary "
        f"whose keys are texts. {_AS_TEXT}",
    ),
    NamelessMessage(
        ("are allowed in ID property arrays",),
        _KEPT,
        f"A list of a custom property holds numbers, or dictionaries: no texts, no None. {_AS_TEXT}",
    ),
    NamelessMessage(
        ("invalid id-property key, expected a string",),
        _KEPT,
        "The keys of a dictionary that a custom property keeps are texts: `{str(key): value}`.",
    ),
    NamelessMessage(
        ("current value '", "' matches no enum in '"),
        ("bpy.props.EnumProperty",),
        "The number that is stored is none of the items any more, and the property reads as an empty text: the items "
        "changed, or a function gives other ones now. Give each item a number of its own that stays, the last of its "
        "tuple, and assign a valid item.",
    ),
    NamelessMessage(
        ("value to the existing '", "Group IDProperty"),
        ("bpy.props.PointerProperty", f"{T}PropertyGroup", f"{T}ID.bl_system_properties_get"),
        "The group of a `PointerProperty` cannot be put in another one's place: set its members as attributes "
        "(`target.settings.size = source.settings.size`), or copy all that were set: "
        '`target.bl_system_properties_get()["settings"].update(source.bl_system_properties_get()["settings"])`. '
        "Custom properties of your own do take another type.",
    ),
    NamelessMessage(
        ("value to the existing '", "IDProperty"),
        (f"{T}ID.bl_system_properties_get", "bpy.props"),
        "What is stored of a property that `bpy.props` registered keeps its type: give a value of that type, best by "
        "the attribute (`scene.count = 3`). Custom properties of your own do take another type.",
        ("Group IDProperty", "existing 'Socket_"),
    ),
    *(
        NamelessMessage((part,), _KEYS, _NO_CUSTOM_PROPERTIES, lacking=PROPERTIES_OF_MODIFIER)
        for part in _UNSUPPORTED
    ),
    *(NamelessMessage((part,), (PROPERTIES_OF_MODIFIER, *_KEYS), _NOR_MODIFIERS) for part in _UNSUPPORTED),
    NamelessMessage(
        ("'_PropertyDeferred' object is not subscriptable",),
        ("bpy.props._PropertyDeferred",),
        "What `bpy.props` returns is no tuple since Blender 2.93: `deferred.function` instead of `deferred[0]`, and "
        "`deferred.keywords`, a dictionary, instead of `deferred[1]`. " + _ONLY_DEFINED,
    ),
    NamelessMessage(
        ("_PropertyDeferred",),
        ("bpy.props", f"{T}PropertyGroup"),
        _ONLY_DEFINED,
        ("is not subscriptable",),
    ),
    NamelessMessage(
        ("property not found in group",),
        (f"{STRUCT}.pop", f"{STRUCT}.get"),
        'There is no such custom property: `ob.pop("x", None)` removes it if there is one, `if "x" in ob:` asks.',
    ),
    NamelessMessage(
        ("Property not found in IDProperty group",),
        (f"{STRUCT}.id_properties_ui",),
        'The custom property is made first, by assigning it: `ob["x"] = 1.0`, then `ob.id_properties_ui("x")`.',
    ),
)
