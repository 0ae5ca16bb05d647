# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the scene at its current frame, from given views. Does not change the scene."""

import bpy
from mathutils import Matrix

from .framing import BoundingBox
from .material_colours import PreviewMaterial
from .proxy_meshes import octahedra
from .scene_copy import SceneCopy
from .studio_scene import REACH, StudioScene, drawing_engine

_PALE = 0.62  # how much the surroundings are whitened
_SLACK = 0.5  # of a view's width: what is this far in front of the actor is shown, unless it hides it
_SPARED, _MARGIN = (
    0.1,
    0.02,
)  # of an actor's depth, and of a view's width: stays in front of some of its points
_PASSED = 8  # own surfaces that a ray passes
_MARK = PreviewMaterial((0.9, 0.2, 0.02), 1)
_MARK_RADIUS = 1.8  # pixels


class PictureJob:
    """A picture to render: ``objects`` (names) stand out in it; ``points`` are some of theirs. Places that are
    ``marks`` get a dot, as large from afar as close by. ``cut``: names of what hides them and was cut away."""

    def __init__(self, objects, points, view, path, marks=()):
        self.objects, self.points, self.view, self.path, self.marks = objects, points, view, path, marks
        self.cut = ()


class FramePictures:
    """Renders pictures of the current frame. ``notes`` collects what a viewer must know about them."""

    def __init__(self, scene):
        self._scene = scene
        self.notes = []
        self._engine = drawing_engine(self.notes)
        self.missing = {}  # names of objects that no picture shows, and why

    def render(self, jobs):
        """Renders the jobs at the current frame; yields after each."""
        graph = bpy.context.evaluated_depsgraph_get()
        with StudioScene(self._engine) as studio:
            scene_copy = SceneCopy(studio, graph, None)
            for names, why in (
                (scene_copy.hidden, "hidden in the viewport"),
                (scene_copy.unrendered, "hidden from renders"),
                (scene_copy.broken, "its geometry or transform is not finite"),
            ):
                self.missing.update(dict.fromkeys(names, why))
            seen = BoundingBox.around(job.view.box for job in jobs)
            studio.aim(seen.centre, seen.diagonal)
            placed = [(piece.owner, studio.add(piece.data, piece.matrix)) for piece in scene_copy.pieces]
            camera = studio.camera()
            camera.data.type, camera.data.sensor_fit = "ORTHO", "HORIZONTAL"
            for job in jobs:
                _highlight(studio, placed, job.objects)
                _aim_camera(studio, camera, job.view, self._near_plane(graph, job))
                dots = _add_dots(studio, job)
                studio.render(camera, job.view.size, job.path)
                if dots is not None:
                    dots.hide_render = True
                yield

    def _near_plane(self, graph, job):
        """From where on objects are shown, in metres in front of the view's centre."""
        view = job.view
        before = view.depth + _SLACK * view.width
        hiders = [self._hider(graph, job, point, before) for point in job.points]
        hiders = [name for name in hiders if name is not None]
        if len(hiders) <= len(job.points) / 2:
            return before
        job.cut = sorted(set(hiders))
        # On a way towards the viewer, what hides it at its farthest may be behind it at its nearest.
        depths = [(point - view.centre).dot(view.axes[2]) for point in job.points]
        return min(view.depth, max(depths) + _SPARED * (max(depths) - min(depths)) + _MARGIN * view.width)

    def _hider(self, graph, job, point, before):
        """The name of another object that hides a point; None without any."""
        view = job.view
        towards = view.axes[2]
        step = towards * (1e-4 * view.width)
        for _ in range(_PASSED):
            left = before - (point - view.centre).dot(towards)
            if left <= 0:
                return None
            hit, place, _, _, obj, _ = self._scene.ray_cast(graph, point + step, towards, distance=left)
            if not hit or obj.name not in job.objects:
                return obj.name if hit else None
            point = place
        return None


def _add_dots(studio, job):
    """An object with the dots of a job; None without any."""
    radius = _MARK_RADIUS * job.view.width / job.view.size[0]
    mesh = octahedra([(place, radius) for place in job.marks])
    if mesh is None:
        return None
    studio.owned(mesh).materials.append(studio.material(_MARK))
    return studio.add(mesh, Matrix())


def _highlight(studio, placed, names):
    """Makes the colours of all but the named objects pale."""
    for owner, obj in placed:
        for slot in obj.material_slots:
            slot.link = "DATA"
            if owner in names or slot.material is None:
                continue
            colour = slot.material.diffuse_color
            grey = sum(colour[:3]) / 3
            rgb = tuple(_PALE + (1 - _PALE) * (part + grey) / 2 for part in colour[:3])
            pale = studio.material(PreviewMaterial(rgb, colour[3]))
            slot.link = "OBJECT"
            slot.material = pale


def _aim_camera(studio, camera, view, before):
    right, up, towards = view.axes
    matrix = Matrix((right, up, towards)).transposed().to_4x4()
    matrix.translation = studio.placed(Matrix.Translation(view.centre)).translation + towards * (4 * REACH)
    camera.matrix_world = matrix
    camera.data.ortho_scale = view.width * studio.scale
    camera.data.clip_start = max(4 * REACH - before * studio.scale, 1e-3)
    camera.data.clip_end = 12 * REACH
    studio.scene.display.matcap_ssao_distance = view.width * studio.scale / 25
