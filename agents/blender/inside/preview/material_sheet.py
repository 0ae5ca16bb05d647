# SPDX-License-Identifier: GPL-3.0-or-later
"""Stills of the scene and of each object with their own materials, in light that is not the scene's.

Nothing of the scene changes: Cycles renders copies of the geometry in a temporary scene.
"""

import time

import bpy

from ..blend.named_objects import objects_named
from ..blend.names import quoted
from ..blend.protocol_tags import object_collections
from ..digests.still_digest import digest_of, lasting_digest
from .fixed_views import SCENE, PreviewRenderer, at_frame, camera_side, copy_of, grouped_boxes, note_missing
from .framing import VIEWS, BoundingBox, boxes_of, patch_of, without_size
from .lit_studio import LitStudio
from .scene_copy import DRAWABLE

_THREE_QUARTER = next(view for view in VIEWS if view[0] == "three-quarter")
OBJECTS = "objects"
_WIDEST = 960  # pixels of the scene's picture, where no size is asked for
_NARROWEST = 64
_ALONE = ("file", "metres_per_pixel")
_MOST_OBJECTS, _MOST_PATCHES = 12, 3
_NAMED = 6
_LISTED = 20
_MOST_MADE = 200
_made = {}  # key of a still → what is said of its picture, latest last


def material_sheet(arguments, report):
    """Renders stills into ``folder``: the scene at each of ``frames`` (none: the current one), and objects alone.

    ``objects``: names of the protocol's objects (lacking those, of Blender's); none: all, alike ones once, those that
    ``first`` names before others, and under ``only_first`` no others: see ``_asked_groups``. ``show``:
    "all", "scene" or "objects". ``size``: (of the scene's picture, None: the scene's own; of an object's), in pixels.
    After ``seconds`` no further still is begun. ``kept``: keys of stills that the caller still has. Returns ``scene``,
    ``objects`` and ``patches`` (close pictures of those that are far larger than all others), with the names of the
    files and the keys, and ``notes``; what is kept and unchanged has no file.
    """
    scene = bpy.context.scene
    frames = arguments["frames"] or [scene.frame_current]
    groups = {} if arguments["show"] == SCENE else _asked_groups(scene, arguments)
    sheet = _Sheet(arguments, report, 0 if arguments["show"] == OBJECTS else len(frames))
    for frame in frames[: 1 if arguments["show"] == OBJECTS else None]:
        sheet.take(scene, frame, groups if frame == frames[0] else {})
    return {
        "title": scene.name,
        "scene": sheet.scene,
        "objects": sheet.objects,
        "patches": sheet.patches,
        "notes": list(dict.fromkeys(sheet.notes)),
    }


