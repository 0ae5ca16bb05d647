# SPDX-License-Identifier: GPL-3.0-or-later
"""Sets the scene protocol's custom properties: everything that a call asks for, or nothing."""

import functools
import re

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .blend.names import nearest, quoted
from .blend.protocol_tags import CONTACT, GROUND, OBJECT, ONLY_ON_OBJECTS, ROLE, ROOT, SYSTEM, TAGS

WITH_SURFACE = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME"}
_NUMBERED = re.compile(r"\.\d{3,}$")
_LISTED = 5
_WARNINGS = 20


def tag(arguments, report):
    """Tags ``collections`` and ``objects`` ([name, {property: value, None to remove it}]) and the ``scene``.

    Returns the tags as they are now, by name, and ``warnings``: what the protocol still misses in the tagged parts.
    """
    del report
    scene = bpy.context.scene
    plan = _TagPlan(scene)
    collections = [plan.request(_collection(name, scene), tags) for name, tags in arguments["collections"]]
    objects = [plan.request(_object(name), tags) for name, tags in arguments["objects"]]
    plan.request(scene, arguments["scene"])
    for collection in collections:
        _check_collection(collection, plan)
    for obj in objects:
        _check_root(obj, plan)
    for obj in objects:
        _check_contacts(obj, plan)
    plan.write()
    return {
        "collections": {block.name: _tags_of(block) for block in collections},
        "objects": {block.name: _tags_of(block) for block in objects},
        "scene": _tags_of(scene),
        "warnings": _warnings(plan, collections, objects),
    }


class _TagPlan:
    """The tags as they will be after the call, and the tree of the scene's collections."""

    def __init__(self, scene):
        self.scene = scene
        self._requested = {}
        self.parents = {}
        self._walk(scene.collection)

    def _walk(self, parent):
        for child in parent.children:
            known = self.parents.setdefault(child, [])
            if parent not in known:
                known.append(parent)
                self._walk(child)

    def request(self, block, tags):
        if block in self._requested:
            raise Refused(f"{block.name!r} is named twice: name it once, with all its tags.")
        self._requested[block] = dict(tags)
        return block

    def of(self, block, tag):
        tags = self._requested.get(block, {})
        return tags[tag] if tag in tags else block.get(tag)

    def is_requested(self, block, tag):
        return tag in self._requested.get(block, {})

    def put(self, block, tag, value):
        self._requested[block][tag] = value

    def write(self):
        for block, tags in self._requested.items():
            for tag, value in tags.items():
                if value:
                    block[tag] = value
                elif tag in block:
                    del block[tag]

    @functools.cached_property
    def owners(self):
        """For each object the L3 collections that hold it; after all requests."""
        owners = {}
        for collection in bpy.data.collections:
            if self.of(collection, ROLE) == OBJECT:
                for obj in collection.all_objects:
                    owners.setdefault(obj, []).append(collection)
        return owners

    def roots_in(self, collection):
        return [obj for obj in collection.all_objects if self.of(obj, ROOT)]

    def is_below_system(self, collection):
        return any(
            self.of(parent, ROLE) == SYSTEM or self.is_below_system(parent)
            for parent in self.parents.get(collection, ())
        )


# Look-ups


def _collection(name, scene):
    if name == scene.collection.name and name not in bpy.data.collections:
        raise Refused(f"{name!r} is the scene's root (L1 of the protocol), which has no tags.")
    return _look_up(name, bpy.data.collections, "collection", bpy.data.objects)


def _object(name):
    return _look_up(name, bpy.data.objects, "object", bpy.data.collections)


def _look_up(name, blocks, word, others):
    block = blocks.get(name)
    if block is None:
        if name in others:
            other = "collection" if word == "object" else "object"
            raise Refused(
                f"{name!r} is not {_article(word)} but {_article(other)}: name it among the {other}s."
            )
        raise Refused(f"There is no {word} called {name!r}. {_name_hint(name, blocks, word)}")
    if block.library is not None:
        raise Refused(f"{name!r} is linked from {block.library.filepath}; its tags can only be set there.")
    return block


