# SPDX-License-Identifier: GPL-3.0-or-later
"""Previews of one mesh, one object, one system or the whole scene, from fixed sides. Does not change the scene."""

import contextlib
import math
import os

import bpy
from mathutils import Matrix

from simworlds.sandbox.inside.refusal import Refused

from ..blend.names import listed, nearest, quoted
from ..blend.protocol_tags import GROUND, OBJECT, ROLE, ROOT, SYSTEM, object_collections
from ..blend.visibility import as_rendered
from ..physics import stepped_frames
from ..physics.caches import unbaked
from .framing import (
    CLOSE,
    LOOSE,
    SMALLEST,
    VIEWS,
    WIDE,
    BoundingBox,
    boxes_of,
    camera_rotation,
    choose_framed,
    fit,
    turn_of,
    turned_views,
    without_size,
)
from .room_cutaway import RoomCutaway
from .room_detection import find_room, large_pieces
from .scene_copy import DRAWABLE, SceneCopy
from .studio_scene import REACH, StudioScene, drawing_engine

MESH, SCENE = "mesh", "scene"  # kinds of subjects, besides OBJECT and SYSTEM
_NAMED = 6  # in a note; the rest are counted
_OUTLINE = 6000  # points from which the framing is chosen
_LABELS = 14
_LABELLED = {"top", "three-quarter"}
_SMALL = 0.4  # share of what is framed: of smaller subjects there is a close view
_SHADOWED = 300_000  # faces; of more, shadows take seconds
_SCATTERED = 12  # faces of dots and strands cost this many times as much as a solid's
_IN_ROOM = 0.4  # slant of the light in a room, low so that the walls' shadows do not cover its content
_FILE = ".preview-{}.png"
_LARGEST = 1e9  # metres across that can still be drawn
_FARTHEST = 1000 * REACH  # of a camera from its subject
_CAMERA_WIDER = 2  # times a panel that the camera's picture may be wide


def preview(arguments, report):
    """Renders pictures of ``kind`` (mesh, object, system, scene) ``name`` at ``frame`` (None: the current one).

    ``everything``: frame grounds and skies as well. ``subjects``: names of objects, of the protocol's or of Blender's,
    that the scene is about; none: all but grounds. If they are small in the views, one view more is close to them. One
    mesh or object is seen along its own axes. The pictures are left in ``folder``, larger than their ``size``, to
    which the caller shrinks them. Returns what the preview's text needs, with the names of the files.
    """
    scene, kind, notes = bpy.context.scene, arguments["kind"], []
    title, objects = _subject(scene, kind, arguments.get("name"), notes)
    engine = drawing_engine(notes)
    with at_frame(scene, arguments.get("frame"), notes), StudioScene(engine) as studio:
        subject = copy_of(studio, kind, title, objects, notes)
        renderer = PreviewRenderer(studio, subject, arguments["folder"], arguments["size"])
        is_layout = kind in {SYSTEM, SCENE}
        wanted = _subjects(scene, subject, arguments["subjects"], notes) if kind == SCENE else {}
        renderer.set_up(is_layout, arguments["everything"], notes, labelled=wanted)
        camera = scene.camera if kind == SCENE else None
        turn = 0.0 if is_layout else turn_of(_root_of(objects).matrix_world)
        with renderer.cleaned_up():
            views = list(
                renderer.fixed_views(report, len(VIEWS) + (camera is not None), views=turned_views(turn))
            )
            views += renderer.close_view([name for owners in wanted.values() for name in owners])
            if camera is not None:
                report(len(views), len(views) + 1, "camera")
                views += renderer.camera_view(camera, scene.render, notes)
        note_missing(subject, notes)
        return {
            "title": title,
            "frame": scene.frame_current,
            "objects": len({piece.owner for piece in subject.pieces}),
            "low": list(renderer.whole.low),
            "high": list(renderer.whole.high),
            "views": views,
            "notes": notes,
            "engine": engine,
            "turned": round(math.degrees(turn), 1),
        }


# The subject


def _root_of(objects):
    """The root of an object of the protocol; lacking that, the first of Blender's."""
    return next((obj for obj in objects if obj.get(ROOT)), objects[0])


