# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of one mesh, one object, one system or the whole scene, from fixed sides; the scene stays as it is."""

import contextlib
import difflib
import math
import os

import bpy
from mathutils import Matrix

from simworlds.sandbox.inside.refusal import Refused

from ..physics.caches import unbaked
from ..render.graphics import best_engine
from .framing import CLOSE, LOOSE, VIEWS, WIDE, Box, boxes_of, fitted, focus, turned_to
from .room_cutaway import Opening
from .rooms import find_room, large_pieces
from .scene_copy import DRAWABLE, Likeness
from .studio_scene import REACH, Stage

MESH, OBJECT, SYSTEM, SCENE = "mesh", "object", "system", "scene"
_NAMED = 6  # in a note; the rest is counted
_OUTLINE = 6000  # points that are looked at to frame
_LABELS = 14
_SHADOWED = 300_000  # faces; of more, shadows take seconds
_SCATTERED = 12  # times as much as a solid's do those of dots and threads cost
_IN_ROOM = 0.4  # how much less slanting the light is there, for walls' shadows not to cover what is in it
_FILE = ".preview-{}.png"
_EXTREMES = (1e-9, 1e9)  # metres across that can still be drawn
_FARTHEST = 1000 * REACH  # from what the camera looks at
_CAMERA_WIDER = 2  # times a panel that the camera's picture may be wide


def preview(arguments, report):
    """Takes pictures of ``kind`` (mesh, object, system, scene) ``name`` at ``frame`` (None: the current one).

    ``everything``: also grounds and skies are framed. The pictures are left in ``folder``, to be shrunk to the size
    that is told of each. Returns what there is to say about them, with files' names.
    """
    scene, kind, notes = bpy.context.scene, arguments["kind"], []
    title, objects = _subject(scene, kind, arguments.get("name"), notes)
    engine, fault = best_engine()
    if fault:
        notes.append(f"Drawn by Cycles, more coarsely: Workbench cannot draw on this machine ({fault}).")
    with _at(scene, arguments.get("frame"), notes), Stage(engine) as stage:
        shot = shot_of(stage, kind, title, objects, notes)
        shoot = Shooting(stage, shot, arguments["folder"], arguments["size"])
        shoot.set_up(kind in {SYSTEM, SCENE}, arguments["everything"], notes)
        camera = scene.camera if kind == SCENE else None
        with shoot.cleaned_up():
            views = list(shoot.sides(report, len(VIEWS) + (camera is not None)))
            if camera is not None:
                report(len(views), len(views) + 1, "camera")
                views += shoot.through(camera, scene.render, notes)
        tell_missing(shot, notes)
        return {
            "title": title,
            "frame": scene.frame_current,
            "objects": len({piece.owner for piece in shot.pieces}),
            "low": list(shoot.whole.low),
            "high": list(shoot.whole.high),
            "views": views,
            "notes": notes,
            "engine": engine,
        }


# What is to be seen


def _subject(scene, kind, name, notes):
    """(title, objects: None for all). Raises Refused, with the nearest names."""
    if kind == SCENE:
        return scene.name, None
    if kind == MESH:
        if name not in scene.objects:
            raise Refused(_unknown(name, MESH, scene.objects.keys(), scene))
        return name, [scene.objects[name]]
    collections = {one.name: one for one in scene.collection.children_recursive}
    tagged = [one for one, found in collections.items() if found.get("protocol_role") == kind]
    if name not in collections:
        raise Refused(_unknown(name, kind, tagged or list(collections), scene))
    found = collections[name]
    if found.get("protocol_role") != kind:
        role = found.get("protocol_role")
        said = f"is tagged protocol_role={role!r}" if role else "has no protocol_role"
        notes.append(f"The collection {name!r} {said}; it was taken for a{'n' * (kind == OBJECT)} {kind}.")
    objects = list(found.all_objects)
    if not objects:
        raise Refused(f"The collection {name!r} is empty.")
    return name, objects


