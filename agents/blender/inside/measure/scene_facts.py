# SPDX-License-Identifier: GPL-3.0-or-later
"""The facts that rules judge by: what is in the scene at its current frame. Changes nothing."""

import math
from types import SimpleNamespace

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..physics.caches import find_caches

_TRANSFORMS = ("location", "rotation_euler", "rotation_quaternion", "rotation_axis_angle", "scale")
_CHANNELS = {*_TRANSFORMS, *(f"delta_{channel}" for channel in _TRANSFORMS)}
# What may be animated without moving anything; the last are custom properties.
_LOOKS = ("hide_", "show_", "visible_", "color", "pass_index", "rigid_body.", "[")


def snapshot(arguments, report):
    """Everything that agents.protocol.facts describes. Raises Refused for what Blender cannot evaluate."""
    del arguments, report
    if circle := _circle_of(bpy.data.collections):
        told = " → ".join(map(repr, circle))
        raise Refused(
            f"Collections make instances of each other in a circle, {told}: break it before it is evaluated."
        )
    try:
        from .geometry_facts import GeometryFacts
    except ImportError as error:
        raise Refused(f"Geometry cannot be measured in this Blender: {error}.") from error
    scene = bpy.context.scene
    geometry = GeometryFacts(scene, bpy.context.evaluated_depsgraph_get())
    holders = _holders(scene)
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
        "strict_grounding": bool(scene.get("strict_grounding", False)),
        "camera": scene.camera.name if scene.camera else None,
        "world_light": _world_light(world) if world else 0.0,
        "collections": _collections(scene),
        "objects": [_object(thing, holders, geometry) for thing in scene.objects],
        "caches": [_cache(cache) for cache in find_caches(scene)],
    }


def _circle_of(collections):
    """Names of collections that make instances of each other in a circle; Blender crashes when it evaluates those."""
    makes = {
        one: {thing.instance_collection for thing in one.all_objects if thing.instance_type == "COLLECTION"}
        - {None}
        for one in collections
    }
    done, path = set(), []

    def search(one):
        if one in path:
            return [*path[path.index(one) :], one]
        if one in done or one not in makes:
            return None
        done.add(one)
        path.append(one)
        found = next(filter(None, map(search, makes[one])), None)
        path.pop()
        return found

    found = next(filter(None, map(search, makes)), None)
    return [one.name for one in found] if found else None


def _number(value):
    value = float(value)
    return value if math.isfinite(value) else 0.0


def _vector(values):
    return [_number(value) for value in values]


def _text(value):
    return value if isinstance(value, str) and value else None


def _collections(scene):
    """All below the scene's own, each once, with the collections that hold it."""
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
            "name": one.name,
            "parents": above,
            "objects": [thing.name for thing in one.objects],
            "role": _text(one.get("protocol_role")),
            "deformation_kind": _text(one.get("deformation_kind")),
            "motion_kind": _text(one.get("motion_kind")),
            "allows_disconnected": bool(one.get("allows_disconnected", False)),
        }
        for one, above in parents.items()
    ]


def _holders(scene):
    """Object → names of the collections that it is in. Asking each for its users_collection would take long."""
    found = {}
    for one in (scene.collection, *bpy.data.collections):
        for thing in one.objects:
            found.setdefault(thing, []).append(one.name)
    return found


def _object(thing, holders, geometry):
    told = {
        "name": thing.name,
        "type": thing.type,
        "data": thing.data.name if thing.data else None,
        "collections": holders.get(thing, []),
        "parent": thing.parent.name if thing.parent else None,
        "is_root": bool(thing.get("is_object_root", False)),
        "contact_with": _names(thing.get("contact_with")),
        "modifiers": [_modifier(one) for one in thing.modifiers],
        "constraints": [_constraint(one) for one in thing.constraints],
        "rigid_body": _rigid_body(thing),
        "keys": _keys(thing),
        "animated_shape_keys": _has_animated_shapes(thing),
        "drivers": len(thing.animation_data.drivers) if thing.animation_data else 0,
        "driven": sorted(_driven(thing)),
    }
    field = thing.field
    if field is not None and field.type != "NONE":
        told["force_field"] = field.type
    if thing.type == "LIGHT":
        told.update(light=thing.data.type, energy=_number(thing.data.energy))
    return told | geometry.of(thing)


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
            one
            for name in ("object", "target", "mirror_object", "auxiliary_target")
            if isinstance(one := getattr(modifier, name, None), bpy.types.Object)
        ),
        None,
    )
    told = {"name": modifier.name, "type": modifier.type, "on": bool(modifier.show_render)}
    if modifier.type == "FLUID":
        told["type"] = f"FLUID_{modifier.fluid_type}"
    if target is not None:
        told["target"] = target.name
    return told


