# SPDX-License-Identifier: GPL-3.0-or-later
"""What a material looks like, in one colour or with one picture: read off its nodes, for engines that run none."""

import math

from mathutils import Matrix

from .shader_values import Reader, between, bounded, link_into

CLAY = (0.62, 0.61, 0.59)  # of what has no material
_CLEAR = 0.3  # alpha of what is seen through, so that it can still be seen
_INVISIBLE = 0.05


class Surface:
    """``rgb`` (scene-linear), ``alpha``, ``roughness``; ``image``, laid on by the UV map of the name ``uv_map`` (""
    for the active one) through ``mapping`` (a matrix or None); ``attribute``: the name of the colour attribute that
    ``rgb`` is to come from ("" for the active one), None if from none."""

    def __init__(self, rgb=CLAY, alpha=1.0, roughness=0.6):
        self.rgb, self.alpha, self.roughness = tuple(rgb), alpha, roughness
        self.image, self.uv_map, self.mapping = None, "", None
        self.attribute = None

    def mixed(self, other, share):
        """Between this one (0) and another (1), with the picture of the larger part."""
        major = other if share > 0.5 else self
        made = Surface(
            between(self.rgb, other.rgb, share),
            self.alpha + (other.alpha - self.alpha) * share,
            self.roughness + (other.roughness - self.roughness) * share,
        )
        made.image, made.uv_map, made.mapping = major.image, major.uv_map, major.mapping
        made.attribute = major.attribute
        return made


def surface_of(material, object_colour, averages):
    """How a material (None: none) looks on an object of that colour. ``averages``: a dict, kept between calls."""
    if material is None:
        return Surface()
    if getattr(material, "grease_pencil", None) is not None:
        ink = material.grease_pencil.color
        return Surface(ink[:3], ink[3])
    tree = material.node_tree if material.use_nodes else None
    output = tree.get_output_node("ALL") if tree is not None else None
    if output is None:
        return Surface(material.diffuse_color[:3], material.diffuse_color[3], material.roughness)
    found = _Shaders(Reader(object_colour, averages)).of(output)
    found.rgb = tuple(map(bounded, found.rgb))
    found.alpha, found.roughness = bounded(found.alpha), bounded(found.roughness)
    return found


