# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the open scene in which what is at fault stands out, and where in them the faults are."""

import contextlib
import os

import bpy
from mathutils import Matrix, Vector

from ..blend.protocol_tags import OBJECT, ROLE
from ..render.engines import best_engine
from .fixed_views import SCENE, PreviewRenderer, copy_of, note_missing
from .framing import VIEWS, BoundingBox, boxes_of, turned_to
from .material_colours import CLAY, PreviewMaterial
from .shader_values import between
from .studio_scene import StudioScene

_OTHERS = PreviewMaterial(CLAY, 0.32, 0.8)
_PARTNER, _CLEAR = (0.16, 0.3, 0.55), 0.55  # in a close-up: of the second of two; all is seen through
_LARGE = 3.0  # times the smallest thing that a finding is about: what is larger is only tinged
_SECOND, _TINGE = 0.6, 0.35  # how much of the colour the second of two things has, and what is large
_CLOSE_UPS = 4
_TIMES, _AROUND = (
    12.0,
    1.4,
)  # how much a close-up shows: of the fault's size, but of the smaller thing at most
_FLAT, _TILT = 1e-4, 0.2  # metres, radians
_FILE = ".close-up-{}.png"
_FRONT, _RIGHT = VIEWS[0], VIEWS[1]


def picture(arguments, report):
    """Four views, framed on what ``findings`` are about, and close-ups of the first of them that have a place.

    Each finding has ``objects`` (names), ``colour``, ``at`` (None: in the middle of its first object), ``size`` of the
    fault in metres (None: no length), ``frame`` (None: now; at another one it has no place here), ``marked``. All else
    is drawn faintly; without findings, everything is as it is. ``whole``: the views show all of the scene. Each tells
    where the marked ones are, as ``marks``: pixels from the upper left, None for one without a place. The pictures are
    left in ``folder``, the views' ``size`` pixels a side, those from close by ``close`` pixels.
    """
    scene, notes = bpy.context.scene, []
    engine, engine_fault = best_engine()
    if engine_fault:
        notes.append(
            f"Drawn by Cycles, more coarsely: Workbench cannot draw on this machine ({engine_fault})."
        )
    with StudioScene(engine) as stage:
        shot = copy_of(stage, SCENE, scene.name, None, notes)
        boxes = boxes_of(shot.pieces)
        faults = [_Fault(finding, scene, boxes) for finding in arguments["findings"]]
        marked = [fault for fault in faults if fault.marked]
        plain = {piece: piece.data for piece in shot.pieces}
        if faults:
            _paint(stage, shot.pieces, _tints(faults))
        renderer = PreviewRenderer(stage, shot, arguments["folder"], arguments["size"])
        around = list(boxes) if arguments.get("whole") else [name for fault in faults for name in fault.small]
        renderer.set_up(True, False, notes, around=around)
        places = [fault.place for fault in marked if fault.place is not None]
        with renderer.cleaned_up():
            views = list(renderer.sides(report, len(VIEWS), places))
            for view in views:
                seen = iter(view.get("marks", ()))
                view["marks"] = [None if fault.place is None else next(seen) for fault in marked]
            close = _CloseUps(stage, plain, renderer.away, arguments["folder"], arguments["close"])
            closed = [close.render(at, fault) for at, fault in enumerate(marked) if fault.is_small][
                :_CLOSE_UPS
            ]
        note_missing(shot, notes)
        return {
            "title": scene.name,
            "frame": scene.frame_current,
            "views": views,
            "close": closed,
            "notes": notes,
        }


class _Fault:
    """A finding: ``names`` of the drawn objects that it is about, ``first`` those that its first name stands for,
    ``small`` those that stand for nothing much larger than the smallest, ``place`` in the world or None."""

    def __init__(self, finding, scene, boxes):
        self.colour, self.size, self.marked = tuple(finding["colour"]), finding["size"], finding["marked"]
        groups = [names for name in finding["objects"] if (names := _drawn(scene, name, boxes))]
        around = [BoundingBox.around(boxes[name] for name in group) for group in groups]
        least = min((box.diagonal for box in around), default=0.0)
        self.names = list(dict.fromkeys(name for group in groups for name in group))
        self.first = groups[0] if groups else []
        self.small = [
            name
            for group, box in zip(groups, around)  # noqa: B905
            for name in group
            if box.diagonal <= _LARGE * least
        ]
        self.boxes = around[:2]
        is_now = finding["frame"] in (None, scene.frame_current)
        self.place = Vector(finding["at"]) if finding["at"] is not None and is_now else None
        self.is_small = self.place is not None and self.size is not None and bool(self.names)
        if self.place is None and around and is_now:
            self.place = around[0].centre


