# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes physics, then checks whether it is baked and whether anything moved."""

import os
import re
import shutil
import time
import zlib

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.file_io import SCENE_FILE, make_own, reason
from ..blend.names import nearest
from ..blend.temporary import temporary_settings
from . import caches, simulated_movement, stillness_causes

CACHE_FOLDER = "cache"  # below the workspace, for fluids
_SAMPLES = 5  # frames at which movement is measured
_KEPT = 3  # bakes of a domain that stay on disk: earlier checkpoints still show theirs
_NAMED = 12
_FLUID_PARTS = ("data", "noise", "mesh", "particles", "guide")


def bake(arguments, report):
    """Bakes the caches of ``objects`` (None: all) over ``frame_start`` to ``frame_end`` (None: the scene's).

    ``folder`` is the workspace. Returns {"range", "seconds", "caches": one entry for each, "notes"}; an entry has
    what PhysicsCache.describe() and simulated_movement.compare() return, ``label``, ``seconds`` (of the pass over the
    frames, which several caches may share), ``fault`` (what is wrong with the bake) and ``warning`` (nothing moved, and
    why).
    """
    started = time.perf_counter()
    scene = bpy.context.scene
    every = caches.find_caches(scene)
    chosen = _chosen(scene, every, arguments["objects"])
    frames = _frames(scene, arguments["frame_start"], arguments["frame_end"])
    notes = _prepare_file(arguments["folder"], chosen)
    frame_before = scene.frame_current
    jobs = [_Job(cache) for cache in chosen]
    progress = _Progress(report)
    try:
        for job in jobs:
            job.prepare(frames)
        with _BakeRange(scene, frames):
            _run(scene, jobs, every, progress)
        with _domains_off(_unchosen_fluids(every, jobs)):
            _check_result(scene, jobs, progress)
    finally:
        scene.frame_set(frame_before)
    for job in jobs:
        job.remove_old_bakes(every)
    return {
        "range": list(frames),
        "seconds": time.perf_counter() - started,
        "caches": [job.entry(scene) for job in jobs],
        "notes": notes,
    }


def _chosen(scene, every, names):
    if not every:
        raise Refused(
            "There is nothing to bake: the scene has no cloth, soft body, particle system, rigid-body world, dynamic "
            "paint or fluid domain."
        )
    if names is None:
        return every
    there = [obj.name for obj in scene.objects]
    for name in names:
        if name not in there:
            near = ", ".join(map(repr, nearest(name, there)))
            raise Refused(f"There is no object {name!r} in the scene.{f' Nearest: {near}.' if near else ''}")
        if not caches.of_objects(scene, [name]):
            have = sorted({cache.object or "the rigid bodies" for cache in every})
            raise Refused(
                f"{name!r} has no simulation of its own to bake. Objects that have one: {', '.join(have[:_NAMED])}"
                f"{' …' if len(have) > _NAMED else ''}."
            )
    return caches.of_objects(scene, names)


def _frames(scene, first, last):
    first = scene.frame_start if first is None else first
    last = scene.frame_end if last is None else last
    if last <= first:
        raise Refused(f"Frames {first} to {last} are not a range: frame_end must be larger than frame_start.")
    return first, last


def _prepare_file(folder, chosen):
    """Makes sure that cache files go into the workspace; returns notes on what had to be changed."""
    notes = []
    active = bpy.context.view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        notes.append(f"{active.name!r} was in {active.mode} mode; it was switched to OBJECT mode.")
        bpy.ops.object.mode_set(mode="OBJECT")
    path = os.path.join(folder, SCENE_FILE)
    if os.path.realpath(bpy.data.filepath or "/") != os.path.realpath(path):
        make_own(folder)  # a cache on disk lies beside the .blend that it belongs to
    for cache in chosen:
        if cache.points is not None and cache.points.use_external:
            raise Refused(
                f"The cache of {cache.label} is read from external files. Set its use_external to False to bake it."
            )
    return notes


class _BakeRange:
    """Sets the scene's frame range for the bake: Blender bakes particles over that one. Puts it back at the end."""

    def __init__(self, scene, frames):
        self._scene = scene
        self._last = frames[1]
        names = ("frame_end", "frame_start")
        if scene.use_preview_range:
            names += ("frame_preview_end", "frame_preview_start")
        self._before = {name: getattr(scene, name) for name in names}

    def __enter__(self):
        for name in self._before:
            if name.endswith("_end"):
                setattr(self._scene, name, self._last)

    def __exit__(self, *error):
        for name, value in self._before.items():
            setattr(self._scene, name, value)


