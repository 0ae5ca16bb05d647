# SPDX-License-Identifier: GPL-3.0-or-later
"""Bakes physics and frees bakes; checks whether what was baked is whole and whether anything moved."""

import os
import re
import shutil
import time
import zlib

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.file_io import SCENE_FILE, make_own, reason
from ..blend.named_objects import objects_named
from ..blend.temporary import temporary_settings
from . import bake_inputs, caches, simulated_movement, stepped_frames, stillness_causes
from .finite_check import Diverged, DivergenceWatch

CACHE_FOLDER = "cache"  # below the workspace, for fluids
_SAMPLES = 5  # frames at which movement is measured
_KEPT = 3  # bakes of a domain that stay on disk: earlier checkpoints still show theirs
_NAMED = 12
_FLUID_PARTS = ("data", "noise", "mesh", "particles", "guide")


def bake(arguments, report):
    """Bakes as ``bake_in_steps`` does, in one go."""
    steps = bake_in_steps(arguments, report)
    while True:
        try:
            next(steps)
        except StopIteration as end:
            return end.value


def bake_in_steps(arguments, report):
    """A generator that bakes the caches of ``objects`` (None: all) over ``frame_start`` to ``frame_end`` (None: as the
    scene's).

    Frames that were simulated before, and still are valid, are kept. A simulation that is not finite ends the bake at
    that frame; the caches of its pass are freed. It yields between frames; closed early, it goes back to the frame.

    ``folder`` is the workspace; None for a user's own file, which keeps its place. ``brought``: fluids that were baked
    in another Blender, {object: folder of its frames}. Returns {"range", "seconds", "caches": one entry for each,
    "notes"}; an entry has what PhysicsCache.describe() and simulated_movement.compare() return, ``label``, ``seconds``
    (of the pass over the frames, which several caches may share), ``kept`` (it was simulated before), ``fault`` (what
    is wrong with the bake) and ``warning`` (nothing moved, and why).
    """
    started = time.perf_counter()
    scene = bpy.context.scene
    every = caches.find_caches(scene)
    chosen = _chosen(scene, every, arguments["objects"])
    frames = _frames(scene, arguments["frame_start"], arguments["frame_end"])
    brought = arguments.get("brought") or {}
    notes = _prepare_file(arguments["folder"], chosen, brought)
    frame_before = scene.frame_current
    jobs = [_Job(cache) for cache in chosen]
    progress = _Progress(report)
    bake_inputs.forget(scene, chosen)
    try:
        _keep_what_was_stepped(scene, jobs, frames)
        for job in jobs:
            if job.cache.domain is not None and job.cache.object in brought:
                job.bring(brought[job.cache.object], frames)
        waiting = [job for job in jobs if not job.kept and not job.is_brought]
        for job in waiting:
            job.prepare(frames)
        with _BakeRange(scene, frames):
            try:
                yield from _run(scene, waiting, every, progress)
            except Diverged as error:
                _give_up([job for job in waiting if not job.cache.baked], error)
        with _domains_off(_unchosen_fluids(every, jobs)):
            yield from _check_result(scene, jobs, progress)
    finally:
        scene.frame_set(frame_before)
    for job in jobs:
        job.remove_old_bakes(every)
    bake_inputs.remember(scene, [job.cache for job in jobs if not job.fault])
    left = [cache for cache in every if cache not in chosen and cache.baked and cache.outdated]
    notes += [
        f"Still played as it was baked before: {caches.describe_stale(cache)}. Bake it too." for cache in left
    ]
    return {
        "range": list(frames),
        "seconds": time.perf_counter() - started,
        "caches": [job.entry(scene) for job in jobs],
        "notes": notes,
    }


def fluids(arguments, report):
    """The names of the fluid domains among ``objects`` (None: all)."""
    del report
    scene = bpy.context.scene
    chosen = _chosen(scene, caches.find_caches(scene), arguments["objects"])
    return [cache.object for cache in chosen if cache.domain is not None]


def free(arguments, report):
    """Frees the bakes of ``objects`` (None: of all): they simulate again. Returns the ``freed`` caches' labels.

    ``in_place``: fluids keep their folder and the type of their cache, as in a user's own file.
    """
    del report
    scene = bpy.context.scene
    chosen = _chosen(scene, caches.find_caches(scene), arguments["objects"])
    freed = [cache for cache in chosen if cache.baked]
    for cache in freed:
        if cache.domain is not None and arguments.get("in_place"):
            _forget_bake(cache.domain)
            continue
        _free(cache)
        if cache.domain is not None:
            cache.domain.cache_type = "REPLAY"
    bake_inputs.forget(scene, freed)
    stepped_frames.forget()
    return {"freed": [cache.label for cache in freed], "unbaked": [c.label for c in chosen if c not in freed]}