def _name_hint(name, blocks, word):
    names = [block.name for block in blocks]
    if near := nearest(name, names):
        return f"Nearest: {_listed(near)}."
    return f"There are: {_listed(names)}." if names else f"There is no {word} at all."


# Contradictions


def _check_collection(collection, plan):
    if plan.of(collection, ROLE) == OBJECT:
        return
    for tag in ONLY_ON_OBJECTS:
        if plan.of(collection, tag):
            raise Refused(
                f"{collection.name!r} cannot have {tag}: only objects (L3) have it. Tag it with role 'object', "
                f"or set {tag} to null."
            )


def _check_root(obj, plan):
    if not plan.of(obj, ROOT):
        return
    if obj.type != "EMPTY":
        raise Refused(
            f"{obj.name!r} is {_article(obj.type)}, but a root must be an Empty: add one, link it to the object's "
            "collection, parent the meshes to it, and tag the Empty."
        )
    owners = plan.owners.get(obj, ())
    if not owners:
        inside = [other.name for other in obj.users_collection]
        raise Refused(
            f"{obj.name!r} is in no object (L3), only in {_listed(inside) or 'no collection'}: tag its collection "
            "with role 'object', or link it to that object's collection."
        )
    if len(owners) > 1:
        names = _listed(other.name for other in owners)
        raise Refused(
            f"{obj.name!r} is in {names}, but a root belongs to one object (L3): unlink it from the others."
        )
    others = [other.name for other in plan.roots_in(owners[0]) if other != obj]
    if others:
        raise Refused(
            f"{owners[0].name!r} already has {_listed(others)} as its root, and an object (L3) has only one: set "
            f"is_object_root of {'that' if len(others) == 1 else 'those'} to null in the same call."
        )


def _check_contacts(obj, plan):
    names = plan.of(obj, CONTACT)
    if not names:
        return
    if not _can_touch(obj, plan):
        raise Refused(
            f"{obj.name!r} is {_article(obj.type)} and not a root: it has no surface that could touch anything."
        )
    if plan.is_requested(obj, CONTACT):
        plan.put(obj, CONTACT, list(dict.fromkeys(_contact_target(name, obj, plan) for name in names)))


def _contact_target(name, obj, plan):
    """The name of the mesh or root that ``name`` stands for: an L3's name stands for its root."""
    other = plan.scene.objects.get(name)
    if other is None:
        collection = bpy.data.collections.get(name)
        if collection is not None and plan.of(collection, ROLE) == OBJECT:
            roots = plan.roots_in(collection)
            if len(roots) != 1:
                raise Refused(
                    f"{name!r} is an object (L3) without exactly one root: name the mesh that is touched."
                )
            other = roots[0]
    if other is None:
        raise Refused(
            f"{obj.name!r} cannot touch {name!r}: the scene has no such object. "
            + _name_hint(name, plan.scene.objects, "object")
        )
    if other == obj and not plan.of(obj, ROOT):
        raise Refused(f"{obj.name!r} is one mesh: it cannot be in contact with itself.")
    if not _can_touch(other, plan):
        raise Refused(
            f"{obj.name!r} cannot touch {other.name!r}, which is {_article(other.type)}, not a root: it has no surface."
        )
    return other.name


def _can_touch(obj, plan):
    return obj.type in WITH_SURFACE or (obj.type == "EMPTY" and bool(plan.of(obj, ROOT)))


# What the protocol still misses


