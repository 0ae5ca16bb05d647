# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads one data-block with everything in it, part by part, into digests."""

import functools
import hashlib
import re
from array import array

import bpy

from ..measure.scene_facts import curves_of
from .block_parts import CACHES, CUSTOM, part_of, rest_of, settings_of, specials_of
from .file_contents import contents_of_image, contents_of_path

_MANY = 64  # elements; from here on, arrays are read at once
_ELEMENTS = 8  # from here on, if the elements are plain
_VALUES = frozenset({"VALUE", "ARRAY", "FLAGS"})
_BY_NAME = frozenset({"objects", "children", "nodes", "attributes"})  # their order is the file's business
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


def is_id(thing):
    """Whether it is a data-block."""
    return isinstance(thing, bpy.types.ID)


def key_of(block):
    """``Object Cube``: the kind of a data-block, as bpy.data knows kinds, and its full name."""
    return f"{_kind_of(type(block))} {block.name_full}"


@functools.cache
def _kind_of(kind):
    rna = kind.bl_rna
    while rna.base is not None and rna.base.identifier != "ID":
        rna = rna.base
    return rna.identifier


class Reader:
    """Reads one data-block. Within a part, a struct is told by the number under which it was met first."""

    def __init__(self, block, plans, *, pictures):
        """``plans`` is kept between readers. ``pictures``: only what these depend on."""
        self._block = block
        self._plans = plans
        self._pictures = pictures
        self._moving = {}
        self._moving_kinds = set()
        self._later = []
        self._begin()

    def read(self):
        """{part: (digest, the data-blocks that this part points to)}."""
        block, found = self._block, {}
        self._animate(block)
        rest, members = self._members(block)
        for part, plan in members.items():
            self._begin()
            self._feed(*self._values(block, plan))
            if part == rest:
                self._feed(type(block).__name__)
                self._special(block)
            found[part] = self._drained()
        for part, told in specials_of(block).items():
            self._begin()
            self._feed(told)
            found[part] = self._drained()
        self._begin()
        if custom := list(self._custom(block)):
            self._feed(*custom)
            found[CUSTOM] = self._drained()
        if self._later:
            self._begin()
            for thing, entry in self._later:
                self._feed(*self._values(thing, (entry,), late=True))
            found[CACHES] = self._drained()
        return found

    def _begin(self):
        self._hash = hashlib.blake2b(digest_size=12)
        self._numbers = {(type(self._block), self._block.as_pointer()): 0}
        self._waiting = []
        self._reached = []

    def _drained(self):
        while self._waiting:
            thing = self._waiting.pop()
            self._animate(thing)
            self._feed(type(thing).__name__)
            self._feed(*self._values(thing, self._plan(thing)))
            if hasattr(thing, "keys"):
                self._feed(*self._custom(thing))
            self._special(thing)
        return self._hash.hexdigest(), self._reached

    def _feed(self, *parts):
        self._hash.update(repr(parts).encode("utf-8", "replace"))

    def _number(self, thing):
        key = (type(thing), thing.as_pointer())
        number = self._numbers.get(key)
        if number is None:
            number = self._numbers[key] = len(self._numbers)
            self._waiting.append(thing)
        return number

    def _plan(self, thing):
        kind = type(thing)
        plan = self._plans.get(kind)
        if plan is None:
            plan = self._plans[kind] = settings_of(thing, pictures=self._pictures)
        return plan

    def _members(self, block):
        """The part for all that has none of its own, and {part: how to read its properties}."""
        known = self._plans.get((type(block), "parts"))
        if known is None:
            members = {}
            for entry in self._plan(block):
                members.setdefault(part_of(block, entry[0]), []).append(entry)
            known = self._plans[type(block), "parts"] = rest_of(block), members
        return known

    # What keyframes and drivers set depends on the frame

    def _animate(self, thing):
        """Remembers what is not to be read of ``thing``, because its animation sets it."""
        animation = getattr(thing, "animation_data", None)
        if animation is not None:
            strips = [strip for track in animation.nla_tracks if not track.mute for strip in track.strips]
            holders = [thing, *(_Holder(strip) for strip in strips if not strip.mute)]
            for curve in (*(one for holder in holders for one in curves_of(holder)), *animation.drivers):
                if not curve.mute:
                    self._note_moving(thing, curve.data_path, curve.array_index)
        if isinstance(thing, bpy.types.Scene) and any(marker.camera for marker in thing.timeline_markers):
            self._note_moving(thing, "camera", 0)

    def _note_moving(self, thing, path, index):
        found = _PROPERTY.fullmatch(path) or _CUSTOM_PROPERTY.fullmatch(path)
        if found is None:
            return
        try:
            owner = thing.path_resolve(found[1]) if found[1] else thing
            key = (owner.as_pointer(), found[2])
        except (ValueError, AttributeError):
            return
        self._moving.setdefault(key, set()).add(index)
        self._moving_kinds.add(type(owner).__name__)

    def _without_moving(self, thing, name, value):
        """The value, or of an array those of its items, that no animation sets."""
        indices = self._moving.get((thing.as_pointer(), name)) if self._moving else None
        if indices is None:
            return value
        if isinstance(value, list):
            return [_ANIMATED if at in indices else item for at, item in enumerate(value)]
        return _ANIMATED

    # Properties

    def _values(self, thing, plan, *, late=False):
        for entry in plan:
            name, how, is_cache = entry
            if is_cache and not late:
                self._later.append((thing, entry))
                continue
            try:
                value = getattr(thing, name)
            except (AttributeError, RuntimeError, UnicodeDecodeError):
                continue
            if how == "COLLECTION":
                yield from self._elements(name, value)
            elif how == "PATH":
                yield contents_of_path(value, self._block)
            elif how == "POINTER":
                yield self._without_moving(thing, name, self._pointed(value))
            else:
                made = _flat(value) if how == "ARRAY" else sorted(value) if how == "FLAGS" else value
                yield self._without_moving(thing, name, made)

    def _pointed(self, value):
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
            listed.sort(key=lambda one: one.name_full if is_id(one) else one.name)
        if name == "attributes":  # those with a dot are Blender's own: selections, and what is read otherwise
            listed = [one for one in listed if not one.name.startswith(".")]
        yield len(listed)
        for item in listed:
            yield self._pointed(item)

    def _columns(self, items, count):
        """Feeds many plain elements property by property; whether they are such."""
        first = items[0]
        if first is None or is_id(first) or type(first).__name__ in self._moving_kinds:
            return False
        plan = self._plan(first)
        plain = (count >= _MANY or _plain(first)) and all(how in _VALUES for _, how, _ in plan)
        if not plan or not plain:
            return False
        self._feed(count, *(_column(items, first, name, how) for name, how, _ in plan))
        return True

    def _custom(self, thing):
        try:
            items = sorted(thing.items())
        except (TypeError, AttributeError):
            return
        for key, value in items:
            yield key
            if is_id(value):
                made = self._pointed(value)
            elif hasattr(value, "to_dict"):
                made = value.to_dict()
            else:
                made = value.to_list() if hasattr(value, "to_list") else value
            yield self._without_moving(thing, key, made)

    def _special(self, thing):
        """What no property tells."""
        if isinstance(thing, bpy.types.Mesh):
            for name, member, code, wide in _MESH:
                items = getattr(thing, name)
                self._hash.update(_numbers(items.foreach_get, (member,), code, len(items) * wide))
            self._feed([(layer.name, layer.active_render) for layer in thing.uv_layers])
        elif isinstance(thing, bpy.types.Image):
            self._feed(contents_of_image(thing))
            if thing.is_dirty:
                self._hash.update(_numbers(thing.pixels.foreach_get, (), "f", len(thing.pixels)))
        elif getattr(thing, "packed_file", None) is not None:  # a sound, a font, a volume
            self._feed(hashlib.blake2b(thing.packed_file.data).digest())


class _Holder:
    """An NLA strip, as ``curves_of`` takes whatever has an action."""

    def __init__(self, strip):
        self.animation_data = strip


def _plain(thing):
    return not any(
        prop.type in {"POINTER", "COLLECTION"} and prop.identifier != "rna_type"
        for prop in thing.bl_rna.properties
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