class _Job:
    """One cache to bake: its fault, its seconds, and where its points were at some frames."""

    def __init__(self, cache):
        self.cache = cache
        self.fault = None
        self.seconds = 0.0
        self.expected = None
        self.samples = []

    def prepare(self, frames):
        """Frees it, and sets its range and folder."""
        cache = self.cache
        if cache.domain is not None:
            # A folder of its own for every bake: if this one is interrupted, the files of the last one remain.
            cache.domain.cache_directory = f"//{self._new_folder()}"
            _forget_bake(cache.domain)
            cache.domain.cache_type = "ALL"
        else:
            with bpy.context.temp_override(point_cache=cache.points):
                bpy.ops.ptcache.free_bake()
        cache.range = frames
        self.expected = cache.expected

    def _base_folder(self):
        name = self.cache.owner.name
        plain = re.sub(r"[^\w-]+", "_", name, flags=re.ASCII)[:40]
        return (
            f"{CACHE_FOLDER}/fluid/{plain if plain == name else f'{plain}-{zlib.crc32(name.encode()):08x}'}"
        )

    def _bake_numbers(self):
        """The numbers of the bakes that lie on disk."""
        folder = bpy.path.abspath(f"//{self._base_folder()}")
        names = os.listdir(folder) if os.path.isdir(folder) else []
        return sorted(int(name) for name in names if name.isdigit())

    def _new_folder(self):
        return f"{self._base_folder()}/{max(self._bake_numbers(), default=0) + 1:04d}"

    def remove_old_bakes(self, every):
        """Removes old bakes."""
        if self.cache.domain is None or self.fault:
            return
        used = {os.path.realpath(cache.folder) for cache in every if cache.domain is not None}
        for number in self._bake_numbers()[:-_KEPT]:
            folder = bpy.path.abspath(f"//{self._base_folder()}/{number:04d}")
            if os.path.realpath(folder) not in used:
                shutil.rmtree(folder, ignore_errors=True)

    def check(self):
        """Sets ``fault`` if something is wrong with the bake."""
        cache = self.cache
        (first, last), (wanted_first, wanted_last) = cache.range, self.expected
        if self.fault:
            return
        if not cache.baked:
            self.fault = "Blender did not bake it"
        elif cache.outdated:
            self.fault = "it is already outdated: something that it depends on changed during the bake"
        elif wanted_first <= wanted_last and (first > wanted_first or last < wanted_last):
            self.fault = f"it covers frames {first}–{last}, not {wanted_first}–{wanted_last}"
        elif missing := cache.missing:
            self.fault = f"{missing} of its frames are missing"

    def entry(self, scene):
        """The cache's entry in the result."""
        entry = self.cache.describe()
        entry.update(label=self.cache.label, seconds=self.seconds, fault=self.fault, warning=None)
        entry.update(simulated_movement.compare(self.cache, self.samples))
        if self.fault or entry["still"]:
            causes = "; ".join(stillness_causes.likely_causes(self.cache, scene))
            because = f": {causes}" if causes else ""
            if self.fault:
                entry["fault"] = self.fault + because
            else:
                entry["warning"] = ("nothing moved" if entry["seen"] else "it is empty") + because
        return entry


def _forget_bake(domain):
    """Makes Blender forget what is baked. Its own operator goes on in a thread after it has returned, and crashes."""
    for part in _FLUID_PARTS:
        setattr(domain, f"has_cache_baked_{part}", False)
        setattr(domain, f"cache_frame_pause_{part}", 0)  # where a bake would go on


def _domains_off(fluids):
    """A context in which domains are switched off: one of type REPLAY simulates at every change of frame."""
    return temporary_settings([(cache.modifier, "show_viewport", False) for cache in fluids])


def _unchosen_fluids(every, jobs):
    chosen = {job.cache.owner for job in jobs}
    return [cache for cache in every if cache.domain is not None and cache.owner not in chosen]


