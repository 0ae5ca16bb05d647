"""Facts about Blender that its symbols do not tell, each as plain data. What a version lacks is passed over."""

from __future__ import annotations

from kb_build.symbols.api_names import TYPES as T

# What looks like modules and is tuples whose items have names, and what those have besides.
STRUCT_SEQUENCES = frozenset(
    {
        "bpy.app", "bpy.app.alembic", "bpy.app.build_options", "bpy.app.ffmpeg", "bpy.app.handlers", "bpy.app.ocio",
        "bpy.app.oiio", "bpy.app.opensubdiv", "bpy.app.openvdb", "bpy.app.sdl", "bpy.app.usd",
    }
)  # fmt: skip
OF_STRUCT_SEQUENCES = frozenset({"count", "index", "n_fields", "n_sequence_fields", "n_unnamed_fields"})
VERSION = "bpy.app.version"  # what tells it is read from this, or from what begins like it

# Operators that make an object and leave it as the active one: how their paths begin or are → the object's type.
_MAKERS = {
    "bpy.ops.mesh.primitive_": "MESH", "bpy.ops.curve.primitive_": "CURVE", "bpy.ops.surface.primitive_": "SURFACE",
    "bpy.ops.object.text_add": "FONT", "bpy.ops.object.armature_add": "ARMATURE", "bpy.ops.object.camera_add": "CAMERA",
    "bpy.ops.object.light_add": "LIGHT", "bpy.ops.object.metaball_add": "META", "bpy.ops.object.speaker_add": "SPEAKER",
    "bpy.ops.object.grease_pencil_add": "GREASEPENCIL", "bpy.ops.object.gpencil_add": "GPENCIL",
}  # fmt: skip
# Operators that leave the active object as it is: how their paths begin.
_LEAVING_IT = (
    "bpy.ops.object.shade_",
    "bpy.ops.object.transform_apply",
    "bpy.ops.object.origin_set",
    "bpy.ops.transform.",
)

# The add-ons that Blender brings, in any version from 4.2 on: what they register is in the base.
ADDONS = frozenset(
    {
        "bl_pkg", "copy_global_transform", "cycles", "hydra_storm", "io_anim_bvh", "io_curve_svg", "io_mesh_uv_layout",
        "io_scene_fbx", "io_scene_gltf2", "node_wrangler", "pose_library", "rigify", "ui_translate",
        "viewport_vr_preview",
    }
)  # fmt: skip

# Modules that Blender brings.
API_MODULES = frozenset({"bpy", "mathutils", "bmesh", "gpu", "gpu_extras", "bpy_extras", "blf", "aud", "freestyle",
                         "bl_math", "idprop", "imbuf", "addon_utils", "bl_keymap_utils", "nodeitems_utils",
                         "rna_keymap_ui", "rna_prop_ui"})  # fmt: skip
# Functions and classes of Python's library that give back what they are given, and the modules that have them.
PYTHON_NAMES = frozenset(
    {
        "random", "random.choice", "random.choices", "random.sample",
        "functools", "functools.partial",
        "itertools", "itertools.batched", "itertools.chain", "itertools.combinations", "itertools.cycle",
        "itertools.dropwhile", "itertools.filterfalse", "itertools.groupby", "itertools.islice", "itertools.pairwise",
        "itertools.permutations", "itertools.product", "itertools.takewhile", "itertools.tee",
        "collections", "collections.defaultdict", "collections.deque",
        "copy", "copy.copy",
    }
)  # fmt: skip
# Modules that Python has lost → the Blender that first brings such a Python, that Python, and what to use.
LOST_MODULES = {
    "binhex": ((4, 1), "3.11", "binascii"),
    "asynchat": ((5, 1), "3.12", "asyncio"), "asyncore": ((5, 1), "3.12", "asyncio"),
    "imp": ((5, 1), "3.12", "importlib.reload"), "smtpd": ((5, 1), "3.12", ""),
    "aifc": ((5, 1), "3.13", "aud"), "audioop": ((5, 1), "3.13", "aud"), "cgi": ((5, 1), "3.13", "urllib.parse"),
    "cgitb": ((5, 1), "3.13", "traceback"), "chunk": ((5, 1), "3.13", ""), "crypt": ((5, 1), "3.13", "hashlib"),
    "imghdr": ((5, 1), "3.13", ""), "lib2to3": ((5, 1), "3.13", "ast"), "mailcap": ((5, 1), "3.13", "mimetypes"),
    "msilib": ((5, 1), "3.13", ""), "nis": ((5, 1), "3.13", ""), "nntplib": ((5, 1), "3.13", ""),
    "ossaudiodev": ((5, 1), "3.13", "aud"), "pipes": ((5, 1), "3.13", "subprocess"), "sndhdr": ((5, 1), "3.13", ""),
    "spwd": ((5, 1), "3.13", ""), "sunau": ((5, 1), "3.13", "aud"), "telnetlib": ((5, 1), "3.13", ""),
    "uu": ((5, 1), "3.13", "base64"), "xdrlib": ((5, 1), "3.13", "struct"),
}  # fmt: skip