def _drawn(scene, name, boxes):
    """The drawn objects that the name of an object, root, collection or part (``Object/Part``) stands for."""
    owner, _, part = name.partition("/")
    obj = scene.objects.get(part or name)
    if obj is not None and obj.name in boxes:
        return [obj.name]
    collections = {collection.name: collection for collection in scene.collection.children_recursive}
    inside = [collections[owner]] if owner in collections else obj.users_collection if obj else ()
    tagged = [collection for collection in inside if collection.get(ROLE) == OBJECT]
    names = dict.fromkeys(member.name for collection in tagged for member in collection.all_objects)
    return [member for member in names if member in boxes]


def _tints(faults):
    """Object → surface: of the first finding that it is about. The first of several things has the full colour, others
    less of it, and what is but the ground of it is only tinged."""
    tints = {}
    for names, share, alpha in (("first", 1.0, 1.0), ("small", _SECOND, 1.0), ("names", _TINGE, 0.5)):
        for fault in faults:
            for name in getattr(fault, names):
                if names != "first" or name in fault.small:
                    tints.setdefault(name, PreviewMaterial(between(CLAY, fault.colour, share), alpha, 0.6))
    return tints


def _paint(stage, pieces, tints):
    """Colours what is at fault, and makes everything else faint. Copies that share a mesh get one each."""
    painted = {}
    for piece in pieces:
        surface = tints.get(piece.owner, _OTHERS)
        key = (piece.data.as_pointer(), surface.rgb, surface.alpha)
        if key not in painted:
            painted[key] = _painted(stage, piece.data, surface)
        piece.data = painted[key]


def _painted(stage, data, surface):
    """A copy of a data-block, all of one look."""
    painted = stage.owned(data.copy())
    material, slots = stage.material(surface), painted.materials
    for at in range(len(slots)):
        slots[at] = material
    if not len(slots):
        slots.append(material)
    return painted


class _CloseUps:
    """Pictures of single faults, with nothing in them but what they are about."""

    def __init__(self, stage, plain, away, folder, size):
        self._stage, self._plain, self._away = stage, plain, away
        self._folder, self._size = folder, size
        for obj in stage.scene.objects:
            obj.hide_render = True
        self._camera = stage.camera()
        self._camera.data.type = "ORTHO"
        self._camera.data.clip_end = 2 * away

    def render(self, number, fault):
        """The picture of a fault, seen across the way in which its two things lie beside each other."""
        name, towards, up = _RIGHT if _axis(fault.boxes) == 1 else _FRONT
        rotation = turned_to(towards, up)
        if any(min(box.size) < _FLAT for box in fault.boxes):
            rotation = rotation @ Matrix.Rotation(-_TILT, 3, "X")  # a sheet seen edge-on cannot be seen
        whole = _AROUND * min(box.diagonal for box in fault.boxes)
        across = min(_TIMES * fault.size or whole, whole)
        matrix = rotation.to_4x4()
        matrix.translation = self._stage.placed(Matrix.Translation(fault.place)).translation
        matrix.translation += rotation.col[2] * self._away
        self._camera.matrix_world = matrix
        self._camera.data.ortho_scale = across * self._stage.scale
        added = []
        for piece, data in self._plain.items():
            if piece.owner in fault.names:
                colour = fault.colour if piece.owner in fault.first else _PARTNER
                surface = PreviewMaterial(colour, _CLEAR)
                added.append(self._stage.add(_painted(self._stage, data, surface), piece.matrix))
        file = _FILE.format(number)
        try:
            self._stage.render(self._camera, (self._size,) * 2, os.path.join(self._folder, file), slant=0.0)
        except BaseException:
            with contextlib.suppress(OSError):
                os.remove(os.path.join(self._folder, file))
            raise
        for obj in added:
            obj.hide_render = True
        return {"mark": number, "name": name, "file": file, "metres_per_pixel": across / self._size}


def _axis(boxes):
    """The axis of the world along which two boxes lie farthest apart, or deepest in each other least."""
    first, second = boxes[0], boxes[-1]
    apart = [
        max(second.low[axis] - first.high[axis], first.low[axis] - second.high[axis]) for axis in range(3)
    ]
    return apart.index(max(apart))
