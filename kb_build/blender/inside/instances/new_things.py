# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes one of everything, in the ways that scripts do, and has it read (see ``observer``).

Each function below makes one kind of thing and yields (what it is, the thing), and the call that made it where that
says it all. Labels are Blender's own names of the classes; where there are two ways of making a thing, that of the
operator names the operator.
"""

import os
import tempfile
import traceback

import bpy

from .making import (
    BY,
    MODIFIED,
    activate,
    add_object,
    all_strips,
    argument_choices,
    attempts,
    block_makers,
    called,
    choices,
    mesh_object,
    new_modifier,
    object_of,
    operator_choices,
    present,
    remove,
    scratch_scene,
)
from .small_parts import small_parts

# It is not new any more: only the items that its enumerations take are asked.
CONSTRAINT_TO_BONE = "constraint with a bone as target"
SOCKETS = frozenset({"inputs", "outputs"})


def data_blocks():
    """Every data-block that ``bpy.data`` makes from a name, each of its types; objects with each as their data."""
    for name, collection, given in block_makers():
        try:
            block = collection.new("new", **given)
        except (TypeError, RuntimeError):
            continue
        if "mode" in given:
            yield f"{called(block)} with mode={given['mode']!r}", block
        else:
            yield called(block), block, f"bpy.data.{name}.new()"
        yield from present(block, "text_boxes")
        yield from present(block, "points")
        if name == "cameras":
            yield "background image", block.background_images.new()
        if hasattr(collection, "create_gpencil_data"):
            collection.create_gpencil_data(block)
            gpencil = getattr(block, "gpencil_settings", None) or getattr(block, "grease_pencil", None)
            if gpencil is not None:
                yield called(gpencil), gpencil
    yield "empty object", add_object(None)
    yield "mesh object", mesh_object()
    yield "scene", bpy.data.scenes.new("new"), "bpy.data.scenes.new()"


def added_by_operators():
    """Objects as the Add menu makes them, with their data."""
    ways = [(getattr(bpy.ops.object, name), argument) for name, argument in (
        ("light_add", "type"), ("lightprobe_add", "type"), ("metaball_add", "type"), ("grease_pencil_add", "type"),
        ("effector_add", "type"), ("camera_add", ""), ("speaker_add", ""), ("text_add", ""), ("volume_add", ""),
        ("armature_add", ""), ("add", "type"), ("empty_add", ""), ("pointcloud_add", ""),
        ("curves_random_add", ""),
    )]  # fmt: skip
    ways += [(getattr(bpy.ops.mesh, f"primitive_{name}_add"), "") for name in ("cube", "plane", "uv_sphere")]
    ways += [(getattr(bpy.ops.curve, f"primitive_{name}_add"), "") for name in ("bezier_curve", "nurbs_path")]
    ways += [(bpy.ops.surface.primitive_nurbs_surface_sphere_add, "")]
    for operator, argument in ways:
        try:
            kinds = operator_choices(operator, argument) if argument else [None]
        except KeyError:
            continue
        for kind in kinds:
            before = len(bpy.data.objects)
            try:
                operator(**({argument: kind} if kind else {}))
            except (AttributeError, TypeError, RuntimeError):
                continue
            obj = bpy.context.object
            if obj is None or len(bpy.data.objects) == before:
                continue
            by = f"{BY}{operator.idname_py()}({f'type={kind!r}' if kind else ''})"
            if operator.idname_py() == "object.effector_add":
                yield f"{kind.lower().replace('_', ' ')} force field", obj.field
            else:
                yield f"object{by}", obj
                if obj.data is not None:
                    yield f"{called(obj.data)}{by}", obj.data
            remove(obj)


def modifiers():
    """Every modifier, on the first kind of object that takes it."""
    objects = [obj for obj in map(object_of, MODIFIED) if obj is not None]
    for kind in choices("Modifier", "type"):
        for obj in objects:
            activate(obj)
            modifier = new_modifier(obj, kind)
            if modifier is None:
                continue
            yield called(modifier), modifier
            yield from present(modifier, "segments")
            if kind == "FLUID":
                yield from fluids(modifier)
            elif kind == "DATA_TRANSFER":
                modifier.object = mesh_object()  # pyright: ignore[reportAttributeAccessIssue]
                modifier.use_vert_data = True  # pyright: ignore[reportAttributeAccessIssue]
                modifier.data_types_verts = {"VGROUP_WEIGHTS"}  # pyright: ignore[reportAttributeAccessIssue]
                yield "data transfer modifier for vertex groups", modifier
            elif kind == "DYNAMIC_PAINT":
                yield from dynamic_paint(modifier)
            elif kind == "PARTICLE_SYSTEM":
                continue
            obj.modifiers.remove(modifier)
            break
    obj = object_of("GREASEPENCIL") or object_of("GPENCIL")
    old = getattr(obj, "grease_pencil_modifiers", None) if obj else None
    for kind in choices("GpencilModifier", "type") if old is not None else ():
        try:
            yield kind.lower(), old.new("new", kind)
        except (TypeError, RuntimeError):
            continue
    effects = getattr(obj, "shader_effects", None) if obj else None
    for kind in choices("ShaderFx", "type") if effects is not None else ():
        effect = effects.new("new", kind)
        yield called(effect), effect


def fluids(modifier):
    """Domain, flow and effector of a fluid."""
    for kind in ("FLOW", "EFFECTOR", "DOMAIN"):
        modifier.fluid_type = kind
        yield f"fluid {kind.lower()}", getattr(modifier, f"{kind.lower()}_settings")


def dynamic_paint(modifier):
    """Canvas with a surface, and brush."""
    for kind in ("CANVAS", "BRUSH"):
        bpy.ops.dpaint.type_toggle(type=kind)
        settings = getattr(modifier, f"{kind.lower()}_settings")
        yield f"dynamic paint {kind.lower()}", settings
        if kind == "CANVAS" and len(settings.canvas_surfaces):
            yield "dynamic paint surface", settings.canvas_surfaces[0]


def constraints():
    """Every constraint of objects, also of an armature's, and of bones; those of objects with a bone as target, too."""
    obj = add_object(None)
    bpy.ops.object.armature_add()
    armature = bpy.context.object
    bone = armature.pose.bones[0]
    for kind in choices("Constraint", "type"):
        label = ""
        for owner in (obj, armature, bone):
            try:
                constraint = owner.constraints.new(kind)
            except (TypeError, RuntimeError):
                continue
            label = "constraint of a bone" if owner == bone and label else called(constraint)
            yield label, constraint
            if owner == obj and hasattr(constraint, "subtarget"):
                constraint.target = armature
                constraint.subtarget = bone.name
                yield CONSTRAINT_TO_BONE, constraint


