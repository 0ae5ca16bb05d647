# SPDX-License-Identifier: GPL-3.0-or-later
"""The facts about the scene at its current frame, by which the protocol's rules judge. Changes nothing."""

import math

import bpy
import numpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.fcurves import played_curves, varies
from ..blend.fluids import domain_of, is_empty_domain
from ..blend.protocol_tags import CONTACT, ROLE, ROOT, STRICT_GROUNDING
from ..physics.body_centres import is_kinematic, off_centre, origin_outside
from ..physics.caches import find_caches

_TRANSFORMS = ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale")
_CHANNELS = {*_TRANSFORMS, *(f"delta_{channel}" for channel in _TRANSFORMS)}
_RIGGING_PARENTS = {"BONE", "ARMATURE", "LATTICE"}
# Properties whose animation moves nothing; the last are custom properties.
_WITHOUT_MOTION = ("hide_", "show_", "visible_", "color", "pass_index", "rigid_body.", "[")


def scene_facts(arguments, report):
    """The facts, as agents.protocol.facts describes them. Raises Refused if Blender cannot evaluate the scene."""
    del arguments, report
    if circle := _circle_of(bpy.data.collections):
        names = " → ".join(map(repr, circle))
        raise Refused(f"Collections instance each other in a circle, {names}: remove one of these instances.")
    try:
        from .geometry_facts import GeometryFacts
    except ImportError as error:
        raise Refused(f"Geometry cannot be measured in this Blender: {error}.") from error
    scene = bpy.context.scene
    geometry = GeometryFacts(scene, bpy.context.evaluated_depsgraph_get())
    holders = _holders(scene)
    caches = find_caches(scene)
    baked_fluids = {cache.object for cache in caches if cache.kind == "fluid" and cache.baked}
    world = scene.world
    return {
        "version": bpy.app.version_string,
        "scene": scene.name,
        "frame": scene.frame_current,
        "frame_start": scene.frame_start,
        "frame_end": scene.frame_end,
        "fps": scene.render.fps / scene.render.fps_base,
        "gravity": _vector(scene.gravity) if scene.use_gravity else (0.0, 0.0, 0.0),
        "metres": scene.unit_settings.scale_length,
        "strict_grounding": bool(scene.get(STRICT_GROUNDING, False)),
        "camera": scene.camera.name if scene.camera else None,
        "world_light": _world_light(world) if world else 0.0,
        "collections": _collections(scene),
        "objects": [
            _object(obj, holders, geometry) | {"fluid": _fluid(obj, baked_fluids)} for obj in scene.objects
        ],
        "caches": [_cache(cache) for cache in caches],
        "joints": [_joint(obj.rigid_body_constraint) for obj in scene.objects if obj.rigid_body_constraint],
    }


def _circle_of(collections):
    """Names of collections that instance each other in a circle, which would crash Blender; None if there are none."""
    makes = {
        collection: {
            obj.instance_collection for obj in collection.all_objects if obj.instance_type == "COLLECTION"
        }
        - {None}
        for collection in collections
    }
    done, path = set(), []

    def search(collection):
        if collection in path:
            return [*path[path.index(collection) :], collection]
        if collection in done or collection not in makes:
            return None
        done.add(collection)
        path.append(collection)
        circle = next(filter(None, map(search, makes[collection])), None)
        path.pop()
        return circle

    circle = next(filter(None, map(search, makes)), None)
    return [collection.name for collection in circle] if circle else None


def _number(value):
    value = float(value)
    return value if math.isfinite(value) else 0.0


def _vector(values):
    return [_number(value) for value in values]


def _text(value):
    return value if isinstance(value, str) and value else None


def _collections(scene):
    """All collections below the scene's own, each once, with its parents."""
    parents = {}
    waiting = [(scene.collection, "")]
    seen = set()
    while waiting:
        above, name = waiting.pop()
        if above.as_pointer() in seen:
            continue
        seen.add(above.as_pointer())
        for below in above.children:
            parents.setdefault(below, []).append(name)
            waiting.append((below, below.name))
    return [
        {
            "name": collection.name,
            "parents": above,
            "objects": [obj.name for obj in collection.objects],
            "role": _text(collection.get(ROLE)),
            "deformation_kind": _text(collection.get("deformation_kind")),
            "motion_kind": _text(collection.get("motion_kind")),
            "allows_disconnected": bool(collection.get("allows_disconnected", False)),
        }
        for collection, above in parents.items()
    ]


