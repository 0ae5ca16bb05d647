# SPDX-License-Identifier: GPL-3.0-or-later
"""The colour or number that arrives at a socket of a shader tree; a texture counts as its average.

Colours are scene-linear RGB.
"""

import math
from array import array

import bpy
from mathutils import Color

GREY = (0.5, 0.5, 0.5)
_DEEPEST = 40  # nodes in a chain: broken trees may have circles
_SMALL = 1024  # pixels; an image of up to this size squared is read as a whole,
_THUMB = 8  # a larger one is shrunk to this size


class ShaderReader:
    """Reads one tree. ``averages``: of images, by name, a cache shared between trees.

    ``attribute``: the name of the colour attribute that was read last, or None.
    """

    def __init__(self, object_colour, averages):
        self.object_colour = tuple(object_colour)[:3]
        self.averages = averages
        self.attribute = None
        self._groups = ()  # the group nodes around the current node, innermost last
        self._depth = 0

    def colour(self, socket):
        """The colour at an input."""
        if link_into(socket) is None:
            return _rgb(getattr(socket, "default_value", GREY))
        return self.follow(socket, self._colour_of, _rgb) or GREY

    def number(self, socket, otherwise=0.5):
        """The number at an input; ``otherwise`` if there is none."""
        if socket is None:
            return otherwise
        return sum(self.colour(socket)) / 3

    def named(self, node, name, otherwise=0.5):
        """The number at a node's input of that name."""
        return self.number(node.inputs.get(name), otherwise)

    def source(self, socket):
        """The node that an input is linked to."""
        return self.follow(socket, lambda node, _out: node)

    def follow(self, socket, read, value=None):
        """The result of ``read(node, output)`` for what feeds an input, through reroutes, groups and muted nodes.

        ``value`` reads the default of an unlinked input of a group node.
        """
        link = link_into(socket)
        if link is None:
            default = getattr(socket, "default_value", None)
            return value(default) if value is not None and default is not None else None
        if self._depth > _DEEPEST:
            return None
        groups, self._depth = self._groups, self._depth + 1
        try:
            node, out = link.from_node, link.from_socket
            onward, self._groups = self._through(node, out)
            if onward is None:
                return None
            if onward is out:
                return read(node, out)
            return self.follow(onward, read, value)
        finally:
            self._groups, self._depth = groups, self._depth - 1

    def _through(self, node, out):
        """(the input that an output only passes on, the groups around it); the output itself if it is computed."""
        groups = self._groups
        if node.bl_idname == "NodeReroute":
            return node.inputs[0], groups
        if node.mute:
            return next(
                (entry.from_socket for entry in node.internal_links if entry.to_socket == out), None
            ), groups
        if node.bl_idname == "ShaderNodeGroup" and node.node_tree is not None:
            ends = [entry for entry in node.node_tree.nodes if entry.bl_idname == "NodeGroupOutput"]
            ends.sort(key=lambda entry: not entry.is_active_output)
            return (_matching_socket(ends[0].inputs, out) if ends else None), (*groups, node)
        if node.bl_idname == "NodeGroupInput" and groups:
            return _matching_socket(groups[-1].inputs, out), groups[:-1]
        return out, groups

    def _colour_of(self, node, out):
        kind = node.bl_idname.removeprefix("ShaderNode")
        if kind == "ObjectInfo":
            return self.object_colour if out.name == "Color" else GREY
        if kind in {"TexImage", "TexEnvironment"}:
            return self._average(node.image) if node.image is not None else None
        if kind in _KNOWN:
            return _KNOWN[kind](self, node)
        if kind.startswith("Tex"):
            ends = [node.inputs.get(name) for name in ("Color1", "Color2")]
            return interpolated(*map(self.colour, ends), 0.5) if all(ends) and out.name == "Color" else GREY  # pyright: ignore[reportCallIssue]
        # An unknown node is assumed to pass its colour on.
        through = next((entry for entry in node.inputs if entry.type == "RGBA" and entry.enabled), None)
        return self.colour(through) if through is not None else None

    def _average(self, image):
        if image.name_full not in self.averages:
            self.averages[image.name_full] = _average_of(image)
        return self.averages[image.name_full]


def link_into(socket):
    """The valid link into an input; None if there is none."""
    return next((link for link in socket.links if link.is_valid and not link.is_muted), None)


def clamped(value):
    """Between 0 and 1."""
    return min(1.0, max(0.0, value)) if math.isfinite(value) else 0.0


def interpolated(first, second, share):
    """From one colour (0) to another (1)."""
    return tuple(a + (b - a) * share for a, b in zip(first, second, strict=True))


def _matching_socket(sockets, socket):
    return next((other for other in sockets if other.identifier == socket.identifier), None)


def _rgb(value):
    if isinstance(value, (int, float)):
        return (float(value),) * 3
    try:
        parts = tuple(float(part) for part in value)[:3]
    except TypeError:
        return GREY
    return parts if len(parts) == 3 else GREY


def _average_of(image):
    """The average colour of an image; None if it cannot be read."""
    values = _values_of(image)
    channels = image.channels
    if not values or not channels:
        return None
    count = len(values) // channels
    means = [sum(values[at::channels]) / count for at in range(channels)]
    colour = Color(means[:3] if channels >= 3 else means[:1] * 3)
    is_linear = image.is_float or image.colorspace_settings.is_data
    return tuple(colour if is_linear else colour.from_srgb_to_scene_linear())


