# SPDX-License-Identifier: GPL-3.0-or-later
"""Animation in a readout: actions with their channels, NLA tracks, drivers, shape keys."""

from array import array

import bpy

from ..blend.fcurves import action_curves, curves_by_slot
from ..digests.block_reader import key_of
from .rna_values import number, numbers, text

MOST_KEYS = 500_000  # of one readout whose values are read
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
_FEW_FRAMES = 16  # of a property with keys, up to which each key is told
_FEW_NUMBERS = 120  # of all keys of an action that are told
# Kinds of keyframes, by the number that foreach_get gives.
_INTERPOLATIONS = {}


class _Keys:
    """How many keys of this readout may still be read."""

    left = MOST_KEYS


def animation_facts(everything, chosen, detail):
    """Yields entries for each animated data-block, named after the object that it belongs to.

    ``everything``: the scene's objects; ``chosen``: those to read, None for all and for what belongs to no object.
    """
    wanted = None if chosen is None else _pointers_of(chosen)
    owners = _owners(everything)
    keys = _Keys()
    for attribute, kind in _KINDS.items():
        for block in getattr(bpy.data, attribute, ()):
            if wanted is not None and block.as_pointer() not in wanted:
                continue
            name = owners.get(block.as_pointer(), block.name)
            if attribute == "shape_keys":
                yield _shape_keys(block, name)
            yield from _block_entries(block, name, kind, keys, detail)
            if attribute in _WITH_NODES and (tree := _nodes_of(block)) is not None:
                yield from _block_entries(tree, name, f"{kind} nodes", keys, detail)


def _owners(everything):
    """{pointer of data or shape keys: name of the first object that uses them}."""
    owners = {}
    for obj in everything:
        data = obj.data
        if data is not None:
            owners.setdefault(data.as_pointer(), obj.name)
            keys = getattr(data, "shape_keys", None)
            if keys is not None:
                owners.setdefault(keys.as_pointer(), obj.name)
    return owners


def unused_actions():
    """Names of actions without users."""
    return [action.name for action in bpy.data.actions if action.users - action.use_fake_user < 1]


def _nodes_of(block):
    name = "compositing_node_group" if hasattr(block, "compositing_node_group") else "node_tree"
    tree = getattr(block, name, None)
    return tree if tree is not None and tree.is_embedded_data else None


def _pointers_of(chosen):
    """Pointers of the objects, their data, shape keys, materials and particle settings."""
    pointers = set()
    for obj in chosen:
        data = obj.data
        blocks = [obj, data, getattr(data, "shape_keys", None)]
        blocks += [slot.material for slot in obj.material_slots]
        blocks += [system.settings for system in obj.particle_systems]
        pointers.update(block.as_pointer() for block in blocks if block is not None)
    return pointers


def _block_entries(block, name, kind, keys, detail):
    animated = getattr(block, "animation_data", None)
    if animated is None:
        return
    entry = {"name": text(name)}
    if kind:
        entry["of"] = kind
    if animated.action is not None:
        yield {**entry, **_action(animated, keys, detail)}
    if tracks := _listed("nla", animated.nla_tracks, _track):
        yield entry | tracks
    if drivers := _listed("drivers", animated.drivers, _driver):
        yield entry | drivers


def _listed(key, items, read):
    """{key: entries that ``read`` makes of the items}, ``unlisted``: how many more there are; {} for no items."""
    items = list(items)
    entry = {key: [read(item) for item in items[:MOST_LISTED]]} if items else {}
    if len(items) > MOST_LISTED:
        entry["unlisted"] = len(items) - MOST_LISTED
    return entry


def _action(animated, keys, detail):
    action = animated.action
    entry = {"action": text(action.name)}
    slot = getattr(animated, "action_slot", None)
    if slot is not None:
        entry["slot"] = text(slot.identifier)
    elif getattr(action, "slots", None):
        entry["slot"] = None
    curves = action_curves(animated)
    groups = _by_path(curves)
    entry["curves"] = len(curves)
    entry["keys"] = sum(len(curve.keyframe_points) for curve in curves)
    ranges = [curve.range() for curve in curves if not curve.is_empty]
    if ranges:
        entry["range"] = numbers((min(low for low, _ in ranges), max(high for _, high in ranges)))
    entry.update(_listed("channels", groups.items(), lambda item: _channel(*item, keys, detail)))  # pyright: ignore[reportCallIssue]
    if detail != "summary" and (points := _points(groups)):
        entry["points"] = points
    if animated.action_influence != 1.0:
        entry["influence"] = number(animated.action_influence)
    return entry


