# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes things by the plainest calls and prints what they hold: a second opinion on the extractor's defaults.

It shares no code with the extractor, on purpose.
"""

import json

import bpy

# What is made → the expression that makes it; ``obj`` is a new object with a mesh, ``scene`` a new scene.
SIMPLE = (
    ("sun light", 'bpy.data.lights.new("x", "SUN")'),
    ("point light", 'bpy.data.lights.new("x", "POINT")'),
    ("spot light", 'bpy.data.lights.new("x", "SPOT")'),
    ("area light", 'bpy.data.lights.new("x", "AREA")'),
    ("camera", 'bpy.data.cameras.new("x")'),
    ("material", 'bpy.data.materials.new("x")'),
    ("world", 'bpy.data.worlds.new("x")'),
    ("mesh", 'bpy.data.meshes.new("x")'),
    ("curve", 'bpy.data.curves.new("x", "CURVE")'),
    ("text curve", 'bpy.data.curves.new("x", "FONT")'),
    ("metaball", 'bpy.data.metaballs.new("x")'),
    ("lattice", 'bpy.data.lattices.new("x")'),
    ("armature", 'bpy.data.armatures.new("x")'),
    ("speaker", 'bpy.data.speakers.new("x")'),
    ("collection", 'bpy.data.collections.new("x")'),
    ("image", 'bpy.data.images.new("x", 8, 8)'),
    ("freestyle line style", 'bpy.data.linestyles.new("x")'),
    ("clouds texture", 'bpy.data.textures.new("x", "CLOUDS")'),
    ("wood texture", 'bpy.data.textures.new("x", "WOOD")'),
    ("voronoi texture", 'bpy.data.textures.new("x", "VORONOI")'),
    ("scene", "scene"),
    ("scene", "scene.render"),
    ("scene", "scene.eevee"),
    ("scene", "scene.unit_settings"),
    ("scene", "scene.tool_settings"),
    ("view layer", 'scene.view_layers.new("x")'),
    ("uv layer", 'obj.data.uv_layers.new(name="x")'),
    ("vertex group", 'obj.vertex_groups.new(name="x")'),
    ("basis shape key", 'obj.shape_key_add(name="x")'),
    ("bezier spline", 'bpy.data.curves.new("x", "CURVE").splines.new("BEZIER")'),
    ("nurbs spline", 'bpy.data.curves.new("x", "CURVE").splines.new("NURBS")'),
    ("ball meta element", 'bpy.data.metaballs.new("x").elements.new()'),
    ("driver", 'obj.driver_add("location", 0).driver'),
    ("nla track", "obj.animation_data_create().nla_tracks.new()"),
    ("active rigid body", 'call(bpy.ops.rigidbody.object_add, type="ACTIVE") and obj.rigid_body'),
    ("passive rigid body", 'call(bpy.ops.rigidbody.object_add, type="PASSIVE") and obj.rigid_body'),
    ("hinge rigid body constraint", 'call(bpy.ops.rigidbody.constraint_add, type="HINGE") and obj.rigid_body_constraint'),
    ("motor rigid body constraint", 'call(bpy.ops.rigidbody.constraint_add, type="MOTOR") and obj.rigid_body_constraint'),
    ("wind force field", 'call(bpy.ops.object.effector_add, type="WIND") and bpy.context.object.field'),
    ("vortex force field", 'call(bpy.ops.object.effector_add, type="VORTEX") and bpy.context.object.field'),
    ("turbulence force field", 'call(bpy.ops.object.effector_add, type="TURBULENCE") and bpy.context.object.field'),
    ("sun light by object.light_add(type='SUN')", 'call(bpy.ops.object.light_add, type="SUN") and bpy.context.object.data'),
    ("area light by object.light_add(type='AREA')", 'call(bpy.ops.object.light_add, type="AREA") and bpy.context.object.data'),
)
# Modifiers' and particle systems' own settings that are read, too.
INNER = (
    "settings", "collision_settings", "point_cache", "domain_settings", "flow_settings", "effector_settings",
    "effector_weights", "canvas_settings", "brush_settings", "texture_mapping", "image_user", "rigidbody_world",
)  # fmt: skip


def call(operator, **arguments):
    """Runs an operator."""
    return operator(**arguments) == {"FINISHED"}


def cube(scene):
    """A new active object with a mesh."""
    obj = bpy.data.objects.new("x", bpy.data.meshes.new("x"))
    obj.data.from_pydata([(0, 0, 0), (1, 0, 0), (0, 1, 0)], [], [(0, 1, 2)])
    bpy.context.scene.collection.objects.link(obj)
    bpy.context.view_layer.objects.active = obj
    return obj


def held(value):
    """A property's value as JSON has it; None for what is left out."""
    if isinstance(value, (bool, int, float, str)):
        return value
    if isinstance(value, set):
        return sorted(value)
    try:
        if len(value) > 32:
            return None
        items = [held(item) for item in value]
    except TypeError:
        return None
    return None if None in items else items


