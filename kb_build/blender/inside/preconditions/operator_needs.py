# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what operators want to be active before they run, by asking each whether it can (``poll``), without an area.

All are asked in an empty scene, then with an active object of every type in every mode. Those that refuse all of these
are asked after everything was added to a mesh object and its scene that calls are known to add; and those that can run
then, after each of these calls alone. The others may want an area (see operator_areas).
"""

import json
import traceback

import bpy

from ..bpy_ops.operator_defaults import Defaults
from ..bpy_ops.operators import operator_names
from ..instances.making import SEQUENCER_SCENE, attempts, choices, mesh_object, no_sequencer_scene, remove
from . import operator_areas
from .active_objects import Objects, can_run, collection_calls, empty_scene, modes

# More modifiers than these are any modifier.
MOST_MODIFIERS = 6
MODIFIER = 'obj.modifiers.new("name", '
THEN = " then "
ANOTHER_SCENE = {"calls": ['bpy.data.scenes.new("name")']}
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
        for module, names in operator_names().items()
        for name in names
        if f"{module}.{name}" not in NOT_ASKED
    }


def clear(scene):
    """Removes all other scenes and what is in any: Blender computes all that there is after each operator."""
    ids = [block for name in CLEARED for block in getattr(bpy.data, name, ()) if block != scene]
    bpy.data.batch_remove(ids)


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
        for modifier in bpy.context.object.modifiers:
            modifier.show_viewport = False  # together they multiply what there is to compute
        after_all = run_in_modes(known)
        add(())
        alone, wanting = run_in_modes(known), {}
        # What can run alone wants something that is nobody's, as an action, or that a mode so far has left.
        free = set()
        for mode, paths in after_all.items():
            free.update(alone.get(mode, ()))
            wanting[mode] = {path: known[path] for path in paths if path not in free}
        asked_in = [mode for mode, wanted in wanting.items() if wanted]
        for call in made if asked_in else ():
            add([call])
            for mode in modes(bpy.context.object, asked_in):
                running = can_run(wanting[mode])
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
    in_only_scene = {*can_run(known)}
    empty_scene()
    no_sequencer_scene()
    defaults = Defaults(known)
    free = Objects(defaults)
    free.ask({path: known.pop(path) for path in can_run(known)})
    for path in free.passed:
        needs = free.free_needs(path)
        write("operator_needs", path=path, needs=needs if needs or path in in_only_scene else ANOTHER_SCENE)
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


class Told:
    """Writes records, and keeps of which operators."""

    def __init__(self, write):
        self.write = write
        self.flush = write.flush
        self.paths = set()

    def __call__(self, record, **fields):
        if record.startswith("operator_"):
            self.paths.add(fields["path"])
        self.write(record, **fields)


def find_all(write, observer, skipped, begun):
    """What is known of what each operator wants: a record ``operator_needs``, if only nothing; ``operator_areas``, see
    there; or ``operator_refused``, with ``is_unknown`` for one that was not asked, or answered now so, now so.

    ``begun`` does ``find_alone`` beside (see apart); without it, or where that ended Blender, all is done here.
    """
    if bpy.context.window is None:
        return
    told, known = Told(write), operators()
    paths = [*known, *(f"bpy.ops.{name}" for name in NOT_ASKED)]
    find_told(told, known, observer, skipped, begun)
    for path in sorted(paths):
        if path not in told.paths:
            write("operator_refused", path=path, is_unknown=True)


def find_told(write, known, observer, skipped, begun):
    """The records of operators that answered."""
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
