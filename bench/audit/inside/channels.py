# SPDX-License-Identifier: GPL-3.0-or-later
"""What is animated, and how densely: actions with and without layers, NLA strips, drivers, shape keys, constraints."""

from array import array

from .json_values import called, number, text

MOST_KEYS = 5_000_000  # of a file that are read; further ones are only counted
_SAME = 1e-4  # metres, radians, factors: smaller changes are not motion
_GENERATORS = {"GENERATOR", "FNGENERATOR", "CYCLES", "NOISE"}
_DEFORMING = {"ARMATURE", "LATTICE", "MESH_DEFORM", "SURFACE_DEFORM", "HOOK", "CURVE"}

_keys_read = [0]


def forget():
    """Forgets the counts of the last file; call it after another one is opened."""
    _keys_read[0] = 0


class DrivenProperty:
    """A driven property, whose values at the sample frames show whether it varies; ``told`` is its channel."""

    def __init__(self, block, curve, channel):
        self.block, self.path, self.index, self.channel = block, curve.data_path, curve.array_index, channel
        self.values = []

    def record(self):
        """Records the current value."""
        try:
            value = self.block.path_resolve(self.path)
            value = value[self.index] if hasattr(value, "__getitem__") else value
            self.values.append(float(value))
        except (ValueError, TypeError, IndexError, KeyError):
            return
        if max(self.values) - min(self.values) > _SAME:
            self.channel["varies"] = True


def channels_of(block, frames, watched):
    """The animated properties of a data-block over ``frames`` (first, last), sorted; drivers go to ``watched``."""
    animated = getattr(block, "animation_data", None)
    if animated is None:
        return []
    channels = {}
    if animated.action is not None and animated.action_influence > 0:
        _gather(
            channels, "action", curves_of(animated.action, getattr(animated, "action_slot", None)), frames
        )
    if animated.use_nla:
        for track in animated.nla_tracks:
            for strip in track.strips:
                if not track.mute and not strip.mute and strip.action is not None:
                    curves = curves_of(strip.action, getattr(strip, "action_slot", None))
                    _gather(channels, "nla", curves, None, strip.scale)
    for curve in animated.drivers:
        if not curve.mute:
            _driven(channels, block, curve, watched)
    return [channels[key] for key in sorted(channels)]


def curves_of(action, slot):
    """The f-curves that an action has for a slot: of its layers (Blender 4.4 and later), or its own."""
    if not hasattr(action, "layers"):
        return list(action.fcurves)
    curves = []
    for layer in action.layers if slot is not None else ():
        for strip in layer.strips:
            bag = strip.channelbag(slot) if strip.type == "KEYFRAME" else None
            curves += bag.fcurves if bag is not None else ()
    return curves


def _gather(channels, way, curves, frames, scale=1.0):
    """Adds curves to ``channels``; the curves of one property become one channel, with the keys of the densest."""
    for curve in curves:
        if curve.mute:
            continue
        keys, span, varies = _keys(curve, frames)
        generated = any(modifier.type in _GENERATORS and not modifier.mute for modifier in curve.modifiers)
        key = (curve.data_path, way)
        channel = channels.setdefault(key, _channel(curve.data_path, way))
        if keys > channel["keys"]:
            channel["keys"], channel["span"] = keys, number(span * abs(scale))
        channel["generated"] = channel["generated"] or generated
        channel["varies"] = channel["varies"] or varies or generated


def _channel(path, way):
    return {"path": text(path), "way": way, "keys": 0, "span": 0.0, "generated": False, "varies": False}


def _keys(curve, frames):
    """(keys and samples within ``frames``, frames from the first to the last of them, whether they differ)."""
    places, values = [], []
    for points in (curve.keyframe_points, curve.sampled_points):
        count = len(points)
        _keys_read[0] += count
        if _keys_read[0] > MOST_KEYS:
            low, high = curve.range()
            return count, high - low, True
        flat = array("f", bytes(8 * count))
        points.foreach_get("co", flat)
        places += flat[0::2]
        values += flat[1::2]
    if frames is not None:
        kept = [index for index, place in enumerate(places) if frames[0] - 1 <= place <= frames[1] + 1]
        # Motion towards a key outside the clip is motion; only its density is not counted.
        varies = bool(values) and max(values) - min(values) > _SAME
        places = [places[index] for index in kept]
    else:
        varies = bool(values) and max(values) - min(values) > _SAME
    return len(places), (max(places) - min(places) if places else 0.0), varies


def _driven(channels, block, curve, watched):
    channel = channels.setdefault((curve.data_path, "driver"), _channel(curve.data_path, "driver"))
    channel["generated"] = True
    driver = curve.driver
    if driver.type == "SCRIPTED" and not driver.is_simple_expression:
        # The expression is not run, so its values are unknown.
        channel["varies"] = True
    else:
        watched.append(DrivenProperty(block, curve, channel))


def shapes_of(obj, frames, watched):
    """(number of shape keys of its data, the animated properties of them and of the data's own points)."""
    data = obj.data
    keys = getattr(data, "shape_keys", None)
    channels = []
    if keys is not None:
        channels += channels_of(keys, frames, watched)
    if data is not None and getattr(data, "animation_data", None) is not None:
        own = channels_of(data, frames, watched)
        channels += [
            channel for channel in own if channel["path"].startswith(("vertices[", "splines[", "points["))
        ]
    return (len(keys.key_blocks) if keys is not None else 0), channels


def constraints_of(obj):
    """Its active constraints, each with the objects or files that it takes motion from."""
    rows = []
    for constraint in obj.constraints:
        if constraint.mute or not constraint.enabled or constraint.influence == 0:
            continue
        targets = [constraint.target] if getattr(constraint, "target", None) is not None else []
        targets += [item.target for item in getattr(constraint, "targets", ()) if item.target is not None]
        names = {called(target) for target in targets}
        file = getattr(constraint, "cache_file", None)
        if file is not None:
            names.add(text(file.filepath))
        rows.append({"type": constraint.type, "targets": sorted(names)})
    return rows


def followed(obj, constraints):
    """Names of the objects that its motion may come from."""
    names = {called(obj.parent)} if obj.parent is not None else set()
    for constraint in constraints:
        names.update(constraint["targets"])
    for modifier in obj.modifiers:
        target = getattr(modifier, "object", None) or getattr(modifier, "target", None)
        if modifier.type in _DEFORMING and target is not None:
            names.add(called(target))
    return sorted(names - {called(obj)})