def _unknown(name, kind, known, scene):
    """What to say of a name that is not there."""
    lower = {one.lower(): one for one in reversed(known)}
    near = [lower[one] for one in difflib.get_close_matches(name.lower(), lower, 4, 0.5)]
    near += [one for one in known if name and name.lower() in one.lower() and one not in near][:3]
    what = {MESH: "object", OBJECT: "object collection", SYSTEM: "system collection"}.get(kind, kind)
    said = f"There is no {what} {name!r} in the scene {scene.name!r}."
    if near:
        return f"{said} Near: {', '.join(map(repr, near))}."
    if known:
        return f"{said} There are: {_listed(known)}."
    return f"{said} There is none at all."


def _listed(names):
    names = list(names)
    more = f" and {len(names) - _NAMED} more" if len(names) > _NAMED else ""
    return ", ".join(map(repr, names[:_NAMED])) + more


@contextlib.contextmanager
def _at(scene, frame, notes):
    """Brings the scene to a frame, and back; stays where it is if a simulation would be lost by a jump."""
    here, part = scene.frame_current, scene.frame_subframe
    if frame is None or frame == here:
        bpy.context.view_layer.update()
        yield
        return
    if waiting := unbaked(scene):
        labels = _listed_plainly(one["label"] for one in waiting)
        notes.append(
            f"Shown at frame {here}, not {frame}: {labels} not baked, and frames of unbaked simulations must not be "
            "jumped. Bake, or step there, first."
        )
        yield
        return
    # What was moved and not keyed is put back where its keys have it by the change of frame.
    moved = [(thing, thing.matrix_basis.copy()) for thing in scene.objects if thing.animation_data]
    scene.frame_set(frame)
    try:
        yield
    finally:
        scene.frame_set(here, subframe=part)
        for thing, basis in moved:
            if thing.matrix_basis != basis:
                thing.matrix_basis = basis


def _listed_plainly(labels):
    labels = list(labels)
    more = f" and {len(labels) - _NAMED} more" if len(labels) > _NAMED else ""
    return ", ".join(labels[:_NAMED]) + more + (" is" if len(labels) == 1 else " are")


def shot_of(stage, kind, title, objects, notes):
    """The snapshot of the subject; if it is hidden as a whole, of what would be seen of it. Raises Refused."""
    graph = bpy.context.evaluated_depsgraph_get()
    shot = Likeness(stage, graph, objects, unrendered=kind == MESH)
    if kind == MESH and not shot.pieces and shot.hidden:
        shot.take_unevaluated(objects[0])
        if shot.pieces:
            notes.append(f"{title!r} is hidden in the viewport: it is shown as it is without its modifiers.")
            shot.hidden = []
    elif not shot.pieces and shot.unrendered:
        shot = Likeness(stage, graph, objects, unrendered=True)
        notes.append("All of this is hidden from renders.")
    if shot.pieces:
        return shot
    raise Refused(_nothing(shot, f"The scene {title!r}" if kind == SCENE else repr(title), objects))


def _nothing(shot, what, objects):
    """Why there is nothing to be seen."""
    if shot.broken:
        name, why = next(iter(shot.broken.items()))
        return f"{what} cannot be drawn: {name!r}: {why}."
    if shot.hidden:
        return f"{what} has nothing to be seen; hidden in the viewport: {_listed(shot.hidden)}."
    if shot.empty:
        return f"{what} has nothing to be seen; without any face or thread: {_listed(shot.empty)}."
    objects = list(bpy.context.scene.objects if objects is None else objects)
    drawable = [thing.name for thing in objects if thing.type in DRAWABLE]
    if drawable:
        return f"{what} has nothing to be seen; not in the view layer: {_listed(drawable)}."
    kinds = sorted({thing.type for thing in objects})
    return f"{what} has no geometry: {'it holds only ' + ', '.join(kinds) if kinds else 'it is empty'}."


def tell_missing(shot, notes):
    """Adds to ``notes`` what the snapshot lacks."""
    for name, why in list(shot.broken.items())[:_NAMED]:
        notes.append(f"Not shown: {name!r}: {why}.")
    for names, why in (
        (shot.hidden, "hidden in the viewport"),
        (shot.unrendered, "hidden from renders"),
        (shot.empty, "without any face or thread"),
    ):
        if names:
            notes.append(f"Not shown, {why}: {_listed(names)}.")
    if shot.left_out:
        notes.append(f"Of many instances {shot.left_out} are not shown.")


