# SPDX-License-Identifier: GPL-3.0-or-later
"""Motion as keys in the file: transforms at every frame, shape keys, objects shown one after another."""

import bpy
import numpy
from mathutils import Matrix

_LINEAR, _CONSTANT = 1, 0


def move(obj, frames, poses):
    """Keys an object's location, rotation and scale at each frame, so that it has these poses (4 × 4)."""
    free(obj)
    parts = [Matrix(pose).decompose() for pose in poses]
    turns = [parts[0][1]]
    for _, turn, _ in parts[1:]:
        turn.make_compatible(turns[-1])
        turns.append(turn)
    obj.rotation_mode = "QUATERNION"
    write(obj, "location", frames, [part[0] for part in parts])
    write(obj, "rotation_quaternion", frames, turns)
    write(obj, "scale", frames, [part[2] for part in parts])


def free(obj):
    """Removes everything else that would move an object."""
    obj.animation_data_clear()
    obj.constraints.clear()
    obj.parent = None
    obj.delta_location, obj.delta_scale = (0, 0, 0), (1, 1, 1)
    obj.delta_rotation_euler, obj.delta_rotation_quaternion = (0, 0, 0), (1, 0, 0, 0)


def reshape(obj, frames, shapes):
    """Stores these shapes (n × 3) as shape keys, played by two keys of the evaluation time."""
    obj.shape_key_add(name="Basis", from_mix=False)
    for number, points in enumerate(shapes):
        key = obj.data.shape_keys.key_blocks[0] if number == 0 else obj.shape_key_add(from_mix=False)
        key.data.foreach_set("co", numpy.ascontiguousarray(points, dtype=numpy.float32).ravel())
        key.interpolation = "KEY_LINEAR"
    keys = obj.data.shape_keys
    keys.use_relative = False
    times = [key.frame for key in keys.key_blocks]
    ends = [frames[0], frames[-1]]
    write(keys, "eval_time", ends, [(times[0],), (times[-1],)])


def show_in_turn(objects, frames):
    """Shows each of these objects only at its frame."""
    for obj, frame in zip(objects, frames, strict=True):
        for path in ("hide_viewport", "hide_render"):
            write(obj, path, [frame - 1, frame, frame + 1], [(1,), (0,), (1,)], _CONSTANT)


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
    """The curves of a data-block's own action, which is made if missing."""
    animated = block.animation_data or block.animation_data_create()
    if animated.action is None:
        action = bpy.data.actions.new(block.name)
        animated.action = action
        animated.action_slot = action.slots.new(block.id_type, block.name)
        action.layers.new("Layer").strips.new(type="KEYFRAME")
    return animated.action.layers[0].strips[0].channelbag(animated.action_slot, ensure=True).fcurves
