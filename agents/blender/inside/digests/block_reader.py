# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads a data-block with everything in it, part by part, into digests."""

import functools
import hashlib
import re
from array import array

import bpy

from ..blend.bake_tag import BAKE_INPUTS
from ..blend.fcurves import played_curves
from .block_parts import CACHES, CUSTOM, extra_parts_of, names_of, part_of, reading_plan_of, rest_of
from .file_contents import contents_of_image, contents_of_path

_MANY = 64  # elements; from here on, they are read property by property
_ELEMENTS = 8  # from here on, if they have no pointers
_VALUES = frozenset({"VALUE", "ARRAY", "FLAGS"})
_BY_NAME = frozenset({"objects", "children", "nodes", "attributes"})  # their order has no meaning
_PROPERTY = re.compile(r"(?:(.*)\.)?(\w+)", re.DOTALL)
_CUSTOM_PROPERTY = re.compile(r'(.*)\["((?:[^"\\]|\\.)*)"\]', re.DOTALL)
_ANIMATED = "animated"
_MESH = (
    ("vertices", "co", "f", 3),
    ("edges", "vertices", "i", 2),
    ("loops", "vertex_index", "i", 1),
    ("polygons", "loop_start", "i", 1),
    ("polygons", "material_index", "i", 1),
)


def is_id(value):
    """Whether it is a data-block."""
    return isinstance(value, bpy.types.ID)


def key_of(block):
    """``Object Cube``: the kind of a data-block, as bpy.data knows kinds, and its full name."""
    return f"{_kind_of(type(block))} {block.name_full}"


@functools.cache
def _kind_of(kind):
    rna = kind.bl_rna
    while rna.base is not None and rna.base.identifier != "ID":
        rna = rna.base
    return rna.identifier


_known_plans = {}


def _plan_of(struct, kind, *, pictures):
    """As reading_plan_of, which takes long; what a type had is used again unless properties were registered since."""
    properties = struct.bl_rna.properties
    registered = (len(properties), properties[-1].identifier, properties[-1].type)  # new ones come last
    known = _known_plans.get((kind, pictures))
    if known is None or known[0] != registered:
        known = _known_plans[kind, pictures] = registered, reading_plan_of(struct, pictures=pictures)
    return known[1]


