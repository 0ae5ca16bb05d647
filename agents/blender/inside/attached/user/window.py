# SPDX-License-Identifier: GPL-3.0-or-later
"""What the user sees: a picture of a window or an editor, and what is selected and set."""

import os
import time

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ...state import readout
from ..files.copies import TooLarge
from ..user_state import main_window, state

_LONGEST_DRAWING = 2.0  # seconds
_drawn = {"shown": None, "seconds": 0.0}  # the last picture: of what, and how long it took


def scene_state(arguments, report):
    """As ``readout.scene_state``. Raises TooLarge for more objects than ``at_most``: the window waits meanwhile; and
    Refused for more than ``in_copy``, which take too long anywhere."""
    most, in_copy = arguments.pop("at_most", None), arguments.pop("in_copy", None)
    objects = list(bpy.context.scene.objects)
    chosen = objects if arguments["objects"] is None else readout.find_objects(arguments["objects"], objects)
    if in_copy is not None and len(chosen) > in_copy:
        raise Refused(
            f"{len(chosen):,} objects are too many to be read in a moment. Name some in 'objects' (patterns and "
            "collections count), or read detail='summary'."
        )
    if most is not None and len(chosen) > most:
        raise TooLarge(f"{len(chosen):,} objects are too many to be read while the window waits.")
    return readout.scene_state(arguments, report)


def user_state(arguments, report):
    """What the user has before them, and files that are missing, linked libraries and unused data-blocks."""
    del arguments, report
    missing = [
        path for path in bpy.utils.blend_paths(absolute=True, packed=False) if not os.path.exists(path)
    ]
    unused = [
        f"{prop.identifier}: {block.name}"
        for prop in bpy.data.bl_rna.properties
        if prop.type == "COLLECTION" and prop.identifier in _UNUSED
        for block in getattr(bpy.data, prop.identifier)
        if block.users == 0 and getattr(block, "type", "") not in {"RENDER_RESULT", "COMPOSITING"}
    ]
    return {
        **state(),
        "missing": sorted(missing)[:40],
        "libraries": sorted(bpy.path.abspath(library.filepath) for library in bpy.data.libraries)[:40],
        "unused": sorted(unused)[:40],
    }


_UNUSED = frozenset(
    (
        "objects",
        "meshes",
        "materials",
        "images",
        "node_groups",
        "actions",
        "collections",
        "curves",
        "textures",
        "lights",
    )
)


def screenshot(arguments, report):
    """Writes a PNG of the window, or of its largest ``editor`` of that type, to ``path``.

    Raises TooLarge if the same was slow the last time: Blender draws all that is shown anew.
    """
    del report
    window, path, editor = main_window(), arguments["path"], arguments["editor"]
    shown = (editor, sum(obj.visible_get() for obj in window.view_layer.objects), window.scene.frame_current)
    if _drawn["shown"] == shown and _drawn["seconds"] > _LONGEST_DRAWING:
        raise TooLarge(
            f"This takes Blender {_drawn['seconds']:.1f} s to draw. Ask the user to hide objects or to use local view "
            "(numpad /), or picture another editor."
        )
    started = time.perf_counter()
    if editor is None:
        with bpy.context.temp_override(window=window, screen=window.screen):
            bpy.ops.screen.screenshot(filepath=path, check_existing=False)
    else:
        areas = [area for area in window.screen.areas if editor in {area.type, area.ui_type}]
        if not areas:
            types = ", ".join(sorted({area.ui_type for area in window.screen.areas}))
            raise Refused(f"The window has no editor {editor!r}. It has: {types}.")
        area = max(areas, key=lambda area: area.width * area.height)
        with bpy.context.temp_override(
            window=window, screen=window.screen, area=area, region=area.regions[-1]
        ):
            bpy.ops.screen.screenshot_area(filepath=path, check_existing=False)
    if not os.path.isfile(path):
        raise Refused("Blender made no picture of its window.")
    _drawn.update(shown=shown, seconds=time.perf_counter() - started)
    return {"editor": editor or "window"}