# Members that went → what is read from them all the same: the property with which it has its type in common, where what
# took their place is no mere new name.
SAME_TYPE = {
    f"{T}Scene.node_tree": f"{T}Scene.compositing_node_group",
    f"{T}SceneObjects.active": f"{T}LayerObjects.active",
    f"{T}Action.fcurves": f"{T}ActionChannelbag.fcurves",
    f"{T}Action.groups": f"{T}ActionChannelbag.groups",
    f"{T}CompositorNodeOutputFile.file_slots": f"{T}CompositorNodeOutputFile.file_output_items",
    f"{T}CompositorNodeOutputFile.layer_slots": f"{T}CompositorNodeOutputFile.file_output_items",
}

# Classes whose name is not spelled like the value that makes them: base class → value → class.
CLASS_OF_VALUE = {
    "Modifier": {
        "GREASE_PENCIL_VERTEX_WEIGHT_ANGLE": "GreasePencilWeightAngleModifier",
        "GREASE_PENCIL_VERTEX_WEIGHT_PROXIMITY": "GreasePencilWeightProximityModifier",
    },
    "Constraint": {"IK": "KinematicConstraint"},
    "Strip": {"SPEED": "SpeedControlStrip"},
    "StripModifier": {
        "COMPOSITOR": "SequencerCompositorModifierData", "TONEMAP": "SequencerTonemapModifierData",
    },
    "ShaderFx": {"FX_PIXEL": "ShaderFxPixel", "FX_WAVE": "ShaderFxWave"},
    "Attribute": {"BOOLEAN": "BoolAttribute"},
    "Curve": {"CURVE": "Curve", "SURFACE": "SurfaceCurve", "FONT": "TextCurve"},
    "NodeSocket": {"VALUE": "NodeSocketFloat", "RGBA": "NodeSocketColor"},
    "NodeTree": {"COMPOSITING": "CompositorNodeTree"},
}  # fmt: skip

# The properties that tell an instance's class by their value, best first.
DISCRIMINANTS = ("type", "bl_idname", "data_type", "effector_type")
# What an area shows is a space of the class that its type names; the second tells apart the trees of its nodes.
AREA, SPACE, AREA_TYPES = f"{T}Area", f"{T}Space", ("type", "ui_type")

