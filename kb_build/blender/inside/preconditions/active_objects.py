# SPDX-License-Identifier: GPL-3.0-or-later
"""Active objects of every type in every mode: which of them operators take, in words; and what can be added to them."""

import bpy

from ..instances.making import activate, add_object, choices, object_of, remove

MOST_CASES = 3


def can_run(known):
    """The operators of these whose poll says yes, in their order."""
    found = []
    for path, operator in known.items():
        try:
            if operator.poll():
                found.append(path)
        except Exception:
            continue
    return found


def empty_scene():
    """A new scene in the window."""
    scene = bpy.context.window.scene = bpy.data.scenes.new("new")
    return scene


def typed_object(kind):
    """A new, active object of a type, with what people expect in it; None where this Blender cannot make one."""
    if kind == "EMPTY":
        return add_object(None)
    if kind == "ARMATURE":
        bpy.ops.object.armature_add()
        return bpy.context.object
    obj = object_of(kind)
    if kind == "CURVE" and obj is not None:
        obj.data.dimensions = "3D"  # as the Add menu makes them
    return obj


def modes(obj, names=()):
    """Puts an object into each of its modes, or into those of these names alone; yields their identifiers."""
    for mode in choices("Object", "mode"):
        if names and mode not in names:
            continue
        try:
            if obj.mode != mode:
                bpy.ops.object.mode_set(mode=mode)
        except (TypeError, RuntimeError):
            continue
        if obj.mode == mode:
            yield mode
    if obj.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")


def wanted(passed, refused):
    """Which names passed, of all that were tried: these, or the others; None where all did."""
    if not refused:
        return None
    is_others = len(passed) > len(refused)
    return {"names": refused if is_others else passed, "is_others": is_others}


class Objects:
    """With which types of active objects, in which modes, each operator can run."""

    def __init__(self, defaults):
        self.defaults = defaults
        # type → all modes that were tried
        self.tried = {}
        # path → {type: modes in which it can run}
        self.passed = {}
        # Those that can run with a mesh object in Object Mode that is active and not selected.
        self.unselected = set()
        # Those that can run with an object once it was in its modes, and could not before: these have left something.
        self.left = set()

    def ask(self, known):
        """Asks these operators, and those that can run again: what does not answer as before depends on more."""
        self.passed = self.asked(known)
        again = self.asked({path: known[path] for path in self.passed})
        self.passed = {
            path: found
            for path, found in self.passed.items()
            if again.get(path) == found and path not in self.left
        }

    def asked(self, known):
        """Path → {type: modes in which it can run}, of these operators."""
        passed = {}
        for kind in choices("Object", "type"):
            try:
                obj = typed_object(kind)
            except (TypeError, RuntimeError):
                continue
            if obj is None:
                continue
            activate(obj)
            if kind == "MESH":
                obj.select_set(False)
                self.unselected.update(can_run(known))
            obj.select_set(True)
            self.tried[kind] = []
            for mode in modes(obj):
                self.tried[kind].append(mode)
                found = can_run(known)
                self.defaults.ask(found)
                for path in found:
                    passed.setdefault(path, {}).setdefault(kind, []).append(mode)
            if "OBJECT" in self.tried[kind]:
                self.left.update(
                    path for path in can_run(known) if "OBJECT" not in passed.get(path, {}).get(kind, ())
                )
            remove(obj)
        return passed

    def free_needs(self, path):
        """What an operator wants that can run in an empty scene; empty where it refused nothing."""
        found = self.passed[path]
        refusing = {
            mode: [
                kind for kind in self.tried if mode in self.tried[kind] and mode not in found.get(kind, ())
            ]
            for modes_tried in self.tried.values()
            for mode in modes_tried
        }
        refused = [mode for mode, kinds in refusing.items() if kinds]
        if not refused:
            return {}
        passed = [mode for mode in refusing if mode not in refused]
        always = [mode for mode in refused if not any(mode in modes for modes in found.values())]
        if always == refused:
            return {"active": "any", "modes": wanted(passed, refused)}
        some = [mode for mode in refused if mode not in always]
        modes = {"names": always, "is_others": True} if always else None
        return {"active": "any", "modes": modes, "modes_of_some": some}

    def needs(self, path):
        """What an operator wants that refuses in an empty scene."""
        found = self.passed[path]
        is_selected = "OBJECT" in found.get("MESH", ()) and path not in self.unselected
        return {"active": "selected" if is_selected else "active", **self.cases(found)}

    def cases(self, found):
        """The types of objects, each with its modes."""
        passed = {mode: None for modes_passed in found.values() for mode in modes_passed}
        refused = {mode: None for kind in found for mode in self.tried[kind] if mode not in found[kind]}
        if not passed.keys() & refused.keys():
            return {"types": self.types(list(found)), "modes": wanted(list(passed), list(refused))}
        by_modes = {}
        for kind, modes_passed in found.items():
            by_modes.setdefault(tuple(modes_passed), []).append(kind)
        if len(by_modes) > MOST_CASES:
            return {"types": self.types(list(found)), "in_some_modes": True}
        cases = []
        for has, kinds in by_modes.items():
            refused = [mode for mode in self.tried[kinds[0]] if mode not in has]
            cases.append({"types": kinds, "modes": wanted(list(has), refused)})
        return {"cases": cases}

    def types(self, kinds):
        """Of which types, unless it is all."""
        return wanted(kinds, [kind for kind in self.tried if kind not in kinds])


def arguments(function):
    """The required arguments of a collection's ``new`` as source; None where they are not names and choices."""
    given = []
    for item in function.parameters:
        if not item.is_required or item.is_output:
            continue
        if item.type not in {"STRING", "ENUM"}:
            return None
        given.append(
            '"name"' if item.type == "STRING" else repr(next(iter(item.enum_items.keys()), "")),
        )
    return ", ".join(given)


def collection_calls(struct, text):
    """The calls that add an element to each collection of a struct."""
    for prop in struct.bl_rna.properties:
        function = prop.srna.functions.get("new") if prop.type == "COLLECTION" and prop.srna else None
        given = arguments(function) if function is not None and prop.identifier != "modifiers" else None
        if given is not None:
            yield f"{text}.{prop.identifier}.new({given})"