# Pictures


class Shooting:
    """Takes the pictures of a snapshot. ``whole``: the box that is framed, in metres of the world; ``away``: how far
    from it cameras stand, in units of the stage."""

    def __init__(self, stage, shot, folder, size):
        self._stage, self._shot, self._folder, self._size = stage, shot, folder, size
        self._files = 0

    def set_up(self, is_layout, everything, notes, around=()):
        """Frames, and puts everything on the stage; a layout leaves out what is out of all proportion.

        ``around``: names of objects to be framed, if any of them can be seen, instead of all; no room is opened then.
        """
        boxes = boxes_of(self._shot.pieces)
        wanted = {name: boxes[name] for name in around if name in boxes} or boxes
        framed, beyond, outside = sorted(wanted), [], []
        if is_layout and not everything:
            framed, beyond, outside = focus(wanted, self._shot.templates)
        self.whole = Box.around(boxes[name] for name in framed)
        self._margin = WIDE if len(wanted) < len(boxes) else LOOSE if beyond else CLOSE
        across = self.whole.diagonal
        if not _EXTREMES[0] <= across <= _EXTREMES[1]:
            raise Refused(
                f"It is {across:.3g} m across, which is too {'small' if across < 1 else 'large'} to be drawn."
            )
        if beyond:
            notes.append(f"Reaching beyond the pictures: {_listed(beyond)}.")
        for name in outside[:_NAMED]:
            place = ", ".join(f"{round(part / across, 4) * across:.4g}" for part in boxes[name].centre)
            notes.append(f"Outside of the pictures, far away: {name!r} at ({place}) m.")
        shown = [piece for piece in self._shot.pieces if piece.owner in set(framed)]
        most = max(8, _OUTLINE // len(shown))
        self._outline = [place for piece in shown for place in piece.outline(most)]
        self._labels = _labels(bpy.context.scene, boxes, self.whole) if is_layout else {}
        stage = self._stage
        stage.aim(self.whole.centre, across)
        pieces = self._shot.pieces
        large = large_pieces(stage, pieces) if is_layout and not around else []
        placed = [(piece, stage.add(piece.data, piece.matrix)) for piece in large]
        self._owners = {thing: piece.owner for piece, thing in placed}
        self._room = find_room(stage, placed, boxes.values())
        self._opening = Opening(stage, self._room)
        if self._opening.fault:
            notes.append(f"Rooms are shown closed: {self._opening.fault}.")
        for piece in pieces:
            if piece not in large:
                stage.add(piece.data, piece.matrix)
        self._faces = sum(
            len(getattr(piece.data, "polygons", ())) * (1 if piece.is_solid else _SCATTERED)
            for piece in pieces
        )
        self._camera = stage.camera()
        self._camera.data.type = "ORTHO"
        # What is framed is in the middle of the stage; what is around it may reach farther than that.
        reach = Box.around(boxes.values()).diagonal * stage.scale if around else 0.0
        self.away = min(2 * REACH + reach, _FARTHEST)
        self._camera.data.clip_end = 2 * self.away

    @contextlib.contextmanager
    def cleaned_up(self):
        """Removes the pictures that were taken if another one fails."""
        try:
            yield
        except BaseException:
            for number in range(self._files):
                with contextlib.suppress(OSError):
                    os.remove(os.path.join(self._folder, _FILE.format(number)))
            raise

    def sides(self, report, total, marks=()):
        """The pictures from the fixed sides; with ``marks``, where in them these places of the world are."""
        for number, (name, towards, up) in enumerate(VIEWS):
            report(number, total, name)
            rotation = turned_to(towards, up)
            middle, across = fitted(self._outline, rotation, self._margin)
            place = self._stage.placed(Matrix.Translation(middle)).translation
            matrix = rotation.to_4x4()
            matrix.translation = place + rotation.col[2] * self.away
            self._camera.matrix_world = matrix
            self._camera.data.ortho_scale = across * self._stage.scale
            with self._opening.towards(rotation) as cut:
                file = self._shoot(self._camera, (self._size, self._size), self._slant(towards, cut))
            yield {
                "name": name,
                "file": file,
                "size": [self._size, self._size],
                "metres_per_pixel": across / self._size,
                "axes": _axes(rotation),
                "cut_away": sorted({self._owners[thing] for thing in cut}),
                "labels": self._seen(rotation, middle, across) if name == "top" else [],
                **(
                    {"marks": [self._place_of(one, rotation, middle, across) for one in marks]}
                    if marks
                    else {}
                ),
                "ground": self._size * (0.5 + middle.z / across) if not towards[2] else None,
            }

    def through(self, camera, render, notes):
        """The picture that a camera of the scene takes; none, and a note, if that cannot be had."""
        seen = camera.evaluated_get(bpy.context.evaluated_depsgraph_get())
        matrix = seen.matrix_world.copy()
        if (
            seen.type != "CAMERA"
            or seen.data.type == "PANO"
            or not all(math.isfinite(part) for row in matrix for part in row)
        ):
            notes.append(
                f"The scene's camera {camera.name!r} is no plain camera, so that its view is not shown."
            )
            return
        data = seen.data.copy()
        thing = self._stage.camera(data, matrix)
        data.animation_data_clear()
        data.dof.use_dof = False
        scale = self._stage.scale
        data.clip_start, data.clip_end = data.clip_start * scale, data.clip_end * scale
        data.ortho_scale *= scale
        aspect = (render.resolution_x * render.pixel_aspect_x) / (render.resolution_y * render.pixel_aspect_y)
        width = min(self._size * _CAMERA_WIDER, round(self._size * aspect))
        size = (max(16, width), max(16, min(self._size, round(width / aspect))))
        # Within a closed room all would lie in the shadow of its walls.
        file = self._shoot(thing, size, slant=0.0 if self._room or self._faces > _SHADOWED else 1.0)
        lens = f"{data.lens:.3g} mm" if data.type == "PERSP" else "orthographic"
        yield {
            "name": f"camera {camera.name!r}",
            "file": file,
            "size": list(size),
            "metres_per_pixel": None,
            "axes": _axes(matrix.to_3x3().normalized()),
            "cut_away": [],
            "labels": [],
            "ground": None,
            "lens": lens,
        }

    def _seen(self, rotation, middle, across):
        """[name, x, y] of what is labelled, in pixels from the upper left."""
        return [
            [name, *self._place_of(place, rotation, middle, across)] for name, place in self._labels.items()
        ]

    def _place_of(self, place, rotation, middle, across):
        """Pixels from the upper left of a place in the world."""
        right, up, _ = rotation.transposed() @ (place - middle)
        return [(0.5 + right / across) * self._size, (0.5 - up / across) * self._size]

    def _slant(self, towards, cut):
        """How much aside the light is to come from: shadows cost most of the time, and tell most as seen from above."""
        if not towards[2] or self._faces > _SHADOWED:
            return 0.0
        return _IN_ROOM if cut else 1.0

    def _shoot(self, camera, size, slant):
        file = _FILE.format(self._files)
        self._files += 1
        self._stage.shoot(camera, size, os.path.join(self._folder, file), slant=slant)
        return file


def _labels(scene, boxes, whole):
    """The centres of the largest objects of the protocol (lacking those, of Blender's), those that fill the picture
    left out."""
    groups = {}
    for collection in scene.collection.children_recursive:
        if collection.get("protocol_role") == OBJECT:
            found = [boxes[thing.name] for thing in collection.all_objects if thing.name in boxes]
            if found:
                groups[collection.name] = Box.around(found)
    groups = groups or boxes
    small = {
        name: box for name, box in groups.items() if whole.meets(box) and box.diagonal < 0.6 * whole.diagonal
    }
    largest = sorted(small, key=lambda name: -small[name].diagonal)[:_LABELS]
    return {name: small[name].centre for name in largest}


def _axes(rotation):
    """Of each axis of the world, its letter and where it points in the picture: right, up, towards the viewer."""
    return [[letter, *row] for letter, row in (("X", rotation[0]), ("Y", rotation[1]), ("Z", rotation[2]))]
