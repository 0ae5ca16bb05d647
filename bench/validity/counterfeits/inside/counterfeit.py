# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a counterfeit of the open scene: it looks the same at every frame, but nothing in it is simulated.

``keys``: all motion is keyed in the file, as transforms at each frame, shape keys, objects shown one after another.
``files``: motion is played from files. Gases are played from the files of their bake in both. What to transfer is found
by comparing the clip with that of the scene without its physics.
"""

import os

import bpy
import numpy
from mathutils import Matrix

from . import gas_volumes, hair_curves, keyframes, played_files
from .clip_recording import ClipRecording, points_of
from .new_objects import add_object
from .physics_removal import remove_physics

_MOST_KEYED = 200  # particles: of more, an object for each would be slow to save and to open
_recordings = {}  # path of the scene → its recording, and that without physics


def make_counterfeit(kind, files):
    """Turns the open scene into a counterfeit. The files that it plays lie beside it; their names begin with ``files``.

    Returns how many objects are moved, shaped, shown as particles, and so on.
    """
    path = bpy.data.filepath
    if path not in _recordings:
        _recordings.clear()
        whole = ClipRecording().record()
        remove_physics()
        _recordings[path] = whole, ClipRecording().record()
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    whole, without_physics = _recordings[path]
    counterfeit = _Counterfeit(kind, os.path.join(os.path.dirname(path), files), whole, without_physics)
    counterfeit.record_solved_data()
    remove_physics()
    counterfeit.transfer()
    bpy.context.scene.frame_set(whole.frames[0])
    return counterfeit.counts


class _Counterfeit:
    """The open scene on its way to a counterfeit: record_solved_data, remove_physics, transfer."""

    def __init__(self, kind, beside, recording, without_physics):
        self._by_files, self._beside, self._recording = kind == "files", beside, recording
        shaped = recording.shaped(without_physics)
        self._gases = {
            obj.name for obj in bpy.context.scene.objects if gas_volumes.settings_of(obj) is not None
        }
        self._reshaped = {name for name in shaped if recording.changes_points(name)} - self._gases
        self._shaped = shaped - self._reshaped - self._gases
        self._moved = recording.moved(without_physics) - self._shaped - self._reshaped - self._gases
        self.counts = {
            "moved": len(self._moved),
            "shaped": len(self._shaped),
            "reshaped": len(self._reshaped),
            "gases": len(self._gases),
            "particles": len({key for now in recording.particles for key in now}),
            "hair": len(recording.hair[0]),
        }

    # While there are solvers

    def record_solved_data(self):
        """Stores what is lost without the solvers: evaluated meshes, files of gases, style of hair."""
        objects = bpy.context.scene.objects
        self._meshes = {name: self._mesh(objects[name]) for name in self._shaped | self._meshed()}
        self._meshes_by_frame = {}
        for name in sorted(self._reshaped):
            if self._by_files:
                played_files.export(objects[name], self._recording.frames, self._file(name, "abc"))
            else:
                self._meshes_by_frame[name] = self._each_frame(objects[name])
        self._volumes = {name: gas_volumes.volume_of(objects[name]) for name in self._gases}
        self._hair_styles = {
            key: hair_curves.style_of(objects[key[0]], key[1]) for key in self._recording.hair[0]
        }

    def _meshed(self):
        """Names of the moved objects whose meshes are played from files; of ``keys``, none."""
        objects = bpy.context.scene.objects
        return {name for name in self._moved if objects[name].type == "MESH"} if self._by_files else set()

    def _mesh(self, obj):
        bpy.context.scene.frame_set(self._recording.frames[0])
        graph = bpy.context.evaluated_depsgraph_get()
        return bpy.data.meshes.new_from_object(
            obj.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
        )

    def _each_frame(self, obj):
        meshes = []
        for frame in self._recording.frames:
            bpy.context.scene.frame_set(frame)
            graph = bpy.context.evaluated_depsgraph_get()
            meshes.append(bpy.data.meshes.new_from_object(obj.evaluated_get(graph), depsgraph=graph))
        return meshes

    # Without solvers

    def transfer(self):
        """Gives the scene without physics the motion that it had."""
        objects = bpy.context.scene.objects
        for name in sorted(self._moved - self._meshed()):
            keyframes.move(objects[name], self._recording.frames, self._recording.poses[name])
        for name in sorted(self._meshes):
            self._place(objects[name], self._meshes[name])
        for name in sorted(self._reshaped):
            self._replace(objects[name])
        for name in sorted(self._gases):
            gas_volumes.replace_domain(objects[name], *self._volumes[name])
        self._show_particles()
        if self._recording.hair[0]:
            self._show_hair()

    def _place(self, obj, mesh):
        """Transfers a mesh that is deformed, or moved by files."""
        frames, poses, shapes = (
            self._recording.frames,
            self._recording.poses[obj.name],
            self._recording.shapes[obj.name],
        )
        obj.modifiers.clear()
        obj.data = mesh
        if not self._by_files:
            if not _still(poses):
                keyframes.move(obj, frames, poses)
            keyframes.reshape(obj, frames, shapes)
            return
        keyframes.free(obj)
        obj.matrix_world = Matrix(poses[0])
        back = numpy.linalg.inv(poses[0])
        moved = [_through(back @ pose, points) for pose, points in zip(poses, shapes, strict=True)]
        played_files.play(obj, frames, moved, self._file(obj.name, "pc2"))

    def _replace(self, obj):
        """Transfers a surface that has another topology at each frame."""
        name, materials = obj.name, [slot.material for slot in obj.material_slots]
        if self._by_files:
            player = played_files.imported(self._file(name, "abc"))
            player.data.materials.clear()
            for material in materials:
                player.data.materials.append(material)
            bpy.data.objects.remove(obj)
            player.name = name
            return
        objects_by_frame = [add_object(name, mesh, obj.matrix_world) for mesh in self._meshes_by_frame[name]]
        bpy.data.objects.remove(obj)
        keyframes.show_in_turn(objects_by_frame, self._recording.frames)

    def _show_particles(self):
        """Keys an object for each particle; of many, or by files, joins all that show the same object to one mesh."""
        alive = {}
        for number, now in enumerate(self._recording.particles):
            for key, (instanced, pose) in now.items():
                alive.setdefault((instanced, key), {})[number] = pose
        frames = self._recording.frames
        tracks = {}
        for (instanced, _), poses in sorted(alive.items()):
            gone = _nowhere(poses[min(poses)])
            tracks.setdefault(instanced, []).append(
                [poses.get(number, gone) for number in range(len(frames))]
            )
        for instanced, several in tracks.items():
            if self._by_files or len(several) > _MOST_KEYED:
                self._join(bpy.data.objects[instanced], several)
                continue
            for poses in several:
                keyframes.move(
                    add_object(instanced, bpy.data.objects[instanced].data, Matrix()), frames, poses
                )

    def _join(self, instanced, tracks):
        mesh = self._mesh(instanced)
        points = points_of(mesh)
        shapes = [
            numpy.concatenate([_through(poses[number], points) for poses in tracks])
            for number in range(len(self._recording.frames))
        ]
        obj = add_object(f"{instanced.name} particles", _repeated(mesh, len(tracks)), Matrix())
        if self._by_files:
            played_files.play(obj, self._recording.frames, shapes, self._file(obj.name, "pc2"))
        else:
            keyframes.reshape(obj, self._recording.frames, shapes)

    def _show_hair(self):
        for key in sorted(self._recording.hair[0]):
            style = self._hair_styles[key]
            objects_by_frame = [
                add_object(key[1], hair_curves.curves(key[1], now[key], style), Matrix())
                for now in self._recording.hair
            ]
            keyframes.show_in_turn(objects_by_frame, self._recording.frames)

    def _file(self, name, ending):
        safe = "".join(letter if letter.isalnum() else f"_{ord(letter):x}" for letter in name)
        return f"{self._beside}-{safe}.{ending}"


def _still(poses):
    return all(numpy.allclose(pose, poses[0], rtol=0, atol=1e-6) for pose in poses)


def _through(pose, points):
    return points @ pose[:3, :3].T.astype(numpy.float32) + pose[:3, 3].astype(numpy.float32)


def _nowhere(pose):
    """The pose of a particle that does not exist: almost no size."""
    gone = pose.copy()
    gone[:3, :3] = numpy.eye(3) * 1e-9
    return gone


def _repeated(mesh, count):
    """Repeats a mesh ``count`` times in one mesh, with its shading."""
    data = bpy.data.meshes.new(mesh.name)
    size = len(mesh.vertices)
    edges, faces = ([tuple(each.vertices) for each in several] for several in (mesh.edges, mesh.polygons))
    starts = [size * number for number in range(count)]
    data.from_pydata(
        numpy.tile(points_of(mesh), (count, 1)).tolist(),
        [(first + start, last + start) for start in starts for first, last in edges],
        [tuple(start + corner for corner in face) for start in starts for face in faces],
    )
    for material in mesh.materials:
        data.materials.append(material)
    for several, name in (("polygons", "use_smooth"), ("edges", "use_edge_sharp")):
        flags = numpy.empty(len(getattr(mesh, several)), dtype=bool)
        getattr(mesh, several).foreach_get(name, flags)
        getattr(data, several).foreach_set(name, numpy.tile(flags, count))
    return data
