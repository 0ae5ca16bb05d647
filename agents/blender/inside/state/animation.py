# SPDX-License-Identifier: GPL-3.0-or-later
"""What moves by itself: actions with their channels, NLA, drivers, shape keys."""

from array import array

import bpy

from .rna_values import number, numbers, text

MOST_KEYS = 500_000  # of one readout whose values are looked at
MOST_LISTED = (
    4_000  # drivers, tracks, shape keys or channels of one data-block; ``unlisted`` counts the others
)
# Collections of bpy.data whose data-blocks may be animated, and what each is called here.
_KINDS = {
    "objects": "",
    "meshes": "mesh",
    "curves": "curve",
    "armatures": "armature",
    "lattices": "lattice",
    "metaballs": "metaball",
    "shape_keys": "shape keys",
    "cameras": "camera",
    "lights": "light",
    "materials": "material",
    "worlds": "world",
    "scenes": "scene",
    "particles": "particle settings",
    "node_groups": "node group",
    "hair_curves": "hair curves",
    "pointclouds": "point cloud",
    "volumes": "volume",
    "grease_pencils": "grease pencil",
    "speakers": "speaker",
    "lightprobes": "light probe",
    "cache_files": "cache file",
    "movieclips": "movie clip",
    "masks": "mask",
    "textures": "texture",
    "linestyles": "line style",
}
_WITH_NODES = {"materials", "worlds", "lights", "scenes", "linestyles"}
# Kinds of keyframes, by the number that foreach_get gives.
_INTERPOLATIONS = {}


class _Keys:
    """How many keys may still be looked at one by one."""

    left = MOST_KEYS


def animation_facts(everything, chosen, detail):
    """One entry for each animated data-block, called as the object that it belongs to.

    ``everything``: the scene's objects; ``chosen``: those that are asked for, None for all and what is not theirs.
    """
    wanted = None if chosen is None else _belonging(chosen)
    owners = _owners(everything)
    keys = _Keys()
    for attribute, kind in _KINDS.items():
        for block in getattr(bpy.data, attribute, ()):
            if wanted is not None and block.as_pointer() not in wanted:
                continue
            name = owners.get(block.as_pointer(), block.name)
            if attribute == "shape_keys":
                yield _shape_keys(block, name)
            yield from _of_block(block, name, kind, keys, detail)
            if attribute in _WITH_NODES and (tree := _nodes_of(block)) is not None:
                yield from _of_block(tree, name, f"{kind} nodes", keys, detail)


def _owners(everything):
    """{pointer of data or shape keys: name of the first object that uses them}."""
    found = {}
    for thing in everything:
        data = thing.data
        if data is not None:
            found.setdefault(data.as_pointer(), thing.name)
            keys = getattr(data, "shape_keys", None)
            if keys is not None:
                found.setdefault(keys.as_pointer(), thing.name)
    return found


def unused_actions():
    """Names of actions that nothing plays."""
    return [action.name for action in bpy.data.actions if action.users - action.use_fake_user < 1]


def _nodes_of(block):
    name = "compositing_node_group" if hasattr(block, "compositing_node_group") else "node_tree"
    tree = getattr(block, name, None)
    return tree if tree is not None and tree.is_embedded_data else None


def _belonging(chosen):
    """Pointers of the objects, their data, shape keys, materials and particle settings."""
    found = set()
    for thing in chosen:
        data = thing.data
        blocks = [thing, data, getattr(data, "shape_keys", None)]
        blocks += [slot.material for slot in thing.material_slots]
        blocks += [system.settings for system in thing.particle_systems]
        found.update(block.as_pointer() for block in blocks if block is not None)
    return found


def _of_block(block, name, kind, keys, detail):
    animated = getattr(block, "animation_data", None)
    if animated is None:
        return
    told = {"name": text(name)}
    if kind:
        told["of"] = kind
    if animated.action is not None:
        yield {**told, **_action(animated, keys, detail)}
    if tracks := _listed("nla", animated.nla_tracks, _track):
        yield told | tracks
    if drivers := _listed("drivers", animated.drivers, _driver):
        yield told | drivers


def _listed(key, items, read):
    """{key: what ``read`` tells of each}, of so many as are told; {} where there are none."""
    items = list(items)
    found = {key: [read(item) for item in items[:MOST_LISTED]]} if items else {}
    if len(items) > MOST_LISTED:
        found["unlisted"] = len(items) - MOST_LISTED
    return found


def _action(animated, keys, detail):
    action = animated.action
    told = {"action": text(action.name)}
    slot = getattr(animated, "action_slot", None)
    if slot is not None:
        told["slot"] = text(slot.identifier)
    elif getattr(action, "slots", None):
        told["slot"] = None
    curves = curves_of(action, slot)
    groups = {}
    for curve in curves:
        groups.setdefault(curve.data_path, []).append(curve)
    told["curves"] = len(curves)
    told["keys"] = sum(len(curve.keyframe_points) for curve in curves)
    ranges = [curve.range() for curve in curves if not curve.is_empty]
    if ranges:
        told["range"] = numbers((min(low for low, _ in ranges), max(high for _, high in ranges)))
    told.update(_listed("channels", groups.items(), lambda item: _channel(*item, keys, detail)))
    if animated.action_influence != 1.0:
        told["influence"] = number(animated.action_influence)
    return told


def curves_of(action, slot):
    """The f-curves that an action has for a slot: of its layers (4.4 and later), or its own."""
    if not hasattr(action, "layers"):
        return list(action.fcurves)
    if slot is None:
        return []
    found = []
    for layer in action.layers:
        for strip in layer.strips:
            bag = strip.channelbag(slot) if strip.type == "KEYFRAME" else None
            if bag is not None:
                found.extend(bag.fcurves)
    return found