def _subjects(scene, subject, names, notes):
    """{name: the drawn objects of it}: of these names, or of all the protocol's objects but those of the ground."""
    drawn = {piece.owner for piece in subject.pieces}
    tagged = {one.name: {obj.name for obj in one.all_objects} & drawn for one in object_collections(scene)}
    if names:
        known = {name: {name} for name in drawn} | tagged
        if unknown := [name for name in names if not known.get(name)]:
            notes.append(f"Nothing to see of {_listed(unknown)}.")
        found = {name: known[name] for name in names if known.get(name)}
        if points := without_size(subject.pieces, found):
            notes.append(f"Without any size at this frame: {_listed(points)}.")
        return found
    ground = scene.collection.children_recursive
    ground = {child.name for one in ground if one.name == GROUND for child in one.children_recursive}
    return {name: owners for name, owners in tagged.items() if owners and name not in ground}


def _subject(scene, kind, name, notes):
    """(title, objects: None for all). Raises Refused, with the nearest names."""
    if kind == SCENE:
        return scene.name, None
    if kind == MESH:
        if name not in scene.objects:
            raise Refused(_unknown(name, MESH, scene.objects.keys(), scene))
        return name, [scene.objects[name]]
    collections = {child.name: child for child in scene.collection.children_recursive}
    tagged = [other for other, collection in collections.items() if collection.get(ROLE) == kind]
    if name not in collections:
        raise Refused(_unknown(name, kind, tagged or list(collections), scene))
    collection = collections[name]
    role = collection.get(ROLE)
    if role != kind:
        state = f"is tagged {ROLE}={role!r}" if role else f"has no {ROLE}"
        notes.append(f"The collection {name!r} {state}; it is shown as a{'n' * (kind == OBJECT)} {kind}.")
    objects = list(collection.all_objects)
    if not objects:
        raise Refused(f"The collection {name!r} is empty.")
    return name, objects


def _unknown(name, kind, known, scene):
    """The message for a name that does not exist."""
    what = {MESH: "object", OBJECT: "object collection", SYSTEM: "system collection"}.get(kind, kind)
    message = f"There is no {what} {name!r} in the scene {scene.name!r}."
    if near := nearest(name, known, 4):
        return f"{message} Nearest: {', '.join(map(repr, near))}."
    return f"{message} There are: {_listed(known)}." if known else f"{message} There is none at all."


def _listed(names):
    return quoted(names, _NAMED)


@contextlib.contextmanager
def at_frame(scene, frame, notes):
    """Takes the scene to a frame and back; leaves it where it is if the jump would spoil a simulation."""
    here, part = scene.frame_current, scene.frame_subframe
    if frame is None:
        frame = here
    held = stepped_frames.last_held(scene)
    waiting = [cache["label"] for cache in unbaked(scene)]
    if frame != here and waiting and (held is None or frame > held):
        verb = "is" if len(waiting) == 1 else "are"
        notes.append(
            f"Shown at frame {here}, not {frame}: {listed(waiting, _NAMED)} {verb} not baked, and frames of unbaked "
            "simulations must not be skipped. Bake first, or step to the frame."
        )
        frame = here
    # What is hidden may be part of a simulation.
    with contextlib.nullcontext() if waiting else as_rendered(scene):
        if frame == here:
            bpy.context.view_layer.update()
            yield
            return
        # Changing the frame puts animated objects back onto their keys, which undoes moves that are not keyed.
        moved = [(obj, obj.matrix_basis.copy()) for obj in scene.objects if obj.animation_data]
        scene.frame_set(frame)
        try:
            yield
        finally:
            scene.frame_set(here, subframe=part)
            for obj, basis in moved:
                if obj.matrix_basis != basis:
                    obj.matrix_basis = basis


def copy_of(studio, kind, title, objects, notes):
    """A copy of the subject; if all of it is hidden, a copy all the same, with a note. Raises Refused."""
    graph = bpy.context.evaluated_depsgraph_get()
    subject = SceneCopy(studio, graph, objects, unrendered=kind == MESH)
    if kind == MESH and not subject.pieces and subject.hidden:
        subject.copy_unevaluated(objects[0])
        if subject.pieces:
            notes.append(f"{title!r} is hidden in the viewport: it is shown without its modifiers.")
            subject.hidden = []
    elif not subject.pieces and subject.unrendered:
        subject = SceneCopy(studio, graph, objects, unrendered=True)
        notes.append("All of it is hidden from renders.")
    if subject.pieces:
        return subject
    raise Refused(
        _why_nothing_visible(subject, f"The scene {title!r}" if kind == SCENE else repr(title), objects)
    )