def _constraint(constraint):
    target = getattr(constraint, "target", None)
    if target is None:  # an Armature constraint has several
        target = next((one.target for one in getattr(constraint, "targets", ()) if one.target), None)
    return {
        "type": constraint.type,
        "on": not constraint.mute and constraint.influence > 0,
        "target": target.name if target else None,
    }


def _rigid_body(thing):
    body = thing.rigid_body
    if body is None:
        return None
    # A body that is let go in the course of the timeline is the solver's then.
    switched = any(curve.data_path == "rigid_body.kinematic" and _varies(curve) for curve in curves_of(thing))
    return {
        "active": body.type == "ACTIVE",
        "kinematic": bool(body.kinematic) and not switched,
        "enabled": bool(body.enabled),
    }


def curves_of(data):
    """The f-curves that animate a data-block: of its slot in a layered action, or of an action of old."""
    animation = getattr(data, "animation_data", None)
    action = animation.action if animation else None
    if action is None:
        return []
    if hasattr(action, "fcurves"):
        return list(action.fcurves)
    slot = animation.action_slot
    if slot is None:
        return []
    return [
        curve
        for layer in action.layers
        for strip in layer.strips
        for bag in strip.channelbags
        if bag.slot_handle == slot.handle
        for curve in bag.fcurves
    ]


def _moving_curves(data):
    """The f-curves that change something over time: of the action, and of what is played in NLA tracks."""
    animation = getattr(data, "animation_data", None)
    strips = (
        [strip for track in animation.nla_tracks if not track.mute for strip in track.strips]
        if animation
        else []
    )
    played = [
        curve
        for strip in strips
        if not strip.mute
        for curve in curves_of(SimpleNamespace(animation_data=strip))
    ]
    return [curve for curve in (*curves_of(data), *played) if not curve.mute and _varies(curve)]


def _varies(curve):
    if len(curve.modifiers) or len(curve.sampled_points):
        return True
    values = {point.co[1] for point in curve.keyframe_points}
    return len(values) > 1


def _keys(thing):
    """Channel → the most keys that one of its curves has; of curves that may move it."""
    found = {}
    for curve in _moving_curves(thing):
        if not curve.data_path.startswith(_LOOKS):
            channel = curve.data_path if curve.data_path in _CHANNELS else "other"
            count = max(len(curve.keyframe_points), len(curve.sampled_points))
            found[channel] = max(found.get(channel, 1), count)
    return found


def _driven(thing):
    """Channels of its own place, rotation and size that drivers set."""
    drivers = thing.animation_data.drivers if thing.animation_data else ()
    return {driver.data_path for driver in drivers if driver.data_path in _CHANNELS}


def _has_animated_shapes(thing):
    shapes = getattr(thing.data, "shape_keys", None)
    if shapes is None:
        return False
    drivers = len(shapes.animation_data.drivers) if shapes.animation_data else 0
    return bool(drivers or _moving_curves(shapes))


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
        "missing": cache.missing if cache.baked else 0,
        "on": bool(cache.simulated),
    }


def _world_light(world):
    """How strongly the world shines: the brightest background of its nodes, or its plain colour."""
    tree = world.node_tree if getattr(world, "use_nodes", True) else None
    return max(_vector(world.color)) if tree is None else _brightest(tree, set())


def _brightest(tree, seen):
    """The strength of the brightest node that shines, in a tree and those that it calls."""
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
