# SPDX-License-Identifier: GPL-3.0-or-later
"""Groups existing objects into objects (L3) of the scene protocol: collections, a root Empty, parents, tags.

Everything is checked before anything is changed. Nothing moves in the world.
"""

import math

import bpy
from mathutils import Matrix, Vector

from simworlds.sandbox.inside.refusal import Refused

from .blend.names import nearest
from .blend.protocol_tags import CONTACT, OBJECT, ROLE, ROOT, SYSTEM
from .state.world_extents import ExtentReader, evaluated_graph
from .tag import WITH_SURFACE, tag

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
    groups = [_Group(scene, request) for request in arguments["groups"]]
    _check_together(scene, groups)
    extents = ExtentReader(evaluated_graph())
    for each in groups:
        each.find_place(extents)
    tree = [scene.collection, *scene.collection.children_recursive]
    free = [collection for collection in tree if not _is_used_by_physics(scene, collection)]
    for number, each in enumerate(groups):
        report(number, len(groups), each.name)
        each.make(free)
    bpy.context.view_layer.update()
    tagged = tag(_tags(groups), report)
    return {"groups": [each.as_dict() for each in groups], "warnings": tagged["warnings"]}


def _check_together(scene, groups):
    """Raises Refused where the groups contradict each other."""
    seen, taken = set(), {}
    for group in groups:
        if group.name in seen:
            raise Refused(f"{group.name!r} is named twice: name it once, with all its members.")
        seen.add(group.name)
        for obj in group.members:
            if obj in taken:
                raise Refused(f"{obj.name!r} cannot be in both {taken[obj]!r} and {group.name!r}.")
            taken[obj] = group.name
    systems = {group.system for group in groups}
    roots = {_root_name(name) for name in seen}
    for group in groups:
        if group.name in systems:
            raise Refused(
                f"{group.name!r} cannot be both a system and an object: choose another name for one."
            )
        for name in group.contacts or ():
            if name not in seen | roots and name not in scene.objects and _role(name) != OBJECT:
                hint = _name_hint(name, [*seen, *scene.objects.keys()])
                raise Refused(f"{group.name!r} cannot touch {name!r}: there is no such object.{hint}")


def _root_name(name):
    return f"{name} root"


def _tags(groups):
    systems = {group.system: None for group in groups if group.system}
    collections = [[name, {ROLE: SYSTEM}] for name in systems]
    collections += [[group.name, {ROLE: OBJECT, **group.tags}] for group in groups]
    roots = []
    for group in groups:
        contacts = {} if group.contacts is None else {CONTACT: group.contacts}
        roots.append([group.root.name, {ROOT: True, **contacts}])
    return {"collections": collections, "objects": roots, "scene": {}}