class _Sheet:
    """Collects the stills of a call: ``scene``, ``objects``, ``patches``, as the caller gets them, and ``notes``."""

    def __init__(self, arguments, report, total):
        self._arguments, self._report, self._total = arguments, report, total
        self._ends = time.monotonic() + arguments["seconds"]
        self._files = self._done = 0
        self._took = []  # seconds of each still that was rendered
        self._digest = None  # of the scene at its frame
        self.scene, self.objects, self.patches, self.notes = [], [], [], []

    def take(self, scene, frame, groups):
        """The still of the scene at a frame, and those of ``groups`` (names of objects, by title)."""
        if self.scene and self._is_late:
            self.notes.append(f"Not shown, for want of time: frame {frame}.")
            return
        width, side = self._arguments["size"]
        width = width or min(_WIDEST, _width_of(scene.render))
        with at_frame(scene, frame, self.notes), LitStudio(scene.frame_current) as studio:
            self._digest = lasting_digest(scene)
            subject = copy_of(studio, SCENE, scene.name, None, self.notes)
            camera = scene.camera
            side_of_view = camera_side(width, scene.render) if camera else width
            renderer = PreviewRenderer(
                studio, subject, self._arguments["folder"], side_of_view, first=self._files
            )
            renderer.set_up(True, False, [])
            if subject.gases:
                self.notes.append(
                    f"Drawn as blocks, without its shader: the gas of {quoted(sorted(subject.gases), _NAMED)}. "
                    "blender_render shows it."
                )
            with renderer.cleaned_up():
                # From outside, materials are seen best on the objects: these come first while there is time.
                present = _present(groups, subject, self.notes)
                alike = _alike(present, self._arguments["first"], as_given=bool(self._arguments["objects"]))
                vast = _vast(scene, subject, present, alike)
                self._total += min(len(alike), _MOST_OBJECTS) + len(vast)
                if camera is None:
                    self._take_objects(renderer, present, alike, side)
                    self._take_patches(renderer, present, vast, side)
                if self._arguments["show"] != OBJECTS:
                    self._take_scene(scene, renderer, camera, width)
                if camera is not None:
                    self._take_objects(renderer, present, alike, side)
                    self._take_patches(renderer, present, vast, side)
            self._files = renderer.files
            if frame == self.scene[0]["frame"] if self.scene else True:
                note_missing(subject, self.notes)

    def _take_scene(self, scene, renderer, camera, width):
        if self.objects and self._is_late:
            self.notes.append("The scene as a whole is not shown, for want of time.")
            return
        self._say(f"frame {scene.frame_current}")

        def render():
            views = list(renderer.camera_view(camera, scene.render, self.notes)) if camera else []
            (view,) = views or renderer.fixed_views(lambda *_: None, 1, views=(_THREE_QUARTER,))
            return {**view, "frame": scene.frame_current}

        self.scene.append(self._still(("scene", width), render))

    def _take_objects(self, renderer, groups, alike, side):
        many, late = [], []
        for name, others in alike.items():
            owners = groups[name]
            if len(self.objects) == _MOST_OBJECTS:
                many.append(name)
                continue
            if self.objects and self._is_late:
                late.append(name)
                continue
            self._say(name)
            self.objects.append(
                {
                    **self._still(
                        (sorted(owners), side),
                        lambda owners=owners: dict(
                            zip(_ALONE, renderer.alone(owners, _THREE_QUARTER[1], side), strict=True)
                        ),
                    ),
                    "name": name,
                    "materials": _materials_of(owners)[:_LISTED],
                    "alike": others[:_LISTED],
                    "alike_in_all": len(others),
                    "bare": sorted(owner for owner in owners if not _materials_of({owner}))[:_LISTED],
                }
            )
        if many:
            self.notes.append(
                f"Not shown alone, since at most {_MOST_OBJECTS} objects are in one call: {quoted(many, _NAMED)}. "
                "Name them as objects to see them."
            )
        if late:
            spent = f"{self._arguments['seconds']:g} seconds were over"
            self.notes.append(
                f"Not shown alone, since the {spent}: {quoted(late, _NAMED)}. Call again with "
                "show='objects' and these names."
            )

    def _take_patches(self, renderer, groups, vast, side):
        shown = {one["name"] for one in self.objects}
        for name, patch in vast.items():
            if name in shown and not self._is_late:
                self._say(f"{name}, close up")
                owners = groups[name]
                still = self._still(
                    (sorted(owners), side, "patch"),
                    lambda owners=owners, patch=patch: dict(
                        zip(_ALONE, renderer.patch(owners, _THREE_QUARTER[1], side, *patch), strict=True)
                    ),
                )
                self.patches.append({**still, "name": name})

    @property
    def _is_late(self):
        return time.monotonic() > self._ends

    def _still(self, shows, render):
        """What ``render`` says of the picture that it makes; without its file, where the caller has it as it would be.

        ``shows`` tells it from other pictures of the scene as it is.
        """
        key = self._digest and digest_of((self._digest, shows))
        if key in self._arguments["kept"] and key in _made:
            return {**_made[key], "file": None, "key": key}
        began = time.monotonic()
        said = render()
        self._took.append(time.monotonic() - began)
        if key is not None:
            _made[key] = said
            while len(_made) > _MOST_MADE:
                del _made[next(iter(_made))]
        return {**said, "key": key}

    def _say(self, what):
        if self._took:
            left = (self._total - self._done) * sum(self._took) / len(self._took)
            what = f"{what}, about {left:.0f} s to go"
        self._report(self._done, self._total, what)
        self._done += 1


