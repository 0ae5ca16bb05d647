# SPDX-License-Identifier: GPL-3.0-or-later
"""How large a scene would become if it were evaluated, from its settings alone, and the limits to that.

Nothing is evaluated here, so an estimate takes seconds whatever the scene asks for. It counts what grows by a
setting: modifiers, geometry nodes, curves, particles, instances, fluids, images, frames. What it lets through is still
bounded by the memory and the time of the process that evaluates it.
"""

import math

import bpy

from . import node_estimate, picture_size
from .animated_settings import AnimatedSettings
from .geometry_size import MOST_POINTS, TooLarge, base_size, grown
from .refusal import Refused

MOST_OBJECTS = 20_000
MOST_FRAMES = 50_000
MOST_PIXELS = 1 << 28  # of one image: 16,384 × 16,384
MOST_PARTICLES = 2_000_000
MOST_INSTANCES = 5_000_000
_NESTED = 8  # Blender shows instances of instances to this depth
_LONGEST_NAME = 60


def check_scene(scene, render=False):
    """Raises Refused if evaluating the scene could exceed a limit; ``render``: with the settings of a render.

    The message names the object, the setting, what it would come to, the limit, and what to do.
    """
    _check_objects()
    _check_frames(scene)
    _check_images()
    sizes = _Sizes(scene, render)
    for obj in bpy.data.objects:
        sizes.add(obj)
    _Instances(sizes).check(scene)


def _refuse(what, count, unit, most, advice):
    raise Refused(
        f"It is too heavy to evaluate: {what} would come to {_number(count)} {unit}; the limit is {most:,}. {advice}"
    )


def _number(count):
    """A count in words: exact while it can be read."""
    return f"{count:,}" if count < 10**21 else "more than 10^21"


def _called(block):
    """The name of a data-block or setting, quoted, without what a terminal would act on."""
    name = block.name if len(block.name) <= _LONGEST_NAME else f"{block.name[:_LONGEST_NAME]}…"
    return repr(name)


# Objects, frames, images


def _check_objects():
    count = len(bpy.data.objects)
    if count > MOST_OBJECTS:
        _refuse(
            "the file",
            count,
            "objects",
            MOST_OBJECTS,
            "Join objects, or show copies as instances of a collection.",
        )


def _check_frames(scene):
    count = scene.frame_end - scene.frame_start + 1
    if count > MOST_FRAMES:
        _refuse(
            f"the clip of scene {_called(scene)}", count, "frames", MOST_FRAMES, "Set its end frame earlier."
        )


def _check_images():
    for image in bpy.data.images:
        width, height = picture_size.of_image(image)
        if width * height > MOST_PIXELS:
            what = f"image {_called(image)} ({width} × {height})"
            _refuse(what, width * height, "pixels", MOST_PIXELS, "Use a smaller image.")


def _animated(scene):
    try:
        return AnimatedSettings(scene)
    except TooLarge as error:
        _refuse(error.setting, error.count, error.unit, error.most, "Bake or remove animation.")


# Geometry


