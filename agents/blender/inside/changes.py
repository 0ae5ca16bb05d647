# SPDX-License-Identifier: GPL-3.0-or-later
"""What a piece of code has changed in the open file: names of what came, went and was altered."""

import bpy
from bpy.app.handlers import persistent

# Collections of bpy.data that are told of, by the name a reader expects.
KINDS = {
    "objects": "objects",
    "materials": "materials",
    "collections": "collections",
    "meshes": "meshes",
    "lights": "lights",
    "cameras": "cameras",
    "actions": "actions",
    "node_groups": "node_groups",
    "images": "images",
    "scenes": "scenes",
    "worlds": "worlds",
}
LISTED = 40  # names of one kind in a report; the rest is counted

_updated = set()


def uid(thing):
    """What tells a data-block or modifier from every other one, whatever it is called."""
    for name in ("session_uid", "persistent_uid"):
        number = getattr(thing, name, None)
        if number is not None:
            return number
    return thing.as_pointer()  # Blender before 4.1


@persistent
def _note_updates(_scene, graph):
    for update in graph.updates:
        _updated.add(uid(update.id.original))


def _listen():
    handlers = bpy.app.handlers.depsgraph_update_post
    if _note_updates not in handlers:
        handlers.append(_note_updates)


class Watch:
    """The state of the file before some code runs; ``report`` tells what is different after it."""

    def __init__(self):
        _listen()
        self._settle()
        _updated.clear()
        self._before = _census()
        self._modifiers = _modifiers()

    @staticmethod
    def _settle():
        layer = getattr(bpy.context, "view_layer", None)
        if layer is not None:
            layer.update()

    def report(self):
        """{kind: {"added" | "removed" | "changed": names}}; modifiers by ``Object[Modifier]``; {} if nothing is."""
        self._settle()
        after, told = _census(), {}
        for kind in KINDS:
            old, new = self._before[kind], after[kind]
            changed = {
                name for key, name in new.items() if key in old and (key in _updated or old[key] != name)
            }
            entry = _entry(
                (name for key, name in new.items() if key not in old),
                (name for key, name in old.items() if key not in new),
                changed,
            )
            if entry:
                told[kind] = entry
        old, new = self._modifiers, _modifiers()
        entry = _entry(
            (name for key, name in new.items() if key not in old),
            (name for key, name in old.items() if key not in new),
            (name for key, name in new.items() if key in old and name != old[key]),
        )
        if entry:
            told["modifiers"] = entry
        return told


def _census():
    return {
        kind: {uid(block): block.name for block in getattr(bpy.data, attribute)}
        for kind, attribute in KINDS.items()
    }


def _modifiers():
    found = {}
    for thing in bpy.data.objects:
        for modifier in thing.modifiers:
            found[uid(thing), uid(modifier)] = f"{thing.name}[{modifier.name}]"
    return found


def _entry(added, removed, changed):
    entry = {}
    for word, names in (("added", added), ("removed", removed), ("changed", changed)):
        listed = sorted(names)
        if len(listed) > LISTED:
            listed = [*listed[:LISTED], f"… and {len(listed) - LISTED} more"]
        if listed:
            entry[word] = listed
    return entry