def _width_of(render):
    """The width of the scene's pictures in pixels, as far as previews go."""
    return max(_NARROWEST, render.resolution_x * render.resolution_percentage // 100)


def _asked_groups(scene, arguments):
    """{title: names of Blender's objects}. Raises Refused.

    Under ``only_first``: what ``first`` names, in whole or in part, or by its material or a collection that has it, and
    what has objects that are not among the ``old`` ones (None: nothing is known of these).
    """
    if arguments["objects"] or not arguments["only_first"]:
        return _groups(scene, arguments["objects"])
    groups = _groups(scene, ())
    grouped = set().union(*groups.values())
    groups |= {obj.name: {obj.name} for obj in scene.objects if obj.name not in grouped}
    wanted = set(arguments["first"])
    held = [one for one in scene.collection.children_recursive if one.name in wanted]
    named = wanted.union(obj.name for one in held for obj in one.all_objects)
    old = set(arguments["old"]) if arguments["old"] is not None else grouped | groups.keys()
    return {
        title: owners
        for title, owners in groups.items()
        if title in wanted or owners & named or owners - old or wanted.intersection(_materials_of(owners))
    }


def _groups(scene, names):
    """{title: names of Blender's objects}: of these names, none: of all objects of the protocol, lacking those, of all
    of Blender's. Raises Refused.
    """
    names = names or [one.name for one in object_collections(scene)] or scene.objects.keys()
    return {name: {obj.name for obj in objects} for name, objects in objects_named(scene, names).items()}


def _present(groups, subject, notes):
    """The groups without what is not drawn; of those of which nothing is left, a note."""
    drawn = {piece.owner for piece in subject.pieces}
    present = {name: owners & drawn for name, owners in groups.items()}
    named = [name for name, owners in present.items() if not owners and _has_surface(groups[name])]
    if named:
        notes.append(f"Nothing to see of {quoted(named, _NAMED)}.")
    present = {name: owners for name, owners in present.items() if owners}
    points = without_size(subject.pieces, present)
    if points:
        notes.append(f"Not shown alone, without any size at this frame: {quoted(points, _NAMED)}.")
    return {name: owners for name, owners in present.items() if name not in points}


def _has_surface(owners):
    return any(bpy.data.objects[owner].type in DRAWABLE for owner in owners)


def _alike(groups, wanted, *, as_given):
    """{name: those that have the same materials and as many parts, and are not shown}.

    As they were given; or first those that are ``wanted``, then those that show materials that none before has: of
    these what acts, then what has the most.
    """
    if as_given:
        return {name: [] for name in groups}
    first, alike, seen = {}, {}, set()
    rank = {name: at for at, name in enumerate(wanted)}
    last = len(rank)
    order = {
        name: (rank.get(name, last), not _acts(name), -len(_materials_of(groups[name]))) for name in groups
    }
    for name in sorted(groups, key=order.__getitem__):
        materials = _materials_of(groups[name])
        look = (tuple(materials), len(groups[name])) if materials else name
        if look in first:
            alike[first[look]].append(name)
        else:
            first[look] = name
            alike[name] = []
    new = {}
    for name in alike:
        materials = {*_materials_of(groups[name])}
        new[name] = bool(materials - seen)
        seen |= materials
    return {
        name: alike[name] for name in sorted(alike, key=lambda name: (rank.get(name, last), not new[name]))
    }


def _vast(scene, subject, groups, names):
    """{name: where and how wide a close picture is to be} of those that are far larger than the scene's others."""
    boxes = boxes_of(subject.pieces)
    every = grouped_boxes(scene, boxes)
    vast = {}
    for name in names:
        others = [box for title, box in every.items() if title != name and title not in groups[name]]
        box = BoundingBox.around(boxes[owner] for owner in groups[name])
        if patch := patch_of(box, others):
            vast[name] = patch
    return dict(list(vast.items())[:_MOST_PATCHES])


def _acts(name):
    """Whether the protocol's object is tagged as moved or changed by anything."""
    collection = bpy.data.collections.get(name)
    kinds = [collection.get(tag) for tag in ("deformation_kind", "motion_kind")] if collection else []
    return any(kind not in {None, "none"} for kind in kinds)


def _materials_of(owners):
    """The names of the materials of objects."""
    slots = (slot for owner in owners for slot in bpy.data.objects[owner].material_slots)
    return sorted({slot.material.name for slot in slots if slot.material})