def _run(scene, jobs, every, progress):
    """Bakes, what others depend on first, with as few passes over the frames as possible."""
    carriers = {
        obj.field.source_object
        for obj in scene.objects
        if obj.field is not None and obj.field.type == "FLUID_FLOW"
    }
    early = [job for job in jobs if job.cache.domain is not None and job.cache.owner in carriers]
    late = [job for job in jobs if job.cache.domain is not None and job not in early]
    points = [job for job in jobs if job.cache.domain is None]
    groups = _groups(points, every)
    progress.expect([*([job] for job in early), *groups, *([job] for job in late)])
    for job in early:
        _bake([job], progress)
    with _domains_off([cache for cache in every if cache.domain is not None and cache.owner not in carriers]):
        for group in groups:
            _bake(group, progress)
    for job in late:
        _bake([job], progress)


def _groups(points, every):
    """Which caches to bake in one pass: Blender has an operator for one cache, and one for all in the scene but hair.

    The latter bakes 250 frames of a domain, whatever its range.
    """
    chosen = {job.cache.points for job in points}
    others = [
        cache
        for cache in every
        if cache.domain is not None or not (cache.points in chosen or cache.points.is_baked)
    ]
    many = [] if others else [job for job in points if job.cache.kind != caches.HAIR]
    rest = [[job] for job in points if job not in many]
    return [many, *rest] if many else rest


def _bake(group, progress):
    began = time.perf_counter()
    try:
        with progress.over(group):
            _bake_caches([job.cache for job in group])
    except RuntimeError as error:
        for job in group:
            job.fault = reason(error)
    for job in group:
        job.seconds = time.perf_counter() - began


def _bake_caches(group):
    cache = group[0]
    if len(group) > 1:
        bpy.ops.ptcache.bake_all(bake=True)
    elif cache.domain is None:
        with bpy.context.temp_override(point_cache=cache.points):
            bpy.ops.ptcache.bake(bake=True)
    else:
        with bpy.context.temp_override(object=cache.owner, active_object=cache.owner):
            bpy.ops.fluid.bake_all()


def _length(group):
    first = min(job.expected[0] for job in group)
    return max(1, max(job.expected[1] for job in group) - first + 1)


class _Progress:
    """Reports every frame that Blender goes to, while it bakes and while the result is checked."""

    def __init__(self, report):
        self._report = report
        self._before = 0  # frames of the passes that are finished
        self._done = 0
        self._total = 0

    def expect(self, groups):
        """Sets the total from the groups that will be baked."""
        self._total = sum(map(_length, groups)) + _SAMPLES

    def over(self, group):
        """The context in which a group is baked."""
        self._first = min(job.expected[0] for job in group)
        self._length = _length(group)
        self._what = group[0].cache.label if len(group) == 1 else f"{len(group)} caches"
        return self

    def checking(self, frame):
        """Reports that a frame of the result is being checked."""
        self._report_progress(self._done + 1, f"checking frame {frame}")

    def _report_progress(self, done, text):
        if self._done < done <= self._total:  # at the end Blender goes back to where it was
            self._done = done
            self._report(done, self._total, text)

    def _at_frame(self, scene, _graph=None):
        number, last = scene.frame_current - self._first + 1, self._first + self._length - 1
        if 0 < number <= self._length:
            self._report_progress(
                self._before + number, f"{self._what}: frame {scene.frame_current} of {self._first}–{last}"
            )

    def __enter__(self):
        bpy.app.handlers.frame_change_post.append(self._at_frame)

    def __exit__(self, *error):
        if self._at_frame in bpy.app.handlers.frame_change_post:
            bpy.app.handlers.frame_change_post.remove(self._at_frame)
        self._before += self._length
        self._done = self._before


def _check_result(scene, jobs, progress):
    """Checks the bakes, and records where points are at some of their frames."""
    for job in jobs:
        job.check()
    at = {}
    for job in jobs:
        first, last = job.expected
        if job.fault or last < first:
            continue
        for frame in sorted(
            {first + (last - first) * number // (_SAMPLES - 1) for number in range(_SAMPLES)}
        ):
            at.setdefault(frame, []).append(job)
    for frame in sorted(at):
        progress.checking(frame)
        scene.frame_set(frame)
        graph = bpy.context.evaluated_depsgraph_get()
        for job in at[frame]:
            job.samples.append(simulated_movement.sample(job.cache, scene, graph))
