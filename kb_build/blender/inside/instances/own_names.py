# SPDX-License-Identifier: GPL-3.0-or-later
"""The names that Blender itself gives to new things, and where the nodes stand that it makes by itself."""

import re
import traceback

import bpy

from .making import MODIFIED, activate, attempts, choices, mesh_object, object_of, startup_block

_NUMBER = re.compile(r"\.\d{3}$")  # what tells it from another one of the same name
# What whoever makes a thing for the extract calls it; no name of Blender's own has it in it.
_GIVEN = ("new", "scratch")
# Types of data-blocks with node trees of their own: (class, collection of ``bpy.data``, arguments of its ``new``).
_WITH_TREES = (
    ("Material", "materials", ()), ("World", "worlds", ()), ("Light", "lights", ("POINT",)),
    ("FreestyleLineStyle", "linestyles", ()),
)  # fmt: skip


class OwnNames:
    """class → the name that the first instance of it had which was not given one."""

    def __init__(self):
        self.names = {}

    def add(self, thing, with_bases=False):
        """Adds the name of a thing, if its class has none yet; ``with_bases``: to the classes above it, too."""
        key = thing.bl_rna.name_property
        name = _NUMBER.sub("", str(getattr(thing, key.identifier, "") or "")) if key is not None else ""
        if not name or any(given in name.lower() for given in _GIVEN):
            return
        rna = thing.bl_rna
        while rna is not None and rna.identifier != "ID":
            self.names.setdefault(rna.identifier, name)
            rna = rna.base if with_bases else None

    def write(self, write):
        """An ``own_name`` record for each class."""
        for identifier in sorted(self.names):
            write("own_name", path=f"bpy.types.{identifier}", name=self.names[identifier])


def look_at_start(observer):
    """Has ``observer`` note what the data-blocks are called that Blender starts with."""
    for prop in bpy.data.bl_rna.properties:
        blocks = getattr(bpy.data, prop.identifier, None) if prop.type == "COLLECTION" else None
        if blocks is not None and len(blocks):
            block = startup_block(blocks)
            if prop.identifier != "images":  # which Blender makes for its own use
                observer.names.add(block, with_bases=True)


def stacked_by_operators():
    """Modifiers, shader effects and particle systems as the buttons that add them do."""
    ops = bpy.ops.object
    bpy.data.batch_remove(bpy.data.objects)  # Blender computes all that a scene has after each operator
    objects = [obj for obj in map(object_of, (*MODIFIED, "GPENCIL")) if obj is not None]
    for operator, cls, stack in (
        ("modifier_add", "Modifier", "modifiers"),
        ("gpencil_modifier_add", "GpencilModifier", "grease_pencil_modifiers"),
        ("shaderfx_add", "ShaderFx", "shader_effects"),
    ):  # fmt: skip
        for kind in choices(cls, "type"):
            for obj in objects:
                items = getattr(obj, stack, ())
                before = {item.as_pointer() for item in items}
                activate(obj)
                try:
                    getattr(ops, operator)(type=kind)
                except (AttributeError, TypeError, RuntimeError):
                    continue
                # Some are put before the others.
                added = [item for item in items if item.as_pointer() not in before]
                if added:
                    yield added[0]
                    if kind == "PARTICLE_SYSTEM":
                        yield obj.particle_systems[-1]
                    break


def named_without_asking():
    """What is made by calls that need no name."""
    obj = mesh_object()
    mesh = obj.data
    yield obj.vertex_groups.new()
    yield mesh.uv_layers.new()
    yield obj.shape_key_add()
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    yield armature.data.bones[0]
    yield armature.pose.bones[0]
    bpy.ops.object.mode_set(mode="EDIT")
    yield armature.data.edit_bones[0]
    bpy.ops.object.mode_set(mode="OBJECT")


NAMERS = (stacked_by_operators, named_without_asking)


def find_all(write, observer, skipped):
    """Has ``observer`` note the names, but for the makers ``skipped``, which crashed this Blender."""
    for make in attempts(write, NAMERS, skipped):
        try:
            for thing in make():
                observer.names.add(thing)
        except Exception:
            write("fault", step="names", traceback=traceback.format_exc())


def startup_or_new(collection, arguments):
    """A data-block that Blender starts with, else a new one."""
    blocks = getattr(bpy.data, collection)
    return startup_block(blocks) or blocks.new("new", *arguments)


def write_places(write):
    """A ``stands_in`` record for each node that a type of data-block has in its tree from the start.

    Of what lights and line styles have only what ends their trees: the rest is found in materials more often.
    """
    placed = set()
    for cls, collection, arguments in _WITH_TREES:
        block = startup_or_new(collection, arguments)
        if block.node_tree is None:
            block.use_nodes = True
        for node in block.node_tree.nodes if block.node_tree is not None else ():
            is_own = collection in {"materials", "worlds"} or not len(node.outputs)
            if is_own and node.bl_idname not in placed:
                placed.add(node.bl_idname)
                write("stands_in", path=f"bpy.types.{node.bl_idname}", name=cls)
