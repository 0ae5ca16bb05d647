# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes things by the plainest calls and prints what they hold: a second opinion on the extractor's defaults.

It shares no code with the extractor, on purpose.
"""

import json

import bpy

# Modifiers' and particle systems' own settings that are read, too.
INNER = (
    "settings", "collision_settings", "point_cache", "domain_settings", "flow_settings", "effector_settings",
    "effector_weights", "canvas_settings", "brush_settings", "texture_mapping", "image_user", "rigidbody_world",
)  # fmt: skip
# Blender 4.5 crashes when an unpaired node is asked for its pair.
NOT_ASKED = ("rna_type", "paired_output")
# What fills pointers that are None at first. Each is run on a new object in a new scene.
CALLS = (
    "bpy.ops.rigidbody.object_add()", "bpy.ops.rigidbody.world_add()", "bpy.ops.object.forcefield_toggle()",
    "obj.modifiers.new('name', 'COLLISION')", "obj.modifiers.new('name', 'SOFT_BODY')", "obj.shape_key_add()",
    "obj.animation_data_create()", "scene.animation_data_create()", "mesh.animation_data_create()",
    "scene.sequence_editor_create()", "bpy.ops.object.shape_key_add()", "bpy.ops.rigidbody.objects_add()",
)  # fmt: skip


def triangle():
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


def asked_for(kind):
    """How the label of a thing begins whose kind was asked for."""
    return str(kind).lower().replace("_", " ") + " "


def read(label, thing, rows):
    """Adds what a thing and its inner settings hold."""
    values, pointers, collections = {}, {}, {}
    for prop in thing.bl_rna.properties:
        if prop.type == "POINTER" and prop.identifier not in NOT_ASKED:
            pointers[prop.identifier] = getattr(thing, prop.identifier, None) is not None
        if prop.type == "COLLECTION":
            try:
                collections[prop.identifier] = len(getattr(thing, prop.identifier)) > 0
            except (AttributeError, RuntimeError, TypeError):
                continue
        if prop.type not in {"POINTER", "COLLECTION"} and not prop.is_readonly:
            try:
                value = held(getattr(thing, prop.identifier))
                if prop.identifier != "type" or not label.startswith(asked_for(value)):
                    values[prop.identifier] = value
            except (AttributeError, RuntimeError):
                continue
    held_here = {"values": values, "pointers": pointers, "collections": collections}
    rows.append({"label": label, "class": thing.bl_rna.identifier, **held_here})
    for name in INNER:
        inner = getattr(thing, name, None)
        if isinstance(inner, bpy.types.bpy_struct) and not isinstance(inner, bpy.types.ID):
            read(label, inner, rows)


def plain_things():
    """(what it is, a new one) of data-blocks and what belongs to them."""
    data = bpy.data
    for kind in ("SUN", "POINT", "SPOT", "AREA"):
        yield f"{kind.lower()} light", data.lights.new("x", kind)
    for kind in ("CLOUDS", "WOOD", "VORONOI"):
        yield f"{kind.lower()} texture", data.textures.new("x", kind)
    for kind in ("BEZIER", "NURBS"):
        yield f"{kind.lower()} spline", data.curves.new("x", "CURVE").splines.new(kind)
    yield "camera", data.cameras.new("x")
    yield "material", data.materials.new("x")
    yield "world", data.worlds.new("x")
    yield "mesh", data.meshes.new("x")
    yield "curve", data.curves.new("x", "CURVE")
    yield "text curve", data.curves.new("x", "FONT")
    yield "metaball", data.metaballs.new("x")
    yield "ball meta element", data.metaballs.new("x").elements.new()
    yield "lattice", data.lattices.new("x")
    yield "armature", data.armatures.new("x")
    yield "speaker", data.speakers.new("x")
    yield "collection", data.collections.new("x")
    yield "image", data.images.new("x", 8, 8)
    yield "freestyle line style", data.linestyles.new("x")
    scene = data.scenes.new("x")
    for thing in (scene, scene.render, scene.eevee, scene.unit_settings, scene.tool_settings):
        yield "scene", thing
    yield "view layer", scene.view_layers.new("x")
    obj = triangle()
    yield "uv layer", obj.data.uv_layers.new(name="x")
    yield "vertex group", obj.vertex_groups.new(name="x")
    yield "basis shape key", obj.shape_key_add(name="x")
    for kind in ("FLOAT", "INT", "FLOAT_COLOR", "FLOAT_VECTOR", "BOOLEAN"):
        value = obj.data.attributes.new(kind, kind, "POINT").data[0]
        yield value.bl_rna.name.lower(), value
    yield "textbox", data.curves.new("x", "FONT").text_boxes[0]
    yield "latticepoint", data.lattices.new("x").points[0]
    yield "keying set path", data.scenes.new("x").keying_sets.new().paths.add(obj, "location")
    theme = bpy.context.preferences.themes[0]
    for part in (theme.view_3d, theme.user_interface, theme.graph_editor):
        yield "factory theme", part
    yield "driver", obj.driver_add("location", 0).driver
    yield "nla track", obj.animation_data.nla_tracks.new()


def things_by_operators():
    """(what it is, a new one) of physics and of objects from the Add menu."""
    ops = bpy.ops
    for kind in ("ACTIVE", "PASSIVE"):
        obj = triangle()
        ops.rigidbody.object_add(type=kind)
        yield f"{kind.lower()} rigid body", obj.rigid_body
    obj = triangle()
    ops.rigidbody.constraint_add()
    yield "rigid body constraint", obj.rigid_body_constraint
    for kind in ("HINGE", "MOTOR", "FIXED"):
        obj = triangle()
        ops.rigidbody.constraint_add(type=kind)
        yield f"{kind.lower()} rigid body constraint", obj.rigid_body_constraint
    for kind in ("WIND", "VORTEX", "TURBULENCE"):
        ops.object.effector_add(type=kind)
        yield f"{kind.lower()} force field", bpy.context.object.field
    for kind in ("SUN", "AREA"):
        ops.object.light_add(type=kind)
        light = bpy.context.object.data
        yield f"{kind.lower()} light by object.light_add(type={kind!r})", light


def stacked(rows):
    """Modifiers and constraints of every kind that a mesh object takes, fluids, and particle systems."""
    obj = triangle()
    for cls, stack in (("Modifier", obj.modifiers), ("Constraint", obj.constraints)):
        for item in getattr(bpy.types, cls).bl_rna.properties["type"].enum_items:
            try:
                thing = (
                    stack.new(name="x", type=item.identifier)  # pyright: ignore[reportCallIssue]
                    if cls == "Modifier"
                    else stack.new(item.identifier)  # pyright: ignore[reportCallIssue]
                )
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
    """Every node, in the tree that it is called after if that takes it."""
    groups = {}
    for tree in ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree"):
        try:
            groups[tree[: -len("Tree")]] = bpy.data.node_groups.new("x", tree)
        except TypeError:
            continue
    for name in dir(bpy.types):
        for kind in sorted(groups, key=lambda kind: not name.startswith(kind)) if "Node" in name else ():
            try:
                node = groups[kind].nodes.new(name)
            except RuntimeError:
                continue
            read(name, node, rows)
            break


def filled_by_calls():
    """call → class.name of the pointers that it filled."""
    found = {}
    for call in CALLS:
        scene = bpy.data.scenes.new("x")
        bpy.context.window.scene = scene
        obj = triangle()
        obj.select_set(True)
        things = {"bpy": bpy, "scene": scene, "obj": obj, "mesh": obj.data}
        before = dict(leading(scene, obj, obj.data))
        exec(call, things)  # noqa: S102 - the constants above
        after = leading(scene, obj, obj.data)
        found[call.replace("'name'", '"name"')] = [
            name for name, leads in after if leads and not before[name]
        ]
    return found


def leading(*things):
    """(class.name, whether it leads to something) of the pointers of some things."""
    for thing in things:
        for prop in thing.bl_rna.properties:
            if prop.type == "POINTER":
                yield (
                    f"{thing.bl_rna.identifier}.{prop.identifier}",
                    getattr(thing, prop.identifier) is not None,
                )


def main(arguments):
    """Writes what new things hold, and what filled pointers, to the file that is the argument."""
    rows = []
    nodes(rows)
    for label, thing in (*plain_things(), *things_by_operators()):
        read(label, thing, rows)
    stacked(rows)
    read("mesh object", triangle(), rows)
    found = {"rows": rows, "filled": filled_by_calls() if bpy.context.window is not None else {}}
    with open(arguments[0], "w", encoding="utf-8") as file:
        json.dump(found, file)