def _free(cache):
    if cache.domain is not None:
        # The files remain: earlier checkpoints still show them.
        cache.domain.cache_directory = f"//{_new_folder(cache)}"
        _forget_bake(cache.domain)
        cache.domain.cache_type = "ALL"
    else:
        with bpy.context.temp_override(point_cache=cache.points):
            bpy.ops.ptcache.free_bake()


def _keep_what_was_stepped(scene, jobs, frames):
    """Makes bakes of the caches that hold all of ``frames`` as they were simulated before."""
    held = stepped_frames.held_caches(scene, [job.cache for job in jobs], *frames)
    for job in (job for job in jobs if job.cache in held):
        job.keep(frames)
        job.check()
        job.kept, job.fault = not job.fault, None


def _give_up(jobs, error):
    """Frees what was not baked to the end or is not finite, and says of each job why."""
    for job in jobs:
        own = job.cache.label == error.cache.label
        job.fault = (
            str(error)
            if own
            else f"the bake was stopped at frame {error.frame}, where another one broke down"
        )
        job.is_cause_known = True
        _free(job.cache)


def _chosen(scene, every, names):
    if not every:
        raise Refused(
            "There is nothing to bake: the scene has no cloth, soft body, particle system, rigid-body world, dynamic "
            "paint or fluid domain."
        )
    if names is None:
        return every
    named = objects_named(scene, names)
    for name, objects in named.items():
        if not caches.of_objects(scene, [obj.name for obj in objects]):
            have = sorted({cache.object or "the rigid bodies" for cache in every})
            raise Refused(
                f"{name!r} has no simulation of its own to bake. Objects that have one: {', '.join(have[:_NAMED])}"
                f"{' …' if len(have) > _NAMED else ''}."
            )
    return caches.of_objects(scene, [obj.name for objects in named.values() for obj in objects])


def _frames(scene, first, last):
    first = scene.frame_start if first is None else first
    last = scene.frame_end if last is None else last
    if last <= first:
        raise Refused(f"Frames {first} to {last} are not a range: frame_end must be larger than frame_start.")
    return first, last


def _prepare_file(folder, chosen, brought):
    """Makes sure that cache files go into the workspace; returns notes on what had to be changed."""
    for cache in chosen:
        if cache.points is not None and cache.points.use_external:
            raise Refused(
                f"The cache of {cache.label} is read from external files. Set its use_external to False to bake it."
            )
    if folder is None:
        if missing := [
            cache.label for cache in chosen if cache.domain is not None and cache.object not in brought
        ]:
            raise Refused(f"Baked elsewhere first: {', '.join(missing)}.")
        return []
    notes = []
    active = bpy.context.view_layer.objects.active
    if active is not None and active.mode != "OBJECT":
        notes.append(f"{active.name!r} was in {active.mode} mode; it was switched to OBJECT mode.")
        bpy.ops.object.mode_set(mode="OBJECT")
    path = os.path.join(folder, SCENE_FILE)
    if os.path.realpath(bpy.data.filepath or "/") != os.path.realpath(path):
        make_own(folder)  # a cache on disk lies beside the .blend that it belongs to
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
        self.kept = False
        self.is_brought = False
        self.is_cause_known = False

    def prepare(self, frames):
        """Frees it, and sets its range; a fluid gets a new folder."""
        _free(self.cache)
        self.cache.range = frames
        self.expected = self.cache.expected

    def keep(self, frames):
        """Makes a bake over ``frames`` of those that the cache holds."""
        cache = self.cache
        if cache.domain is None:
            with bpy.context.temp_override(point_cache=cache.points):
                bpy.ops.ptcache.bake_from_cache()
            if cache.range != frames:  # setting it marks the cache of some kinds as outdated
                cache.range = frames
            self.expected = cache.expected
            return
        stepped = os.path.realpath(cache.folder)  # a link may stand in its place
        folder = f"//{_new_folder(cache)}"
        target = bpy.path.abspath(folder)
        os.makedirs(os.path.dirname(target), exist_ok=True)
        shutil.move(stepped, target)  # a change of the type removes the files of the domain's folder
        self._show(folder, frames)

    def bring(self, folder, frames):
        """Has it show what was baked to a folder in another Blender."""
        self.is_brought = True
        self.cache.domain.cache_directory = (
            f"{folder}-none"  # what is in its own is not removed with its type
        )
        self._show(folder, frames)

    def _show(self, folder, frames):
        cache, domain = self.cache, self.cache.domain
        domain.cache_type = "ALL"
        cache.range = frames
        self.expected = cache.expected
        domain.cache_directory = folder
        liquid = domain.domain_type == "LIQUID"
        domain.has_cache_baked_data = True
        domain.has_cache_baked_mesh = liquid and domain.use_mesh
        domain.has_cache_baked_noise = not liquid and domain.use_noise

    def remove_old_bakes(self, every):
        """Removes old bakes."""
        if self.cache.domain is None or self.fault or self.is_brought:
            return
        used = {os.path.realpath(cache.folder) for cache in every if cache.domain is not None}
        for number in _bake_numbers(self.cache)[:-_KEPT]:
            folder = bpy.path.abspath(f"//{_base_folder(self.cache)}/{number:04d}")
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
        entry.update(
            label=self.cache.label, seconds=self.seconds, kept=self.kept, fault=self.fault, warning=None
        )
        entry.update(simulated_movement.compare(self.cache, self.samples))
        if self.is_cause_known:
            return entry
        if self.fault or entry["still"]:
            causes = "; ".join(stillness_causes.likely_causes(self.cache, scene))
            because = f": {causes}" if causes else ""
            if self.fault:
                entry["fault"] = self.fault + because
            else:
                entry["warning"] = ("nothing moved" if entry["seen"] else "it is empty") + because
        return entry


