# SPDX-License-Identifier: GPL-3.0-or-later
"""Materials simplified to one colour or one image, read from their nodes, for engines that do not run nodes."""

import math

from mathutils import Matrix

from .shader_values import ShaderReader, clamped, interpolated, link_into

CLAY = (0.62, 0.61, 0.59)  # colour of objects without a material
_CLEAR = 0.3  # alpha of transparent materials, which are to stay visible
_INVISIBLE = 0.05


class PreviewMaterial:
    """``rgb`` (scene-linear), ``alpha``, ``roughness``; ``image`` with the name of its ``uv_map`` ("" for the
    active one) and a ``mapping`` (a matrix or None); ``attribute``: the name of the colour attribute that ``rgb`` comes
    from ("" for the active one), or None."""

    def __init__(self, rgb=CLAY, alpha=1.0, roughness=0.6, image=None):
        self.rgb, self.alpha, self.roughness = tuple(rgb), alpha, roughness
        self.image, self.uv_map, self.mapping = image, "", None
        self.attribute = None

    def mixed(self, other, share):
        """A mixture of this one (0) and another (1), with the image of the larger share."""
        major = other if share > 0.5 else self
        mixture = PreviewMaterial(
            interpolated(self.rgb, other.rgb, share),
            self.alpha + (other.alpha - self.alpha) * share,
            self.roughness + (other.roughness - self.roughness) * share,
        )
        mixture.image, mixture.uv_map, mixture.mapping = major.image, major.uv_map, major.mapping
        mixture.attribute = major.attribute
        return mixture


def surface_of(material, object_colour, averages):
    """The preview material for a material (or None) on an object of that colour. ``averages``: a cache, kept by the
    caller."""
    if material is None:
        return PreviewMaterial()
    if getattr(material, "grease_pencil", None) is not None:
        ink = material.grease_pencil.color
        return PreviewMaterial(ink[:3], ink[3])
    tree = material.node_tree if material.use_nodes else None
    output = tree.get_output_node("ALL") if tree is not None else None
    if output is None:
        return PreviewMaterial(material.diffuse_color[:3], material.diffuse_color[3], material.roughness)
    surface = _Shaders(ShaderReader(object_colour, averages)).of(output)
    surface.rgb = tuple(map(clamped, surface.rgb))
    surface.alpha, surface.roughness = clamped(surface.alpha), clamped(surface.roughness)
    return surface


class _Shaders:
    """Reads the shaders of a tree."""

    def __init__(self, reader):
        self._reader = reader

    def of(self, output):
        """The preview material for an output node."""
        surface, volume = output.inputs["Surface"], output.inputs["Volume"]
        if link_into(surface):
            return self._shader(surface) or PreviewMaterial()
        if link_into(volume):
            return self._reader.follow(volume, self._volume) or PreviewMaterial(alpha=_CLEAR)
        return PreviewMaterial((0.0, 0.0, 0.0))

    def _shader(self, socket):
        return self._reader.follow(socket, self._read)

    def _read(self, node, _out):
        kind = node.bl_idname.removeprefix("ShaderNode")
        special = {
            "MixShader": self._mix,
            "AddShader": self._add,
            "BsdfPrincipled": self._principled,
            "BsdfTransparent": lambda node: PreviewMaterial(self._reader.colour(node.inputs["Color"]), 0.0),
            "BsdfGlass": self._glass,
            "BsdfRefraction": self._glass,
            "Emission": self._emission,
            "Holdout": lambda _node: PreviewMaterial((0.0, 0.0, 0.0)),
        }
        if kind in special:
            return special[kind](node)
        name = next((name for name in ("Color", "Base Color") if node.inputs.get(name) is not None), None)
        if name is None:
            return None
        surface = self._coloured(node.inputs[name])
        surface.roughness = self._reader.named(node, "Roughness", 0.6)
        return surface

    def _volume(self, node, _out):
        return (
            PreviewMaterial(self._reader.colour(node.inputs["Color"]), _CLEAR)
            if node.inputs.get("Color")
            else None
        )

    def _mix(self, node):
        first, second = self._shader(node.inputs[1]), self._shader(node.inputs[2])
        if first is None or second is None:
            return first or second
        share = clamped(self._reader.number(node.inputs[0]))
        if min(first.alpha, second.alpha) > _INVISIBLE:
            return first.mixed(second, share)
        # One part is transparent: a texture as factor cuts holes, a number makes everything thinner.
        visible, part = (second, share) if first.alpha <= _INVISIBLE else (first, 1 - share)
        if link_into(node.inputs[0]) is None:
            visible.alpha *= part
        return visible

    def _add(self, node):
        first, second = self._shader(node.inputs[0]), self._shader(node.inputs[1])
        if first is None or second is None:
            return first or second
        both = first.mixed(second, 0.5)
        both.rgb, both.alpha = (
            tuple(map(sum, zip(first.rgb, second.rgb, strict=True))),
            max(first.alpha, second.alpha),
        )
        return both

    def _glass(self, node):
        return PreviewMaterial(
            self._reader.colour(node.inputs["Color"]), _CLEAR, self._reader.named(node, "Roughness", 0.0)
        )

    def _emission(self, node):
        return _emitting(self._coloured(node.inputs["Color"]), self._reader.named(node, "Strength", 1.0))

    def _principled(self, node):
        named = self._reader.named
        surface = self._coloured(node.inputs["Base Color"])
        surface.roughness = named(node, "Roughness")
        clear = named(node, "Transmission Weight", named(node, "Transmission", 0.0))
        surface.alpha = 1 - (1 - _CLEAR) * clamped(clear) * (1 - clamped(named(node, "Metallic", 0.0)))
        alpha = node.inputs.get("Alpha")
        if alpha is not None and link_into(alpha) is None:  # a texture cuts holes
            surface.alpha *= clamped(alpha.default_value)
        glow = node.inputs.get("Emission Color") or node.inputs.get("Emission")
        strength = named(node, "Emission Strength", 1.0) if glow else 0.0
        light = self._reader.colour(glow) if strength > 0 else (0.0, 0.0, 0.0)
        if max(light) * strength > 0.02:
            surface = surface.mixed(
                _emitting(PreviewMaterial(light), strength), clamped(max(light) * strength)
            )
        return surface

    def _coloured(self, socket):
        """A preview material with the colour of an input, and the image behind it."""
        reader = self._reader
        reader.attribute = None
        surface = PreviewMaterial(reader.colour(socket))
        surface.attribute = reader.attribute
        source = reader.source(socket)
        if source is not None and source.bl_idname == "ShaderNodeTexImage" and _is_flat_picture(source):
            mapping = _coordinates(source.inputs["Vector"])
            if mapping is not None:
                surface.image = source.image
                surface.uv_map, surface.mapping = mapping
        return surface


def _emitting(surface, strength):
    """An emitting material: as bright as its colour can be."""
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
    """(name of the UV map, matrix or None) of a vector input; None if its coordinates come from elsewhere."""
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
