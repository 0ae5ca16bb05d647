# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what operators want to be active before they run, by asking each whether it can (``poll``), without an area.

All are asked in an empty scene, then with an active object of every type in every mode. Those that refuse all of these
are asked after everything was added to a mesh object and its scene that calls are known to add; and those that can run
then, after each of these calls alone. The others may want an area (see operator_areas).
"""

import json
import traceback

import bpy

from . import operator_areas
from .instances.making import (
    SEQUENCER_SCENE,
    activate,
    add_object,
    attempts,
    choices,
    mesh_object,
    no_sequencer_scene,
    object_of,
    remove,
)
from .operator_defaults import Defaults

MOST_CASES = 3
# More modifiers than these are any modifier.
MOST_MODIFIERS = 6
MODIFIER = 'obj.modifiers.new("name", '
THEN = " then "
NOT_ASKED = frozenset(
    {
        # It crashes Blender 5.0 where no object is active.
        "anim.slot_channels_move_to_new_action",
        # They answer as far as Blender has read its asset libraries, which it does in the background.
        "asset.library_refresh",
        "brush.asset_revert",
        "brush.asset_save_as",
        # It answers by what its user has.
        "preferences.asset_library_remove",
    }
)
# Of bpy.data.
CLEARED = (
    "scenes",
    "objects",
    "meshes",
    "node_groups",
    "materials",
    "actions",
    "particles",
    "armatures",
    "curves",
)
# What is added to an object in other ways than by a collection's ``new`` and by what fills pointers.
ADDED = (
    "obj.data.materials.append(material)",
    'obj.keyframe_insert("location")',
    f"scene.sequence_editor_create(){THEN}{SEQUENCER_SCENE} = scene",
)


def operators():
    """Path → operator."""
    return {
        f"bpy.ops.{module}.{name}": getattr(getattr(bpy.ops, module), name)
        for module in dir(bpy.ops)
        for name in dir(getattr(bpy.ops, module))
        if f"{module}.{name}" not in NOT_ASKED
    }


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


def clear(scene):
    """Removes all other scenes and what is in any: Blender computes all that there is after each operator."""
    ids = [block for name in CLEARED for block in getattr(bpy.data, name, ()) if block != scene]
    bpy.data.batch_remove(ids)


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


def modes(obj):
    """Puts an object into each of its modes; yields their identifiers."""
    for mode in choices("Object", "mode"):
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


def adding_calls(observer):
    """Calls that add something to a mesh object ``obj`` or its ``scene``, without modifiers."""
    obj = mesh_object()
    calls = [
        *ADDED,
        *collection_calls(obj, "obj"),
        *collection_calls(obj.data, "obj.data"),
        *collection_calls(bpy.context.scene, "scene"),
    ]
    remove(obj)
    for path in sorted(observer.pointers.fillers):
        calls += observer.pointers.fillers[path]
    firsts = ("obj.", "scene.", "bpy.ops.")
    return [
        call for call in dict.fromkeys(calls) if call.startswith(firsts) and not call.startswith(MODIFIER)
    ]


def modifier_calls():
    """The calls that add each kind of modifier."""
    return [f"{MODIFIER}{kind!r})" for kind in choices("Modifier", "type")]


def add(calls):
    """Makes calls, each if it can be made, with a new mesh object in a scene of its own. Returns those it made."""
    scene = empty_scene()
    no_sequencer_scene()
    obj = mesh_object()
    obj.select_set(True)
    names = {"bpy": bpy, "obj": obj, "scene": scene, "material": bpy.data.materials.new("new")}
    made = []
    for call in calls:
        try:
            for part in call.split(THEN):
                exec(part, names)  # noqa: S102 - of the text that is told
        except Exception:
            continue
        made.append(call)
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    return made


def run_in_modes(known):
    """Mode → the operators of these whose poll says yes there, each in the first that does, for the active object."""
    left, found = dict(known), {}
    for mode in modes(bpy.context.object):
        found[mode] = can_run(left)
        for path in found[mode]:
            del left[path]
    return found


def parts_needed(known, observer, defaults):
    """path → (mode, the calls after which an operator can run there that cannot with a new object alone)."""
    found = {}
    for calls in (adding_calls(observer), modifier_calls()):
        made = add(calls)
        after_all = run_in_modes(known)
        add(())
        alone, wanting = run_in_modes(known), {}
        # What can run alone wants something that is nobody's, as an action, or that a mode so far has left.
        free = set()
        for mode, paths in after_all.items():
            free.update(alone.get(mode, ()))
            wanting[mode] = {path: known[path] for path in paths if path not in free}
        for call in made if any(wanting.values()) else ():
            add([call])
            for mode in modes(bpy.context.object):
                running = can_run(wanting.get(mode, {}))
                defaults.ask(running)
                for path in running:
                    found.setdefault(path, (mode, []))[1].append(call)
    return found


def added(path, mode, calls):
    """What an operator wants that these calls add: the one whose name says most of the operator's own."""
    active = {
        "active": "active",
        "modes": {"names": [mode], "is_others": False} if mode != "OBJECT" else None,
    }
    if sum(call.startswith(MODIFIER) for call in calls) > MOST_MODIFIERS:
        return {**active, "with_modifier": True}
    words = path.rpartition(".")[2].split("_")
    best = max(calls, key=lambda call: sum(word in call.lower() for word in words))
    is_of_scene = best.startswith("scene.") and mode == "OBJECT"
    return {**({} if is_of_scene else active), "calls": best.split(THEN)}