def _base_folder(cache):
    """The folder of a fluid's bakes, below the workspace."""
    name = cache.owner.name
    plain = re.sub(r"[^\w-]+", "_", name, flags=re.ASCII)[:40]
    return f"{CACHE_FOLDER}/fluid/{plain if plain == name else f'{plain}-{zlib.crc32(name.encode()):08x}'}"


def _bake_numbers(cache):
    """The numbers of the bakes of a fluid that lie on disk."""
    folder = bpy.path.abspath(f"//{_base_folder(cache)}")
    names = os.listdir(folder) if os.path.isdir(folder) else []
    return sorted(int(name) for name in names if name.isdigit())


def _new_folder(cache):
    """A folder of its own for every bake: if this one is interrupted, the files of the last one remain."""
    return f"{_base_folder(cache)}/{max(_bake_numbers(cache), default=0) + 1:04d}"


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
    """Bakes in steps, what others depend on first, with as few passes over the frames as possible. Raises Diverged."""
    carriers = {
        obj.field.source_object
        for obj in scene.objects
        if obj.field is not None and obj.field.type == "FLUID_FLOW"
    }
    early = [job for job in jobs if job.cache.domain is not None and job.cache.owner in carriers]
    late = [job for job in jobs if job.cache.domain is not None and job not in early]
    points = [job for job in jobs if job.cache.domain is None]
    progress.expect([*([job] for job in early), *([points] if points else []), *([job] for job in late)])
    for job in early:
        _bake_fluid(job, progress)
    if points:
        with _domains_off(
            [cache for cache in every if cache.domain is not None and cache.owner not in carriers]
        ):
            yield from _bake_points(scene, points, progress)
    for job in late:
        _bake_fluid(job, progress)


def _bake_points(scene, jobs, progress):
    """Steps through the frames once for all ``jobs``, which fills their caches, and makes bakes of these."""
    began = time.perf_counter()
    watch = DivergenceWatch(scene, [job.cache for job in jobs])
    caches.restart_unbaked(scene)
    first, last = min(job.cache.range[0] for job in jobs), max(job.cache.range[1] for job in jobs)
    with progress.over(jobs):
        for frame in range(first, last + 1):
            scene.frame_set(frame)
            watch.check(frame, bpy.context.evaluated_depsgraph_get())
            yield
    for job in jobs:
        job.keep(job.cache.range)
        job.seconds = time.perf_counter() - began


def _bake_fluid(job, progress):
    began = time.perf_counter()
    owner = job.cache.owner
    try:
        with progress.over([job]), bpy.context.temp_override(object=owner, active_object=owner):
            bpy.ops.fluid.bake_all()
    except RuntimeError as error:
        job.fault = reason(error)
    job.seconds = time.perf_counter() - began


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
            if job.fault:
                continue
            try:
                DivergenceWatch(scene, [job.cache]).check(frame, graph)
            except Diverged as error:
                _give_up([job], error)
                continue
            job.samples.append(simulated_movement.sample(job.cache, scene, graph))
        yield