class BlockReader:
    """Reads one data-block. Within a part, a struct is referred to by the number that it got when it was met first."""

    def __init__(self, block, plans, *, pictures):
        """``plans`` is shared between readers. ``pictures``: read only what renders depend on."""
        self._block = block
        self._plans = plans
        self._pictures = pictures
        self._animated = {}
        self._animated_types = set()
        self._cache_properties = []
        self.has_files = False  # whether what was read depends on files that others may write
        self._begin()

    def read(self):
        """{part: (digest, the data-blocks that this part points to)}."""
        block, digests = self._block, {}
        self._note_animation(block)
        rest, members = self._plans_by_part(block)
        for part, plan in members.items():
            self._begin()
            self._feed(*self._values(block, plan))
            if part == rest:
                self._feed(type(block).__name__)
                self._feed_special(block)
            digests[part] = self._finish_part()
        for part, content in extra_parts_of(block).items():
            self._begin()
            self._feed(content)
            digests[part] = self._finish_part()
        self._begin()
        if custom := list(self._custom(block)):
            self._feed(*custom)
            digests[CUSTOM] = self._finish_part()
        if self._cache_properties:
            self._begin()
            for struct, entry in self._cache_properties:
                self._feed(*self._values(struct, (entry,), late=True))
            digests[CACHES] = self._finish_part()
        return digests

    def struct_digest(self, structs):
        """The digest of some structs of the data-block, or of the block as one, apart from their caches."""
        self._note_animation(self._block)
        self._begin()
        self._numbers.clear()
        for struct in structs:
            self._number(struct)
        return self._finish_part()[0]

    def _begin(self):
        self._hash = hashlib.blake2b(digest_size=12)
        self._numbers = {(type(self._block), self._block.as_pointer()): 0}
        self._unread = []
        self._reached = []

    def _finish_part(self):
        while self._unread:
            struct = self._unread.pop()
            self._note_animation(struct)
            self._feed(type(struct).__name__)
            self._feed(*self._values(struct, self._plan(struct)))
            if hasattr(struct, "keys"):
                self._feed(*self._custom(struct))
            self._feed_special(struct)
        return self._hash.hexdigest(), self._reached

    def _feed(self, *parts):
        self._hash.update(repr(parts).encode("utf-8", "replace"))

    def _number(self, struct):
        key = (type(struct), struct.as_pointer())
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers[key] = len(self._numbers)
            self._unread.append(struct)
        return number

    def _plan(self, struct):
        kind = type(struct)
        plan = self._plans.get(kind)
        if plan is None:
            plan = self._plans[kind] = _plan_of(struct, kind, pictures=self._pictures)
        return plan

    def _plans_by_part(self, block):
        """(the part for properties without one of their own, {part: how to read its properties})."""
        known = self._plans.get((type(block), "parts"))
        if known is None:
            members = {}
            for entry in self._plan(block):
                members.setdefault(part_of(block, entry[0]), []).append(entry)
            known = self._plans[type(block), "parts"] = rest_of(block), members
        return known

    # What keyframes and drivers set, which depends on the frame

    def _note_animation(self, struct):
        """Remembers the properties of ``struct`` that animation sets: they are not read."""
        animation = getattr(struct, "animation_data", None)
        if animation is not None:
            for curve in (*played_curves(struct), *animation.drivers):
                if not curve.mute:
                    self._note_animated_property(struct, curve.data_path, curve.array_index)
        if isinstance(struct, bpy.types.Scene) and any(marker.camera for marker in struct.timeline_markers):
            self._note_animated_property(struct, "camera", 0)

    def _note_animated_property(self, struct, path, index):
        match = _PROPERTY.fullmatch(path) or _CUSTOM_PROPERTY.fullmatch(path)
        if match is None:
            return
        try:
            owner = struct.path_resolve(match[1]) if match[1] else struct
            keys = [(owner.as_pointer(), name) for name in names_of(owner, match[2])]
        except (ValueError, AttributeError):
            return
        for key in keys:
            self._animated.setdefault(key, set()).add(index)
        self._animated_types.add(type(owner).__name__)

    def _without_animated(self, struct, name, value):
        """The value, with a placeholder for it, or for items of an array, that animation sets."""
        indices = self._animated.get((struct.as_pointer(), name)) if self._animated else None
        if indices is None:
            return value
        if isinstance(value, list):
            return [_ANIMATED if at in indices else item for at, item in enumerate(value)]
        return _ANIMATED

    # Properties

    def _values(self, struct, plan, *, late=False):
        for entry in plan:
            name, how, is_cache = entry
            if is_cache and not late:
                self._cache_properties.append((struct, entry))
                continue
            try:
                value = getattr(struct, name)
            except (AttributeError, RuntimeError, UnicodeDecodeError):
                continue
            if how == "COLLECTION":
                yield from self._elements(name, value)
            elif how == "PATH":
                self.has_files |= bool(value)
                yield contents_of_path(value, self._block)
            elif how == "POINTER":
                yield self._without_animated(struct, name, self._reference(value))
            else:
                content = _flat(value) if how == "ARRAY" else sorted(value) if how == "FLAGS" else value
                yield self._without_animated(struct, name, content)

    def _reference(self, value):
        if value is None:
            return None
        if is_id(value) and not getattr(value, "is_embedded_data", False):
            if value is not self._block:
                self._reached.append(value)
            return key_of(value)
        return self._number(value)

    def _elements(self, name, items):
        count = len(items)
        if count >= _ELEMENTS and self._columns(items, count):
            return
        listed = list(items)
        if name in _BY_NAME and listed and hasattr(listed[0], "name"):
            listed.sort(key=lambda item: item.name_full if is_id(item) else item.name)
        if name == "attributes":  # those with a dot are Blender's own: selections, and what is read elsewhere
            listed = [item for item in listed if not item.name.startswith(".")]
        yield len(listed)
        for item in listed:
            yield self._reference(item)

    def _columns(self, items, count):
        """Feeds many simple elements property by property; returns whether they were simple."""
        first = items[0]
        if first is None or is_id(first) or type(first).__name__ in self._animated_types:
            return False
        plan = self._plan(first)
        plain = (count >= _MANY or _plain(first)) and all(how in _VALUES for _, how, _ in plan)
        if not plan or not plain:
            return False
        self._feed(count, *(_column(items, first, name, how) for name, how, _ in plan))
        return True

    def _custom(self, struct):
        try:
            items = sorted(struct.items())
        except (TypeError, AttributeError):
            return
        for key, value in items:
            if key == BAKE_INPUTS:  # the tools' own, of what other properties hold
                continue
            yield key
            if is_id(value):
                content = self._reference(value)
            elif hasattr(value, "to_dict"):
                content = value.to_dict()
            else:
                content = value.to_list() if hasattr(value, "to_list") else value
            yield self._without_animated(struct, key, content)

    def _feed_special(self, struct):
        """Feeds content that no property holds."""
        if isinstance(struct, bpy.types.Mesh):
            for name, member, code, wide in _MESH:
                items = getattr(struct, name)
                self._hash.update(_numbers(items.foreach_get, (member,), code, len(items) * wide))
            self._feed([(layer.name, layer.active_render) for layer in struct.uv_layers])
        elif isinstance(struct, bpy.types.Image):
            self.has_files = True
            self._feed(contents_of_image(struct))
            if struct.is_dirty:
                self._hash.update(_numbers(struct.pixels.foreach_get, (), "f", len(struct.pixels)))
        elif getattr(struct, "packed_file", None) is not None:  # a sound, a font, a volume
            self._feed(hashlib.blake2b(struct.packed_file.data).digest())


def _plain(struct):
    return not any(
        prop.type in {"POINTER", "COLLECTION"} and prop.identifier != "rna_type"
        for prop in struct.bl_rna.properties
    )


def _flat(value):
    return [tuple(row) if hasattr(row, "__len__") else row for row in value]


def _column(items, first, name, how):
    """One property of all elements."""
    prop = first.bl_rna.properties[name]
    code = {"BOOLEAN": "b", "INT": "i", "FLOAT": "f"}.get(prop.type)
    if code is None:
        return [
            sorted(value) if how == "FLAGS" else value for value in (getattr(item, name) for item in items)
        ]
    wide = prop.array_length if how == "ARRAY" else 1
    return hashlib.blake2b(_numbers(items.foreach_get, (name,), code, len(items) * wide)).digest()


def _numbers(get, arguments, code, count):
    """What ``foreach_get`` yields, as bytes."""
    taken = array(code, bytes(array(code).itemsize * count))
    if count:
        get(*arguments, taken)
    return taken.tobytes()
