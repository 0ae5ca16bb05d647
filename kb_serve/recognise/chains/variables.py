"""Which classes a variable may hold, by its name: ``ob`` an Object, ``psys`` a ParticleSystem, ``mat`` a Material."""

from __future__ import annotations

import re
from functools import lru_cache
from itertools import pairwise
from typing import TYPE_CHECKING

from kb_build.index.analysis import key, words
from kb_build.symbols.api_names import BLEND_DATA, OBJECT, TYPES

if TYPE_CHECKING:
    from collections.abc import Collection, Iterator

    from kb_serve.reader import BaseReader

USUAL = 0.95  # fit of a name that scripts use for a class
OTHERWISE = 0.92  # … and of the further classes that they use it for
_POINTER = 0.8  # … of what a pointer of that name leads to, or what begins so: a member may tell otherwise
_LETTER = 0.4  # … of a single letter that a class begins with: it may be anything
_NUMBERED = re.compile(r"_?\d+$|^(?:my|new|this|the|old|orig|src|dst|active|selected|cur|current)_(?=\w)")

# Names that scripts give to instances of a class, besides the class's own name and its beginning. A camera, light or
# armature is often the object that holds it.
_NAMES = {
    "Object": "o ob obj object objs cube empty child",
    "Camera Object": "cam camera",
    "Light Object": "lamp light lamp_data light_data key_light fill_light sun sun_lamp sun_light",
    "Armature Object": "arm armature amt rig",
    "Mesh": "me mesh msh mesh_data",
    "Curve": "cu curve curve_data crv",
    "TextCurve Object": "txt text_obj font_curve",
    "Text TextCurve Object": "text",
    "TextCurve": "text_data txt_data text_curve font_data",
    "MetaBall": "mball metaball mb",
    "Scene": "sce scn scene sc",
    "ViewLayer": "view_layer vl vlayer",
    "ViewLayer GreasePencilLayer": "layer",
    "RenderSettings": "render rd render_settings rnd",
    "CyclesRenderSettings": "cycles cscene",
    "SceneEEVEE": "eevee",
    "Material": "mat material mtl mtrl",
    "Texture ImageTexture": "texture",
    "Texture ImageTexture ShaderNodeTexImage": "tex",
    "Image": "img image",
    "Image ImageFormatSettings": "im",
    "World": "world wrld wld",
    "Collection": "coll collection grp",
    "UILayout Collection": "col",
    "Action": "act action",
    "FCurve": "fc fcu fcurve",
    "Keyframe": "kp kf keyframe keyframe_point kfp",
    "Driver": "driver",
    "Driver FCurve": "drv",
    "AnimData": "ad anim_data adt animation_data",
    "NlaTrack": "nla_track",
    "NlaStrip": "nla_strip",
    "Bone EditBone PoseBone": "bone bn",
    "EditBone": "eb ebone edit_bone",
    "PoseBone": "pb pbone pose_bone pchan",
    "Pose": "pose",
    "ParticleSystem ParticleSettings": "psys particle_system ps part",
    "ParticleSettings": "pset particle_settings psettings part_settings",
    "Modifier": "mod md modifier",
    "ShaderFx": "fx",
    "ClothModifier ClothSettings": "cloth",
    "ClothSettings": "cloth_settings",
    "Constraint": "con cns constraint const crc",
    "Node ShaderNode GeometryNode": "node nd",
    "ShaderNodeBsdfPrincipled": "bsdf principled principled_bsdf bsdf_node principled_node shader pbsdf",
    "NodeTree": "ntree nodetree nt node_tree tree ng node_group nodegroup",
    "NodeTree VertexGroup": "group",
    "NodeLinks": "links",
    "Nodes": "nodes",
    "NodeSocket NodeTreeInterfaceSocket": "socket sock inp",
    "ShapeKey": "sk kb shape_key shapekey key_block",
    "Key": "shape_keys",
    "Spline": "spline spl",
    "VertexGroup": "vg vgroup vertex_group",
    "MeshPolygon": "poly polygon",
    "MeshVertex bmesh.types.BMVert": "v vert vertex vtx",
    "MeshPolygon bmesh.types.BMFace": "f face",
    "MeshEdge bmesh.types.BMEdge": "e edge",
    "MeshLoop bmesh.types.BMLoop": "l loop",
    "bmesh.types.BMLoopUV": "luv loop_uv",
    "SpaceView3D": "space space_data v3d view view3d",
    "SpaceImageEditor": "sima image_editor",
    "SpaceSequenceEditor": "sseq",
    "RegionView3D": "rv3d region_3d r3d",
    "Area": "area",
    "Region": "region",
    "Screen": "screen scr",
    "Window": "win window",
    "WindowManager": "wm",
    "UILayout": "layout row column split box",
    "UILayout FluidFlowSettings": "flow",
    "Depsgraph": "depsgraph deg dg",
    "Preferences": "prefs preferences user_preferences user_prefs userpref",
    "SequenceEditor": "se sed seq_editor sequence_editor",
    "Strip": "strip sequence",
    "Strip SequenceEditor": "seq",
    "RigidBodyWorld": "rbw rigidbody_world rb_world",
    "RigidBodyObject": "rb rigid_body",
    "RigidBodyConstraint": "rbc rigid_body_constraint",
    "FieldSettings": "field force_field",
    "GreasePencil": "gp gpd gpencil grease_pencil",
    "GreasePencilLayer": "gpl gp_layer",
    "GreasePencilFrame": "gpf gp_frame frame",
    "GreasePencilDrawing": "drawing",
    "_bpy_internal.grease_pencil.stroke.GreasePencilStroke AnnotationStroke": "stroke",
    "SplinePoint BezierSplinePoint _bpy_internal.grease_pencil.stroke.GreasePencilStrokePoint": "point pt",
    "ToolSettings": "ts tool_settings ups",
    "Brush": "brush br",
    "PointCache": "cache point_cache",
    "Context": "ctx cntx context",
    "KeyMapItem": "kmi",
    "KeyMap": "km",
    "AOV": "aov",
    "ColorRamp ShaderNodeValToRGB": "ramp color_ramp cr",
    "MovieClip": "clip",
    "Text": "textblock text_block",
    "Event": "event evt",
    "Library UserAssetLibrary": "lib",
    "Volume": "volume vol",
    "bmesh.types.BMesh": "bm bmesh",
    "mathutils.bvhtree.BVHTree": "bvh bvhtree bvh_tree",
    "mathutils.kdtree.KDTree": "kd kdtree kd_tree",
}  # fmt: skip


