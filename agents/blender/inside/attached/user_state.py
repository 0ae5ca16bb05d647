# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user sees and has set: windows, views, selection, frame, mode, render settings."""

import hashlib

import bpy

_MOST_NAMES = 200
_NOT_SET = frozenset({"rna_type", "name", "bl_rna"})


def main_window():
    """The window to work in: the active one, if it is not a dialog. Raises LookupError if there is none."""
    windows = bpy.context.window_manager.windows
    now = bpy.context.window
    if now is not None and getattr(now, "parent", None) is None:
        return now
    for window in windows:
        if getattr(window, "parent", None) is None:
            return window
    if not windows:
        raise LookupError("This Blender has no window.")
    return windows[0]


def in_window():
    """A context with the main window."""
    window = main_window()
    return bpy.context.temp_override(window=window, screen=window.screen, scene=window.scene)


def largest_view(window):
    """The largest 3D view of a window, None without one."""
    areas = [area for area in window.screen.areas if area.type == "VIEW_3D"]
    return max(areas, key=lambda area: area.width * area.height, default=None)


def state():
    """What the user has before them, as JSON."""
    window = main_window()
    scene, layer = window.scene, window.view_layer
    area = largest_view(window)
    selected = sorted(obj.name for obj in layer.objects if obj.select_get(view_layer=layer))
    active = layer.objects.active
    return {
        "file": bpy.data.filepath,
        "unsaved": bpy.data.is_dirty,
        "scene": scene.name,
        "view_layer": layer.name,
        "workspace": window.workspace.name,
        "frame": scene.frame_current,
        "playing": any(other.screen.is_animation_playing for other in bpy.context.window_manager.windows),
        "mode": _mode(active),
        "tool": _tool(window),
        "active": active.name if active else None,
        "selected": selected[:_MOST_NAMES],
        "selected_count": len(selected),
        "editors": sorted({other.ui_type for other in window.screen.areas}),
        "view": _view(area) if area else None,
    }


def _mode(active):
    return active.mode if active is not None else "OBJECT"


def _tool(window):
    area = largest_view(window)
    if area is None:
        return None
    with bpy.context.temp_override(window=window, area=area):
        tool = window.workspace.tools.from_space_view3d_mode(bpy.context.mode, create=False)
    return tool.idname if tool else None


def _view(area):
    region = area.spaces.active.region_3d
    return {
        "perspective": region.view_perspective,
        "shading": area.spaces.active.shading.type,
        "matrix": [[round(part, 5) for part in row] for row in region.view_matrix],
        "location": [round(part, 5) for part in region.view_location],
        "distance": round(region.view_distance, 5),
        "lens": area.spaces.active.lens,
        "local": area.spaces.active.local_view is not None,
    }


def digests(arguments=None, report=None):
    """Digests by part of all that looking must not change."""
    del arguments, report
    parts = {"windows": [], "scenes": [], "data": _names()}
    for window in bpy.context.window_manager.windows:
        parts["windows"].append(
            [
                window.scene.name,
                window.view_layer.name,
                window.workspace.name,
                [
                    (
                        area.ui_type,
                        area.x,
                        area.y,
                        area.width,
                        area.height,
                        _view(area) if area.type == "VIEW_3D" else None,
                    )
                    for area in window.screen.areas
                ],
            ]
        )
    for scene in bpy.data.scenes:
        layers = [
            [
                layer.name,
                layer.objects.active.name if layer.objects.active else None,
                [
                    (obj.name, obj.select_get(view_layer=layer), obj.mode, obj.hide_viewport)
                    for obj in layer.objects
                ],
            ]
            for layer in scene.view_layers
        ]
        settings = [_settings(scene.render), _settings(scene.view_settings), _settings(scene.tool_settings)]
        settings += [_settings(scene.render.image_settings)]
        settings += [_settings(own) for name in ("eevee", "cycles") if (own := getattr(scene, name, None))]
        camera = scene.camera.name if scene.camera else None
        parts["scenes"].append(
            [
                scene.name,
                scene.frame_current,
                scene.frame_subframe,
                camera,
                list(scene.cursor.location),
                layers,
                settings,
            ]
        )
    parts["dirty"] = [bpy.data.is_dirty, bpy.data.filepath]
    return {
        name: hashlib.sha256(repr(part).encode("utf-8", "replace")).hexdigest()[:16]
        for name, part in parts.items()
    }


def _settings(owner):
    found = []
    for prop in owner.bl_rna.properties:
        if prop.identifier in _NOT_SET or prop.type in {"POINTER", "COLLECTION"}:
            continue
        value = getattr(owner, prop.identifier, None)
        found.append((prop.identifier, list(value) if getattr(prop, "is_array", False) else value))
    return found


def _names():
    return {
        prop.identifier: [block.name_full for block in getattr(bpy.data, prop.identifier)]
        for prop in bpy.data.bl_rna.properties
        if prop.type == "COLLECTION" and prop.identifier not in {"window_managers", "screens", "workspaces"}
    }