def _why_nothing_visible(subject, what, objects):
    """Why there is nothing to draw."""
    if subject.broken:
        name, why = next(iter(subject.broken.items()))
        return f"{what} cannot be drawn: {name!r}: {why}."
    if subject.hidden:
        return f"{what} has nothing to draw. Hidden in the viewport: {_listed(subject.hidden)}."
    if subject.empty:
        return f"{what} has nothing to draw. Without faces or strands: {_listed(subject.empty)}."
    if subject.gasless:
        return f"{what} has nothing to draw. {_without_gas().capitalize()}: {_listed(subject.gasless)}."
    objects = list(bpy.context.scene.objects if objects is None else objects)
    drawable = [obj.name for obj in objects if obj.type in DRAWABLE]
    if drawable:
        return f"{what} has nothing to draw. Not in the view layer: {_listed(drawable)}."
    kinds = sorted({obj.type for obj in objects})
    return f"{what} has no geometry: {'it holds only ' + ', '.join(kinds) if kinds else 'it is empty'}."


def _without_gas():
    return f"without gas at frame {bpy.context.scene.frame_current}"


def note_missing(subject, notes):
    """Adds to ``notes`` what the copy lacks."""
    for name, why in list(subject.broken.items())[:_NAMED]:
        notes.append(f"Not shown: {name!r}: {why}.")
    for names, why in (
        (subject.hidden, "hidden in the viewport"),
        (subject.unrendered, "hidden from renders"),
        (subject.empty, "without faces or strands"),
        (subject.gasless, _without_gas()),
    ):
        if names:
            notes.append(f"Not shown, {why}: {_listed(names)}.")
    if subject.left_out:
        notes.append(f"There are too many instances: {subject.left_out} are not shown.")


# Pictures


