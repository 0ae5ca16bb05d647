# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the open scene that highlight findings, with the pixels where these are."""

import contextlib
import os

import bpy
from mathutils import Matrix, Vector

from ..blend.protocol_tags import OBJECT, ROLE
from .fixed_views import SCENE, PreviewRenderer, copy_of, note_missing
from .framing import VIEWS, BoundingBox, boxes_of, camera_rotation
from .material_colours import CLAY, PreviewMaterial
from .shader_values import interpolated
from .studio_scene import StudioScene, drawing_engine

_OTHERS = PreviewMaterial(CLAY, 0.32, 0.8)
_PARTNER, _CLEAR = (0.16, 0.3, 0.55), 0.55  # in a close-up: colour of the second object; alpha of everything
_LARGE = 3.0  # times the smallest object of a finding: larger objects are only tinted
_SECOND, _TINT = 0.6, 0.35  # share of the colour for the second object, and for large ones
_CLOSE_UPS = 4
_TIMES, _AROUND = (
    12.0,
    1.4,
)  # width of a close-up: in sizes of the finding, at most in sizes of the smaller object
_FLAT, _TILT = 1e-4, 0.2  # metres, radians
_FILE = ".close-up-{}.png"
_FRONT, _RIGHT = VIEWS[0], VIEWS[1]


def findings_image(arguments, report):
    """Renders four views, framed on the objects of ``findings``, and close-ups of the first findings with a place.

    Each finding has ``objects`` (names), ``colour``, ``at`` (None: in the middle of its first object), ``size`` of the
    finding in metres (None: it has none), ``frame`` (None: the current one; at another one it has no place here), and
    ``marked``. Everything else is faint; without findings, everything is as it is. ``whole``: the views show the whole
    scene. ``marks`` of a view are the pixels of the marked findings, from the upper left, None without a place.
    The pictures are in ``folder``, the views ``size`` pixels wide, the close-ups ``close`` pixels.
    """
    scene, notes = bpy.context.scene, []
    engine = drawing_engine(notes)
    with StudioScene(engine) as studio:
        subject = copy_of(studio, SCENE, scene.name, None, notes)
        boxes = boxes_of(subject.pieces)
        findings = [_Finding(entry, scene, boxes) for entry in arguments["findings"]]
        marked = [finding for finding in findings if finding.marked]
        plain = {piece: piece.data for piece in subject.pieces}
        if findings:
            _paint(studio, subject.pieces, _tints(findings))
        renderer = PreviewRenderer(studio, subject, arguments["folder"], arguments["size"])
        small = [name for finding in findings for name in finding.small]
        around = list(boxes) if arguments.get("whole") else small
        renderer.set_up(True, False, notes, around=around)
        places = [finding.place for finding in marked if finding.place is not None]
        with renderer.cleaned_up():
            views = list(renderer.fixed_views(report, len(VIEWS), places))
            for view in views:
                seen = iter(view.get("marks", ()))
                view["marks"] = [None if finding.place is None else next(seen) for finding in marked]
            close = _CloseUps(studio, plain, renderer.away, arguments["folder"], arguments["close"])
            small = [(at, finding) for at, finding in enumerate(marked) if finding.is_small][:_CLOSE_UPS]
            close_ups = [close.render(at, finding) for at, finding in small]
        note_missing(subject, notes)
        return {
            "title": scene.name,
            "frame": scene.frame_current,
            "views": views,
            "close": close_ups,
            "notes": notes,
        }


