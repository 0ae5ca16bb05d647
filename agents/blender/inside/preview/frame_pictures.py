# SPDX-License-Identifier: GPL-3.0-or-later
"""Pictures of the scene as it stands at a frame, from views of one's own; the scene itself is not touched."""

import bpy
from mathutils import Matrix

from ..render.engines import best_engine
from .framing import BoundingBox
from .material_colours import PreviewMaterial
from .scene_copy import SceneCopy
from .studio_scene import REACH, StudioScene

_PALE = 0.62  # how white the surroundings are made
_SLACK = 0.5  # of a view's width: what is so far before the actor is shown, unless it hides it
_PASSED = 8  # own surfaces that a look at a point goes through


class PictureJob:
    """A picture to be taken: ``objects`` (names) stand out in it; ``points`` are some of theirs."""

    def __init__(self, objects, points, view, path):
        self.objects, self.points, self.view, self.path = objects, points, view, path


class FramePictures:
    """Takes the pictures that are wanted at a frame. ``notes`` collects what a viewer has to know of them."""

    def __init__(self, scene):
        self._scene = scene
        self._engine, fault = best_engine()
        self.notes = []
        self.missing = {}  # names of objects that no picture shows, and why
        if fault:
            self.notes.append(
                f"Drawn by Cycles, more coarsely: Workbench cannot draw on this machine ({fault})."
            )

    def render(self, jobs):
        """Renders the jobs at the current frame; yields after each."""
        graph = bpy.context.evaluated_depsgraph_get()
        with StudioScene(self._engine) as stage:
            scene_copy = SceneCopy(stage, graph, None)
            for names, why in (
                (scene_copy.hidden, "hidden in the viewport"),
                (scene_copy.unrendered, "hidden from renders"),
                (scene_copy.broken, "its geometry or transform is not finite"),
            ):
                self.missing.update(dict.fromkeys(names, why))
            seen = BoundingBox.around(job.view.box for job in jobs)
            stage.aim(seen.centre, seen.diagonal)
            placed = [(piece.owner, stage.add(piece.data, piece.matrix)) for piece in scene_copy.pieces]
            camera = stage.camera()
            camera.data.type, camera.data.sensor_fit = "ORTHO", "HORIZONTAL"
            for job in jobs:
                _set_off(stage, placed, job.objects)
                _point(stage, camera, job.view, self._from_where(graph, job))
                stage.render(camera, job.view.size, job.path)
                yield

    def _from_where(self, graph, job):
        """How near to the viewer things are shown, in metres before the view's centre."""
        view = job.view
        before = view.depth + _SLACK * view.width
        hidden = sum(self._is_hidden(graph, job, point, before) for point in job.points)
        return view.depth if hidden > len(job.points) / 2 else before

    def _is_hidden(self, graph, job, point, before):
        """Whether a point is behind something else that is shown."""
        view = job.view
        towards = view.axes[2]
        step = towards * (1e-4 * view.width)
        for _ in range(_PASSED):
            left = before - (point - view.centre).dot(towards)
            if left <= 0:
                return False
            hit, place, _, _, obj, _ = self._scene.ray_cast(graph, point + step, towards, distance=left)
            if not hit or obj.name not in job.objects:
                return hit
            point = place
        return False


def _set_off(stage, placed, names):
    """Leaves the named objects their colours, and gives all others pale ones."""
    for owner, obj in placed:
        for slot in obj.material_slots:
            slot.link = "DATA"
            if owner in names or slot.material is None:
                continue
            colour = slot.material.diffuse_color
            grey = sum(colour[:3]) / 3
            rgb = tuple(_PALE + (1 - _PALE) * (part + grey) / 2 for part in colour[:3])
            pale = stage.material(PreviewMaterial(rgb, colour[3]))
            slot.link = "OBJECT"
            slot.material = pale


def _point(stage, camera, view, before):
    right, up, towards = view.axes
    matrix = Matrix((right, up, towards)).transposed().to_4x4()
    matrix.translation = stage.placed(Matrix.Translation(view.centre)).translation + towards * (4 * REACH)
    camera.matrix_world = matrix
    camera.data.ortho_scale = view.width * stage.scale
    camera.data.clip_start = max(4 * REACH - before * stage.scale, 1e-3)
    camera.data.clip_end = 12 * REACH
    stage.scene.display.matcap_ssao_distance = view.width * stage.scale / 25