def children():
    """Objects with parents, whose type decides how they can be parented."""
    for kind in ("MESH", "CURVE", "SURFACE", "FONT", "LATTICE", "ARMATURE"):
        parent = object_of(kind)
        child = add_object(None)
        child.parent = parent
        yield f"child of {kind.lower()} object", child


def particles():
    """Particle systems that emit, and hair, with their textures."""
    obj = mesh_object()
    for kind in ("EMITTER", "HAIR"):
        obj.modifiers.new("new", "PARTICLE_SYSTEM")
        system = obj.particle_systems[-1]
        label = "particle system" if kind == "EMITTER" else "hair particle system"
        settings = system.settings
        if kind == "HAIR":
            settings.type = kind
        yield label, system
        yield f"{label}'s settings", settings
        yield "particle texture slot", settings.texture_slots.add()
        yield f"{label}'s modifier", obj.modifiers[-1]
    # What emits can be chosen only where there are particles.
    fluid = obj.modifiers.new("new", "FLUID")
    fluid.fluid_type = "FLOW"
    yield "fluid flow with particles", fluid.flow_settings
    fluid.fluid_type = "EFFECTOR"
    yield "fluid effector with particles", fluid.effector_settings


def force_fields():
    """Force fields of objects of every type: some shapes need surfaces or points."""
    for kind in choices("Object", "type"):
        obj = object_of(kind)
        if obj is not None:
            bpy.ops.object.forcefield_toggle()
            if obj.field is not None:
                yield f"force field of a {kind.lower()} object", obj.field


def rigid_bodies():
    """The rigid body world, bodies and constraints."""
    bpy.ops.rigidbody.world_add()
    yield "rigid body world", bpy.context.scene.rigidbody_world
    for kind in ("ACTIVE", "PASSIVE"):
        obj = mesh_object()
        bpy.ops.rigidbody.object_add(type=kind)
        yield f"{kind.lower()} rigid body", obj.rigid_body
    obj = add_object(None)
    bpy.ops.rigidbody.constraint_add()
    yield "rigid body constraint", obj.rigid_body_constraint, "bpy.ops.rigidbody.constraint_add()"
    for kind in choices("RigidBodyConstraint", "type"):
        obj = add_object(None)
        bpy.ops.rigidbody.constraint_add(type=kind)
        yield f"{kind.lower().replace('_', ' ')} rigid body constraint", obj.rigid_body_constraint