def _holders(scene):
    """Object → names of the collections that it is in. Reading each users_collection would be slow."""
    holders = {}
    for collection in (scene.collection, *bpy.data.collections):
        for obj in collection.objects:
            holders.setdefault(obj, []).append(collection.name)
    return holders


def _object(obj, holders, geometry):
    facts = {
        "name": obj.name,
        "type": obj.type,
        "data": obj.data.name if obj.data else None,
        "collections": holders.get(obj, []),
        "parent": obj.parent.name if obj.parent else None,
        "is_root": bool(obj.get(ROOT, False)),
        "contact_with": _names(obj.get(CONTACT)),
        "modifiers": [_modifier(entry) for entry in obj.modifiers],
        "constraints": [_constraint(entry) for entry in obj.constraints],
        "rigid_body": _rigid_body(obj),
        "keys": _keys(obj),
        "animated_shape_keys": _has_animated_shapes(obj),
        "rigged": _is_rigged(obj),
        "drivers": len(obj.animation_data.drivers) if obj.animation_data else 0,
        "driven": sorted(_driven(obj)),
    }
    field = obj.field
    if field is not None and field.type != "NONE":
        facts.update(force_field=field.type, force_strength=_number(field.strength))
        if field.use_max_distance:
            facts["force_reach"] = _number(field.distance_max)
    if obj.type == "LIGHT":
        facts.update(light=obj.data.type, energy=_number(obj.data.energy))
    return facts | geometry.of(obj)


def _names(value):
    if isinstance(value, str):
        return [part.strip() for part in value.split(",") if part.strip()]
    if isinstance(value, bpy.types.ID):
        return [value.name]
    try:
        return [getattr(part, "name", None) or str(part) for part in value] if value is not None else []
    except TypeError:
        return [str(value)]


def _modifier(modifier):
    target = next(
        (
            value
            for name in ("object", "target", "mirror_object", "auxiliary_target")
            if isinstance(value := getattr(modifier, name, None), bpy.types.Object)
        ),
        None,
    )
    facts = {"name": modifier.name, "type": modifier.type, "on": bool(modifier.show_render)}
    if modifier.type == "FLUID":
        facts["type"] = f"FLUID_{modifier.fluid_type}"
    if modifier.type == "PARTICLE_SYSTEM":
        facts["copies"] = _copied(modifier.particle_system.settings)
    if modifier.type == "CLOTH":
        facts["pinned"] = bool(modifier.settings.vertex_group_mass)
    if target is not None:
        facts["target"] = target.name
    return facts


def _copied(settings):
    """Names of the objects that particles are shown as."""
    if settings.render_type == "OBJECT" and settings.instance_object is not None:
        return [settings.instance_object.name]
    if settings.render_type == "COLLECTION" and settings.instance_collection is not None:
        return [obj.name for obj in settings.instance_collection.all_objects]
    return []


def _constraint(constraint):
    target = getattr(constraint, "target", None)
    if target is None:  # an Armature constraint has several
        target = next(
            (candidate.target for candidate in getattr(constraint, "targets", ()) if candidate.target), None
        )
    return {
        "type": constraint.type,
        "on": _is_on(constraint),
        "target": target.name if target else None,
    }


def _is_on(constraint):
    return not constraint.mute and constraint.influence > 0


def _is_rigged(obj):
    """Whether a bone carries an object, as its parent or by a constraint, or its parent deforms it."""
    if obj.parent is not None and obj.parent_type in _RIGGING_PARENTS:
        return True
    return any(
        link.target is not None and link.target.type == "ARMATURE" and link.subtarget
        for entry in obj.constraints
        if _is_on(entry)
        for link in (entry, *getattr(entry, "targets", ()))
        if hasattr(link, "subtarget")
    )


def _rigid_body(obj):
    body = obj.rigid_body
    if body is None:
        return None
    return {
        "active": body.type == "ACTIVE",
        "kinematic": is_kinematic(obj),
        "enabled": bool(body.enabled),
        "shape": body.collision_shape,
        "off_centre": _number(off_centre(obj)),
        "origin_outside": _number(origin_outside(obj)),
    }


