# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes things as scripts do: objects, and data-blocks of every type."""

import bpy

# What the sequencer works on since 5.0; None in a new file.
SEQUENCER_SCENE = "bpy.context.workspace.sequencer_scene"
BY = " by "  # between what was made and the operator that made it
# The types of objects that some modifier of each kind takes.
MODIFIED = ("MESH", "CURVE", "LATTICE", "GREASEPENCIL", "VOLUME")


def called(thing):
    """What a thing is, by its class: ``cloth modifier``."""
    return thing.bl_rna.name.lower()


def present(thing, collection):
    """The first of the elements that a new thing has from the beginning, if it has such."""
    elements = getattr(thing, collection, None)
    if isinstance(elements, bpy.types.bpy_prop_collection) and len(elements):
        yield called(elements[0]), elements[0]


def all_strips(editor):
    """The strips of a sequencer, which older Blenders call its sequences."""
    return editor.strips if hasattr(editor, "strips") else editor.sequences


def has_sequencer_scene():
    """Whether the sequencer has a scene, in a Blender that knows of one."""
    return getattr(bpy.context.workspace, "sequencer_scene", None) is not None


def no_sequencer_scene():
    """Takes the sequencer's scene away, in a Blender that has one."""
    if hasattr(bpy.context.workspace, "sequencer_scene"):
        bpy.context.workspace.sequencer_scene = None


def by_operator(label):
    """Whether an operator has made what is called so, and filled it perhaps."""
    return BY in label


def choices(cls, name):
    """The identifiers of an enum property of a class; none if this Blender has no such class."""
    rna = getattr(getattr(bpy.types, cls, None), "bl_rna", None)
    prop = rna.properties.get(name) if rna else None
    return [item.identifier for item in prop.enum_items] if prop else []


def argument_choices(collection, argument):
    """The identifiers that an enum argument of a collection's ``new`` takes."""
    function = collection.bl_rna.functions.get("new")
    parameter = function.parameters.get(argument) if function else None
    return [item.identifier for item in parameter.enum_items] if parameter else []


def operator_choices(operator, argument):
    """The identifiers that an enum argument of an operator takes."""
    prop = operator.get_rna_type().properties.get(argument)
    return [item.identifier for item in prop.enum_items] if prop else []


def activate(obj):
    """Makes an object the active one."""
    bpy.context.view_layer.objects.active = obj
    return obj


def add_object(data):
    """A new, active object with this data."""
    obj = bpy.data.objects.new("new", data)
    bpy.context.scene.collection.objects.link(obj)
    return activate(obj)


def mesh_object():
    """A new object with a triangle."""
    mesh = bpy.data.meshes.new("new")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    return add_object(mesh)


def object_of(kind):
    """A new object of a type that ``object.add`` knows; None where this Blender does not."""
    if kind == "MESH":
        return mesh_object()
    try:
        bpy.ops.object.add(type=kind)
    except (TypeError, RuntimeError):
        return None
    return bpy.context.object


def new_modifier(obj, kind):
    """A new modifier of an object; None where it takes none of that kind."""
    try:
        return obj.modifiers.new("new", kind)
    except (TypeError, RuntimeError):
        return None


def remove(obj):
    """Removes an object that is no longer needed: every other one makes the scene slower."""
    bpy.data.objects.remove(obj)


def block_makers():
    """(name, collection, arguments) of each type of data-block that a collection of ``bpy.data`` makes from a name."""
    for prop in bpy.data.bl_rna.properties:
        collection = getattr(bpy.data, prop.identifier, None) if prop.type == "COLLECTION" else None
        function = prop.srna.functions.get("new") if collection is not None and prop.srna else None
        if function is None or prop.identifier in {"objects", "scenes", "node_groups"}:
            continue
        arguments = [item.identifier for item in function.parameters if not item.is_output]
        choice = "mode" if prop.identifier == "brushes" else "type"
        # A mode is chosen rarely: what a call has that names none is what is usual.
        plain_too = [None] if choice == "mode" else []
        for kind in [*plain_too, *argument_choices(collection, choice)] or [None]:
            given = {"width": 8, "height": 8} if "width" in arguments else {}
            yield prop.identifier, collection, {choice: kind} if kind else given


def startup_block(blocks):
    """Of the data-blocks of a type that Blender starts with the one that is called like the type, else the first."""
    return next((block for block in blocks if block.name == block.bl_rna.name), blocks[0] if blocks else None)


def scratch_scene():
    """An empty scene to make things in, the one of the window where there is a window."""
    if bpy.context.mode != "OBJECT":
        bpy.ops.object.mode_set(mode="OBJECT")
    scene = bpy.data.scenes.new("scratch")
    if bpy.context.window is not None:
        bpy.context.window.scene = scene


def attempts(write, functions, skipped):
    """Each function whose name is not ``skipped``; it is on record before it is run, should Blender crash."""
    for function in functions:
        if function.__name__ in skipped:
            write("fault", step="new things", traceback=f"Blender crashed in {function.__name__}")
            continue
        write("making", maker=function.__name__)
        write.flush()
        yield function