def movie_clip():
    """A clip of one image, of which the file is gone; None where this Blender cannot make one."""
    image = bpy.data.images.new("new", 8, 8)
    with tempfile.TemporaryDirectory() as folder:
        path = os.path.join(folder, "new.png")
        try:
            image.save(filepath=path)
            return bpy.data.movieclips.load(path)
        except (TypeError, RuntimeError):
            return None
        finally:
            bpy.data.images.remove(image)


def strips():
    """Every strip, of files that are not there where it has some, with every modifier of strips."""
    scene = bpy.context.scene
    editor = scene.sequence_editor_create()
    workspace = bpy.context.workspace
    if hasattr(workspace, "sequencer_scene"):
        # Without it, Blender crashes when a strip gets a modifier.
        workspace.sequencer_scene = scene
    found = all_strips(editor)
    making = found.bl_rna.functions["new_effect"].parameters
    end = "length" if "length" in making else "frame_end"
    first, second = (
        found.new_effect(name="new", type="COLOR", channel=channel, frame_start=1, **{end: 9})  # pyright: ignore[reportCallIssue]
        for channel in (1, 2)
    )
    yield called(editor), editor
    yield called(first), first
    inputs = ("seq1", "seq2") if "seq1" in making else ("input1", "input2")
    for number, item in enumerate(making["type"].enum_items):
        kind = item.identifier
        for given in ({}, {inputs[0]: first}, {inputs[0]: first, inputs[1]: second}):
            try:
                strip = found.new_effect(  # pyright: ignore[reportCallIssue]
                    name="new", type=kind, channel=3 + number, frame_start=1, **{end: 9}, **given
                )
            except Exception:
                continue
            yield called(strip), strip
            break
    mask = bpy.data.masks.new("new")
    for kind, more in (
        ("new_scene", {"scene": bpy.data.scenes.new("new")}), ("new_mask", {"mask": mask}), ("new_meta", {}),
        ("new_image", {"filepath": "none.png"}), ("new_sound", {"filepath": "none.wav"}),
        ("new_movie", {"filepath": "none.mp4"}), ("new_clip", {"clip": movie_clip()}),
    ):  # fmt: skip
        try:
            strip = getattr(found, kind)(name="new", channel=1, frame_start=20, **more)
        except Exception:
            continue
        yield called(strip), strip
    for kind in argument_choices(first.modifiers, "type") if hasattr(first, "modifiers") else ():
        try:
            modifier = first.modifiers.new("new", kind)
        except (TypeError, RuntimeError):
            continue
        if modifier is not None:
            yield called(modifier), modifier


def curves_of(action):
    """An action's F-curves, wherever this Blender keeps them."""
    if hasattr(action, "fcurves"):
        return action.fcurves
    return action.layers[0].strips[0].channelbags[0].fcurves


def animation():
    """F-curves with keyframes of each way of inserting, their modifiers, drivers, and the NLA."""
    obj = add_object(None)
    obj.keyframe_insert("location", frame=1)
    data = obj.animation_data
    yield "animation data", data
    curve = curves_of(data.action)[0]
    yield "f-curve of keyframe_insert()", curve
    yield "f-curve of fcurves.new()", curves_of(data.action).new("scale", index=0)
    yield "keyframe of keyframe_insert()", curve.keyframe_points[0]
    yield "keyframe of keyframe_points.insert()", curve.keyframe_points.insert(5, 1.0)
    curve.keyframe_points.add(1)
    yield "keyframe of keyframe_points.add()", curve.keyframe_points[-1]
    for kind in choices("FModifier", "type"):
        try:
            modifier = curve.modifiers.new(kind)
        except (TypeError, RuntimeError):
            continue
        if modifier is not None:
            yield called(modifier), modifier
            curve.modifiers.remove(modifier)
    driven = obj.driver_add("scale", 0)
    yield "f-curve of driver_add()", driven
    yield "driver", driven.driver, "obj.driver_add()"
    variable = driven.driver.variables.new()
    yield "driver variable", variable
    yield "driver target", variable.targets[0]
    track = data.nla_tracks.new()
    yield "nla track", track
    yield "nla strip", track.strips.new("new", 1, data.action)
    if hasattr(data.action, "layers"):
        yield "action layer", data.action.layers[0]
        yield "action slot", data.action.slots[0]
    keying_set = bpy.context.scene.keying_sets.new()
    yield "keying set", keying_set
    yield "keying set path", keying_set.paths.add(obj, "location")