def _fluid(obj, baked):
    """What an object is to the fluid solver, if fluids of the objects ``baked`` are; None for nothing."""
    modifier = next((entry for entry in obj.modifiers if entry.type == "FLUID"), None)
    if modifier is None or modifier.fluid_type == "NONE":
        return None
    facts = {"role": modifier.fluid_type.lower()}
    if modifier.fluid_type == "FLOW":
        flow = modifier.flow_settings
        facts.update(matter=flow.flow_type.lower(), behavior=flow.flow_behavior.lower())
    domain = domain_of(obj)
    if domain is not None:
        evaluated = obj.evaluated_get(bpy.context.evaluated_depsgraph_get())
        has_mesh = domain.domain_type == "LIQUID" and domain.use_mesh
        facts.update(
            matter=domain.domain_type.lower(),
            cell=_number(max(_own_size(obj)) / max(1, domain.resolution_max)),
            surface=has_mesh and (obj.name in baked or not is_empty_domain(evaluated)),
        )
    return facts


def _own_size(obj):
    """The extents of an object's own mesh, before modifiers, in metres."""
    places = numpy.array([vertex.co for vertex in obj.data.vertices], float).reshape(-1, 3)
    if not len(places):
        return (0.0, 0.0, 0.0)
    lengths = numpy.linalg.norm(numpy.array(obj.matrix_world, float)[:3, :3], axis=0)
    return (places.max(axis=0) - places.min(axis=0)) * lengths


def _joint(joint):
    limits = [name for name in dir(joint) if name.startswith("use_limit_")]
    return {
        "type": joint.type,
        "a": joint.object1.name if joint.object1 else None,
        "b": joint.object2.name if joint.object2 else None,
        "limited": joint.enabled and any(getattr(joint, name) for name in limits),
    }


def _changing_curves(block):
    """The f-curves that change something over time: of the action, and of what is played in NLA tracks."""
    return [curve for curve in played_curves(block) if not curve.mute and varies(curve)]


def _keys(obj):
    """Channel → the largest number of keys in one of its curves; of curves that may move the object."""
    counts = {}
    for curve in _changing_curves(obj):
        if not curve.data_path.startswith(_WITHOUT_MOTION):
            channel = curve.data_path if curve.data_path in _CHANNELS else "other"
            count = max(len(curve.keyframe_points), len(curve.sampled_points))
            counts[channel] = max(counts.get(channel, 1), count)
    return counts


def _driven(obj):
    """Transform channels that drivers set."""
    drivers = obj.animation_data.drivers if obj.animation_data else ()
    return {driver.data_path for driver in drivers if driver.data_path in _CHANNELS}


def _has_animated_shapes(obj):
    shapes = getattr(obj.data, "shape_keys", None)
    if shapes is None:
        return False
    drivers = len(shapes.animation_data.drivers) if shapes.animation_data else 0
    return bool(drivers or _changing_curves(shapes))


def _cache(cache):
    start, end = cache.range
    return {
        "object": cache.object or "",
        "kind": cache.kind,
        "owner": getattr(cache.holder, "name", ""),
        "frame_start": start,
        "frame_end": end,
        "baked": bool(cache.baked),
        "outdated": bool(cache.outdated),
        "changed": cache.changed if cache.baked else [],
        "missing": cache.missing if cache.baked else 0,
        "on": bool(cache.simulated),
    }


def _world_light(world):
    """How strongly the world emits light: its brightest background node, or its plain colour."""
    tree = world.node_tree if getattr(world, "use_nodes", True) else None
    return max(_vector(world.color)) if tree is None else _brightest(tree, set())


def _brightest(tree, seen):
    """The strength of the brightest emitting node in a tree and its groups."""
    if tree is None or tree in seen:
        return 0.0
    seen.add(tree)
    shines = [0.0]
    for node in tree.nodes:
        if node.mute or not any(socket.is_linked for socket in node.outputs):
            continue
        if node.bl_idname in {"ShaderNodeBackground", "ShaderNodeEmission"}:
            color, strength = node.inputs["Color"], node.inputs["Strength"]
            brightness = 1.0 if color.is_linked else max(_vector(color.default_value[:3]))
            shines.append(brightness * (1.0 if strength.is_linked else _number(strength.default_value)))
        elif node.bl_idname == "ShaderNodeGroup":
            shines.append(_brightest(node.node_tree, seen))
    return max(shines)