def _channel(path, curves, keys, detail):
    """The curves of one property: ``axes`` (array indices), ``keys`` in all, ``frames`` and ``values`` from–to."""
    counts = [len(curve.keyframe_points) for curve in curves]
    entry = {"path": text(path), "keys": sum(counts)}
    axes = [curve.array_index for curve in curves]
    if axes != [0]:
        entry["axes"] = axes[:16]
    held = [curve for curve, count in zip(curves, counts, strict=True) if count]
    if held:
        ends = [curve.range() for curve in held]
        entry["frames"] = [number(min(end[0] for end in ends)), number(max(end[1] for end in ends))]
        entry.update(_values(held, keys))
    sampled = sum(len(curve.sampled_points) for curve in curves)
    if sampled:
        entry["samples"] = sampled
    if any(_is_keyed_on_every_frame(curve, count) for curve, count in zip(curves, counts, strict=True)):
        entry["every_frame"] = True
    for word, affected in (
        ("muted", [curve for curve in curves if curve.mute]),
        ("broken", [curve for curve in curves if not curve.is_valid]),
    ):
        if affected:
            entry[word] = (
                True if len(affected) == len(curves) else [curve.array_index for curve in affected][:16]
            )
    modifiers = sorted(
        {modifier.type for curve in curves for modifier in curve.modifiers if not modifier.mute}
    )
    if modifiers:
        entry["modifiers"] = modifiers
    if any(curve.extrapolation == "LINEAR" for curve in curves):
        entry["extrapolation"] = "LINEAR"
    if detail != "summary":
        entry.update(_interpolation(held))
    return entry


def action_keys():
    """{"Action Swing": {path: [[frame, value of each curve], …]}} of the file's actions, as far as keys are few."""
    told = {}
    for action in bpy.data.actions:
        slots = curves_by_slot(action)
        keys = {
            f"{slot}: {path}" if len(slots) > 1 else path: rows
            for slot, curves in slots
            for path, rows in _points(_by_path(curves)).items()
        }
        if keys:
            told[key_of(action)] = keys
    return told


def _by_path(curves):
    groups = {}
    for curve in curves:
        groups.setdefault(curve.data_path, []).append(curve)
    return groups


def _points(groups):
    """{path: [[frame, value of each curve], …]} of properties with few keys, at the same frames for each curve."""
    told, left = {}, _FEW_NUMBERS
    for path, curves in groups.items():
        if any(not 0 < len(curve.keyframe_points) <= _FEW_FRAMES for curve in curves):
            continue
        if any(_is_keyed_on_every_frame(curve, len(curve.keyframe_points)) for curve in curves):
            continue
        places = [[tuple(key.co) for key in curve.keyframe_points] for curve in curves]
        if len({tuple(frame for frame, _ in keys) for keys in places}) > 1:
            continue
        rows = [numbers((keys[0][0], *(value for _, value in keys))) for keys in zip(*places, strict=True)]
        left -= sum(map(len, rows))
        if left < 0:
            break
        told[text(path)] = rows
    return told


def _is_keyed_on_every_frame(curve, count):
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
    # Few curves have a range each, which shows the direction; many have one range together.
    if 1 < len(curves) <= 4:
        return {"values": [numbers(pair) for pair in zip(low, high, strict=True)]}
    return {"values": numbers((min(low), max(high)))}


def _interpolation(curves):
    """{"interpolation": …}; {} for Blender's default."""
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
    entry = {"name": text(track.name), "strips": strips}
    if len(track.strips) > len(strips):
        entry["left_out"] = len(track.strips) - len(strips)
    if track.mute:
        entry["muted"] = True
    return entry


def _driver(curve):
    driver = curve.driver
    entry = {"path": text(curve.data_path), "type": driver.type}
    if curve.array_index:
        entry["axis"] = curve.array_index
    if driver.type == "SCRIPTED":
        entry["expression"] = text(driver.expression)
    variables = [_variable(variable) for variable in list(driver.variables)[:8]]
    if variables:
        entry["variables"] = variables
    if not driver.is_valid or not curve.is_valid:
        entry["broken"] = True
    if curve.mute:
        entry["muted"] = True
    return entry


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
    entry = {"name": text(variable.name), "targets": targets}
    if variable.type != "SINGLE_PROP":
        entry["type"] = variable.type
    return entry


def _shape_keys(keys, name):
    entry = {"name": text(name), "of": "shape keys"}
    entry.update(_listed("blocks", keys.key_blocks, _block))
    if not keys.use_relative:
        entry["absolute"] = number(keys.eval_time)
    return entry


def _block(block):
    entry = {"name": text(block.name), "value": number(block.value)}
    if _has_own_range(block):
        entry["range"] = numbers((block.slider_min, block.slider_max))
    if block.mute:
        entry["muted"] = True
    if block.vertex_group:
        entry["vertex_group"] = text(block.vertex_group)
    return entry


def _has_own_range(block):
    return (block.slider_min, block.slider_max) != (0.0, 1.0)