class _Group:
    """One object (L3) to be made or completed. Raises Refused for what is impossible."""

    def __init__(self, scene, request):
        self._scene = scene
        self.name, self.system = request["object"], request["system"]
        self.tags, self.contacts = request["tags"], request["contact_with"]
        self._location = request["location"]
        self._freed, self._left = {}, set()
        self._collection = _collection(self.name, OBJECT)
        if self.system is not None:
            _collection(self.system, SYSTEM)
        elif self._collection is None or not self._is_below_system():
            raise Refused(f"{self.name!r} is in no system yet: name one, such as 'furniture' or 'ground'.")
        before = _contents(self._collection) if self._collection else []
        if request["members"] is None and not before:
            raise Refused(f"{self.name!r} is empty: name its members.")
        self.members = [_member(scene, name) for name in request["members"] or ()]
        self._all = list(dict.fromkeys([*before, *self.members]))
        if not any(obj.type in WITH_SURFACE for obj in self._all):
            raise Refused(f"{self.name!r} would have no mesh: add one to its members.")
        self.root = self._find_root(before)
        for obj in self._topmost():
            _check_parent(obj, self.name)

    def _is_below_system(self):
        def below(parent):
            return any(
                child == self._collection or (child.get(ROLE) != SYSTEM and below(child))
                for child in parent.children
            )

        return any(
            collection.get(ROLE) == SYSTEM and below(collection)
            for collection in self._scene.collection.children_recursive
        )

    def _find_root(self, before):
        """The root that it has, or the Empty to which all its meshes are parented already; None if there is none."""
        roots = [obj for obj in before if obj.get(ROOT)]
        if len(roots) > 1 or any(obj.type != "EMPTY" for obj in roots):
            names = ", ".join(repr(obj.name) for obj in roots)
            raise Refused(
                f"{self.name!r} has {names} as root, but an object has one root, an Empty: untag the others."
            )
        if roots:
            return roots[0]
        tops = {_topmost_in_group(obj, self._all) for obj in self._all if obj.type in WITH_SURFACE}
        top = tops.pop()
        return top if not tops and top.type == "EMPTY" and top.parent is None else None

    def _topmost(self):
        """The objects to parent to the root: those whose parent, if any, is outside the group."""
        tops = dict.fromkeys(_topmost_in_group(obj, self._all) for obj in self._all)
        return [obj for obj in tops if obj != self.root and obj.parent != (self.root or obj)]

    def find_place(self, extents):
        """Finds the place for a new root. Changes nothing."""
        boxes = [
            box
            for obj in self._all
            if obj.type in WITH_SURFACE
            and (box := extents.measure(obj, extents.evaluated(obj))[0]) is not None
        ]
        ends = [value for box in boxes for value in (*box.low, *box.high)]
        if not all(map(math.isfinite, ends)):
            raise Refused(f"{self.name!r} has geometry with coordinates that are not finite: fix that first.")
        if self._location is None and not boxes and self.root is None:
            raise Refused(f"{self.name!r} has no geometry from which to find its bottom: give a location.")
        low = Vector(min((box.low[axis] for box in boxes), default=0.0) for axis in range(3))
        high = Vector(max((box.high[axis] for box in boxes), default=0.0) for axis in range(3))
        self._bottom = Vector(((low.x + high.x) / 2, (low.y + high.y) / 2, low.z))
        self._across = (high - low).length
        if self.root is not None and self._location is not None and _is_driven(self.root):
            raise Refused(f"The root {self.root.name!r} is animated or constrained, so it cannot be moved.")

    def make(self, free):
        """Makes it. ``free``: the collections that objects may be taken out of."""
        self._link(free)
        self._place_root()
        for obj in self._topmost():
            if obj.parent is not None:
                self._freed[obj.name] = obj.parent.name
            _parent_to_root(obj, self.root)

    def _link(self, free):
        top = self._scene.collection
        if self._collection is None:
            self._collection = bpy.data.collections.new(self.name)
        if self.system is not None:
            system = bpy.data.collections.get(self.system) or bpy.data.collections.new(self.system)
            _move_below(system, top, top)
            _move_below(self._collection, system, top)
        inside = [self._collection, *_untagged_below(self._collection)]
        for obj in self.members:
            for other in obj.users_collection:
                if other not in inside and (other in free or other.get(ROLE) == OBJECT):
                    other.objects.unlink(obj)
                    self._left.add(other.name)
            if not any(obj.name in collection.objects for collection in inside):
                self._collection.objects.link(obj)

    def _place_root(self):
        if self.root is None:
            self.root = bpy.data.objects.new(_root_name(self.name), None)
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
            below = [(obj, _parent_space(obj)) for obj in self.root.children]
            self.root.location = Vector(self._location)
            bpy.context.view_layer.update()
            for obj, space in below:
                obj.matrix_parent_inverse = self.root.matrix_world.inverted() @ space

    def as_dict(self):
        """The group as it is now, as data."""
        return {
            "object": self.name,
            "systems": sorted(
                collection.name
                for collection in bpy.data.collections
                if collection.get(ROLE) == SYSTEM and self._collection in collection.children_recursive
            ),
            "root": self.root.name,
            "location": [round(value, 6) for value in self.root.matrix_world.translation],
            "members": sorted(obj.name for obj in _contents(self._collection) if obj != self.root),
            "taken_out_of": sorted(self._left),
            "freed_from": self._freed,
        }