def _classes_by_name() -> dict[str, list[str]]:
    found: dict[str, list[str]] = {}
    for classes, names in _NAMES.items():
        paths = [cls if "." in cls else TYPES + cls for cls in classes.split()]
        for name in names.split():
            found.setdefault(name, []).extend(path for path in paths if path not in found[name])
    return found


_BY_NAME = _classes_by_name()


def variable_fit(variable: str, cls: str) -> float:
    """How well a variable's name suits a class: ``obj`` Object, ``psys`` ParticleSystem, ``mat`` Material."""
    name, target = key(variable).rstrip("0123456789"), key(cls)
    if not name or not target:
        return 0.0
    if name == target:
        return 1.0
    if target.startswith(name) or name.startswith(target):
        return 0.9 if len(name) > 1 else _LETTER
    if target.endswith(name) or name.endswith(target):
        return 0.8 if len(name) > 1 else 0.0
    letters = iter(target)
    if name[0] == target[0] and len(name) >= 3 and all(letter in letters for letter in name):
        return 0.6
    return 0.0


def usual_classes(variable: str) -> list[str]:
    """Paths of the classes that scripts use a variable's name for, the likeliest first: ``my_cam2`` as ``cam``."""
    name = variable.lower()
    while name not in _BY_NAME and (plain := _NUMBERED.sub("", name)) != name:
        name = plain
    return _BY_NAME.get(name) or _of_data(name)