class _Sizes:
    """Sizes of objects after their modifiers. ``render``: by the settings of a render, else of the viewport."""

    def __init__(self, scene, render):
        self.render = render
        animated = _animated(scene)
        self.high, self.low, self.high_of = animated.highest, animated.lowest, animated.highest_of
        self.of = {}  # object → Size
        self.particles = {}  # object → [(settings, particles and their children)]
        simplify = scene.render if scene.render.use_simplify else None
        kind = "_render" if render else ""
        self.most_levels = getattr(simplify, f"simplify_subdivision{kind}") if simplify else math.inf
        self.most_children = getattr(simplify, f"simplify_child_particles{kind}") if simplify else 1.0
        self._nodes = node_estimate.Trees(self)
        self._done = {}
        self._shared = set()
        self._points = self._count = 0
        self._largest = (0, None)

    def add(self, obj):
        """Adds an object. Raises Refused once a limit is exceeded."""
        size, is_grown = self._size(obj), any(self.is_used(modifier) for modifier in obj.modifiers)
        self.of[obj] = size
        points = size.points
        if not is_grown and obj.data is not None:
            if obj.data in self._shared:
                points = 0  # it uses the same memory as another object
            self._shared.add(obj.data)
        for settings, count in self.particles.get(obj, ()):
            self._count += count
            if self._count > MOST_PARTICLES:
                _refuse(
                    f"the particle systems, the last of them {_called(settings)} of object {_called(obj)},",
                    self._count,
                    "particles",
                    MOST_PARTICLES,
                    "Lower their number, or that of their children.",
                )
            points += count * _points_of_path(settings)
        self._points += points
        self._largest = max(self._largest, (points, obj.name), key=lambda pair: pair[0])
        if self._points > MOST_POINTS:
            _refuse(
                f"all objects together (the largest is {self._largest[1][:_LONGEST_NAME]!r} with "
                f"{_number(self._largest[0])})",
                self._points,
                "faces and points",
                MOST_POINTS,
                "Lower the resolution of the largest.",
            )

    def once(self, key, work):
        """The result of ``work()``, done once per key: objects that share data must not multiply the time."""
        if key not in self._done:
            self._done[key] = work()
        return self._done[key]

    def is_used(self, modifier):
        """Whether the modifier is evaluated."""
        return self.high(modifier, "show_render" if self.render else "show_viewport")

    def _size(self, obj):
        try:
            size = base_size(obj, self)
        except TooLarge as error:
            _refuse(
                f"{_described(obj)} with {error.setting}",
                error.count,
                error.unit,
                error.most,
                "Lower that setting.",
            )
        for place, modifier in enumerate(obj.modifiers):
            if not self.is_used(modifier):
                continue
            before = size
            try:
                if modifier.type == "NODES":
                    size = self._nodes.grown(size, modifier)
                elif modifier.type == "PARTICLE_SYSTEM":
                    self._emit(obj, modifier.particle_system)
                else:
                    size = grown(size, modifier, self)
            except TooLarge as error:
                which = f"modifier {_called(modifier)}" + (
                    f" (number {place + 1} of its stack)" if place else ""
                )
                start = f", given {_number(before.points)} {before.unit}," if before.points else ""
                _refuse(
                    f"{_described(obj)}: {which} with {error.setting}{start}",
                    error.count,
                    error.unit,
                    error.most,
                    "Lower that setting, or turn the modifier off.",
                )
        return size

    def _emit(self, obj, system):
        if system is None or system.settings is None:
            return
        settings = system.settings
        children = 0
        if settings.child_type != "NONE":
            children = self.high(settings, "rendered_child_count" if self.render else "child_percent")
        parents = max(0, self.high(settings, "count"))
        count = parents + int(parents * max(0, children) * self.most_children)
        self.particles.setdefault(obj, []).append((settings, count))


def _described(obj):
    return f"object {_called(obj)}"


def _points_of_path(settings):
    if settings.type != "HAIR" and settings.render_type != "PATH":
        return 0
    return 2 ** max(settings.display_step, 0) + 1


# Instances


class _Instances:
    """Counts what is shown by instancing: collections, parents' vertices and faces, particles."""

    def __init__(self, sizes):
        self._sizes = sizes
        self._shown = {}
        self._children = {}
        for obj in sizes.of:
            if obj.parent is not None and obj.parent.instance_type in {"VERTS", "FACES"}:
                self._children.setdefault(obj.parent, []).append(obj)

    def check(self, scene):
        """Raises Refused if the scene shows too many instances."""
        total, most, largest = 0, 0, None
        for obj in scene.objects:
            count = self._of_object(obj, _NESTED)
            total += count
            if count > most:
                most, largest = count, obj
            if total > MOST_INSTANCES:
                _refuse(
                    f"what its instances show (most by {_described(largest)})",
                    total,
                    "objects or more",
                    MOST_INSTANCES,
                    "Use fewer instances, or smaller collections.",
                )

    def _of_object(self, obj, depth):
        if depth == 0:
            return 0
        count = 0
        if obj.instance_type == "COLLECTION" and obj.instance_collection is not None:
            count += self._of_collection(obj.instance_collection, depth - 1)
        elif obj.instance_type in {"VERTS", "FACES"}:
            size = self._sizes.of.get(obj)
            times = 0 if size is None else size.vertices if obj.instance_type == "VERTS" else size.faces
            for child in self._children.get(obj, ()) if times else ():
                count += times * (1 + self._of_object(child, depth - 1))
        for settings, particles in self._sizes.particles.get(obj, ()):
            if settings.render_type == "OBJECT" and settings.instance_object is not None:
                count += particles * (1 + self._of_object(settings.instance_object, depth - 1))
            elif settings.render_type == "COLLECTION" and settings.instance_collection is not None:
                whole = settings.use_whole_collection
                count += particles * (
                    self._of_collection(settings.instance_collection, depth - 1) if whole else 1
                )
        size = self._sizes.of.get(obj)
        return count + (size.instances if size is not None else 0)

    def _of_collection(self, collection, depth):
        key = (collection, depth)
        if key not in self._shown:
            count = 0
            for obj in collection.all_objects:
                count += 1 + self._of_object(obj, depth)
                if count > MOST_INSTANCES:
                    break  # it is too much already, and a sum of everything could take long
            self._shown[key] = count
        return self._shown[key]
