"""Names that people ask of a class for what something else near it has: ``keyframe.value``, ``collection.exclude``."""

from __future__ import annotations

from typing import TYPE_CHECKING, NamedTuple

from kb_build.symbols.api_names import TYPES as T

if TYPE_CHECKING:
    from kb_serve.reader import BaseReader


class MeantElsewhere(NamedTuple):
    """The symbol that is meant, and how it is reached."""

    path: str
    how: str


_OF_CHANNELBAG = MeantElsewhere(
    f"{T}ActionChannelbag.fcurves",
    "A slot's F-curves are in a channelbag: `ad = obj.animation_data`, then "
    "`ad.action.layers[0].strips[0].channelbag(ad.action_slot).fcurves`.",
)
_CHANNELBAG = MeantElsewhere(
    f"{T}ActionKeyframeStrip.channelbag",
    "The strip of a layer has it: `action.layers[0].strips[0].channelbag(slot)`.",
)
_OF_KEYFRAME = MeantElsewhere(
    f"{T}Keyframe.co", "`keyframe.co[0]` is the frame of a keyframe, `keyframe.co[1]` its value."
)
_STROKES = MeantElsewhere(
    f"{T}GreasePencilDrawing.strokes",
    "A drawing has them: `grease_pencil.layers[0].frames[0].drawing.strokes`.",
)
_OF_POSE = MeantElsewhere(
    f"{T}PoseBone.constraints", "The bone of the pose has them: `obj.pose.bones[bone.name].constraints`."
)
_LENGTH = MeantElsewhere(
    "mathutils.Vector.length", "The distance of two points is the length between them: `(a - b).length`."
)
# Member that a class lacks → what is meant.
MEANT_ELSEWHERE = {
    f"{T}Action.channelbag": _CHANNELBAG,
    f"{T}ActionLayer.channelbag": _CHANNELBAG,
    f"{T}ActionLayer.fcurves": _OF_CHANNELBAG,
    f"{T}ActionSlot.fcurves": _OF_CHANNELBAG,
    f"{T}AnimData.fcurves": _OF_CHANNELBAG,
    f"{T}Object.fcurves": _OF_CHANNELBAG,
    f"{T}ArrayModifier.offset": MeantElsewhere(
        f"{T}ArrayModifier.relative_offset_displace",
        "`relative_offset_displace` is in sizes of the object, `constant_offset_displace` in metres, with "
        "`use_constant_offset = True`.",
    ),
    f"{T}EditBone.constraints": _OF_POSE,
    f"{T}Collection.exclude": MeantElsewhere(
        f"{T}LayerCollection.exclude",
        "A view layer excludes it: `view_layer.layer_collection.children[collection.name].exclude = True`.",
    ),
    f"{T}GreasePencil.strokes": _STROKES,
    f"{T}GreasePencilLayer.strokes": _STROKES,
    f"{T}GreasePencilDrawing.points": MeantElsewhere(
        f"{T}GreasePencilDrawing.strokes", "Each stroke has its points: `drawing.strokes[0].points`."
    ),
    f"{T}ImageStrip.filepath": MeantElsewhere(
        f"{T}ImageStrip.elements",
        "An image strip has a folder and a file for each frame: `strip.directory + strip.elements[0].filename`.",
    ),
    f"{T}Context.depsgraph": MeantElsewhere(
        f"{T}Context.evaluated_depsgraph_get", "`bpy.context.evaluated_depsgraph_get()` gives it, up to date."
    ),
    f"{T}bpy_struct.setdefault": MeantElsewhere(
        f"{T}bpy_struct.get",
        'A custom property is set where it is not there yet: `if "name" not in obj: obj["name"] = value`.',
    ),
    "mathutils.Vector.distance": _LENGTH,
    "mathutils.Vector.distance_to": _LENGTH,
    f"{T}Keyframe.frame": _OF_KEYFRAME,
    f"{T}Keyframe.value": _OF_KEYFRAME,
    f"{T}NodesModifier.properties": MeantElsewhere(
        f"{T}NodeTreeInterfaceSocket.identifier",
        'Before 5.2 its inputs are custom properties: `modifier["Socket_2"] = 5.0`; `item.identifier` of '
        "`node_group.interface.items_tree` tells each one's key.",
    ),
    f"{T}RenderSettings.samples": MeantElsewhere(
        f"{T}CyclesRenderSettings.samples",
        "Each engine has its own: `scene.cycles.samples`, `scene.eevee.taa_render_samples`.",
    ),
}


def meant_elsewhere(owner: str, name: str, reader: BaseReader) -> MeantElsewhere | None:
    """What is meant by a name that a class lacks, if this Blender has that."""
    names = (MEANT_ELSEWHERE.get(f"{entry.path}.{name}") for entry in reader.lineage(owner))
    return next((found for found in names if found and reader.entry(found.path)), None)