def _of_data(name: str) -> list[str]:
    """The classes of the data of objects that scripts call so: ``cam_data`` as ``cam``."""
    holder, mark, _ = name.rpartition("_data")
    classes = _BY_NAME.get(holder, []) if mark and name.endswith(mark) else []
    return [cls for cls in classes if cls != OBJECT] if OBJECT in classes else []


def classes_of_parts(variable: str) -> list[str]:
    """Paths of the classes that scripts use a part of a variable's name for: ``bone_dest`` as ``bone``."""
    parts = variable.lower().strip("_").split("_")
    return [path for part in parts if len(parts) > 1 for path in usual_classes(part)]


def is_guess(variable: str) -> bool:
    """Whether a name is too short to tell what it holds: a letter, or two that scripts use for no one class."""
    return len(variable) == 1 or (len(variable) == 2 and len(usual_classes(variable)) != 1)


@lru_cache(maxsize=500)
def is_short_form(variable: str) -> bool:
    """Whether a name only shortens the class that scripts use it for, and has no word of it: ``obj``, ``mat``."""
    classes = [path.rpartition(".")[2] for path in usual_classes(variable)]
    named = any(variable_fit(variable, cls) for cls in classes)
    return named and all(set(words(variable)).isdisjoint(words(cls)) for cls in classes)


class Variables:
    """What variables may hold in one base."""

    def __init__(self, reader: BaseReader) -> None:
        self._reader = reader

    def classes(self, name: str, *, of_instance: bool = False) -> list[tuple[str, float]]:
        """(class, fit) that a bare variable may have, best first: by context members and properties of its name, by
        what scripts call so, and similar classes. ``of_instance``: it is an attribute of a class of the script's own,
        of which Blender's properties of that name tell nothing.
        """
        fits: dict[str, float] = {}
        for path, fit in self._candidates(name, by_pointers=not of_instance):
            fits[path] = max(fit, fits.get(path, 0.0))
        found = sorted(fits.items(), key=lambda row: -row[1])
        if any(one[1] == other[1] for one, other in pairwise(found)):
            used = self._used(name, fits)
            found.sort(key=lambda row: (-row[1], -used.get(row[0], 0.0)))
        return found

    def _used(self, name: str, classes: Collection[str]) -> dict[str, float]:
        """Class → how much it counts, or the collection of that name which is of it."""
        held = {
            entry.path: TYPES + entry.collection
            for entry in self._reader.names.by_name(name)
            if entry.collection
        }
        weights = self._reader.usage.weights({*classes, *held})
        used = {cls: weights.get(cls, 0.0) for cls in classes}
        for path, cls in held.items():
            if cls in used:
                used[cls] = max(used[cls], weights.get(path, 0.0))
        return used

    def _candidates(self, name: str, *, by_pointers: bool) -> Iterator[tuple[str, float]]:
        named = self._reader.names.by_name(name)
        for entry in named:
            if entry.target and entry.kind == "context" and entry.type == "pointer":
                yield TYPES + entry.target, 1.0
        fit = USUAL
        for path in usual_classes(name):
            if self._reader.entry(path):
                yield path, fit
                fit = OTHERWISE
        pointed = {entry.target for entry in named if entry.kind == "property" and entry.type == "pointer"}
        for entry in named if by_pointers else ():
            if entry.target and entry.kind == "property" and entry.type == "pointer":
                yield TYPES + entry.target, _POINTER if len(pointed) == 1 else 0.5
        for entry in self._reader.members(BLEND_DATA).values():
            if entry.type == "collection" and (fit := variable_fit(name, entry.target)) > 0:
                yield TYPES + entry.target, fit if fit == 1.0 else min(fit, _POINTER)
        spelled = [identifier for _, identifier in self._reader.names.by_key(key(name))]
        self._reader.entry.load(spelled)
        for entry in map(self._reader.entry, spelled):
            if entry and entry.kind == "class":
                yield entry.path, 0.9
