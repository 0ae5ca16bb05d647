# SPDX-License-Identifier: GPL-3.0-or-later
"""What code changed in the open file: names of data-blocks and modifiers added, removed and changed."""

import bpy
from bpy.app.handlers import persistent

# Collections of bpy.data whose changes are reported.
KINDS = (
    *("objects", "materials", "collections", "meshes", "lights", "cameras", "actions", "node_groups"),
    *("images", "scenes", "worlds"),
)
LISTED = 40  # names of one kind in a report; the rest are counted

_updated = set()


def uid(block):
    """A number that identifies a data-block or modifier, whatever its name."""
    for name in ("session_uid", "persistent_uid"):
        number = getattr(block, name, None)
        if number is not None:
            return number
    return block.as_pointer()  # Blender before 4.1


@persistent
def _note_updates(_scene, graph):
    for update in graph.updates:
        _updated.add(uid(update.id.original))


def _listen():
    handlers = bpy.app.handlers.depsgraph_update_post
    if _note_updates not in handlers:
        handlers.append(_note_updates)


class ChangeWatch:
    """Remembers the file before some code runs; ``report`` returns the differences after it."""

    def __init__(self):
        _listen()
        self._settle()
        _updated.clear()
        self._before = _names_by_kind()
        self._modifiers = _modifiers()

    @staticmethod
    def _settle():
        layer = getattr(bpy.context, "view_layer", None)
        if layer is not None:
            layer.update()

    def report(self):
        """{kind: {"added" | "removed" | "changed": names}}; modifiers by ``Object[Modifier]``; {} if nothing is."""
        self._settle()
        report = {}
        for kind, new in _names_by_kind().items():
            old = self._before[kind]
            updated = {key for key in new if key in old and (key in _updated or old[key] != new[key])}
            if entry := _entry(old, new, updated):
                report[kind] = entry
        old, new = self._modifiers, _modifiers()
        if entry := _entry(old, new, {key for key in new if key in old and new[key] != old[key]}):
            report["modifiers"] = entry
        return report


def _names_by_kind():
    return {kind: {uid(block): block.name for block in getattr(bpy.data, kind)} for kind in KINDS}


def _modifiers():
    names = {}
    for obj in bpy.data.objects:
        for modifier in obj.modifiers:
            names[uid(obj), uid(modifier)] = f"{obj.name}[{modifier.name}]"
    return names


def _entry(old, new, changed):
    """The names that differ between ``old`` and ``new`` ({uid: name}), and those of the uids that ``changed``."""
    entry = {}
    for word, names in (
        ("added", [name for key, name in new.items() if key not in old]),
        ("removed", [name for key, name in old.items() if key not in new]),
        ("changed", [new[key] for key in changed]),
    ):
        listed = sorted(names)
        if len(listed) > LISTED:
            listed = [*listed[:LISTED], f"… and {len(listed) - LISTED} more"]
        if listed:
            entry[word] = listed
    return entry