# Look-ups


def _collection(name, role):
    """The collection of that name, None if there is none. Raises Refused if it cannot have the role."""
    longest = bpy.types.ID.bl_rna.properties["name"].length_max - 1
    if not name.strip() or len(name.encode()) > longest:
        raise Refused(f"{name[:80]!r} is not a valid name: it must have 1 to {longest} bytes.")
    collection = bpy.data.collections.get(name)
    if collection is None:
        return None
    if collection.library is not None:
        raise Refused(f"{name!r} is linked from {collection.library.filepath}; it can only be changed there.")
    other = {SYSTEM: OBJECT, OBJECT: SYSTEM}[role]
    if collection.get(ROLE) == other:
        raise Refused(
            f"{name!r} is already tagged as {other}, so it cannot become {role}: choose another name."
        )
    return collection


def _role(name):
    collection = bpy.data.collections.get(name)
    return collection.get(ROLE) if collection else None


def _member(scene, name):
    obj = scene.objects.get(name)
    if obj is None:
        raise Refused(f"The scene has no object {name!r}.{_name_hint(name, scene.objects.keys())}")
    if obj.library is not None:
        raise Refused(f"{name!r} is linked from {obj.library.filepath}; it can only be changed there.")
    if obj.type in {"LIGHT", "CAMERA"} or (obj.field is not None and obj.field.type != "NONE"):
        kind = "force field" if obj.type not in {"LIGHT", "CAMERA"} else obj.type.lower()
        raise Refused(
            f"{name!r} is a {kind}, which cannot be part of an object: link it into a system instead."
        )
    return obj


def _check_parent(obj, name):
    """Raises Refused if unparenting ``obj`` would lose more than the parent."""
    parent = obj.parent
    if parent is None or (obj.parent_type == "OBJECT" and parent.type not in {"ARMATURE", "LATTICE"}):
        return
    raise Refused(
        f"{obj.name!r} is moved by {parent.name!r} (parent type {obj.parent_type}), which is not in "
        f"{name!r}: add it to the members, or clear the parent."
    )


def _contents(collection):
    """The objects of an L3: its own, and those of untagged collections below it."""
    members = {}
    for child in (collection, *_untagged_below(collection)):
        members.update(dict.fromkeys(child.objects))
    return list(members)


def _untagged_below(collection):
    below = []
    for child in collection.children:
        if not child.get(ROLE):
            below += [child, *_untagged_below(child)]
    return below


def _topmost_in_group(obj, group):
    """The uppermost of the chain of parents from ``obj`` up that is in the group."""
    while obj.parent in group:
        obj = obj.parent
    return obj


def _is_driven(obj):
    data = obj.animation_data
    animated = data is not None and (data.action is not None or len(data.drivers) or len(data.nla_tracks))
    return bool(animated or any(not constraint.mute for constraint in obj.constraints))


def _is_used_by_physics(scene, collection):
    """Whether anything but the tree of collections depends on what is in it."""
    world = scene.rigidbody_world
    if world is not None and collection in (world.collection, world.constraints):
        return True
    if collection == scene.collection:
        return False
    users = bpy.data.user_map(subset=[collection]).get(collection, ())
    return any(not isinstance(user, (bpy.types.Collection, bpy.types.Scene)) for user in users)


def _name_hint(name, names):
    near = nearest(name, names)
    return f" Nearest: {', '.join(map(repr, near))}." if near else ""


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


def _parent_space(obj):
    """The space that an object's own location, rotation and scale are in."""
    if obj.parent is None:
        return Matrix()
    return obj.parent.matrix_world @ obj.matrix_parent_inverse


def _parent_to_root(obj, root):
    """Parents to the root; where it is, how it is turned and sheared, and what animates it, stay."""
    space = _parent_space(obj)
    obj.parent, obj.parent_type = root, "OBJECT"
    obj.matrix_parent_inverse = root.matrix_world.inverted() @ space
