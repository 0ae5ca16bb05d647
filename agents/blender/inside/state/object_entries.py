# SPDX-License-Identifier: GPL-3.0-or-later
"""Collections as a tree, and objects: where they are, how far they reach, what they are made of."""

import math

from .modifier_stacks import constraints_of, modifiers_of
from .rna_values import custom, number, numbers, plain, text

# What the scene protocol writes on collections and objects.
TAGS = (
    "protocol_role",
    "is_object_root",
    "contact_with",
    "deformation_kind",
    "motion_kind",
    "allows_disconnected",
    "strict_grounding",
)
_FULL = "full"
_DEEPEST = 60  # collections within collections


def tags_of(thing):
    """The protocol's properties of a scene, collection or object, as they are written on it."""
    keys = set(thing.keys())
    return {tag: plain(thing[tag]) for tag in TAGS if tag in keys} if keys else {}


class Census:
    """Every object of a scene once, by collection as the outliner has them, and which collections each is in."""

    def __init__(self, scene):
        self.collections = {}
        found, seen, waiting = {}, set(), [scene.collection]
        while waiting:
            collection = waiting.pop()
            if collection.name_full in seen:
                continue
            seen.add(collection.name_full)
            for thing in collection.objects:
                found.setdefault(thing.name_full, thing)
                self.collections.setdefault(thing.name_full, []).append(text(collection.name))
            waiting.extend(reversed(collection.children))
        self.objects = list(found.values())


def tree_of(scene, view_layer, chosen):
    """The collections of a scene in order: one entry a collection, with ``depth`` (0: the scene's own).

    ``chosen``: the objects asked for; None for all. Collections without any of them are left out. A collection that
    has been told before is marked ``again``, and what is below it is not repeated; what lies too deep is ``cut``.
    """
    tree = _Tree(None if chosen is None else {thing.name_full for thing in chosen})
    tree.grow(scene.collection, view_layer.layer_collection if view_layer is not None else None, 0)
    return tree.entries


class _Tree:
    """Collects the entries of ``tree_of``. ``names``: of the objects asked for; None for all."""

    def __init__(self, names):
        self.entries = []
        self._names = names
        self._seen = set()

    def grow(self, collection, layer, depth):
        """Adds a collection and what is below it; returns whether any object asked for is in it."""
        if collection.name_full in self._seen or depth > _DEEPEST:
            word = "again" if collection.name_full in self._seen else "cut"
            self.entries.append({"name": text(collection.name), "depth": depth, word: True})
            return self._names is None
        self._seen.add(collection.name_full)
        place = len(self.entries)
        entry = self._told(collection, layer, depth)
        self.entries.append(entry)
        wanted = self._names is None or "objects" in entry
        layers = {} if layer is None else {below.collection.name_full: below for below in layer.children}
        for child in collection.children:
            wanted |= self.grow(child, layers.get(child.name_full), depth + 1)
        if not wanted:
            del self.entries[place:]
        return wanted

    def _told(self, collection, layer, depth):
        entry = {"name": text(collection.name), "depth": depth}
        if tags := tags_of(collection):
            entry["tags"] = tags
        own = [thing for thing in collection.objects if self._names is None or thing.name_full in self._names]
        if own:
            counts = {}
            for thing in own:
                counts[thing.type] = counts.get(thing.type, 0) + 1
            entry["objects"] = counts
            entry["names"] = [text(thing.name) for thing in own]
        hidden = [word for word in ("viewport", "render") if getattr(collection, f"hide_{word}")]
        if layer is not None and (layer.exclude or layer.hide_viewport):
            hidden.append("excluded" if layer.exclude else "layer")
        if hidden:
            entry["hidden"] = hidden
        if collection.library is not None:
            entry["linked"] = text(collection.library.filepath)
        return entry


def object_facts(thing, collections, extents, visible, detail):
    """An object as data; rotation in degrees (XYZ), lengths in units of the scene.

    ``collections``: names of those that it is in; ``visible``: full names of what the view layer shows.
    """
    told = {"name": text(thing.name), "type": thing.type, "in": collections[:4]}
    if thing.parent is not None:
        told["parent"] = text(thing.parent.name)
        if thing.parent_type != "OBJECT":
            told["parent_type"] = f"{thing.parent_type} {text(thing.parent_bone)}".strip()
    evaluated = extents.evaluated(thing)
    told.update(_transform((evaluated or thing).matrix_world))
    box, instances = extents.measure(thing, evaluated)
    parts = {
        "tags": tags_of(thing),
        "extent": box.told() if box is not None else None,
        "instances": instances,
        "hidden": _hidden(thing, visible),
    }
    if detail != "summary":
        parts.update(_data(thing, evaluated, detail))
        parts["materials"] = _materials(thing)
        parts["modifiers"] = modifiers_of(thing)
        parts["constraints"] = constraints_of(thing)
    told.update({name: value for name, value in parts.items() if value})
    if detail != "summary":
        told.update(_provenance(thing))
    if detail == _FULL:
        told.update(_more(thing))
    return told


