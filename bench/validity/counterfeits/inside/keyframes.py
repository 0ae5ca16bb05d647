# SPDX-License-Identifier: GPL-3.0-or-later
"""A film as keys in the file: places and turns at every frame, stored shapes, things shown in turn."""

import bpy
import numpy
from mathutils import Matrix

_LINEAR, _CONSTANT = 1, 0


def move(thing, frames, poses):
    """Keys an object's location, rotation and size at each frame, so that it goes through these poses (4 × 4)."""
    free(thing)
    parts = [Matrix(pose).decompose() for pose in poses]
    turns = [parts[0][1]]
    for _, turn, _ in parts[1:]:
        turn.make_compatible(turns[-1])
        turns.append(turn)
    thing.rotation_mode = "QUATERNION"
    write(thing, "location", frames, [part[0] for part in parts])
    write(thing, "rotation_quaternion", frames, turns)
    write(thing, "scale", frames, [part[2] for part in parts])


def free(thing):
    """Takes off an object whatever else would move it."""
    thing.animation_data_clear()
    thing.constraints.clear()
    thing.parent = None
    thing.delta_location, thing.delta_scale = (0, 0, 0), (1, 1, 1)
    thing.delta_rotation_euler, thing.delta_rotation_quaternion = (0, 0, 0), (1, 0, 0, 0)


def reshape(thing, frames, shapes):
    """Stores these shapes (n × 3) as shape keys, which two keys of time run through."""
    thing.shape_key_add(name="Basis", from_mix=False)
    for number, points in enumerate(shapes):
        key = thing.data.shape_keys.key_blocks[0] if number == 0 else thing.shape_key_add(from_mix=False)
        key.data.foreach_set("co", numpy.ascontiguousarray(points, dtype=numpy.float32).ravel())
        key.interpolation = "KEY_LINEAR"
    keys = thing.data.shape_keys
    keys.use_relative = False
    times = [key.frame for key in keys.key_blocks]
    ends = [frames[0], frames[-1]]
    write(keys, "eval_time", ends, [(times[0],), (times[-1],)])


def show_in_turn(things, frames):
    """Shows each of these objects at its frame alone."""
    for thing, frame in zip(things, frames, strict=True):
        for path in ("hide_viewport", "hide_render"):
            write(thing, path, [frame - 1, frame, frame + 1], [(1,), (0,), (1,)], _CONSTANT)


def write(block, path, frames, values, interpolation=_LINEAR):
    """Keys a property at each of ``frames``; ``values``: a number for each axis."""
    curves = _curves_of(block)
    values = numpy.array([tuple(value) for value in values], dtype=numpy.float32)
    for axis in range(values.shape[1]):
        curve = curves.new(path, index=axis)
        points = curve.keyframe_points
        points.add(len(frames))
        points.foreach_set(
            "co", numpy.stack([numpy.array(frames), values[:, axis]], axis=1).astype("f").ravel()
        )
        points.foreach_set("interpolation", [interpolation] * len(frames))
        curve.update()


def _curves_of(block):
    """The curves of an object's, or other block's, own action."""
    animated = block.animation_data or block.animation_data_create()
    if animated.action is None:
        action = bpy.data.actions.new(block.name)
        animated.action = action
        animated.action_slot = action.slots.new(block.id_type, block.name)
        action.layers.new("Layer").strips.new(type="KEYFRAME")
    return animated.action.layers[0].strips[0].channelbag(animated.action_slot, ensure=True).fcurves
