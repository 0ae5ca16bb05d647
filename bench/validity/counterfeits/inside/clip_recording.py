# SPDX-License-Identifier: GPL-3.0-or-later
"""Records a clip frame by frame: poses and shapes of objects, particles, hair."""

import bpy
import numpy

_SAME = 1e-5  # of the scene's units, and of a rotation's entries


class ClipRecording:
    """``frames``; for each of them, by object's name: ``poses`` (4 × 4) and ``shapes`` (points of meshes, own space).

    ``particles``: for each frame {(emitter, system, number): (object shown, its 4 × 4 in the world)}. ``hair``: for
    each frame {(object, system): strands, each an array of points in the world}.
    """

    def __init__(self):
        self.frames = list(clip())
        self.poses, self.shapes, self.particles, self.hair = {}, {}, [], []

    def record(self):
        """Plays the clip and records every frame. Returns the recording."""
        scene = bpy.context.scene
        for frame in self.frames:
            scene.frame_set(frame)
            graph = bpy.context.evaluated_depsgraph_get()
            for obj in scene.objects:
                evaluated = obj.evaluated_get(graph)
                self.poses.setdefault(obj.name, []).append(numpy.array(evaluated.matrix_world))
                if obj.type == "MESH":
                    self.shapes.setdefault(obj.name, []).append(points_of(evaluated.data))
            self.particles.append(_particles(graph))
            self.hair.append(_hair(scene, graph))
        return self

    def moved(self, other):
        """Names of the objects that have another pose in another recording of the scene, or are not in it."""
        return {
            name for name, poses in self.poses.items() if not _are_equal(poses, other.poses.get(name, ()))
        }

    def shaped(self, other):
        """Names of the objects that have another shape in another recording, or none."""
        return {
            name for name, shapes in self.shapes.items() if not _are_equal(shapes, other.shapes.get(name, ()))
        }

    def changes_points(self, name):
        """Whether the number of points of a shape changes."""
        return len({len(points) for points in self.shapes[name]}) > 1


def clip():
    """The scene's frames."""
    scene = bpy.context.scene
    return range(scene.frame_start, scene.frame_end + 1)


def points_of(mesh):
    """The points of a mesh, in its own space (n × 3)."""
    flat = numpy.empty(3 * len(mesh.vertices), dtype=numpy.float32)
    mesh.vertices.foreach_get("co", flat)
    return flat.reshape(-1, 3)


def _are_equal(first, second):
    return len(first) == len(second) and all(
        a.shape == b.shape and numpy.allclose(a, b, rtol=0, atol=_SAME)
        for a, b in zip(first, second, strict=True)
    )


def _particles(graph):
    particles = {}
    for instance in graph.object_instances:
        if instance.is_instance and instance.particle_system is not None:
            key = (instance.parent.original.name, instance.particle_system.name, instance.persistent_id[0])
            particles[key] = (instance.object.original.name, numpy.array(instance.matrix_world))
    return particles


def _hair(scene, graph):
    strands = {}
    for obj in scene.objects:
        evaluated = obj.evaluated_get(graph)
        for system in evaluated.particle_systems:
            settings = system.settings
            if settings.type == "HAIR" and settings.render_type == "PATH":
                strands[obj.name, system.name] = _strands(evaluated, system)
    return strands


def _strands(evaluated, system):
    settings, parents, children = system.settings, len(system.particles), len(system.child_particles)
    # Where hair has children, they are shown in its place.
    first = parents if children and not settings.use_parent_particles else 0
    steps = range(2**settings.display_step + 1)
    return [
        numpy.array([system.co_hair(object=evaluated, particle_no=number, step=step) for step in steps])
        for number in range(first, parents + children)
    ]