class _Shaders:
    """Reads the shaders of a tree."""

    def __init__(self, reader):
        self._reader = reader

    def of(self, output):
        """What a material's output shows."""
        surface, volume = output.inputs["Surface"], output.inputs["Volume"]
        if link_into(surface):
            return self._shader(surface) or Surface()
        if link_into(volume):
            return self._reader.follow(volume, self._volume) or Surface(alpha=_CLEAR)
        return Surface((0.0, 0.0, 0.0))

    def _shader(self, socket):
        return self._reader.follow(socket, self._read)

    def _read(self, node, _out):
        kind = node.bl_idname.removeprefix("ShaderNode")
        special = {
            "MixShader": self._mix,
            "AddShader": self._add,
            "BsdfPrincipled": self._principled,
            "BsdfTransparent": lambda one: Surface(self._reader.colour(one.inputs["Color"]), 0.0),
            "BsdfGlass": self._glass,
            "BsdfRefraction": self._glass,
            "Emission": self._emission,
            "Holdout": lambda _one: Surface((0.0, 0.0, 0.0)),
        }
        if kind in special:
            return special[kind](node)
        name = next((one for one in ("Color", "Base Color") if node.inputs.get(one) is not None), None)
        if name is None:
            return None
        made = self._painted(node.inputs[name])
        made.roughness = self._reader.named(node, "Roughness", 0.6)
        return made

    def _volume(self, node, _out):
        return (
            Surface(self._reader.colour(node.inputs["Color"]), _CLEAR) if node.inputs.get("Color") else None
        )

    def _mix(self, node):
        one, two = self._shader(node.inputs[1]), self._shader(node.inputs[2])
        if one is None or two is None:
            return one or two
        share = bounded(self._reader.number(node.inputs[0]))
        if min(one.alpha, two.alpha) > _INVISIBLE:
            return one.mixed(two, share)
        # A part lets through: by a texture, holes are cut into it; by a number, all of it is thinner.
        shown, part = (two, share) if one.alpha <= _INVISIBLE else (one, 1 - share)
        if link_into(node.inputs[0]) is None:
            shown.alpha *= part
        return shown

    def _add(self, node):
        one, two = self._shader(node.inputs[0]), self._shader(node.inputs[1])
        if one is None or two is None:
            return one or two
        both = one.mixed(two, 0.5)
        both.rgb, both.alpha = tuple(map(sum, zip(one.rgb, two.rgb))), max(one.alpha, two.alpha)  # noqa: B905
        return both

    def _glass(self, node):
        return Surface(
            self._reader.colour(node.inputs["Color"]), _CLEAR, self._reader.named(node, "Roughness", 0.0)
        )

    def _emission(self, node):
        return _lit(self._painted(node.inputs["Color"]), self._reader.named(node, "Strength", 1.0))

    def _principled(self, node):
        named = self._reader.named
        made = self._painted(node.inputs["Base Color"])
        made.roughness = named(node, "Roughness")
        clear = named(node, "Transmission Weight", named(node, "Transmission", 0.0))
        made.alpha = 1 - (1 - _CLEAR) * bounded(clear) * (1 - bounded(named(node, "Metallic", 0.0)))
        alpha = node.inputs.get("Alpha")
        if alpha is not None and link_into(alpha) is None:  # a texture cuts holes
            made.alpha *= bounded(alpha.default_value)
        glow = node.inputs.get("Emission Color") or node.inputs.get("Emission")
        strength = named(node, "Emission Strength", 1.0) if glow else 0.0
        light = self._reader.colour(glow) if strength > 0 else (0.0, 0.0, 0.0)
        if max(light) * strength > 0.02:
            made = made.mixed(_lit(Surface(light), strength), bounded(max(light) * strength))
        return made

    def _painted(self, socket):
        """A surface of the colour of an input, with the picture that comes in through it."""
        reader = self._reader
        reader.attribute = None
        made = Surface(reader.colour(socket))
        made.attribute = reader.attribute
        source = reader.source(socket)
        if source is not None and source.bl_idname == "ShaderNodeTexImage" and _is_flat_picture(source):
            mapping = _coordinates(source.inputs["Vector"])
            if mapping is not None:
                made.image = source.image
                made.uv_map, made.mapping = mapping
        return made


def _lit(surface, strength):
    """What shines: as bright as its colour can be, and no brighter."""
    parts = [part * strength if math.isfinite(part * strength) else 1.0 for part in surface.rgb]
    surface.rgb = tuple(max(part, 0.0) / max(1.0, *parts) for part in parts)
    return surface


def _is_flat_picture(node):
    image = node.image
    return (
        image is not None
        and node.projection == "FLAT"
        and image.source in {"FILE", "GENERATED"}
        and all(image.size)
    )


def _coordinates(vector):
    """(name of the UV map, matrix or None) that a vector input stands for; None if its coordinates are no UV map's."""
    mapping = None
    for _ in range(4):
        link = link_into(vector)
        node = link.from_node if link else None
        kind = node.bl_idname.removeprefix("ShaderNode") if node else ""
        if kind == "UVMap":
            return node.uv_map, mapping
        if not kind or kind == "TexCoord":
            return ("", mapping) if not kind or link.from_socket.name == "UV" else None
        if kind == "Mapping" and mapping is None and node.vector_type == "POINT":
            mapping, vector = _matrix_of(node), node.inputs["Vector"]
        elif kind == "NodeReroute":
            vector = node.inputs[0]
        else:
            return None
    return None


def _matrix_of(node):
    place, turn, size = (node.inputs[name].default_value for name in ("Location", "Rotation", "Scale"))
    return Matrix.Translation(place) @ turn.to_matrix().to_4x4() @ Matrix.Diagonal((*size, 1))
