# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes a twin of the open scene: it looks the same at every frame, and nothing in it is simulated.

``keys``: all motion is keyed in the file: places at each frame, stored shapes, things shown in turn. ``files``: it is
played from files. Gases are played from the files of their bake in both. What is transferred is found by comparing the
clip with that of the scene without its physics.
"""

import os

import bpy
import numpy
from mathutils import Matrix

from . import gases, keyed, played_files, strands
from .placing import put
from .recording import Film, points_of
from .stripping import strip

_MOST_KEYED = 200  # particles: of more, an object for each would be slow to save and to open
_films = {}  # path of the scene → what it shows, and what it shows without physics


def copy(kind, files):
    """Turns the open scene into its twin. Files that it plays lie beside, and begin with ``files``.

    Returns how many objects are moved, shaped, shown as particles, or otherwise.
    """
    path = bpy.data.filepath
    if path not in _films:
        _films.clear()
        whole = Film().take()
        strip()
        _films[path] = whole, Film().take()
        bpy.ops.wm.open_mainfile(filepath=path, load_ui=False, use_scripts=False)
    whole, bare = _films[path]
    twin = _Twin(kind, os.path.join(os.path.dirname(path), files), whole, bare)
    twin.take_along()
    strip()
    twin.transfer()
    bpy.context.scene.frame_set(whole.frames[0])
    return twin.told


class _Twin:
    def __init__(self, kind, beside, film, bare):
        self._by_files, self._beside, self._film = kind == "files", beside, film
        shaped = film.shaped(bare)
        self._gases = {
            thing.name for thing in bpy.context.scene.objects if gases.settings_of(thing) is not None
        }
        self._reshaped = {name for name in shaped if film.changes_points(name)} - self._gases
        self._shaped = shaped - self._reshaped - self._gases
        self._moved = film.moved(bare) - self._shaped - self._reshaped - self._gases
        self.told = {
            "moved": len(self._moved),
            "shaped": len(self._shaped),
            "reshaped": len(self._reshaped),
            "gases": len(self._gases),
            "particles": len({key for now in film.particles for key in now}),
            "hair": len(film.hair[0]),
        }

    # What the solvers are needed for

    def take_along(self):
        """Takes what is gone without the solvers: meshes as they are shown, gases' files."""
        things = bpy.context.scene.objects
        self._meshes = {name: self._mesh(things[name]) for name in self._shaped | self._meshed()}
        self._pages = {}
        for name in sorted(self._reshaped):
            if self._by_files:
                played_files.export(things[name], self._film.frames, self._file(name, "abc"))
            else:
                self._pages[name] = self._each_frame(things[name])
        self._volumes = {name: gases.volume_of(things[name]) for name in self._gases}
        self._looks = {key: strands.look_of(things[key[0]], key[1]) for key in self._film.hair[0]}

    def _meshed(self):
        """Names of what moves as a whole and is a mesh, which files play as one."""
        things = bpy.context.scene.objects
        return {name for name in self._moved if things[name].type == "MESH"} if self._by_files else set()

    def _mesh(self, thing):
        bpy.context.scene.frame_set(self._film.frames[0])
        graph = bpy.context.evaluated_depsgraph_get()
        return bpy.data.meshes.new_from_object(
            thing.evaluated_get(graph), preserve_all_data_layers=True, depsgraph=graph
        )

    def _each_frame(self, thing):
        found = []
        for frame in self._film.frames:
            bpy.context.scene.frame_set(frame)
            graph = bpy.context.evaluated_depsgraph_get()
            found.append(bpy.data.meshes.new_from_object(thing.evaluated_get(graph), depsgraph=graph))
        return found

    # What takes their place

    def transfer(self):
        """Gives the scene, which has no physics any more, the motion that it had."""
        things = bpy.context.scene.objects
        for name in sorted(self._moved - self._meshed()):
            keyed.move(things[name], self._film.frames, self._film.poses[name])
        for name in sorted(self._meshes):
            self._place(things[name], self._meshes[name])
        for name in sorted(self._reshaped):
            self._replace(things[name])
        for name in sorted(self._gases):
            gases.put_in_place(things[name], *self._volumes[name])
        self._show_particles()
        if self._film.hair[0]:
            self._show_hair()

    def _place(self, thing, mesh):
        """A mesh that is shaped, or that files move."""
        frames, poses, shapes = self._film.frames, self._film.poses[thing.name], self._film.shapes[thing.name]
        thing.modifiers.clear()
        thing.data = mesh
        if not self._by_files:
            if not _still(poses):
                keyed.move(thing, frames, poses)
            keyed.reshape(thing, frames, shapes)
            return
        keyed.free(thing)
        thing.matrix_world = Matrix(poses[0])
        back = numpy.linalg.inv(poses[0])
        moved = [_through(back @ pose, points) for pose, points in zip(poses, shapes, strict=True)]
        played_files.play(thing, frames, moved, self._file(thing.name, "pc2"))

    def _replace(self, thing):
        """A surface that is another one at each frame."""
        name, materials = thing.name, [slot.material for slot in thing.material_slots]
        if self._by_files:
            copied = played_files.imported(self._file(name, "abc"))
            copied.data.materials.clear()
            for material in materials:
                copied.data.materials.append(material)
            bpy.data.objects.remove(thing)
            copied.name = name
            return
        pages = [put(name, mesh, thing.matrix_world) for mesh in self._pages[name]]
        bpy.data.objects.remove(thing)
        keyed.show_in_turn(pages, self._film.frames)

    def _show_particles(self):
        """Each particle as an object that is keyed; or, by files or of many, all that show one thing as one mesh."""
        alive = {}
        for number, now in enumerate(self._film.particles):
            for key, (shown, pose) in now.items():
                alive.setdefault((shown, key), {})[number] = pose
        frames = self._film.frames
        tracks = {}
        for (shown, _), poses in sorted(alive.items()):
            gone = _nowhere(poses[min(poses)])
            tracks.setdefault(shown, []).append([poses.get(number, gone) for number in range(len(frames))])
        for shown, several in tracks.items():
            if self._by_files or len(several) > _MOST_KEYED:
                self._join(bpy.data.objects[shown], several)
                continue
            for poses in several:
                keyed.move(put(shown, bpy.data.objects[shown].data, Matrix()), frames, poses)

    def _join(self, shown, tracks):
        mesh = self._mesh(shown)
        points = points_of(mesh)
        shapes = [
            numpy.concatenate([_through(poses[number], points) for poses in tracks])
            for number in range(len(self._film.frames))
        ]
        thing = put(f"{shown.name} particles", _repeated(mesh, len(tracks)), Matrix())
        if self._by_files:
            played_files.play(thing, self._film.frames, shapes, self._file(thing.name, "pc2"))
        else:
            keyed.reshape(thing, self._film.frames, shapes)

    def _show_hair(self):
        for key in sorted(self._film.hair[0]):
            look = self._looks[key]
            pages = [put(key[1], strands.curves(key[1], now[key], look), Matrix()) for now in self._film.hair]
            keyed.show_in_turn(pages, self._film.frames)

    def _file(self, name, ending):
        safe = "".join(letter if letter.isalnum() else f"_{ord(letter):x}" for letter in name)
        return f"{self._beside}-{safe}.{ending}"