def tracking():
    """A clip of a camera with what tracks it, and an image of tiles."""
    clip = movie_clip()
    if clip is not None:
        yield called(clip), clip
        tracked = clip.tracking.objects.new("new")
        yield called(tracked), tracked
        track = clip.tracking.objects[0].tracks.new(frame=1)
        yield called(track), track
        yield called(track.markers[0]), track.markers[0]
    yield from present(bpy.data.images.new("new", 8, 8, tiled=True), "tiles")


def armatures():
    """Bones in edit mode, in object mode and in the pose; collections of bones."""
    bpy.ops.object.armature_add()
    obj = bpy.context.object
    bpy.ops.object.mode_set(mode="EDIT")
    bone = obj.data.edit_bones.new("new")
    bone.tail = (0, 0, 1)
    yield "edit bone", bone
    bpy.ops.object.mode_set(mode="OBJECT")
    yield "bone", obj.data.bones["new"]
    yield "pose bone", obj.pose.bones["new"]
    yield "pose", obj.pose
    if hasattr(obj.data, "collections"):
        yield "bone collection", obj.data.collections.new("new")


def splines():
    """Splines of each type with their points, and elements of metaballs."""
    curve = bpy.data.curves.new("new", "CURVE")
    for kind in argument_choices(curve.splines, "type"):
        try:
            spline = curve.splines.new(kind)
        except (TypeError, RuntimeError):
            continue
        yield f"{kind.lower()} spline", spline
        points = spline.bezier_points if kind == "BEZIER" else spline.points
        try:
            points.add(1)
        except RuntimeError:
            continue
        yield called(points[-1]), points[-1]
    ball = bpy.data.metaballs.new("new")
    for kind in choices("MetaElement", "type"):
        yield f"{kind.lower()} meta element", ball.elements.new(type=kind)


def mesh_parts():
    """What meshes and their objects carry: layers, attributes, groups, shape keys, slots."""
    obj = mesh_object()
    mesh = obj.data
    yield "uv layer", mesh.uv_layers.new(name="new")
    if hasattr(mesh, "vertex_colors"):
        yield "vertex colors", mesh.vertex_colors.new(name="new")
    for kind in argument_choices(mesh.attributes, "type"):
        attribute = mesh.attributes.new(f"new {kind}", kind, "POINT")
        yield f"{kind.lower()} attribute", attribute
        yield from present(attribute, "data")
    yield "vertex group", obj.vertex_groups.new(name="new")
    yield "basis shape key", obj.shape_key_add(name="new")
    yield "shape key", obj.shape_key_add(name="new")
    yield "shape keys", mesh.shape_keys
    mesh.materials.append(bpy.data.materials.new("new"))
    yield "material slot", obj.material_slots[0]
    if hasattr(obj, "asset_mark"):
        obj.asset_mark()
        yield "asset data", obj.asset_data


def drawings():
    """Layers of grease pencils, of annotations and of masks; colours of palettes."""
    for name in ("grease_pencils", "grease_pencils_v3", "annotations"):
        collection = getattr(bpy.data, name, None)
        if collection is None:
            continue
        block = collection.new("new")
        layer = block.layers.new("new")
        yield called(layer), layer
        frame = layer.frames.new(1)
        yield called(frame), frame
        if hasattr(block, "layer_groups"):
            group = collection.new("new").layer_groups.new("new")
            yield called(group), group
    layer = bpy.data.masks.new("new").layers.new()
    yield "mask layer", layer
    spline = layer.splines.new()
    yield "mask spline", spline
    spline.points.add(1)
    yield "mask point", spline.points[0]
    yield "palette color", bpy.data.palettes.new("new").colors.new()


def scenes():
    """What belongs to scenes: view layers, markers, Freestyle's line sets and the modifiers of its styles."""
    scene = bpy.data.scenes.new("new")
    layer = scene.view_layers.new("new")
    yield "view layer", layer
    yield "timeline marker", scene.timeline_markers.new("new")
    yield "render view", scene.render.views.new("new")
    yield "line set", layer.freestyle_settings.linesets.new("new")
    yield "freestyle module", layer.freestyle_settings.modules.new()
    style = bpy.data.linestyles.new("new")
    for name in ("alpha", "color", "geometry", "thickness"):
        collection = getattr(style, f"{name}_modifiers")
        for kind in argument_choices(collection, "type"):
            modifier = collection.new("new", kind)
            yield f"{called(modifier)} modifier of a line style", modifier
    aovs = getattr(layer, "aovs", None)
    if aovs is not None:
        yield "aov", aovs.add()
    lightgroups = getattr(layer, "lightgroups", None)
    if lightgroups is not None:
        yield "light group", lightgroups.add()