def with_objects(write, known, _observer):
    """What operators want of which it is enough that an object is active, or nothing is: these leave ``known``."""
    empty_scene()
    no_sequencer_scene()
    defaults = Defaults(known)
    free = Objects(defaults)
    free.ask({path: known.pop(path) for path in can_run(known)})
    for path in free.passed:
        write("operator_needs", path=path, needs=free.free_needs(path))
    objects = Objects(defaults)
    objects.ask(known)
    for path in objects.passed:
        write("operator_needs", path=path, needs=objects.needs(path))
        del known[path]
    defaults.write(write)


def with_parts(write, known, observer):
    """What operators want that is added to an object: these leave ``known``."""
    defaults = Defaults(known)
    for path, (mode, calls) in sorted(parts_needed(known, observer, defaults).items()):
        write("operator_needs", path=path, needs=added(path, mode, calls))
        del known[path]
    defaults.write(write)


def with_areas(write, known, _observer):
    """What the others want."""
    operator_areas.find_all(write, known, empty_scene())


def find(write, finders, known, observer, skipped):
    """Has finders ask the ``known`` operators, but for the ``skipped``, which crashed this Blender."""
    window = bpy.context.window
    scene = window.scene
    clear(scene)
    for ask in attempts(write, finders, skipped):
        try:
            ask(write, known, observer)
        except Exception:
            write("fault", step="operators", traceback=traceback.format_exc())
        finally:
            window.scene = scene


def find_alone(write, skipped):
    """The records that need nothing of what other steps find; for operators that want parts as well, too many."""
    if bpy.context.window is not None:
        find(write, (with_objects, with_areas), operators(), None, skipped)


def find_all(write, observer, skipped, begun):
    """One ``operator_needs`` record for each operator of which it is known what it wants, if only nothing.

    ``begun`` does ``find_alone`` beside (see apart); without it, or where that ended Blender, all is done here.
    """
    if bpy.context.window is None:
        return
    known = operators()
    try:
        rows = [json.loads(line) for line in begun.lines()] if begun is not None else None
    except RuntimeError:
        rows = None
    if rows is None:
        find(write, (with_objects, with_parts, with_areas), known, observer, skipped)
        return
    for row in rows:
        if row["record"] == "operator_needs":
            del known[row["path"]]
    of_parts = set(known)
    find(write, (with_parts,), known, observer, skipped)
    of_parts.difference_update(known)
    for row in rows:
        if row.get("path") not in of_parts:
            write(**row)