def read(label, thing, rows):
    """Adds what a thing and its inner settings hold."""
    values = {}
    for prop in thing.bl_rna.properties:
        if prop.type not in {"POINTER", "COLLECTION"} and not prop.is_readonly:
            try:
                values[prop.identifier] = held(getattr(thing, prop.identifier))
            except (AttributeError, RuntimeError):
                continue
    rows.append({"label": label, "class": thing.bl_rna.identifier, "values": values})
    for name in INNER:
        inner = getattr(thing, name, None)
        if isinstance(inner, bpy.types.bpy_struct) and not isinstance(inner, bpy.types.ID):
            read(label, inner, rows)


def simple(rows):
    """The things of the table."""
    for label, expression in SIMPLE:
        scene = bpy.data.scenes.new("x")
        try:
            thing = eval(expression, {"bpy": bpy, "call": call, "scene": scene, "obj": cube(scene)})
        except Exception as error:
            print(f"{label}: {error}")
            continue
        if thing:
            read(label, thing, rows)


def stacked(rows):
    """Modifiers and constraints of every kind that a mesh object takes, fluids, and particle systems."""
    obj = cube(None)
    for cls, stack in (("Modifier", obj.modifiers), ("Constraint", obj.constraints)):
        for item in getattr(bpy.types, cls).bl_rna.properties["type"].enum_items:
            try:
                thing = stack.new(name="x", type=item.identifier) if cls == "Modifier" else stack.new(item.identifier)
            except (TypeError, RuntimeError):
                continue
            if thing is None:
                continue
            if item.identifier == "FLUID":
                thing.fluid_type = "DOMAIN"
                read("fluid domain", thing.domain_settings, rows)
                thing.domain_settings.domain_type = "LIQUID"
                read("domain_type='LIQUID'", thing.domain_settings, rows)
                thing.fluid_type = "FLOW"
                read("fluid flow", thing.flow_settings, rows)
                thing.fluid_type = "EFFECTOR"
                read("fluid effector", thing.effector_settings, rows)
            elif item.identifier == "PARTICLE_SYSTEM":
                settings = obj.particle_systems[-1].settings
                read("particle system's settings", settings, rows)
                read("particle system", obj.particle_systems[-1], rows)
            else:
                read(thing.bl_rna.name.lower(), thing, rows)


def nodes(rows):
    """Every node of every tree."""
    for tree in ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree"):
        try:
            group = bpy.data.node_groups.new("x", tree)
        except TypeError:
            continue
        for name in dir(bpy.types):
            if "Node" in name and not any(row["label"] == name for row in rows):
                try:
                    node = group.nodes.new(name)
                except RuntimeError:
                    continue
                read(name, node, rows)


def main(arguments):
    """Writes the rows to the file that is the argument."""
    rows = []
    for part in (nodes, simple, stacked):
        part(rows)
    with open(arguments[0], "w", encoding="utf-8") as file:
        json.dump(rows, file)
