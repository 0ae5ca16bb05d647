# SPDX-License-Identifier: GPL-3.0-or-later
"""Sets the scene protocol's custom properties, all that a call asks for or nothing."""

import difflib
import functools
import re

import bpy

from simworlds.sandbox.inside.refusal import Refused

ROLE, ROOT, CONTACT = "protocol_role", "is_object_root", "contact_with"
ONLY_ON_OBJECTS = ("deformation_kind", "motion_kind", "allows_disconnected")
STRICT_GROUNDING = "strict_grounding"
SYSTEM, OBJECT, GROUND = "system", "object", "ground"
TAGS = (ROLE, *ONLY_ON_OBJECTS, ROOT, CONTACT, STRICT_GROUNDING)

WITH_SURFACE = {"MESH", "CURVE", "SURFACE", "META", "FONT", "CURVES", "POINTCLOUD", "VOLUME"}
_NUMBERED = re.compile(r"\.\d{3,}$")
_LISTED = 5
_WARNINGS = 20


def tag(arguments, report):
    """Tags ``collections`` and ``objects`` ([name, {property: value, None to remove it}]) and the ``scene``.

    Returns the tags as they are now, by name, and ``warnings``: what the protocol still misses where it was tagged.
    """
    del report
    scene = bpy.context.scene
    wanted = _Wanted(scene)
    collections = [wanted.ask(_collection(name, scene), tags) for name, tags in arguments["collections"]]
    objects = [wanted.ask(_object(name), tags) for name, tags in arguments["objects"]]
    wanted.ask(scene, arguments["scene"])
    for collection in collections:
        _check_collection(collection, wanted)
    for thing in objects:
        _check_root(thing, wanted)
    for thing in objects:
        _check_contacts(thing, wanted)
    wanted.write()
    return {
        "collections": {one.name: _tags_of(one) for one in collections},
        "objects": {one.name: _tags_of(one) for one in objects},
        "scene": _tags_of(scene),
        "warnings": _warnings(wanted, collections, objects),
    }


class _Wanted:
    """The tags as they will be: what is asked for over what is there. And the collections of the scene."""

    def __init__(self, scene):
        self.scene = scene
        self._asked = {}
        self.parents = {}
        self._walk(scene.collection)

    def _walk(self, parent):
        for child in parent.children:
            known = self.parents.setdefault(child, [])
            if parent not in known:
                known.append(parent)
                self._walk(child)

    def ask(self, thing, tags):
        if thing in self._asked:
            raise Refused(f"{thing.name!r} is named twice; say once what it is to carry.")
        self._asked[thing] = dict(tags)
        return thing

    def of(self, thing, tag):
        asked = self._asked.get(thing, {})
        return asked[tag] if tag in asked else thing.get(tag)

    def is_asked(self, thing, tag):
        return tag in self._asked.get(thing, {})

    def put(self, thing, tag, value):
        self._asked[thing][tag] = value

    def write(self):
        for thing, tags in self._asked.items():
            for tag, value in tags.items():
                if value:
                    thing[tag] = value
                elif tag in thing:
                    del thing[tag]

    @functools.cached_property
    def owners(self):
        """For each object the L3 collections that hold it; once all is asked for."""
        found = {}
        for one in bpy.data.collections:
            if self.of(one, ROLE) == OBJECT:
                for thing in one.all_objects:
                    found.setdefault(thing, []).append(one)
        return found

    def roots_in(self, collection):
        return [one for one in collection.all_objects if self.of(one, ROOT)]

    def is_below_system(self, collection):
        return any(
            self.of(parent, ROLE) == SYSTEM or self.is_below_system(parent)
            for parent in self.parents.get(collection, ())
        )


# What is named


def _collection(name, scene):
    if name == scene.collection.name and name not in bpy.data.collections:
        raise Refused(f"{name!r} is the scene's root, L1 of the protocol; it carries no tags.")
    return _named(name, bpy.data.collections, "collection", bpy.data.objects)


def _object(name):
    return _named(name, bpy.data.objects, "object", bpy.data.collections)


def _named(name, things, word, others):
    found = things.get(name)
    if found is None:
        if name in others:
            other = "collection" if word == "object" else "object"
            raise Refused(f"{name!r} is not {_a(word)} but {_a(other)}; name it among the {other}s.")
        raise Refused(f"There is no {word} called {name!r}. {_nearest(name, things, word)}")
    if found.library is not None:
        raise Refused(f"{name!r} is linked from {found.library.filepath}; its tags can only be set there.")
    return found


