# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what Blender starts with: the scene, the data in it, the preferences, and the editors on its screens."""

import bpy

from ..apart import can_work_apart, sent_apart
from ..wire import plain
from .assigning import refused_value_items
from .making import called, startup_block

# Properties that one Blender crashes on; of one that crashes on more, the editors are left out.
MOST_CRASHES = 8


def startup_areas():
    """The first area of each type on the screens that Blender starts with, those in use first."""
    found = {}
    for screen in sorted(bpy.data.screens, key=lambda screen: screen != bpy.context.screen):
        for area in screen.areas:
            if area.spaces.active is not None:
                found.setdefault(area.spaces.active.bl_rna.identifier, area)
    return list(found.values())


def crashes_on(observer, spaces):
    """(class, name) of the property of these that Blender crashes on when it is read or asked; None for none."""

    def work(send):
        for space in spaces:
            for struct in observer.nearest(space):
                for field in observer.layout(struct).fields:
                    send([struct.bl_rna.identifier, field.name])
                    if not field.is_chosen:
                        plain(getattr(struct, field.name, None))
                    if field.is_enum:
                        refused_value_items(struct, field.name, field.is_flag)

    has_ended, sent = sent_apart(work)
    return None if has_ended else tuple(sent[-1])


def can_read(observer, spaces):
    """Whether all that is left of these can be read: what Blender, without its window, crashes on is left out."""
    for _ in range(MOST_CRASHES if can_work_apart() else 0):
        found = crashes_on(observer, spaces)
        if found is None:
            return True
        observer.leave_out(*found)
    return False


def look_at_start(observer):
    """Reads what Blender starts with."""
    scene = bpy.context.scene
    if scene is None:
        return
    observer.look("start-up scene", scene, is_new=False)
    observer.look("start-up view layer", bpy.context.view_layer, is_new=False)
    for block in (scene.world, *map(startup_block, (bpy.data.materials, bpy.data.lights, bpy.data.cameras))):
        if block is not None:
            observer.look(f"start-up {called(block)}", block, is_new=False)
    preferences = bpy.context.preferences
    observer.look("factory preferences", preferences, vary=False, is_new=False)
    if len(preferences.themes):
        observer.look("factory theme", preferences.themes[0], vary=False, is_new=False)
    areas = startup_areas()
    if can_read(observer, [area.spaces.active for area in areas]):
        for area in areas:
            space = area.spaces.active
            observer.look(f"start-up {called(space)}", space, vary=False, is_new=False)
            observer.ask(area, "start-up area", "")