# Classes whose instances have whatever a script, an add-on or an operator gave them.
OPEN_CLASSES = (
    "bpy.types.PropertyGroup", "bpy.types.OperatorProperties", "bpy.types.AddonPreferences",
    "bpy.types.GizmoGroupProperties", "bpy.types.KeyConfigPreferences", "bpy.types.IDPropertyWrapPtr",
    "bpy.types.AnyType", "bpy.types.UnknownType", "bpy.types.NodesModifierProperties",
    "bpy.types.Gizmo", "bpy.utils.previews.ImagePreviewCollection",
)  # fmt: skip
# What a button, or a key, calls an operator with. The trait names the operator, where a script does.
OPERATOR_PROPERTIES, OF_OPERATOR = "bpy.types.OperatorProperties", "operator"
# The trait of what is read as an object's data: one of the classes of such data, whatever else is an ID.
OF_OBJECT = "of an object"
# Classes that scripts derive their own from, which a value declared so may be.
DERIVED_BY_SCRIPTS = frozenset(
    {
        "bpy.types.Operator", "bpy.types.Macro", "bpy.types.Panel", "bpy.types.Menu", "bpy.types.Header",
        "bpy.types.UIList", "bpy.types.RenderEngine", "bpy.types.KeyingSetInfo", "bpy.types.GizmoGroup",
        "bpy.types.Node", "bpy.types.NodeSocket", "bpy.types.NodeTree", "bpy.types.NodeCustomGroup",
        "bpy.types.NodeTreeInterfaceSocket",
    }
)  # fmt: skip
# Nodes that have the sockets which their group, their zone or their items give them.
NODES_WITH_SOCKETS_OF_THEIR_OWN = (
    "Group", "GroupInput", "GroupOutput", "SimulationInput", "SimulationOutput", "RepeatInput", "RepeatOutput",
    "ForeachGeometryElementInput", "ForeachGeometryElementOutput", "Bake", "CaptureAttribute", "MenuSwitch",
    "IndexSwitch", "GeometryNodeViewer", "OutputFile", "Script", "CombineBundle", "SeparateBundle", "EvaluateClosure",
    "ClosureInput", "ClosureOutput", "ClosureToList", "FieldToGrid", "FieldToList", "ShaderNodeRaycast",
    "FormatString", "CryptomatteV2", "RLayers", "Image", "Reroute", "Custom",
)  # fmt: skip
# Of these, the ones whose sockets change what they hold, and keep their names.
NODES_THAT_KEEP_NAMES = frozenset({"bpy.types.NodeReroute"})

# Modules whose base classes and imported names the symbols do not tell (Iterator has what Interface0DIterator has).
HALF_KNOWN = ("freestyle",)
# Modules that are attributes of their packages once something imports them, which Blender itself does not.
UNLOADED = ("bpy.utils.previews", "gpu_extras.batch", "gpu_extras.presets")
# Names that new things have otherwise than their labels: a modifier of nodes is called after its group, and Blender
# brings one of this name.
CALLED = {"NodesModifier": "Array"}

# Functions that take keywords which their signatures do not list.
OPEN_CALLS = frozenset({"bpy.types.Context.temp_override"})
# The keyword that all of bpy.props take and none lists: the property's own name, which registering fills in.
NAME_OF_PROPERTY = "attr"

# What the entries of a result of bmesh.ops hold, by the beginning of their names.
BMESH_RESULTS = {
    "vert": ("BMVert",), "edge": ("BMEdge",), "face": ("BMFace",), "geom": ("BMVert", "BMEdge", "BMFace"),
    "region": ("BMFace",), "new_geom": ("BMVert", "BMEdge", "BMFace"), "split": ("BMVert", "BMEdge", "BMFace"),
}  # fmt: skip

# Functions that take the name of a class of nodes or sockets: path → parameter.
CLASS_NAMES = {f"{T}Nodes.new": "type", f"{T}NodeTreeInterface.new_socket": "socket_type"}

# Properties that RNA declares wider than they are: path → class.
NARROWER = {
    "bpy.types.SpaceNodeEditor.edit_tree": "NodeTree",
    "bpy.types.Context.space_data": "Space",
    "bpy.types.Context.edit_bone": "EditBone",
    "bpy.types.BoidSettings.active_boid_state": "BoidState",
    "bpy.types.Context.grease_pencil": "GreasePencilv3",
}

