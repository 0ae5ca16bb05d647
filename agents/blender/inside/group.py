# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes objects (L3) of the scene protocol out of what is there: collections, a root Empty, parents, tags.

Everything is checked before anything is changed. Nothing moves in the world.
"""

import difflib
import math

import bpy
from mathutils import Matrix, Vector

from simworlds.sandbox.inside.refusal import Refused

from .state.world_extents import Extents, evaluated_graph
from .tag import CONTACT, OBJECT, ROLE, ROOT, SYSTEM, WITH_SURFACE, tag

_EMPTY_SHARE = 0.25  # of the object's diagonal: how large its root is drawn


def group(arguments, report):
    """Makes or completes the ``groups``.

    Each has ``object`` (the L3's name), ``system`` (the L2's; None: it is in one already), ``members`` (names of
    objects; None: what is in the L3 already), ``location`` of the root (None: at the bottom, in the middle), ``tags``
    of the L3, and ``contact_with`` (None: as it is). Returns ``groups`` as they are now, and ``warnings``: what the
    protocol still misses in them.
    """
    bpy.context.view_layer.update()
    scene = bpy.context.scene
    wanted = [_Group(scene, given) for given in arguments["groups"]]
    _check_together(scene, wanted)
    extents = Extents(evaluated_graph())
    for one in wanted:
        one.find_place(extents)
    tree = [scene.collection, *scene.collection.children_recursive]
    free = [one for one in tree if not _is_used_by_physics(scene, one)]
    for number, one in enumerate(wanted):
        report(number, len(wanted), one.name)
        one.make(free)
    bpy.context.view_layer.update()
    told = tag(_tags(wanted), report)
    return {"groups": [one.told() for one in wanted], "warnings": told["warnings"]}


def _check_together(scene, wanted):
    seen, taken = set(), {}
    for one in wanted:
        if one.name in seen:
            raise Refused(f"{one.name!r} is named twice; say once what belongs to it.")
        seen.add(one.name)
        for thing in one.members:
            if thing in taken:
                raise Refused(f"{thing.name!r} cannot be in {taken[thing]!r} and in {one.name!r}.")
            taken[thing] = one.name
    systems = {one.system for one in wanted}
    for one in wanted:
        if one.name in systems:
            raise Refused(f"{one.name!r} cannot be a system and an object: collections share names.")
        for name in one.contacts or ():
            if name == one.name:
                raise Refused(f"{name!r} is not in contact with itself.")
            if name not in seen and name not in scene.objects and _role(name) != OBJECT:
                near = _nearest(name, [*seen, *scene.objects.keys()])
                raise Refused(f"{one.name!r} cannot touch {name!r}: there is no such object.{near}")


def _tags(wanted):
    systems = {one.system: None for one in wanted if one.system}
    collections = [[name, {ROLE: SYSTEM}] for name in systems]
    collections += [[one.name, {ROLE: OBJECT, **one.tags}] for one in wanted]
    roots = []
    for one in wanted:
        contacts = {} if one.contacts is None else {CONTACT: one.contacts}
        roots.append([one.root.name, {ROOT: True, **contacts}])
    return {"collections": collections, "objects": roots, "scene": {}}


class _Group:
    """What is to become of one object. Raises Refused for what cannot be."""

    def __init__(self, scene, given):
        self._scene = scene
        self.name, self.system = given["object"], given["system"]
        self.tags, self.contacts = given["tags"], given["contact_with"]
        self._location = given["location"]
        self._freed, self._left = {}, set()
        self._collection = _collection(self.name, OBJECT)
        if self.system is not None:
            _collection(self.system, SYSTEM)
        elif self._collection is None or not self._is_below_system():
            raise Refused(f"Which system is {self.name!r} to be in? Name one, as 'furniture' or 'ground'.")
        before = _contents(self._collection) if self._collection else []
        if given["members"] is None and not before:
            raise Refused(f"There is nothing in {self.name!r}: name its members.")
        self.members = [_member(scene, name) for name in given["members"] or ()]
        self._all = list(dict.fromkeys([*before, *self.members]))
        if not any(thing.type in WITH_SURFACE for thing in self._all):
            raise Refused(f"{self.name!r} would have no mesh: name one among its members.")
        self.root = self._find_root(before)
        for thing in self._tops():
            _check_parent(thing, self.name)

    def _is_below_system(self):
        def below(parent):
            return any(
                child == self._collection or (child.get(ROLE) != SYSTEM and below(child))
                for child in parent.children
            )

        return any(
            one.get(ROLE) == SYSTEM and below(one) for one in self._scene.collection.children_recursive
        )

    def _find_root(self, before):
        """The root that it has, or the Empty to which all its meshes are parented already; None if there is none."""
        roots = [thing for thing in before if thing.get(ROOT)]
        if len(roots) > 1 or any(thing.type != "EMPTY" for thing in roots):
            names = ", ".join(repr(thing.name) for thing in roots)
            raise Refused(
                f"{self.name!r} has {names} as root; an object has one, and that is an Empty: untag it."
            )
        if roots:
            return roots[0]
        tops = {_top(thing, self._all) for thing in self._all if thing.type in WITH_SURFACE}
        top = tops.pop()
        return top if not tops and top.type == "EMPTY" and top.parent is None else None

    def _tops(self):
        """What is to be parented to the root: whatever hangs on nothing that belongs to the object."""
        tops = dict.fromkeys(_top(thing, self._all) for thing in self._all)
        return [thing for thing in tops if thing != self.root and thing.parent != (self.root or thing)]

    def find_place(self, extents):
        """Where the root is to be, before anything is changed."""
        boxes = [
            box
            for thing in self._all
            if thing.type in WITH_SURFACE
            and (box := extents.measure(thing, extents.evaluated(thing))[0]) is not None
        ]
        ends = [value for box in boxes for value in (*box.low, *box.high)]
        if not all(map(math.isfinite, ends)):
            raise Refused(f"{self.name!r} has geometry at places that are no numbers; mend that first.")
        if self._location is None and not boxes and self.root is None:
            raise Refused(f"{self.name!r} has no geometry to find its bottom by: give a location.")
        low = Vector(min((box.low[axis] for box in boxes), default=0.0) for axis in range(3))
        high = Vector(max((box.high[axis] for box in boxes), default=0.0) for axis in range(3))
        self._bottom = Vector(((low.x + high.x) / 2, (low.y + high.y) / 2, low.z))
        self._across = (high - low).length
        if self.root is not None and self._location is not None and _is_driven(self.root):
            raise Refused(
                f"The root {self.root.name!r} is animated or constrained: it cannot be put elsewhere."
            )

    def make(self, free):
        """Makes it. ``free``: the collections that objects may be taken out of."""
        self._link(free)
        self._place_root()
        for thing in self._tops():
            if thing.parent is not None:
                self._freed[thing.name] = thing.parent.name
            _hang(thing, self.root)

    def _link(self, free):
        top = self._scene.collection
        if self._collection is None:
            self._collection = bpy.data.collections.new(self.name)
        if self.system is not None:
            system = bpy.data.collections.get(self.system) or bpy.data.collections.new(self.system)
            _move_below(system, top, top)
            _move_below(self._collection, system, top)
        inside = [self._collection, *_untagged_below(self._collection)]
        for thing in self.members:
            for other in thing.users_collection:
                if other not in inside and (other in free or other.get(ROLE) == OBJECT):
                    other.objects.unlink(thing)
                    self._left.add(other.name)
            if not any(thing.name in one.objects for one in inside):
                self._collection.objects.link(thing)

    def _place_root(self):
        if self.root is None:
            self.root = bpy.data.objects.new(f"{self.name} root", None)
            self.root.empty_display_size = max(self._across * _EMPTY_SHARE, 1e-3)
            self._collection.objects.link(self.root)
            self.root.matrix_world = Matrix.Translation(self._location or self._bottom)
            bpy.context.view_layer.update()
            return
        if self.root.parent is not None:
            self._freed[self.root.name] = self.root.parent.name
            world = self.root.matrix_world.copy()
            self.root.parent = None
            self.root.matrix_world = world
        if self._location is not None:
            below = [(thing, _space(thing)) for thing in self.root.children]
            self.root.location = Vector(self._location)
            bpy.context.view_layer.update()
            for thing, space in below:
                thing.matrix_parent_inverse = self.root.matrix_world.inverted() @ space

    def told(self):
        """It, as it is now."""
        return {
            "object": self.name,
            "systems": sorted(
                one.name
                for one in bpy.data.collections
                if one.get(ROLE) == SYSTEM and self._collection in one.children_recursive
            ),
            "root": self.root.name,
            "location": [round(value, 6) for value in self.root.matrix_world.translation],
            "members": sorted(thing.name for thing in _contents(self._collection) if thing != self.root),
            "taken_out_of": sorted(self._left),
            "freed_from": self._freed,
        }


# What there is


def _collection(name, role):
    """The collection of that name, None if there is none. Raises Refused if it cannot be what it is to be."""
    longest = bpy.types.ID.bl_rna.properties["name"].length_max - 1
    if not name.strip() or len(name.encode()) > longest:
        raise Refused(f"{name[:80]!r} cannot be a name: it is empty, or has more than {longest} bytes.")
    found = bpy.data.collections.get(name)
    if found is None:
        return None
    if found.library is not None:
        raise Refused(f"{name!r} is linked from {found.library.filepath}; it can only be changed there.")
    other = {SYSTEM: OBJECT, OBJECT: SYSTEM}[role]
    if found.get(ROLE) == other:
        raise Refused(f"{name!r} is tagged as {other} already, and is to be {role} now; choose another name.")
    return found


def _role(name):
    found = bpy.data.collections.get(name)
    return found.get(ROLE) if found else None


def _member(scene, name):
    thing = scene.objects.get(name)
    if thing is None:
        raise Refused(f"The scene has no object {name!r}.{_nearest(name, scene.objects.keys())}")
    if thing.library is not None:
        raise Refused(f"{name!r} is linked from {thing.library.filepath}; it can only be changed there.")
    if thing.type in {"LIGHT", "CAMERA"} or (thing.field is not None and thing.field.type != "NONE"):
        kind = "force field" if thing.type not in {"LIGHT", "CAMERA"} else thing.type.lower()
        raise Refused(f"{name!r} is a {kind}, and no part of an object: link it into a system of its own.")
    return thing


def _check_parent(thing, name):
    """That taking ``thing`` off its parent loses nothing but the parent."""
    parent = thing.parent
    if parent is None or (thing.parent_type == "OBJECT" and parent.type not in {"ARMATURE", "LATTICE"}):
        return
    raise Refused(
        f"{thing.name!r} is moved by {parent.name!r} (parent type {thing.parent_type}), which is no member of "
        f"{name!r}: name it among the members as well, or clear the parent."
    )


def _contents(collection):
    """The objects of an L3: its own, and those of untagged collections below it."""
    found = {}
    for one in (collection, *_untagged_below(collection)):
        found.update(dict.fromkeys(one.objects))
    return list(found)


def _untagged_below(collection):
    found = []
    for one in collection.children:
        if not one.get(ROLE):
            found += [one, *_untagged_below(one)]
    return found


def _top(thing, group):
    """The uppermost of the chain of parents from ``thing`` that is in the group."""
    while thing.parent in group:
        thing = thing.parent
    return thing


def _is_driven(thing):
    data = thing.animation_data
    animated = data is not None and (data.action is not None or len(data.drivers) or len(data.nla_tracks))
    return bool(animated or any(not one.mute for one in thing.constraints))


def _is_used_by_physics(scene, collection):
    """Whether something else than the tree of collections goes by what is in it."""
    world = scene.rigidbody_world
    if world is not None and collection in (world.collection, world.constraints):
        return True
    if collection == scene.collection:
        return False
    users = bpy.data.user_map(subset=[collection]).get(collection, ())
    return any(not isinstance(one, (bpy.types.Collection, bpy.types.Scene)) for one in users)


def _nearest(name, names):
    found = difflib.get_close_matches(name, list(names), 3, 0.5)
    return f" Nearest: {', '.join(map(repr, found))}." if found else ""


# Changes


def _move_below(collection, parent, top):
    """Links a collection below another one, and takes it out of what is no system; a system is only at the top."""
    if collection.name not in parent.children:
        parent.children.link(collection)
    for other in (top, *top.children_recursive):
        if (
            other != parent
            and collection.name in other.children
            and (parent == top or other.get(ROLE) != SYSTEM)
        ):
            other.children.unlink(collection)


def _space(thing):
    """The space that an object's own location, rotation and scale are in."""
    if thing.parent is None:
        return Matrix()
    return thing.parent.matrix_world @ thing.matrix_parent_inverse


def _hang(thing, root):
    """Parents to the root; where it is, how it is turned and sheared, and what animates it, stay."""
    space = _space(thing)
    thing.parent, thing.parent_type = root, "OBJECT"
    thing.matrix_parent_inverse = root.matrix_world.inverted() @ space