def _warnings(plan, collections, objects):
    warnings = []
    concerned = list(dict.fromkeys(collections))
    for obj in objects:
        owners = plan.owners.get(obj, ())
        concerned += [collection for collection in owners if collection not in concerned]
        if not owners and obj.type in WITH_SURFACE:
            warnings.append(f"C3: {obj.name!r} is in no object (L3): link it to the collection of one.")
        lost = [name for name in _contact_names(obj.get(CONTACT)) if name not in plan.scene.objects]
        if lost:
            warnings.append(
                f"V1: {obj.name!r} should touch {_listed(lost)}, but the scene has no such object."
            )
    for collection in concerned:
        role = plan.of(collection, ROLE)
        if role:
            warnings += _collection_warnings(collection, plan)
        if role == SYSTEM:
            warnings += _system_warnings(collection, plan)
        elif role == OBJECT:
            warnings += _object_warnings(collection, plan)
        if role != OBJECT:
            ownerless = [root.name for root in plan.roots_in(collection) if root not in plan.owners]
            if ownerless:
                warnings.append(
                    f"G3: {_listed(ownerless)} in {collection.name!r} is tagged as a root, but is in no object (L3)."
                )
    if any(plan.of(collection, ROLE) for collection in collections) and not _has_ground(plan):
        warnings.append(f"C6: there is no system {GROUND!r} with an object (L3) in it yet.")
    warnings = list(dict.fromkeys(warnings))
    if len(warnings) > _WARNINGS:
        warnings[_WARNINGS:] = [f"… and {len(warnings) - _WARNINGS} more; tag fewer at a time to read them."]
    return warnings


def _collection_warnings(collection, plan):
    if collection not in plan.parents:
        yield f"{collection.name!r} is not in the scene: link it into the scene's tree of collections."
    if _NUMBERED.search(collection.name):
        yield f"C5: {collection.name!r} has a name that ends in a number: name it after what it is."


def _system_warnings(collection, plan):
    if any(parent != plan.scene.collection for parent in plan.parents.get(collection, ())):
        yield f"C2: system {collection.name!r} is not directly under the scene's root: move it there."


def _object_warnings(collection, plan):
    name = collection.name
    if collection in plan.parents and not plan.is_below_system(collection):
        yield f"C1: object {name!r} is in no system (L2): link it into one."
    roots = plan.roots_in(collection)
    if not roots:
        yield f"C4: object {name!r} has no root: add an Empty, parent its meshes to it, and tag it is_object_root."
    if len(roots) > 1:
        yield f"C4: object {name!r} has {len(roots)} roots ({_listed(obj.name for obj in roots)}): keep one."
    for root in roots:
        if root.parent is not None:
            yield f"G2: root {root.name!r} has the parent {root.parent.name!r}: clear it, keeping the transform."
    surfaces = [obj for obj in collection.all_objects if obj.type in WITH_SURFACE]
    loose = [obj.name for obj in surfaces if roots and not any(_is_below(obj, root) for root in roots)]
    if loose:
        yield f"G1: parent to the root {roots[0].name!r} of {name!r}: {_listed(loose)}."
    shared = [obj.name for obj in surfaces if len(plan.owners.get(obj, ())) > 1]
    if shared:
        yield f"C3: {_listed(shared)} of {name!r} are in another object (L3) as well: unlink them from one."
    misplaced = [obj.name for obj in collection.all_objects if _belongs_in_system(obj)]
    if misplaced:
        yield f"W3: {_listed(misplaced)} in {name!r}: lights, cameras and force fields belong directly in a system."


def _is_below(obj, root):
    while obj.parent is not None:
        obj = obj.parent
    return obj == root


def _belongs_in_system(obj):
    return obj.type in {"LIGHT", "CAMERA"} or (obj.field is not None and obj.field.type != "NONE")


def _has_ground(plan):
    ground = bpy.data.collections.get(GROUND)
    if ground is None or plan.of(ground, ROLE) != SYSTEM or ground not in plan.parents:
        return False
    return any(plan.of(child, ROLE) == OBJECT for child in ground.children_recursive)


# Text


def _tags_of(block):
    tags = {}
    for tag in TAGS:
        value = block.get(tag)
        if value is not None:
            tags[tag] = _contact_names(value) if tag == CONTACT else value
    return tags


def _contact_names(value):
    """What ``contact_with`` names, however code has put it there."""
    if isinstance(value, str):
        return [value]
    try:
        return [str(name) for name in value or ()]
    except TypeError:
        return []


def _listed(names):
    return quoted(names, _LISTED)


def _article(word):
    word = word.lower().replace("_", " ") if word.isupper() else word
    return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"