def _values_of(image):
    """All values of an image, or of a small copy if it is large; () if it cannot be read."""
    if image.size[0] * image.size[1] <= _SMALL**2 or image.is_dirty:
        values = array("f", bytes(4 * len(image.pixels)))
        if values:
            image.pixels.foreach_get(values)
        return values
    small = image.copy()
    try:
        small.scale(_THUMB, _THUMB)
        return array("f", small.pixels)
    except RuntimeError:
        return ()
    finally:
        bpy.data.images.remove(small)


# Nodes


def _attribute(reader, node):
    if getattr(node, "attribute_type", "GEOMETRY") == "GEOMETRY":
        reader.attribute = getattr(node, "layer_name", "") or getattr(node, "attribute_name", "")
    return GREY


def _mix(reader, node):
    factor, first, second = [entry for entry in node.inputs if entry.enabled][:3]
    blend = node.blend_type if getattr(node, "data_type", "RGBA") == "RGBA" else "MIX"
    return _blended(blend, clamped(reader.number(factor)), reader.colour(first), reader.colour(second))


def _blended(blend, share, first, second):
    mixes = {
        "MULTIPLY": lambda a, b: a * b,
        "ADD": lambda a, b: a + b,
        "SUBTRACT": lambda a, b: a - b,
        "SCREEN": lambda a, b: 1 - (1 - a) * (1 - b),
        "DARKEN": min,
        "LIGHTEN": max,
        "DIFFERENCE": lambda a, b: abs(a - b),
        "OVERLAY": lambda a, b: 2 * a * b if a < 0.5 else 1 - 2 * (1 - a) * (1 - b),
        "DIVIDE": lambda a, b: a / b if b else a,
    }
    mix = mixes.get(blend)
    return interpolated(first, tuple(map(mix, first, second)) if mix else second, share)


def _ramp(reader, node):
    source = reader.source(node.inputs[0])
    if source is None or not source.bl_idname.startswith("ShaderNodeTex"):
        return tuple(node.color_ramp.evaluate(clamped(reader.number(node.inputs[0])))[:3])
    # Noise keeps to the middle of its range.
    first, last = (0.3, 0.7) if "Noise" in source.bl_idname else (0.0, 1.0)
    samples = [node.color_ramp.evaluate(first + (last - first) * (at + 0.5) / 16) for at in range(16)]
    return tuple(sum(sample[at] for sample in samples) / 16 for at in range(3))


def _hue_saturation(reader, node):
    before = reader.colour(node.inputs["Color"])
    colour = Color(map(clamped, before))
    hue = (colour.h + reader.named(node, "Hue") + 0.5) % 1.0
    colour.hsv = hue, clamped(colour.s * reader.named(node, "Saturation", 1.0)), colour.v
    share = reader.number(node.inputs.get("Factor") or node.inputs.get("Fac"), 1.0)
    return interpolated(
        before, tuple(part * reader.named(node, "Value", 1.0) for part in colour), clamped(share)
    )


def _invert(reader, node):
    before = reader.colour(node.inputs[1])
    return interpolated(before, tuple(1 - part for part in before), clamped(reader.number(node.inputs[0])))


def _gamma(reader, node):
    power = min(10.0, max(0.0, reader.number(node.inputs[1])))
    return tuple(max(part, 0.0) ** power for part in reader.colour(node.inputs[0]))


def _bright_contrast(reader, node):
    bright, contrast = reader.number(node.inputs[1]), reader.number(node.inputs[2])
    return tuple((1 + contrast) * part + bright - contrast / 2 for part in reader.colour(node.inputs[0]))


def _to_grey(reader, node):
    red, green, blue = reader.colour(node.inputs[0])
    return (0.2126 * red + 0.7152 * green + 0.0722 * blue,) * 3


def _combined(reader, node):
    parts = tuple(reader.number(entry) for entry in node.inputs[:3])
    mode = getattr(node, "mode", "RGB").lower()
    if mode == "rgb":
        return parts
    colour = Color()
    setattr(colour, mode, tuple(map(clamped, parts)))
    return tuple(colour)


def _blackbody(reader, node):
    """Roughly: red at 1,000 K, white at 6,500 K, bluish above."""
    kelvin = reader.number(node.inputs[0])
    warm, cold = clamped((kelvin - 1000) / 5500), clamped((kelvin - 6500) / 10000)
    return (1.0 - 0.5 * cold, 0.25 + 0.75 * warm**0.7 - 0.25 * cold, warm**1.8)


def _math(reader, node):
    first, second = (reader.number(entry) for entry in node.inputs[:2])
    known = {"ADD": first + second, "SUBTRACT": first - second, "MULTIPLY": first * second}
    known.update(MAXIMUM=max(first, second), MINIMUM=min(first, second))
    return (known.get(node.operation, 0.5),) * 3


def _output_value(reader, node):
    del reader
    return _rgb(node.outputs[0].default_value)


_KNOWN = {
    "RGB": _output_value,
    "Value": _output_value,
    "VertexColor": _attribute,
    "Attribute": _attribute,
    "Mix": _mix,
    "MixRGB": _mix,
    "ValToRGB": _ramp,
    "HueSaturation": _hue_saturation,
    "Invert": _invert,
    "Gamma": _gamma,
    "BrightContrast": _bright_contrast,
    "RGBToBW": _to_grey,
    "CombineColor": _combined,
    "CombineRGB": _combined,
    "Blackbody": _blackbody,
    "Math": _math,
    # Weights of glancing angles: small on average.
    "Fresnel": lambda _reader, _node: (0.1,) * 3,
    "LayerWeight": lambda _reader, _node: (0.2,) * 3,
}
