"""Messages of registration that name nothing of the API."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T
from kb_serve.recognise.messages.nameless.message import NamelessMessage

_OF_PROPERTIES = (
    "Functions of a property get arguments: `update` and `items` `(self, context)`, `get` `(self)`, `set` "
    "`(self, value)`."
)
REGISTRATION = (
    NamelessMessage(
        (" keyword: expected a function taking ",),
        ("bpy.props.FloatProperty", "bpy.props.EnumProperty"),
        _OF_PROPERTIES,
    ),
    NamelessMessage(
        ("EnumProperty(...): expected 'items' function to take ",),
        ("bpy.props.EnumProperty",),
        _OF_PROPERTIES,
    ),
    NamelessMessage(
        (' class "', '" function to have ', " args, found "),
        (f"{T}Operator.execute", f"{T}Panel.draw"),
        "`self` is counted: `def execute(self, context):`, and so `draw`; `def invoke(self, context, event):`, and so "
        "`modal`; `@classmethod` above `def poll(cls, context):`.",
    ),
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
        (f"{T}Panel.bl_idname",),
        "The `bl_idname` of a panel, or its class's name where it has none, is like `MY_PT_panel`: capitals, `_PT_`, "
        "a name.",
    ),
    NamelessMessage(
        (" have upper case alpha", "numeric prefix"),
        (f"{T}Panel.bl_idname", f"{T}Menu.bl_idname", f"{T}UIList.bl_idname"),
        "The `bl_idname`, or the class's name where it has none, begins with capitals: `MY_PT_panel`, `MY_MT_menu`, "
        "`MY_UL_list`. It is a warning: the class is registered all the same.",
    ),
    NamelessMessage(
        ("Registering panel class: '", "' has category '"),
        (f"{T}Panel.bl_region_type", f"{T}Panel.bl_category"),
        "Only panels of a sidebar have a category, the tab that they stand in: `bl_region_type = 'UI'`. Panels of "
        "other regions have no `bl_category`.",
    ),
    NamelessMessage(
        ("contain '_MT_' with prefix",),
        (f"{T}Menu.bl_idname",),
        "The `bl_idname` of a menu, or its class's name where it has none, is like `MY_MT_menu`: capitals, `_MT_`, a "
        "name.",
    ),
    NamelessMessage(
        ("contain '_UL_' with prefix",),
        (f"{T}UIList.bl_idname",),
        "The `bl_idname` of a list, or its class's name where it has none, is like `MY_UL_list`: capitals, `_UL_`, a "
        "name.",
    ),
    NamelessMessage(
        ("contain '_HT_' with prefix",),
        (f"{T}Header.bl_idname",),
        "The `bl_idname` of a header, or its class's name where it has none, is like `MY_HT_header`: capitals, `_HT_`, "
        "a name.",
    ),
    NamelessMessage(
        ("validating class: ", " expected a string type, not "),
        (f"{T}Operator.bl_idname", f"{T}Panel.bl_idname"),
        'It is a text that stands in the class, as `bl_idname = "object.my_tool"`: no method, no property, and no '
        "other "
        "value.",
    ),
    NamelessMessage(
        ("EnumProperty(", "when 'items' is a function"),
        ("bpy.props.EnumProperty",),
        "The texts of `items` are known only when the function is called: give the number of an item as `default`, or "
        "leave it out.",
    ),
    NamelessMessage(
        ("EnumProperty(", "not found in enum members"),
        ("bpy.props.EnumProperty",),
        "`default` is the identifier of one of `items`, the first text of its tuple; with `'ENUM_FLAG'` a set of them.",
    ),
    NamelessMessage(
        ("Registering operator class", "invalid bl_idname '"),
        (f"{T}Operator.bl_idname",),
        "An operator's `bl_idname` is two names with one dot between, of small letters, digits and `_`, at most 60 "
        'characters: `bl_idname = "object.my_tool"`.',
    ),
    NamelessMessage(
        ("CollectionProperty(...) expected an RNA type derived from ID Property Group",),
        ("bpy.props.CollectionProperty", f"{T}PropertyGroup", "bpy.props.PointerProperty"),
        "`type` of a CollectionProperty is a class of one's own, `class Item(bpy.types.PropertyGroup)`, registered "
        "before. To hold objects or other data-blocks, give it a pointer: "
        "`ob: bpy.props.PointerProperty(type=bpy.types.Object)`.",
    ),
    NamelessMessage(
        ("PointerProperty(...) expected an RNA type derived from ID or ID Property Group",),
        ("bpy.props.PointerProperty", f"{T}PropertyGroup", f"{T}ID"),
        "`type` of a PointerProperty is a kind of data-block (`bpy.types.Object`, `bpy.types.Material` …), or a class "
        "of one's own, `class Settings(bpy.types.PropertyGroup)`, registered before. Nothing else can be pointed at: "
        "keep its name or index.",
    ),
    NamelessMessage(
        ("Property(...)", "expected an RNA type, failed with: "),
        ("bpy.utils.register_class", "bpy.props.PointerProperty", "bpy.props.CollectionProperty"),
        "The class in `type` is not registered yet: `bpy.utils.register_class(Settings)` comes first, then the "
        "property and the classes that hold it.",
    ),
    NamelessMessage(
        ("Function.result expected a set, not a NoneType",),
        (f"{T}Operator.execute",),
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
    NamelessMessage(
        ("Region not found in space type",),
        (f"{T}Panel.bl_region_type", f"{T}Panel.bl_space_type"),
        "The editor of `bl_space_type` has no region of that `bl_region_type`: panels of the Properties editor are in "
        "'WINDOW', those of the sidebar of a viewport in 'UI'.",
    ),
    NamelessMessage(
        ("Online access required",),
        (f"{T}PreferencesSystem.use_online_access", "bpy.app.online_access"),
        "Extensions are fetched only where the user allows it: "
        "`bpy.context.preferences.system.use_online_access = True`, unless Blender was started with `--offline-mode`.",
    ),
)
