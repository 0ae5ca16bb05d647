# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads what Blender starts with: the scene, the data in it, the preferences, and the editors on its screens."""

import bpy

from ..apart import can_work_apart, sent_apart
from ..classes.rna import path_of
from ..wire import plain
from .assigning import refused_value_items
from .making import called, choices, startup_block
from .observations import FACTORY, START_UP

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


def new_editors():
    """(label, area, space) of an editor of each type, in an area that is made it and then what it was again."""
    area = next(iter(startup_areas()), None)
    if area is None:
        return
    kind = area.type
    for new in choices("Area", "type"):
        try:
            area.type = new
        except (TypeError, RuntimeError):
            continue
        space = area.spaces.active
        if space is not None and area.type == new:
            yield called(space), area, space
    area.type = kind


def old_editors():
    """The same of the editors that Blender starts with."""
    for area in startup_areas():
        yield f"{START_UP}{called(area.spaces.active)}", area, area.spaces.active


def crashes_on(observer, editors):
    """(class, name) of the property of these that Blender crashes on when it is read or asked; None for none."""

    def work(send):
        for _, _, space in editors():
            for struct in observer.nearest(space):
                for field in observer.layout(struct).fields:
                    send([struct.bl_rna.identifier, field.name])
                    value = None if field.is_chosen else plain(getattr(struct, field.name, None))
                    if field.is_listed_wrongly(value):
                        refused_value_items(struct, field.name, field.is_flag)

    has_ended, sent = sent_apart(work)
    return None if has_ended else tuple(sent[-1])


def can_read(observer, editors):
    """Whether all that is left of these can be read: what Blender, without its window, crashes on is left out."""
    for _ in range(MOST_CRASHES if can_work_apart() else 0):
        found = crashes_on(observer, editors)
        if found is None:
            return True
        observer.leave_out(*found)
    return False


def look_at_start(observer):
    """Reads what Blender starts with."""
    scene = bpy.context.scene
    if scene is None:
        return
    observer.look(f"{START_UP}scene", scene, is_new=False)
    observer.look(f"{START_UP}view layer", bpy.context.view_layer, is_new=False)
    for block in (scene.world, *map(startup_block, (bpy.data.materials, bpy.data.lights, bpy.data.cameras))):
        if block is not None:
            observer.look(f"{START_UP}{called(block)}", block, is_new=False)
    preferences = bpy.context.preferences
    observer.look(f"{FACTORY}preferences", preferences, vary=False, is_new=False)
    if len(preferences.themes):
        observer.look(f"{FACTORY}theme", preferences.themes[0], vary=False, is_new=False)
    for editors in (new_editors, old_editors):
        if can_read(observer, editors):
            for label, area, space in editors():
                observer.look(label, space, vary=False, is_new=False)
                observer.ask(area, f"{START_UP}area", "")


def write_present(write, observer):
    """A ``start_empty`` record for each collection of ``bpy.data`` and of the window manager in which Blender starts
    with nothing, and a ``start_filled`` one for each pointer of what it starts with that leads to something.
    """
    for owner in (bpy.data, bpy.context.window_manager):
        for prop in owner.bl_rna.properties:
            if prop.type == "COLLECTION" and not len(getattr(owner, prop.identifier)):
                write("start_empty", path=path_of(owner.bl_rna, prop.identifier))
    context = bpy.context
    material = startup_block(bpy.data.materials)
    roots = (
        context.scene,
        context.view_layer,
        context.object,
        context.object and context.object.data,
        material,
    )
    filled = set()
    for root in (*roots, context.scene and context.scene.world):
        for struct in observer.nearest(root) if root is not None else ():
            pointers = observer.layout(struct).pointers
            filled |= {path for name, path in pointers.items() if getattr(struct, name, None) is not None}
    for path in sorted(filled):
        write("start_filled", path=path)