def _channel(path, curves, keys, detail):
    """The curves of one property: ``axes`` (array indices), ``keys`` in all, ``frames`` and ``values`` from–to."""
    counts = [len(curve.keyframe_points) for curve in curves]
    told = {"path": text(path), "keys": sum(counts)}
    axes = [curve.array_index for curve in curves]
    if axes != [0]:
        told["axes"] = axes[:16]
    held = [curve for curve, count in zip(curves, counts, strict=True) if count]
    if held:
        ends = [curve.range() for curve in held]
        told["frames"] = [number(min(end[0] for end in ends)), number(max(end[1] for end in ends))]
        told.update(_values(held, keys))
    sampled = sum(len(curve.sampled_points) for curve in curves)
    if sampled:
        told["samples"] = sampled
    if any(_dense(curve, count) for curve, count in zip(curves, counts, strict=True)):
        told["every_frame"] = True
    for word, curves_so in (
        ("muted", [curve for curve in curves if curve.mute]),
        ("broken", [curve for curve in curves if not curve.is_valid]),
    ):
        if curves_so:
            told[word] = (
                True if len(curves_so) == len(curves) else [curve.array_index for curve in curves_so][:16]
            )
    modifiers = sorted(
        {modifier.type for curve in curves for modifier in curve.modifiers if not modifier.mute}
    )
    if modifiers:
        told["modifiers"] = modifiers
    if any(curve.extrapolation == "LINEAR" for curve in curves):
        told["extrapolation"] = "LINEAR"
    if detail != "summary":
        told.update(_interpolation(held))
    return told


def _dense(curve, count):
    """Whether it has a key on each frame of its range."""
    if count < 3:
        return False
    first, last = curve.range()
    return last - first <= count - 1


def _values(curves, keys):
    low, high = [], []
    for curve in curves:
        points = curve.keyframe_points
        count = len(points)
        if count > keys.left:
            return {}
        keys.left -= count
        places = array("f", bytes(8 * count))
        points.foreach_get("co", places)
        low.append(min(places[1::2]))
        high.append(max(places[1::2]))
    # A range for each axis tells which way it goes; more than a few are one range.
    if 1 < len(curves) <= 4:
        return {"values": [numbers(pair) for pair in zip(low, high, strict=True)]}
    return {"values": numbers((min(low), max(high)))}


def _interpolation(curves):
    """{"interpolation": …} where it is one and not Blender's usual one."""
    if not _INTERPOLATIONS:
        items = bpy.types.Keyframe.bl_rna.properties["interpolation"].enum_items
        _INTERPOLATIONS.update({item.value: item.identifier for item in items})
    kinds = set()
    for curve in curves:
        points = curve.keyframe_points
        if len(points) > 10_000:
            return {}
        numbers_of = array("i", bytes(4 * len(points)))
        points.foreach_get("interpolation", numbers_of)
        kinds.update(numbers_of)
    names = sorted(_INTERPOLATIONS.get(kind, str(kind)) for kind in kinds)
    return {"interpolation": names} if names and names != ["BEZIER"] else {}


def _track(track):
    strips = [
        {
            "name": text(strip.name),
            "action": text(strip.action.name) if strip.action is not None else None,
            "frames": [number(strip.frame_start), number(strip.frame_end)],
            **({"muted": True} if strip.mute else {}),
        }
        for strip in list(track.strips)[:16]
    ]
    told = {"name": text(track.name), "strips": strips}
    if len(track.strips) > len(strips):
        told["left_out"] = len(track.strips) - len(strips)
    if track.mute:
        told["muted"] = True
    return told


def _driver(curve):
    driver = curve.driver
    told = {"path": text(curve.data_path), "type": driver.type}
    if curve.array_index:
        told["axis"] = curve.array_index
    if driver.type == "SCRIPTED":
        told["expression"] = text(driver.expression)
    variables = [_variable(variable) for variable in list(driver.variables)[:8]]
    if variables:
        told["variables"] = variables
    if not driver.is_valid or not curve.is_valid:
        told["broken"] = True
    if curve.mute:
        told["muted"] = True
    return told


def _variable(variable):
    targets = []
    for target in list(variable.targets)[:4]:
        owner = text(target.id.name) if target.id is not None else "?"
        if variable.type == "SINGLE_PROP":
            targets.append(f"{owner}.{text(target.data_path)}")
        elif variable.type == "CONTEXT_PROP":
            targets.append(f"{target.context_property}.{text(target.data_path)}")
        elif variable.type == "TRANSFORMS":
            bone = f".{text(target.bone_target)}" if target.bone_target else ""
            targets.append(f"{owner}{bone}.{target.transform_type} ({target.transform_space})")
        else:
            targets.append(owner)
    told = {"name": text(variable.name), "targets": targets}
    if variable.type != "SINGLE_PROP":
        told["type"] = variable.type
    return told


def _shape_keys(keys, name):
    told = {"name": text(name), "of": "shape keys"}
    told.update(_listed("blocks", keys.key_blocks, _block))
    if not keys.use_relative:
        told["absolute"] = number(keys.eval_time)
    return told


def _block(block):
    told = {"name": text(block.name), "value": number(block.value)}
    if _widened(block):
        told["range"] = numbers((block.slider_min, block.slider_max))
    if block.mute:
        told["muted"] = True
    if block.vertex_group:
        told["vertex_group"] = text(block.vertex_group)
    return told


def _widened(block):
    return (block.slider_min, block.slider_max) != (0.0, 1.0)