# Parameters of a script's own functions that are called so by everyone. Only a name that hardly means another thing
# has a place here; types from here are not sure.
PARAMETERS = {
    "context": "Context", "_context": "Context", "C": "Context", "ctx": "Context",
    "layout": "UILayout", "depsgraph": "Depsgraph", "scene": "Scene", "view_layer": "ViewLayer",
    "obj": "Object", "ob": "Object", "material": "Material", "mat": "Material", "mesh": "Mesh",
    "fcurve": "FCurve", "fcu": "FCurve", "pbone": "PoseBone", "pose_bone": "PoseBone", "edit_bone": "EditBone",
    "armature_ob": "Object", "node_tree": "NodeTree", "ntree": "NodeTree", "tree": "NodeTree",
    "nodes": "Nodes", "event": "Event",
    "psys": "ParticleSystem", "brush": "Brush", "armature": "Object", "region": "Region", "wm": "WindowManager",
    "window_manager": "WindowManager", "constraint": "Constraint", "action": "Action", "image": "Image",
    "driver": "Driver", "col": "UILayout", "row": "UILayout", "box": "UILayout", "addon_prefs": "AddonPreferences",
}  # fmt: skip

# What mathutils computes of two values, one of its own among them; it refuses the other pairs, tuples among them.
_NUMBER = "number"
_BY_ITEM = frozenset((f"mathutils.{name}",) * 2 for name in ("Matrix", "Quaternion", "Vector"))
_SCALED = frozenset(f"mathutils.{name}" for name in ("Color", "Matrix", "Quaternion", "Vector"))
_ADDED = frozenset((cls, cls) for cls in _SCALED)
_DIVIDED = frozenset({("mathutils.Vector", _NUMBER), ("mathutils.Color", _NUMBER)})
PRODUCTS = {
    "*": _BY_ITEM | {(cls, _NUMBER) for cls in _SCALED} | {(_NUMBER, cls) for cls in _SCALED},
    "@": _BY_ITEM | {
        ("mathutils.Matrix", "mathutils.Vector"), ("mathutils.Vector", "mathutils.Matrix"),
        ("mathutils.Quaternion", "mathutils.Vector"),
    },
}  # fmt: skip
COMPUTED = {**PRODUCTS, "+": _ADDED, "-": _ADDED, "/": _DIVIDED}
# The same in place, where the result must be of the same class.
COMPUTED_IN_PLACE = {**COMPUTED, "@": _BY_ITEM - {("mathutils.Vector", "mathutils.Vector")}}

# Members whose value has the class of what they are read from, though they are declared wider.
SAME_CLASS = frozenset(
    {"original", "evaluated_get", "copy", "override_create", "make_local", "evaluated_object"}
)

# What sequences with a class of their own hold.
ELEMENTS = {
    "bmesh.types.BMVertSeq": ("bmesh.types.BMVert",), "bmesh.types.BMEdgeSeq": ("bmesh.types.BMEdge",),
    "bmesh.types.BMFaceSeq": ("bmesh.types.BMFace",), "bmesh.types.BMLoopSeq": ("bmesh.types.BMLoop",),
    "bmesh.types.BMEditSelSeq": ("bmesh.types.BMVert", "bmesh.types.BMEdge", "bmesh.types.BMFace"),
    "bmesh.types.BMEditSelIter": ("bmesh.types.BMVert", "bmesh.types.BMEdge", "bmesh.types.BMFace"),
}  # fmt: skip
# What reads the active object, and what it is set by.
READ_ACTIVE = frozenset({f"{T}Context.object", f"{T}Context.active_object"})
SET_ACTIVE = f"{T}LayerObjects.active"
LAYER_ITEM = "bmesh.types.BMLayerItem"
LAYERS = "bmesh.types.BMLayerCollection"
ELEMENT = "[]"  # the trait that names what an instance holds
LAYERS_OF = "of"  # the trait of layers, and of one of them, that names what they were read from
LAYER_ACCESS = "bmesh.types.BMLayerAccess"  # how the classes of that begin, which end with an element's name


def made_by(operator: str) -> str:
    """The type of the object that an operator makes and leaves as the active one; empty for other operators."""
    is_adding = operator.endswith("_add")
    return next((kind for path, kind in _MAKERS.items() if is_adding and operator.startswith(path)), "")


def leaves_active(operator: str) -> bool:
    """Whether an operator surely leaves the active object as it is."""
    return operator.startswith(_LEAVING_IT)
