"""What those members of ``bpy.context`` are that only an editor gives, or what the interface shows: asked, Blender has
no value of them.
"""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

from kb_build.symbols.api_names import TYPES
from kb_build.symbols.flag_names import WITHOUT_SHOWN

if TYPE_CHECKING:
    from collections.abc import Mapping

# Name → class, of several that which this Blender has; with brackets, a list of them.
_MEMBERS = {
    "active_annotation_layer": "AnnotationLayer GPencilLayer", "active_editable_fcurve": "FCurve",
    "active_file": "FileSelectEntry", "active_gpencil_layer": "GPencilLayer", "active_sequence_strip": "Strip Sequence",
    "annotation_data": "Annotation GreasePencil", "asset": "AssetRepresentation", "cloth": "ClothModifier",
    "collision": "CollisionModifier", "curves": "Curves", "dynamic_paint": "DynamicPaintModifier",
    "edit_image": "Image", "edit_movieclip": "MovieClip", "editable_fcurves": "[FCurve]",
    "editable_gpencil_layers": "[GPencilLayer]", "editable_gpencil_strokes": "[GPencilStroke]",
    "fluid": "FluidModifier", "gpencil": "GreasePencil", "gpencil_data": "GreasePencil", "gpencil_data_owner": "ID",
    "id": "ID", "image_paint_object": "Object", "lightprobe": "LightProbe", "line_style": "FreestyleLineStyle",
    "particle_edit_object": "Object", "particle_system_editable": "ParticleSystem", "pointcloud": "PointCloud",
    "sculpt_object": "Object", "selected_asset_files": "[FileSelectEntry]", "selected_assets": "[AssetRepresentation]",
    "selected_editable_fcurves": "[FCurve]", "selected_editable_sequences": "[Strip Sequence]",
    "selected_files": "[FileSelectEntry]", "selected_ids": "[ID]", "selected_movieclip_tracks": "[MovieTrackingTrack]",
    "selected_pose_bones_from_active_object": "[PoseBone]", "selected_sequences": "[Strip Sequence]",
    "selected_visible_fcurves": "[FCurve]", "sequencer_scene": "Scene", "sequences": "[Strip Sequence]",
    "soft_body": "SoftBodyModifier", "texture_user_property": "Property", "ui_list": "UIList",
    "vertex_paint_object": "Object", "visible_fcurves": "[FCurve]", "visible_gpencil_layers": "[GPencilLayer]",
    "weight_paint_object": "Object",
}  # fmt: skip
# Members that are None while the interface shows no such thing. They are not asked: reading some crashes Blender.
_OF_WHAT_IS_SHOWN = frozenset({"asset", "gizmo_group", "region_popup"})


def mark_absent(symbols: Mapping[str, dict[str, Any]]) -> None:
    """Flags the members that are None unless the interface shows what they are."""
    for row in symbols.values():
        if row["kind"] == "context" and row["path"].rpartition(".")[2] in _OF_WHAT_IS_SHOWN:
            row["flags"] = [*row.get("flags", ()), WITHOUT_SHOWN]


def name_classes(symbols: Mapping[str, dict[str, Any]]) -> None:
    """Gives those members their class that Blender, when it was asked, had no value of."""
    for row in symbols.values():
        if row["kind"] != "context" or row.get("type"):
            continue
        told = _MEMBERS.get(row["path"].rpartition(".")[2], "")
        for name in told.strip("[]").split():
            if f"{TYPES}{name}" in symbols:
                row["type"], row["target"] = "collection" if told.startswith("[") else "pointer", name
                break
