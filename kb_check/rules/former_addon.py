"""An add-on that is enabled and that Blender brings no more.

Most that Blender 3.4 brought are in no installation since 4.2: people install them as extensions, whose modules are
called otherwise (`bl_ext.blender_org.…`). To enable one that is not there is a RuntimeError.

```python
bpy.ops.preferences.addon_enable(module="io_scene_obj")  # reported since 4.2
```

It is a warning, since somebody may have installed it under its former name. Not reported: a `try` around it.
"""

from __future__ import annotations

import ast
from typing import TYPE_CHECKING

from kb_build.flow.blender.facts import ADDONS
from kb_check.calls.sites import calls
from kb_check.findings import Finding
from kb_check.rule import Rule
from kb_check.running.tried import is_tried

if TYPE_CHECKING:
    from collections.abc import Iterator

    from kb_check.script import Script

_ENABLING = "bpy.ops.preferences.addon_enable"
_BROUGHT_BY, _GONE_BY = "3.4", (4, 2)
# What Blender 3.4.1 brings in its folder of add-ons, and neither 4.2 nor a later one does.
_FORMER = frozenset(
    {
        "add_camera_rigs", "add_curve_extra_objects", "add_curve_ivygen", "add_curve_sapling", "add_mesh_BoltFactory",
        "add_mesh_discombobulator", "add_mesh_extra_objects", "add_mesh_geodesic_domes", "amaranth",
        "animation_add_corrective_shape_key", "animation_animall", "ant_landscape", "archimesh", "blender_id",
        "bone_selection_sets", "btrace", "camera_turnaround", "curve_assign_shapekey", "curve_simplify", "curve_tools",
        "depsgraph_debug", "development_edit_operator", "development_icon_get", "development_iskeyfree",
        "greasepencil_tools", "io_anim_camera", "io_anim_nuke_chan", "io_coat3D", "io_export_dxf",
        "io_export_paper_model", "io_export_pc2", "io_import_BrushSet", "io_import_dxf", "io_import_images_as_planes",
        "io_import_palette", "io_mesh_atomic", "io_mesh_ply", "io_mesh_stl", "io_scene_obj", "io_scene_x3d",
        "io_shape_mdd", "lighting_dynamic_sky", "lighting_tri_lights", "magic_uv", "materials_library_vx",
        "materials_utils", "measureit", "mesh_auto_mirror", "mesh_bsurfaces", "mesh_f2", "mesh_inset", "mesh_looptools",
        "mesh_snap_utilities_line", "mesh_tiny_cad", "mesh_tissue", "mesh_tools", "node_arrange", "node_presets",
        "object_boolean_tools", "object_carver", "object_collection_manager", "object_color_rules",
        "object_edit_linked", "object_fracture_cell", "object_print3d_utils", "object_scatter", "object_skinify",
        "paint_palette", "power_sequencer", "precision_drawing_tools", "real_snow", "render_copy_settings",
        "render_freestyle_svg", "render_povray", "render_ui_animation_render", "space_clip_editor_refine_solution",
        "space_view3d_3d_navigation", "space_view3d_align_tools", "space_view3d_brush_menus",
        "space_view3d_copy_attributes", "space_view3d_math_vis", "space_view3d_modifier_tools",
        "space_view3d_pie_menus", "space_view3d_spacebar_menu", "space_view3d_stored_views", "storypencil",
        "sun_position", "system_blend_info", "system_demo_mode", "system_property_chart",
    }
)  # fmt: skip


def _check(script: Script) -> Iterator[Finding]:
    for call in calls(script) if script.version >= _GONE_BY else ():
        given = call.argument("module") if call.callee.symbol.path == _ENABLING else None
        name = given.value if isinstance(given, ast.Constant) else None
        if given and isinstance(name, str) and name in _FORMER - ADDONS and not is_tried(script, call.node):
            yield Finding(
                RULE.id, "warning", script.span(given),
                f"Blender {script.names.version} brings no add-on {name!r}, as {_BROUGHT_BY} did: a RuntimeError, "
                "unless somebody has installed it.",
                _ENABLING,
            )  # fmt: skip


RULE = Rule("former-addon", "warning", "An add-on that Blender brings no more", _check)