def _nearest(name, things, word):
    names = [one.name for one in things]
    by_folded = {one.lower(): one for one in reversed(names)}
    near = difflib.get_close_matches(name.lower(), by_folded, 3, 0.5)
    if near:
        return f"Nearest: {_listed(by_folded[one] for one in near)}."
    return f"There are: {_listed(names)}." if names else f"There is no {word} at all."


# What contradicts itself


def _check_collection(collection, wanted):
    if wanted.of(collection, ROLE) == OBJECT:
        return
    for tag in ONLY_ON_OBJECTS:
        if wanted.of(collection, tag):
            raise Refused(
                f"{collection.name!r} would carry {tag} without being an object (L3), which alone has one: tag "
                f"it with role 'object', or set {tag} to null."
            )


def _check_root(thing, wanted):
    if not wanted.of(thing, ROOT):
        return
    if thing.type != "EMPTY":
        raise Refused(
            f"{thing.name!r} is {_a(thing.type)}, and a root is an Empty: make one, link it to the object's "
            "collection, parent the meshes to it, and tag that."
        )
    owners = wanted.owners.get(thing, ())
    if not owners:
        inside = [one.name for one in thing.users_collection]
        raise Refused(
            f"{thing.name!r} lies in no object (L3), only in {_listed(inside) or 'no collection'}: tag its collection "
            "with role 'object', or link it to that object's collection."
        )
    if len(owners) > 1:
        names = _listed(one.name for one in owners)
        raise Refused(
            f"{thing.name!r} lies in {names}; a root belongs to one object (L3). Unlink it from the others."
        )
    others = [one.name for one in wanted.roots_in(owners[0]) if one != thing]
    if others:
        raise Refused(
            f"{owners[0].name!r} has {_listed(others)} as its root, and an object (L3) has one: set is_object_root "
            f"of {'that' if len(others) == 1 else 'those'} to null in the same call."
        )


def _check_contacts(thing, wanted):
    names = wanted.of(thing, CONTACT)
    if not names:
        return
    if not _can_touch(thing, wanted):
        raise Refused(f"{thing.name!r} is {_a(thing.type)} and no root: it has no surface to touch with.")
    if wanted.is_asked(thing, CONTACT):
        wanted.put(thing, CONTACT, list(dict.fromkeys(_touched(name, thing, wanted) for name in names)))


def _touched(name, thing, wanted):
    """The name of the mesh or root that ``name`` stands for: an L3's name stands for its root."""
    other = wanted.scene.objects.get(name)
    if other is None:
        collection = bpy.data.collections.get(name)
        if collection is not None and wanted.of(collection, ROLE) == OBJECT:
            roots = wanted.roots_in(collection)
            if len(roots) != 1:
                raise Refused(
                    f"{name!r} is an object (L3) without a root of its own; name the mesh that is touched."
                )
            other = roots[0]
    if other is None:
        raise Refused(
            f"{thing.name!r} cannot touch {name!r}: the scene has no such object. "
            + _nearest(name, wanted.scene.objects, "object")
        )
    if other == thing:
        raise Refused(f"{thing.name!r} is not in contact with itself.")
    if not _can_touch(other, wanted):
        raise Refused(
            f"{thing.name!r} cannot touch {other.name!r}, which is {_a(other.type)} and no root: it has no surface."
        )
    return other.name


def _can_touch(thing, wanted):
    return thing.type in WITH_SURFACE or (thing.type == "EMPTY" and bool(wanted.of(thing, ROOT)))


# What is still missing