def _provenance(thing):
    told = {}
    if thing.instance_type != "NONE":
        source = thing.instance_collection if thing.instance_type == "COLLECTION" else None
        told["instancing"] = f"{thing.instance_type} {text(source.name)}" if source else thing.instance_type
    if thing.library is not None:
        told["linked"] = text(thing.library.filepath)
    elif thing.override_library is not None:
        told["overrides"] = text(getattr(thing.override_library.reference, "name", "?"))
    return told


def _transform(matrix):
    place, turn, scale = matrix.decompose()
    told = {"location": numbers(place)}
    angles = [math.degrees(angle) for angle in turn.to_euler()]
    if not all(abs(angle) < 1e-3 for angle in angles):
        told["rotation"] = [_degrees(angle) for angle in angles]
    if not all(abs(factor - 1.0) < 1e-5 for factor in scale):
        told["scale"] = numbers(scale)
    return told


def _degrees(angle):
    return number(round(angle, 2) if math.isfinite(angle) else angle)


def _hidden(thing, visible):
    words = [word for word in ("viewport", "render") if getattr(thing, f"hide_{word}")]
    if thing.name_full not in visible and "viewport" not in words:
        words.append("layer")
    return words


def _data(thing, evaluated, detail):
    data = thing.data
    if data is None:
        return {}
    told = {}
    if data.users > 1:
        told["shares"] = f"{text(data.name)} with {data.users - 1} more"
    elif detail == _FULL and data.name != thing.name:
        told["data"] = text(data.name)
    if thing.type == "MESH":
        told.update(_mesh(data, evaluated.data if evaluated is not None else data, detail))
    elif thing.type == "ARMATURE":
        told["bones"] = len(data.bones)
    elif thing.type == "FONT":
        told["text"] = text(data.body)
    elif thing.type in {"CURVE", "SURFACE"}:
        told["splines"] = len(data.splines)
    if thing.type in {"MESH", "LATTICE"} and len(groups := thing.vertex_groups):
        told["vertex_groups"] = [text(group.name) for group in groups] if len(groups) <= 8 else len(groups)
    keys = getattr(data, "shape_keys", None)
    if keys is not None:
        told["shape_keys"] = len(keys.key_blocks)
    return told


def _mesh(mesh, evaluated, detail):
    told = {"vertices": len(mesh.vertices) or "no"}
    if len(evaluated.vertices) != len(mesh.vertices):
        told["evaluated_vertices"] = len(evaluated.vertices) or "none"
    if detail == _FULL:
        told["faces"] = len(mesh.polygons)
        told["uv_layers"] = [text(layer.name) for layer in mesh.uv_layers]
    return told


def _materials(thing):
    names = []
    for slot in thing.material_slots:
        name = text(slot.material.name) if slot.material is not None else None
        if name not in names:
            names.append(name)
        if len(names) > 8:
            names[8] = f"… ({len(thing.material_slots)} slots)"
            break
    return names


def _more(thing):
    """What only a full readout tells."""
    told = {}
    if thing.rotation_mode != "XYZ":
        told["rotation_mode"] = thing.rotation_mode
    if any(abs(one) > 1e-6 for one in (*thing.delta_location, *thing.delta_rotation_euler)):
        told["delta"] = numbers((*thing.delta_location, *thing.delta_rotation_euler))
    locks = [
        f"{word}.{axis}"
        for word in ("location", "rotation", "scale")
        for axis, locked in zip("xyz", getattr(thing, f"lock_{word}"), strict=True)
        if locked
    ]
    if locks:
        told["locked"] = locks
    if thing.display_type != "TEXTURED":
        told["display_type"] = thing.display_type
    if thing.pass_index:
        told["pass_index"] = thing.pass_index
    own = {name: value for name, value in custom(thing).items() if name not in TAGS}
    if own:
        told["custom"] = plain(own)
    return told