def _still(poses):
    return all(numpy.allclose(pose, poses[0], rtol=0, atol=1e-6) for pose in poses)


def _through(pose, points):
    return points @ pose[:3, :3].T.astype(numpy.float32) + pose[:3, 3].astype(numpy.float32)


def _nowhere(pose):
    """The pose of a particle that is not there: as small as nothing."""
    gone = pose.copy()
    gone[:3, :3] = numpy.eye(3) * 1e-9
    return gone


def _repeated(mesh, count):
    """A mesh as often as that, as one, shaded as it is."""
    made = bpy.data.meshes.new(mesh.name)
    size = len(mesh.vertices)
    edges, faces = ([tuple(each.vertices) for each in several] for several in (mesh.edges, mesh.polygons))
    starts = [size * number for number in range(count)]
    made.from_pydata(
        numpy.tile(points_of(mesh), (count, 1)).tolist(),
        [(first + start, last + start) for start in starts for first, last in edges],
        [tuple(start + corner for corner in face) for start in starts for face in faces],
    )
    for material in mesh.materials:
        made.materials.append(material)
    for several, name in (("polygons", "use_smooth"), ("edges", "use_edge_sharp")):
        found = numpy.empty(len(getattr(mesh, several)), dtype=bool)
        getattr(mesh, several).foreach_get(name, found)
        getattr(made, several).foreach_set(name, numpy.tile(found, count))
    return made