class PreviewRenderer:
    """Renders the pictures of a scene copy. ``whole``: the box that is framed, in metres of the world; ``away``: how
    far cameras stand from it, in units of the studio scene."""

    def __init__(self, studio, subject, folder, size, *, first=0):
        """``first``: the number of the first picture's file."""
        self._studio, self._subject, self._folder, self._size = studio, subject, folder, size
        self._first = self._files = first

    def set_up(self, is_layout, everything, notes, *, around=(), labelled=()):
        """Chooses the framing and fills the studio scene; a layout does not frame what is far too large or far away.

        ``around``: names of objects to be framed, if any of them can be seen, instead of all; no room is opened then.
        ``labelled``: names that are labelled before all others.
        """
        boxes = boxes_of(self._subject.pieces)
        wanted = {name: boxes[name] for name in around if name in boxes} or boxes
        framed, beyond, outside = sorted(wanted), [], []
        if is_layout and not everything:
            framed, beyond, outside = choose_framed(wanted, self._subject.templates)
        self.whole = BoundingBox.around(boxes[name] for name in framed)
        self._margin = WIDE if len(wanted) < len(boxes) else LOOSE if beyond else CLOSE
        across = self.whole.diagonal
        if across < SMALLEST:
            raise Refused(
                f"There is nothing to draw at frame {bpy.context.scene.frame_current}: all of it lies in one point, as "
                "what is scaled to 0. Ask for a frame at which it has a size."
            )
        if across > _LARGEST:
            raise Refused(f"It is {across:.3g} m across, too large to draw.")
        if beyond:
            notes.append(f"Larger than the pictures: {_listed(beyond)}.")
        for name in outside[:_NAMED]:
            place = ", ".join(f"{round(part / across, 4) * across:.4g}" for part in boxes[name].centre)
            notes.append(f"Outside the pictures, far away: {name!r} at ({place}) m.")
        framed_pieces = [piece for piece in self._subject.pieces if piece.owner in set(framed)]
        most = max(8, _OUTLINE // len(framed_pieces))
        self._outline = [place for piece in framed_pieces for place in piece.outline(most)]
        self._labels = _labels(bpy.context.scene, boxes, self.whole, labelled) if is_layout else {}
        studio = self._studio
        studio.aim(self.whole.centre, across)
        pieces = self._subject.pieces
        large = large_pieces(studio, pieces) if is_layout and not around else []
        placed = [(piece, studio.add(piece.data, piece.matrix)) for piece in large]
        self._owners = {obj: piece.owner for piece, obj in placed}
        self._placed = list(placed)
        self._room = find_room(studio, placed, grouped_boxes(bpy.context.scene, boxes).values())
        self._opening = RoomCutaway(studio, self._room)
        if self._opening.fault:
            notes.append(f"Rooms are shown with all their walls: {self._opening.fault}.")
        for piece in pieces:
            if piece not in large:
                self._placed.append((piece, studio.add(piece.data, piece.matrix)))
        self._faces = sum(
            len(getattr(piece.data, "polygons", ())) * (1 if piece.is_solid else _SCATTERED)
            for piece in pieces
        )
        self._camera = studio.camera()
        self._camera.data.type = "ORTHO"
        # What is framed is in the middle of the studio; what is around it may reach farther than that.
        reach = BoundingBox.around(boxes.values()).diagonal * studio.scale if around else 0.0
        self.away = min(2 * REACH + reach, _FARTHEST)
        self._camera.data.clip_end = 2 * self.away

    @property
    def files(self):
        """The number of the next picture's file."""
        return self._files

    @contextlib.contextmanager
    def cleaned_up(self):
        """Removes the pictures rendered so far if a later one fails."""
        try:
            yield
        except BaseException:
            for number in range(self._first, self._files):
                with contextlib.suppress(OSError):
                    os.remove(os.path.join(self._folder, _FILE.format(number)))
            raise

    def fixed_views(self, report, total, marks=(), views=VIEWS):
        """The pictures from the fixed sides; with ``marks``, where in them these places of the world are."""
        for number, (name, towards, up) in enumerate(views):
            report(number, total, name)
            rotation = camera_rotation(towards, up)
            middle, across = self._aim(self._outline, rotation, self._margin)
            with self._opening.towards(rotation) as cut:
                file = self._render(self._camera, (self._size, self._size), self._slant(towards, cut))
            yield {
                "name": name,
                "file": file,
                "size": [self._size, self._size],
                "metres_per_pixel": across / self._size,
                "axes": _axes(rotation),
                "cut_away": sorted({self._owners[obj] for obj in cut}),
                "labels": self._label_pixels(rotation, middle, across) if name in _LABELLED else [],
                **(
                    {"marks": [self._pixel_of(mark, rotation, middle, across) for mark in marks]}
                    if marks
                    else {}
                ),
                "ground": self._size * (0.5 + middle.z / across) if not towards[2] else None,
            }

    def close_view(self, owners):
        """The three-quarter picture of some objects (names) among all others; none if they are large in all views."""
        mine = [piece for piece, _ in self._placed if piece.owner in owners]
        if not mine or not SMALLEST <= BoundingBox.around(mine).diagonal <= _SMALL * self.whole.diagonal:
            return
        name, towards, up = next(view for view in VIEWS if view[0] == "three-quarter")
        most = max(8, _OUTLINE // len(mine))
        whole, self._outline = self._outline, [place for piece in mine for place in piece.outline(most)]
        margin, self._margin = self._margin, LOOSE
        try:
            (view,) = self.fixed_views(lambda *_: None, 1, views=((name, towards, up),))
        finally:
            self._outline, self._margin = whole, margin
        yield {**view, "name": "subjects"}

    def camera_view(self, camera, render, notes):
        """The picture through a camera of the scene; none, and a note, if it cannot be rendered."""
        obj = studio_camera(self._studio, camera)
        if obj is None:
            notes.append(
                f"The scene's camera {camera.name!r} is neither perspective nor orthographic, so its view is not shown."
            )
            return
        data = obj.data
        aspect = _aspect(render)
        width = min(self._size * _CAMERA_WIDER, round(self._size * aspect))
        size = (max(16, width), max(16, min(self._size, round(width / aspect))))
        # Within a closed room all would lie in the shadow of its walls.
        file = self._render(obj, size, slant=0.0 if self._room or self._faces > _SHADOWED else 1.0)
        lens = f"{data.lens:.3g} mm" if data.type == "PERSP" else "orthographic"
        yield {
            "name": f"camera {camera.name!r}",
            "file": file,
            "size": list(size),
            "metres_per_pixel": None,
            "axes": [],  # a picture through a camera is to show what the camera sees, and nothing over it
            "cut_away": [],
            "labels": [],
            "ground": None,
            "lens": lens,
        }

    def _aim(self, outline, rotation, margin):
        """Turns the camera to points of the world; returns the middle of its picture and the width, in metres."""
        middle, across = fit(outline, rotation, margin)
        self._point(rotation, middle, across)
        return middle, across

    def _point(self, rotation, middle, across):
        """Turns the camera to a place of the world; its picture is so many metres wide."""
        matrix = rotation.to_4x4()
        matrix.translation = (
            self._studio.placed(Matrix.Translation(middle)).translation + rotation.col[2] * self.away
        )
        self._camera.matrix_world = matrix
        self._camera.data.ortho_scale = across * self._studio.scale

    def alone(self, owners, towards, side):
        """The picture, ``side`` pixels wide, of some objects (names) without all others: (file, metres a pixel)."""
        mine = [piece for piece, _ in self._placed if piece.owner in owners]
        most = max(8, _OUTLINE // max(1, len(mine)))
        outline = [place for piece in mine for place in piece.outline(most)]
        _, across = self._aim(outline, camera_rotation(towards, (0, 0, 1)), CLOSE)
        return self._render_only(owners, side), across / side

    def patch(self, owners, towards, side, near, across):
        """The picture of some objects as ``alone``, of so many metres of them, nearest to a place."""
        self._point(camera_rotation(towards, (0, 0, 1)), self._nearest(owners, near), across)
        return self._render_only(owners, side), across / side

    def _render_only(self, owners, side):
        others = [obj for piece, obj in self._placed if piece.owner not in owners and not obj.hide_render]
        for obj in others:
            obj.hide_render = True
        try:
            return self._render(self._camera, (side, side), 1.0)
        finally:
            for obj in others:
                obj.hide_render = False

    def _nearest(self, owners, near):
        """The point of the surface of some objects that is nearest to a place of the world."""
        graph = self._studio.update()
        points = []
        for piece, obj in self._placed:
            if piece.owner in owners and getattr(piece.data, "polygons", ()):
                origin = piece.matrix.inverted_safe() @ near
                found, point, *_ = obj.closest_point_on_mesh(origin, depsgraph=graph)
                points += [piece.matrix @ point] if found else []
        return min(points, key=lambda point: (point - near).length, default=near)

    def _label_pixels(self, rotation, middle, across):
        """[name, x, y] of what is labelled, in pixels from the upper left."""
        return [
            [name, *self._pixel_of(place, rotation, middle, across)] for name, place in self._labels.items()
        ]

    def _pixel_of(self, place, rotation, middle, across):
        """Pixels from the upper left of a place in the world."""
        right, up, _ = rotation.transposed() @ (place - middle)
        return [(0.5 + right / across) * self._size, (0.5 - up / across) * self._size]

    def _slant(self, towards, cut):
        """How much aside the light is to come from: shadows cost most of the time, and tell most as seen from above."""
        if not towards[2] or self._faces > _SHADOWED:
            return 0.0
        return _IN_ROOM if cut else 1.0

    def _render(self, camera, size, slant):
        file = _FILE.format(self._files)
        self._files += 1
        self._studio.render(camera, size, os.path.join(self._folder, file), slant=slant)
        return file


def camera_side(width, render):
    """The side of the fixed views beside which a camera's view is so wide; of an upright picture, so high."""
    return round(width / min(max(_aspect(render), 1.0), _CAMERA_WIDER))


def _aspect(render):
    return (render.resolution_x * render.pixel_aspect_x) / (render.resolution_y * render.pixel_aspect_y)


def studio_camera(studio, camera):
    """A copy of a camera of the scene in the studio; None if it is neither perspective nor orthographic."""
    seen = camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
    matrix = seen.matrix_world.copy()
    is_placed = all(math.isfinite(part) for row in matrix for part in row)
    if seen.type != "CAMERA" or seen.data.type == "PANO" or not is_placed:
        return None
    data = seen.data.copy()
    obj = studio.camera(data, matrix)
    data.animation_data_clear()
    data.dof.use_dof = False
    data.clip_start, data.clip_end = data.clip_start * studio.scale, data.clip_end * studio.scale
    data.ortho_scale *= studio.scale
    return obj


def grouped_boxes(scene, boxes):
    """The boxes of the protocol's objects, and of those of Blender's that belong to none, by name."""
    groups, members = {}, set()
    for collection in object_collections(scene):
        own = {obj.name for obj in collection.all_objects} & boxes.keys()
        if own:
            groups[collection.name] = BoundingBox.around(boxes[name] for name in own)
            members |= own
    return groups | {name: box for name, box in boxes.items() if name not in members and name not in groups}


def _labels(scene, boxes, whole, first):
    """The centres of the largest objects of the protocol (lacking those, of Blender's), those that fill the picture
    left out."""
    tagged = {collection.name for collection in object_collections(scene)}
    groups = grouped_boxes(scene, boxes)
    small = {
        name: box
        for name, box in groups.items()
        if (name in tagged or not tagged) and whole.meets(box) and box.diagonal < 0.6 * whole.diagonal
    }
    largest = sorted(small, key=lambda name: (name not in first, -small[name].diagonal))[:_LABELS]
    return {name: small[name].centre for name in largest}


def _axes(rotation):
    """Of each axis of the world, its letter and where it points in the picture: right, up, towards the viewer."""
    return [[letter, *row] for letter, row in (("X", rotation[0]), ("Y", rotation[1]), ("Z", rotation[2]))]