class _Finding:
    """A finding: ``names`` of its drawn objects, ``first`` those of its first object, ``small`` those of objects that
    are not much larger than the smallest, ``place`` in the world or None."""

    def __init__(self, finding, scene, boxes):
        self.colour, self.size, self.marked = tuple(finding["colour"]), finding["size"], finding["marked"]
        groups = [names for name in finding["objects"] if (names := _drawn(scene, name, boxes))]
        around = [BoundingBox.around(boxes[name] for name in group) for group in groups]
        least = min((box.diagonal for box in around), default=0.0)
        self.names = list(dict.fromkeys(name for group in groups for name in group))
        self.first = groups[0] if groups else []
        self.small = [
            name
            for group, box in zip(groups, around, strict=True)
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


def _tints(findings):
    """Object → material, by its first finding. The first object of a finding has the full colour, others less of it,
    much larger ones only a tint."""
    tints = {}
    for names, share, alpha in (("first", 1.0, 1.0), ("small", _SECOND, 1.0), ("names", _TINT, 0.5)):
        for finding in findings:
            for name in getattr(finding, names):
                if names != "first" or name in finding.small:
                    tints.setdefault(
                        name, PreviewMaterial(interpolated(CLAY, finding.colour, share), alpha, 0.6)
                    )
    return tints


def _paint(studio, pieces, tints):
    """Colours what is at finding, and makes everything else faint. Copies that share a mesh get one each."""
    painted = {}
    for piece in pieces:
        surface = tints.get(piece.owner, _OTHERS)
        key = (piece.data.as_pointer(), surface.rgb, surface.alpha)
        if key not in painted:
            painted[key] = _painted(studio, piece.data, surface)
        piece.data = painted[key]


def _painted(studio, data, surface):
    """A copy of a data-block with one material."""
    painted = studio.owned(data.copy())
    material, slots = studio.material(surface), painted.materials
    for at in range(len(slots)):
        slots[at] = material
    if not len(slots):
        slots.append(material)
    return painted


class _CloseUps:
    """Pictures of single findings, which show only their objects."""

    def __init__(self, studio, plain, away, folder, size):
        self._studio, self._plain, self._away = studio, plain, away
        self._folder, self._size = folder, size
        for obj in studio.scene.objects:
            obj.hide_render = True
        self._camera = studio.camera()
        self._camera.data.type = "ORTHO"
        self._camera.data.clip_end = 2 * away

    def render(self, number, finding):
        """The picture of a finding, seen from the side, so that its two objects are next to each other."""
        name, towards, up = _RIGHT if _axis(finding.boxes) == 1 else _FRONT
        rotation = camera_rotation(towards, up)
        if any(min(box.size) < _FLAT for box in finding.boxes):
            rotation = rotation @ Matrix.Rotation(-_TILT, 3, "X")  # a sheet seen edge-on is invisible
        whole = _AROUND * min(box.diagonal for box in finding.boxes)
        across = min(_TIMES * finding.size or whole, whole)
        matrix = rotation.to_4x4()
        matrix.translation = self._studio.placed(Matrix.Translation(finding.place)).translation
        matrix.translation += rotation.col[2] * self._away
        self._camera.matrix_world = matrix
        self._camera.data.ortho_scale = across * self._studio.scale
        added = []
        for piece, data in self._plain.items():
            if piece.owner in finding.names:
                colour = finding.colour if piece.owner in finding.first else _PARTNER
                surface = PreviewMaterial(colour, _CLEAR)
                added.append(self._studio.add(_painted(self._studio, data, surface), piece.matrix))
        file = _FILE.format(number)
        try:
            self._studio.render(self._camera, (self._size,) * 2, os.path.join(self._folder, file), slant=0.0)
        except BaseException:
            with contextlib.suppress(OSError):
                os.remove(os.path.join(self._folder, file))
            raise
        for obj in added:
            obj.hide_render = True
        return {"mark": number, "name": name, "file": file, "metres_per_pixel": across / self._size}


def _axis(boxes):
    """The world axis along which two boxes are farthest apart, or overlap least."""
    first, second = boxes[0], boxes[-1]
    apart = [
        max(second.low[axis] - first.high[axis], first.low[axis] - second.high[axis]) for axis in range(3)
    ]
    return apart.index(max(apart))
