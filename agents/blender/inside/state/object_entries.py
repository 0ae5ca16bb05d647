# SPDX-License-Identifier: GPL-3.0-or-later
"""Collections and objects in a readout: the tree, transforms, extents, data, tags."""

import math

from mathutils import Matrix

from ..blend.protocol_tags import TAGS
from .modifier_stacks import constraints_of, modifiers_of
from .rna_values import custom_properties, number, numbers, text, to_json

_FULL = "full"
_DEEPEST = 60  # collections within collections


def tags_of(block):
    """The protocol's properties of a scene, collection or object, as data."""
    keys = set(block.keys())
    return {tag: to_json(block[tag]) for tag in TAGS if tag in keys} if keys else {}


class SceneObjects:
    """Every object of a scene once, in the outliner's order, and the names of its collections."""

    def __init__(self, scene):
        self.collections = {}
        objects, seen, waiting = {}, set(), [scene.collection]
        while waiting:
            collection = waiting.pop()
            if collection.name_full in seen:
                continue
            seen.add(collection.name_full)
            for obj in collection.objects:
                objects.setdefault(obj.name_full, obj)
                self.collections.setdefault(obj.name_full, []).append(text(collection.name))
            waiting.extend(reversed(collection.children))
        self.objects = list(objects.values())


def tree_of(scene, view_layer, chosen):
    """The collections of a scene in order: one entry a collection, with ``depth`` (0: the scene's own).

    ``chosen``: the objects to list; None for all. Collections without any of them are left out. A collection that was
    listed before is marked ``again``, without its children; one that is too deep is marked ``cut``.
    """
    tree = _Tree(None if chosen is None else {obj.name_full for obj in chosen})
    tree.grow(scene.collection, view_layer.layer_collection if view_layer is not None else None, 0)
    return tree.entries


class _Tree:
    """Collects the entries of ``tree_of``. ``names``: of the objects to list; None for all."""

    def __init__(self, names):
        self.entries = []
        self._names = names
        self._seen = set()

    def grow(self, collection, layer, depth):
        """Adds a collection and what is below it; returns whether any object to list is in it."""
        if collection.name_full in self._seen or depth > _DEEPEST:
            word = "again" if collection.name_full in self._seen else "cut"
            self.entries.append({"name": text(collection.name), "depth": depth, word: True})
            return self._names is None
        self._seen.add(collection.name_full)
        place = len(self.entries)
        entry = self._entry(collection, layer, depth)
        self.entries.append(entry)
        wanted = self._names is None or "objects" in entry
        layers = {} if layer is None else {below.collection.name_full: below for below in layer.children}
        for child in collection.children:
            wanted |= self.grow(child, layers.get(child.name_full), depth + 1)
        if not wanted:
            del self.entries[place:]
        return wanted

    def _entry(self, collection, layer, depth):
        entry = {"name": text(collection.name), "depth": depth}
        if tags := tags_of(collection):
            entry["tags"] = tags
        own = [obj for obj in collection.objects if self._names is None or obj.name_full in self._names]
        if own:
            counts = {}
            for obj in own:
                counts[obj.type] = counts.get(obj.type, 0) + 1
            entry["objects"] = counts
            entry["names"] = [text(obj.name) for obj in own]
        hidden = [word for word in ("viewport", "render") if getattr(collection, f"hide_{word}")]
        if layer is not None and (layer.exclude or layer.hide_viewport):
            hidden.append("excluded" if layer.exclude else "layer")
        if hidden:
            entry["hidden"] = hidden
        if collection.library is not None:
            entry["linked"] = text(collection.library.filepath)
        return entry


def object_facts(obj, collections, extents, visible, detail):
    """An object as data; rotation in degrees (XYZ), lengths in units of the scene.

    ``collections``: names of its collections; ``visible``: full names of what the view layer shows.
    """
    entry = {"name": text(obj.name), "type": obj.type, "in": collections[:4]}
    if obj.parent is not None:
        entry["parent"] = text(obj.parent.name)
        if obj.parent_type != "OBJECT":
            entry["parent_type"] = f"{obj.parent_type} {text(obj.parent_bone)}".strip()
    evaluated = extents.evaluated(obj)
    entry.update(_transform((evaluated or obj).matrix_world, obj.scale))
    box, instances = extents.measure(obj, evaluated)
    parts = {
        "tags": tags_of(obj),
        "extent": box.as_dict() if box is not None else None,
        "instances": instances,
        "hidden": _hidden(obj, visible),
    }
    if detail != "summary":
        parts.update(_data(obj, evaluated, detail))
        parts["materials"] = _materials(obj)
        parts["modifiers"] = modifiers_of(obj)
        parts["constraints"] = constraints_of(obj)
    entry.update({name: value for name, value in parts.items() if value})
    if detail != "summary":
        entry.update(_provenance(obj))
    if detail == _FULL:
        entry.update(_more(obj))
    return entry


