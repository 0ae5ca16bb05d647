# SPDX-License-Identifier: GPL-3.0-or-later
"""The extreme values that keyframes and drivers give to settings, read from the file; nothing is evaluated.

Of drivers, those are followed that calculate with numbers of the file, by Blender's simple expressions. Other driven
settings count as they were saved.
"""

import ast
import math
import operator

import bpy
import numpy

from .geometry_size import TooLarge

_SAMPLES = 64  # of a curve that modifiers change
_MOST_CURVES = 1_000_000  # each counted once per user of its action
_MOST = float(2**53)
_LONGEST_EXPRESSION = 256


class AnimatedSettings:
    """Looks settings up by what they belong to. Raises TooLarge for a file with too many curves."""

    def __init__(self, scene):
        self._frames = numpy.linspace(scene.frame_start, scene.frame_end, _SAMPLES).tolist()
        self._bounds = {}
        self._known = {}
        self._left = _MOST_CURVES
        for blocks in (
            bpy.data.objects,
            bpy.data.curves,
            bpy.data.metaballs,
            bpy.data.particles,
            bpy.data.node_groups,
        ):
            for block in blocks:
                if block.animation_data is not None:
                    self._read(block, block.animation_data)

    def highest(self, owner, name):
        """The largest value of a number or flag during the clip. ``name`` may be that of a property: ["name"]."""
        return self.highest_of(owner, name, getattr(owner, name))

    def highest_of(self, owner, name, value):
        """The same where the value at rest is known; None stays None."""
        bounds = self._bounds.get((owner.as_pointer(), name))
        return value if bounds is None or value is None else max(value, type(value)(bounds[1]))

    def lowest(self, owner, name):
        """The smallest value."""
        value, bounds = getattr(owner, name), self._bounds.get((owner.as_pointer(), name))
        return value if bounds is None else min(value, type(value)(bounds[0]))

    def _read(self, block, animation):
        for action in _actions(animation):
            if action not in self._known:
                self._known[action] = [(curve.data_path, *self._extremes(curve)) for curve in _curves(action)]
            for path, low, high in self._known[action]:
                self._note(block, path, low, high)
        for curve in animation.drivers:
            values = [
                value
                for frame in self._frames[:: _SAMPLES - 1]
                if (value := _driven(curve, frame)) is not None
            ]
            if values:
                self._note(block, curve.data_path, min(values), max(values))

    def _note(self, block, path, low, high):
        self._left -= 1
        if self._left < 0:
            raise TooLarge("its animation", _MOST_CURVES + 1, "curves or more", _MOST_CURVES)
        # A path names its owner in several ways, by name or by number, so that only the owner itself can be compared.
        place = path.rfind("[") if path.endswith("]") else path.rfind(".")
        owner, name = path[: max(place, 0)], path[place:] if path.endswith("]") else path[place + 1 :]
        try:
            holder = block.path_resolve(owner) if owner else block
            key = holder.as_pointer(), name.replace("'", '"')
        except (ValueError, AttributeError):
            return  # it animates nothing
        low, high = max(-_MOST, min(low, _MOST)), max(-_MOST, min(high, _MOST))
        before = self._bounds.get(key, (low, high))
        self._bounds[key] = min(low, before[0]), max(high, before[1])

    def _extremes(self, curve):
        values = [
            curve.evaluate(frame)
            for frame in (self._frames if curve.modifiers else self._frames[:: _SAMPLES - 1])
        ]
        if count := len(curve.keyframe_points):
            # A curve stays between its keyframes and their handles.
            for name in ("co", "handle_left", "handle_right"):
                flat = numpy.empty(2 * count, dtype=numpy.float32)
                curve.keyframe_points.foreach_get(name, flat)
                values += [float(flat[1::2].min()), float(flat[1::2].max())]
        values = [value for value in values if not math.isnan(value)]
        return min(values, default=0.0), max(values, default=0.0)


def _actions(animation):
    if animation.action is not None:
        yield animation.action
    for track in animation.nla_tracks:
        yield from (strip.action for strip in track.strips if strip.action is not None)


def _curves(action):
    if hasattr(action, "layers"):
        for layer in action.layers:
            for strip in layer.strips:
                for bag in strip.channelbags:
                    yield from bag.fcurves
    else:  # before Blender 4.4
        yield from action.fcurves


# Drivers


def _driven(curve, frame):
    """What a driver gives, None if that is unknown."""
    driver = curve.driver
    names = {variable.name: _variable(variable) for variable in driver.variables}
    values = list(names.values())
    if any(value is None for value in values):
        return None
    if driver.type == "SCRIPTED":
        value = _calculated(driver.expression, {**_NAMES, **names, "frame": frame})
    else:
        value = {"SUM": sum, "MIN": min, "MAX": max}.get(driver.type, _mean)(values) if values else None
    if value is None or math.isnan(value):
        return None
    value = max(-_MOST, min(value, _MOST))
    return curve.evaluate(value) if len(curve.keyframe_points) else value


def _mean(values):
    return sum(values) / len(values)


def _variable(variable):
    target = variable.targets[0] if len(variable.targets) == 1 else None
    if variable.type != "SINGLE_PROP" or target is None or target.id is None or target.id_type == "IMAGE":
        return None  # to ask an image for a number may load it
    try:
        value = target.id.path_resolve(target.data_path)
    except (ValueError, AttributeError):
        return None
    return float(value) if isinstance(value, int | float) else None


def _calculated(expression, names):
    """The value of an expression of numbers and names; None if it has anything else."""
    if len(expression) > _LONGEST_EXPRESSION:
        return None
    try:
        return float(_value(ast.parse(expression.strip(), mode="eval").body, names))
    except (SyntaxError, ValueError, TypeError, KeyError, ArithmeticError, RecursionError, MemoryError):
        return None


def _value(node, names):
    """The value of a part of an expression. Raises KeyError for what is not known."""
    if isinstance(node, ast.Constant):
        return float(node.value)
    if isinstance(node, ast.Name):
        return names[node.id]
    if isinstance(node, ast.UnaryOp) and isinstance(node.op, ast.USub):
        return -_value(node.operand, names)
    if isinstance(node, ast.BinOp):
        return _OPERATIONS[type(node.op)](_value(node.left, names), _value(node.right, names))
    if isinstance(node, ast.Call) and isinstance(node.func, ast.Name):
        return _FUNCTIONS[node.func.id](*(_value(argument, names) for argument in node.args))
    raise KeyError(type(node).__name__)


_NAMES = {"pi": math.pi, "True": 1.0, "False": 0.0}
_OPERATIONS = {
    ast.Add: operator.add,
    ast.Sub: operator.sub,
    ast.Mult: operator.mul,
    ast.Div: operator.truediv,
    ast.Pow: math.pow,
}
_FUNCTIONS = {
    "abs": abs,
    "ceil": math.ceil,
    "floor": math.floor,
    "exp": math.exp,
    "int": int,
    "float": float,
    "max": max,
    "min": min,
    "pow": math.pow,
    "round": round,
    "sqrt": math.sqrt,
}