def _warnings(wanted, collections, objects):
    found = []
    concerned = list(dict.fromkeys(collections))
    for thing in objects:
        owners = wanted.owners.get(thing, ())
        concerned += [one for one in owners if one not in concerned]
        if not owners and thing.type in WITH_SURFACE:
            found.append(f"C3: {thing.name!r} lies in no object (L3): link it to one's collection.")
        lost = [name for name in _names(thing.get(CONTACT)) if name not in wanted.scene.objects]
        if lost:
            found.append(f"V1: {thing.name!r} is to touch {_listed(lost)}, which the scene does not have.")
    for collection in concerned:
        role = wanted.of(collection, ROLE)
        if role:
            found += _misplaced(collection, wanted)
        if role == SYSTEM:
            found += _of_system(collection, wanted)
        elif role == OBJECT:
            found += _of_object(collection, wanted)
        if role != OBJECT:
            left = [one.name for one in wanted.roots_in(collection) if one not in wanted.owners]
            if left:
                found.append(
                    f"G3: {_listed(left)} in {collection.name!r} is tagged as a root, but of no object (L3)."
                )
    if any(wanted.of(one, ROLE) for one in collections) and not _has_ground(wanted):
        found.append(f"C6: there is no system {GROUND!r} with an object (L3) in it yet.")
    found = list(dict.fromkeys(found))
    if len(found) > _WARNINGS:
        found[_WARNINGS:] = [f"… and {len(found) - _WARNINGS} more; tag fewer at a time to read them."]
    return found


def _misplaced(collection, wanted):
    if collection not in wanted.parents:
        yield f"{collection.name!r} is not in the scene: link it into the scene's tree of collections."
    if _NUMBERED.search(collection.name):
        yield f"C5: {collection.name!r} has a number for a name's end: name it after what it is."


def _of_system(collection, wanted):
    if any(parent != wanted.scene.collection for parent in wanted.parents.get(collection, ())):
        yield f"C2: system {collection.name!r} is not directly under the scene's root: move it there."


def _of_object(collection, wanted):
    name = collection.name
    if collection in wanted.parents and not wanted.is_below_system(collection):
        yield f"C1: object {name!r} lies in no system (L2): link it into one."
    roots = wanted.roots_in(collection)
    if not roots:
        yield f"C4: object {name!r} has no root: add an Empty to it, parent its meshes to that, tag it is_object_root."
    if len(roots) > 1:
        yield f"C4: object {name!r} has {len(roots)} roots ({_listed(one.name for one in roots)}): keep one."
    for root in roots:
        if root.parent is not None:
            yield f"G2: root {root.name!r} has the parent {root.parent.name!r}: clear it, keeping the transform."
    surfaces = [one for one in collection.all_objects if one.type in WITH_SURFACE]
    loose = [one.name for one in surfaces if roots and not any(_leads_to(one, root) for root in roots)]
    if loose:
        yield f"G1: {_listed(loose)} of {name!r} {_hangs(loose)} on its root {roots[0].name!r}: parent to it."
    shared = [one.name for one in surfaces if len(wanted.owners.get(one, ())) > 1]
    if shared:
        yield f"C3: {_listed(shared)} of {name!r} lie in another object (L3) as well: unlink from one."
    strangers = [one.name for one in collection.all_objects if _is_no_part(one)]
    if strangers:
        yield f"W3: {_listed(strangers)} in {name!r}: lights, cameras and force fields belong into a system."


def _leads_to(thing, root):
    while thing.parent is not None:
        thing = thing.parent
    return thing == root


def _hangs(names):
    return "does not hang" if len(names) == 1 else "do not hang"


def _is_no_part(thing):
    return thing.type in {"LIGHT", "CAMERA"} or (thing.field is not None and thing.field.type != "NONE")


def _has_ground(wanted):
    ground = bpy.data.collections.get(GROUND)
    if ground is None or wanted.of(ground, ROLE) != SYSTEM or ground not in wanted.parents:
        return False
    return any(wanted.of(one, ROLE) == OBJECT for one in ground.children_recursive)


# In words


def _tags_of(thing):
    found = {}
    for tag in TAGS:
        value = thing.get(tag)
        if value is not None:
            found[tag] = _names(value) if tag == CONTACT else value
    return found


def _names(value):
    """What ``contact_with`` names, however code has put it there."""
    if isinstance(value, str):
        return [value]
    try:
        return [str(one) for one in value or ()]
    except TypeError:
        return []


def _listed(names):
    names = list(names)
    shown = ", ".join(repr(one) for one in names[:_LISTED])
    return shown if len(names) <= _LISTED else f"{shown} and {len(names) - _LISTED} more"


def _a(word):
    word = word.lower().replace("_", " ") if word.isupper() else word
    return f"{'an' if word[0] in 'aeiou' else 'a'} {word}"