def _provenance(obj):
    entry = {}
    if obj.instance_type != "NONE":
        source = obj.instance_collection if obj.instance_type == "COLLECTION" else None
        entry["instancing"] = f"{obj.instance_type} {text(source.name)}" if source else obj.instance_type
    if obj.library is not None:
        entry["linked"] = text(obj.library.filepath)
    elif obj.override_library is not None:
        entry["overrides"] = text(getattr(obj.override_library.reference, "name", "?"))
    return entry


def _transform(matrix, own_scale):
    """Place, rotation and scale in the world; what the object mirrors is mirrored along the same axes."""
    place, turn, scale = matrix.decompose()
    signs = [math.copysign(1.0, factor) for factor in own_scale]
    if min(signs) < 0 and (matrix.determinant() < 0) == (math.prod(signs) < 0):
        _, turn, sizes = (matrix @ Matrix.Diagonal((*signs, 1.0))).decompose()
        scale = [sign * size for sign, size in zip(signs, sizes, strict=False)]
    entry = {"location": numbers(place)}
    angles = [math.degrees(angle) for angle in turn.to_euler()]
    if not all(abs(angle) < 1e-3 for angle in angles):
        entry["rotation"] = [_degrees(angle) for angle in angles]
    if not all(abs(factor - 1.0) < 1e-5 for factor in scale):
        entry["scale"] = numbers(scale)
    return entry


def _degrees(angle):
    return number(round(angle, 2) if math.isfinite(angle) else angle)


def _hidden(obj, visible):
    words = [word for word in ("viewport", "render") if getattr(obj, f"hide_{word}")]
    if obj.name_full not in visible and "viewport" not in words:
        words.append("layer")
    return words


def _data(obj, evaluated, detail):
    data = obj.data
    if data is None:
        return {}
    entry = {}
    if data.users > 1:
        entry["shares"] = f"{text(data.name)} with {data.users - 1} more"
    elif detail == _FULL and data.name != obj.name:
        entry["data"] = text(data.name)
    if obj.type == "MESH":
        entry.update(_mesh(data, evaluated.data if evaluated is not None else data, detail))
    elif obj.type == "ARMATURE":
        entry["bones"] = len(data.bones)
    elif obj.type == "FONT":
        entry["text"] = text(data.body)
    elif obj.type in {"CURVE", "SURFACE"}:
        entry["splines"] = len(data.splines)
    if obj.type in {"MESH", "LATTICE"} and len(groups := obj.vertex_groups):
        entry["vertex_groups"] = [text(group.name) for group in groups] if len(groups) <= 8 else len(groups)
    keys = getattr(data, "shape_keys", None)
    if keys is not None:
        entry["shape_keys"] = len(keys.key_blocks)
    return entry


def _mesh(mesh, evaluated, detail):
    entry = {"vertices": len(mesh.vertices) or "no"}
    if len(evaluated.vertices) != len(mesh.vertices):
        entry["evaluated_vertices"] = len(evaluated.vertices) or "none"
    if detail == _FULL:
        entry["faces"] = len(mesh.polygons)
        entry["uv_layers"] = [text(layer.name) for layer in mesh.uv_layers]
    return entry


def _materials(obj):
    names = []
    for slot in obj.material_slots:
        name = text(slot.material.name) if slot.material is not None else None
        if name not in names:
            names.append(name)
        if len(names) > 8:
            names[8] = f"… ({len(obj.material_slots)} slots)"
            break
    return names


def _more(obj):
    """What only a full readout contains."""
    entry = {}
    if obj.rotation_mode != "XYZ":
        entry["rotation_mode"] = obj.rotation_mode
    if any(abs(part) > 1e-6 for part in (*obj.delta_location, *obj.delta_rotation_euler)):
        entry["delta"] = numbers((*obj.delta_location, *obj.delta_rotation_euler))
    locks = [
        f"{word}.{axis}"
        for word in ("location", "rotation", "scale")
        for axis, locked in zip("xyz", getattr(obj, f"lock_{word}"), strict=True)
        if locked
    ]
    if locks:
        entry["locked"] = locks
    if obj.display_type != "TEXTURED":
        entry["display_type"] = obj.display_type
    if obj.pass_index:
        entry["pass_index"] = obj.pass_index
    own = {name: value for name, value in custom_properties(obj).items() if name not in TAGS}
    if own:
        entry["custom"] = to_json(own)
    return entry
