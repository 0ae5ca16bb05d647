# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what fills the pointers that are None on new things and take no assignment, by trying it on new ones.

Tried are functions of ``bpy.data`` that take such a thing, methods without arguments and ``use_…`` switches of each
kind of data-block, the kinds of modifiers, and the operators that add things to the active object, its modifiers and
its scene. Each is tried on things that were made for it alone; an operator that refuses is tried again after each one
that did fill something.
"""

import functools
import traceback

import bpy

from .making import attempts, block_makers, choices, mesh_object, new_modifier, operator_choices
from .pointers import variable

ADDING = frozenset({"add", "new", "create", "ensure", "mark", "toggle"})
# Operators of other modules work in a mode, in an editor, or on files.
MODULES = ("anim", "dpaint", "object", "particle", "rigidbody", "scene", "texture", "world")
# These lead to another mode, write files, wait for an answer, or move what is there (which crashes Blender 5.0.1).
LEFT_OUT = ("mode_toggle", "paint_toggle", "edit_toggle", "preset", "interactive", "move_to")
# More types than these are types of other things than the active one.
MOST_TYPES = 4


class Trial:
    """New things, and which of their pointers are None: asked before and after something is tried on them."""

    def __init__(self, observer, *structs):
        self.observer = observer
        self.structs = structs
        self.empty = {path for path, is_empty in self.asked() if is_empty}

    def asked(self):
        """(path, whether it is None) of every pointer that nothing can be assigned to."""
        for struct in self.structs:
            yield from self.observer.empty_pointers(struct).items()

    def filled(self):
        """The paths of the pointers that were None and lead to something now."""
        return [path for path, is_empty in self.asked() if path in self.empty and not is_empty]


def adds(name):
    """Whether a function of this name may make something."""
    return not ADDING.isdisjoint(name.split("_"))


def methods(rna):
    """Names of the functions of a class that may make something and need no arguments."""
    for function in rna.functions:
        needs_more = any(item.is_required and not item.is_output for item in function.parameters)
        if function.use_self and not needs_more and adds(function.identifier):
            yield function.identifier


def switches(rna):
    """Names of the boolean properties of a class that switch something on."""
    for prop in rna.properties:
        if prop.type == "BOOLEAN" and prop.identifier.startswith("use_") and not prop.is_readonly:
            yield prop.identifier


def try_on_blocks(observer, make):
    """Tries the methods and switches of one kind of data-block, each on a new one that ``make`` gives."""
    rna = make().bl_rna
    tries = [(name, False) for name in methods(rna)] + [(name, True) for name in switches(rna)]
    for name, is_switch in tries:
        block = make()
        data = getattr(block, "data", None)
        trial = Trial(observer, block, data) if isinstance(data, bpy.types.ID) else Trial(observer, block)
        try:
            if is_switch:
                setattr(block, name, True)
            else:
                getattr(block, name)()
        except Exception:
            continue
        observer.note_filled(block, trial.filled(), f".{name} = True" if is_switch else f".{name}()")


def functions_of(collection, block):
    """Names of the functions of a collection that may make something in one of its data-blocks, and need no more."""
    for function in collection.bl_rna.functions:
        needed = [item for item in function.parameters if item.is_required and not item.is_output]
        takes_it = len(needed) == 1 and needed[0].type == "POINTER" and isinstance(block, bpy.types.ID)
        if takes_it and needed[0].fixed_type == block.bl_rna and adds(function.identifier):
            yield function.identifier


def data_block_fillers(observer):
    """Functions of ``bpy.data``, methods and switches of every kind of data-block."""
    tried = set()
    for path, collection, given in block_makers():
        try:
            block = collection.new("new", **given)
        except (TypeError, RuntimeError):
            continue
        if block is not None and block.bl_rna.identifier not in tried:
            tried.add(block.bl_rna.identifier)
            for name in functions_of(collection, block):
                trial = Trial(observer, block)
                getattr(collection, name)(block)
                call = f"bpy.data.{path}.{name}({variable(block.bl_rna.identifier)})"
                observer.note_filled(None, trial.filled(), call)
            try_on_blocks(observer, lambda c=collection, g=given: c.new("new", **g))
    try_on_blocks(observer, mesh_object)
    try_on_blocks(observer, lambda: bpy.data.scenes.new("new"))


def modifier_fillers(observer):
    """The kinds of modifiers that a mesh object takes, and the kinds that these have."""
    for kind in choices("Modifier", "type"):
        obj = mesh_object()
        trial = Trial(observer, obj)
        modifier = new_modifier(obj, kind)
        if modifier is None:
            continue
        observer.note_filled(obj, trial.filled(), f'.modifiers.new("name", {kind!r})')
        for field in observer.layout(modifier).enums:
            if field.is_mode or field.is_flag or field.name == "type":
                continue  # the observer has tried the modes
            for item in choices(modifier.bl_rna.identifier, field.name):
                trial = Trial(observer, modifier)
                try:
                    setattr(modifier, field.name, item)
                except (TypeError, RuntimeError):
                    continue
                observer.note_filled(modifier, trial.filled(), f".{field.name} = {item!r}")


def particle_fillers(observer):
    """The switches of particle systems, of each type."""
    for kind in choices("ParticleSettings", "type"):
        for name in switches(bpy.types.ParticleSystem.bl_rna):
            obj = mesh_object()
            new_modifier(obj, "PARTICLE_SYSTEM")
            system = obj.particle_systems[-1]
            system.settings.type = kind
            trial = Trial(observer, system)
            setattr(system, name, True)
            observer.note_filled(system, trial.filled(), f".{name} = True")


def operators():
    """(call, operator) of the operators that may add something to what is active."""
    for module in MODULES:
        namespace = getattr(bpy.ops, module)
        for name in dir(namespace):
            if adds(name) and not any(part in name for part in LEFT_OUT):
                yield f"bpy.ops.{module}.{name}()", getattr(namespace, name)


def typed(call, operator):
    """(call, operator) of an operator with each of its types; of one without types, as it is."""
    kinds = operator_choices(operator, "type")
    if not 1 < len(kinds) <= MOST_TYPES:
        yield call, operator
        return
    for kind in kinds:
        yield f"{call[:-1]}type={kind!r})", functools.partial(operator, type=kind)


def operate(observer, given, modifier=""):
    """Runs operators one after the other on a new object in a scene of its own.

    Returns the paths that the last one filled; None if it could not be run.
    """
    scene = bpy.data.scenes.new("new")
    bpy.context.window.scene = scene
    obj = mesh_object()
    obj.select_set(True)
    structs = [obj, obj.data, scene]
    if modifier:
        structs.append(obj.modifiers.new("new", modifier))  # pyright: ignore[reportCallIssue]
    try:
        for operator in given[:-1]:
            operator()
        trial = Trial(observer, *structs)
        return None if "CANCELLED" in given[-1]() else trial.filled()
    except Exception:
        return None
    finally:
        if bpy.context.mode != "OBJECT":
            bpy.ops.object.mode_set(mode="OBJECT")


def unfilled_modifiers(observer):
    """The kinds of modifiers with pointers that are None when they are new, and that nothing is known to fill."""
    for kind in choices("Modifier", "type"):
        modifier = new_modifier(mesh_object(), kind)
        if modifier is not None and Trial(observer, modifier).empty - observer.pointers.fillers.keys():
            yield kind


def operator_fillers(observer):
    """Operators, the one that fills the fewest pointers first."""
    found, refused = [], []
    empty_modifiers = list(unfilled_modifiers(observer))
    for call, operator in operators():
        filled = operate(observer, [operator])
        if filled is None:
            refused.append((call, operator))
        elif filled:
            found.append((len(filled), call, operator, filled))
    found.sort(key=lambda row: row[:2])
    for _, call, _, filled in found:
        observer.note_filled(None, filled, call)
    for kind in empty_modifiers:
        for call, operator in (row for known in refused for row in typed(*known)):
            observer.note_filled(None, operate(observer, [operator], kind) or (), call)
    for _, first_call, first, _ in found:
        for call, operator in refused:
            if call.split(".")[2] == first_call.split(".")[2]:
                filled = operate(observer, [first, operator]) or ()
                observer.note_filled(None, filled, f"{first_call} then {call}")


FILLERS = (data_block_fillers, modifier_fillers, particle_fillers, operator_fillers)


def find_all(write, observer, skipped):
    """Has ``observer`` note what fills pointers, but for the ``skipped``, which crashed this Blender."""
    window = bpy.context.window
    scene = bpy.context.scene
    for find in attempts(write, FILLERS, skipped):
        if find is operator_fillers and window is None:
            continue
        try:
            find(observer)
        except Exception:
            write("fault", step="new things", traceback=traceback.format_exc())
        finally:
            if window is not None:
                window.scene = scene