def libraries():
    """Libraries of assets, in the preferences."""
    paths = bpy.context.preferences.filepaths
    collection = getattr(paths, "asset_libraries", None)
    if hasattr(collection, "new"):
        library = collection.new(name="new", directory="new")
        yield called(library), library
        collection.remove(library)


def node_trees():
    """Node trees, the sockets of their interfaces, and what hangs on them."""
    for kind in ("ShaderNodeTree", "GeometryNodeTree", "CompositorNodeTree", "TextureNodeTree"):
        tree = bpy.data.node_groups.new("new", kind)
        yield called(tree), tree
        interface = getattr(tree, "interface", None)
        if interface is None:
            continue
        for name in dir(bpy.types):
            if name.startswith("NodeSocket") and name.count("Socket") == 1 and name != "NodeSocket":
                try:
                    socket = interface.new_socket("new", in_out="INPUT", socket_type=name)
                except (TypeError, RuntimeError):
                    continue
                if socket is not None:
                    yield called(socket), socket
        yield "panel of a node interface", interface.new_panel("new")
    ramp = bpy.data.textures.new("new", "CLOUDS")
    ramp.use_color_ramp = True
    yield "color ramp", ramp.color_ramp
    yield "color ramp element", ramp.color_ramp.elements.new(0.5)


def added_items(node):
    """The first item that each collection of a node's items makes, of the first type that it takes."""
    for prop in node.bl_rna.properties:
        collection = getattr(node, prop.identifier) if prop.type == "COLLECTION" and prop.srna else None
        if prop.identifier in SOCKETS or not hasattr(collection, "new"):
            continue
        for kind in argument_choices(collection, "socket_type") or [""]:
            given = [
                item for item in collection.bl_rna.functions["new"].parameters if item.identifier == "name"
            ]
            try:
                item = collection.new(*([kind] if kind else []), *("new" for _ in given))
            except (TypeError, RuntimeError):
                continue
            if item is not None:
                yield called(item), item
                break


def node_items():
    """The items of geometry nodes, and the bakes of a modifier."""
    tree = bpy.data.node_groups.new("new", "GeometryNodeTree")
    for name in dir(bpy.types):
        cls = getattr(bpy.types, name)
        if not isinstance(cls, type) or not issubclass(cls, bpy.types.Node):
            continue
        try:
            node = tree.nodes.new(name)
        except (TypeError, RuntimeError):
            continue
        yield from added_items(node)
        tree.nodes.remove(node)
    modifier = new_modifier(mesh_object(), "NODES")
    if hasattr(modifier, "bakes"):
        tree = bpy.data.node_groups.new("new", "GeometryNodeTree")
        tree.nodes.new("GeometryNodeBake")
        modifier.node_group = tree  # pyright: ignore[reportOptionalMemberAccess]
        yield from present(modifier, "bakes")


MAKERS = (
    data_blocks, added_by_operators, modifiers, constraints, particles, children, force_fields, rigid_bodies, strips,
    animation, tracking, armatures, splines, mesh_parts, drawings, scenes, libraries, node_trees,
    node_items, small_parts,
)  # fmt: skip
# Those whose things are small: on large ones some functions wait for threads, which a copy of a process has not.
BY_FUNCTIONS = tuple(make for make in MAKERS if make is not added_by_operators)


def place_of(thing):
    """In which kind of tree a part of a node tree's interface is: that decides what it takes."""
    is_of_tree = hasattr(thing, "socket_type") and isinstance(thing.id_data, bpy.types.NodeTree)
    return f" in a {thing.id_data.bl_idname}" if is_of_tree else ""


def write_all(write, observer, neighbours, skipped):
    """Makes everything but what the makers ``skipped`` make, for ``observer`` and ``neighbours`` to look at.

    A maker that fails is a ``fault``.
    """
    scratch_scene()
    for make in attempts(write, MAKERS, skipped):
        try:
            for label, thing, *call in make():
                if thing is not None:
                    if label == CONSTRAINT_TO_BONE:
                        observer.ask(thing, label, "")
                        continue
                    observer.calls[label] = "".join(call)
                    observer.look(label, thing, place=place_of(thing))
                    neighbours.look(thing)
        except Exception:
            write("fault", step="new things", traceback=traceback.format_exc())
