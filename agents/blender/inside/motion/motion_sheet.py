# SPDX-License-Identifier: GPL-3.0-or-later
"""The content of a motion sheet: actors' motion in numbers and pictures, and notes on how reliable it is."""

import os

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.names import quoted
from ..physics.caches import of_objects
from ..preview.frame_pictures import FramePictures, PictureJob
from .actors import dots_of, resolve
from .contacts import Contacts
from .keyed_frames import keyed_frames
from .reliability_notes import notes_on
from .timeline import FrameStepper
from .trajectories import Track
from .viewpoints import close_view, path_view, wants_close_views

_FEWEST, _MOST = 6, 12  # pictures of an actor
_USUAL = 7  # pictures without phases
_IN_A_ROW, _WIDEST = 8, 300  # pictures, and pixels of one
_MEASURED = 600  # frames; longer ranges are measured at a stride
_LONGEST = 20_000
_FARTHEST = 1_000_000  # a frame; keys can be farther
_NAMED = 6
_RAYS = 16  # from an actor to the viewer, to see whether it is hidden


def motion_sheet(arguments, report):
    """Follows ``actors`` over ``phases``, and draws them at ``frames``, in rows of ``width`` pixels.

    The pictures go to ``folder``, which is made. Returns the range, the sampled frames, and for each actor its caches,
    keyframes, curves, numbers and pictures.
    """
    scene = bpy.context.scene
    actors = resolve(arguments["actors"], scene)
    phases, sampled = _plan(arguments, scene)
    first = min(phases[0]["start"], sampled[0])
    last = max(sampled[-1], *(phase["end"] for phase in phases))
    stride = -(-(last - first + 1) // _MEASURED)
    ends = {frame for phase in phases for frame in (phase["start"], phase["end"])}
    measured = sorted({*range(first, last + 1, stride), *sampled, *ends})
    caches = [_caches(actor, scene) for actor in actors]  # their state before frames are stepped
    stepper = FrameStepper(scene, first)
    tracks = [Track(actor, scene.render.fps / scene.render.fps_base) for actor in actors]
    contacts = Contacts(scene, actors)
    pictures = FramePictures(scene)
    strips = _PictureStrips(tracks, sampled, arguments)
    steps = stepper.count(measured)
    if steps > _LONGEST:
        hint = f" Bake first: {', '.join(stepper.stepped_for[:3])}." if stepper.stepped_for else ""
        raise Refused(f"{steps} frames would have to be visited; {_LONGEST} at most.{hint}")
    progress = _Progress(report, steps + stepper.count(sampled))
    with stepper:
        for frame, graph in stepper.through(measured, progress.step):
            for track in tracks:
                track.add(frame, track.actor.state_at(graph))
            contacts.look(frame, graph, tracks)
        strips.plan()
        for frame, graph in stepper.through(sampled if strips.any else [], progress.step):
            strips.draw(frame, graph, pictures, progress)
    return {
        "start": first,
        "end": last,
        "fps": tracks[0].fps,
        "stride": stride,
        "sampled": sampled,
        "phases": phases,
        "stepped_from": stepper.stepped_from,
        "stepped_for": stepper.stepped_for,
        "notes": pictures.notes,
        "actors": [
            {
                **_actor_entry(track, (first, last)),
                "phases": [_phase_entry(track, number, phase, contacts) for phase in phases],
                "caches": [state for _, state in caches[number]],
                "notes": [*notes_on(track, caches[number], pictures.missing, scene), *strips.notes(number)],
                "columns": strips.columns,
                "views": strips.views[number],
            }
            for number, track in enumerate(tracks)
        ],
    }


class _Progress:
    """Reports progress over ``total`` frames."""

    def __init__(self, report, total):
        self._report, self._total, self._done = report, total, 0

    def step(self, frame):
        """Reports that a frame is visited."""
        self._done += 1
        self._report(self._done - 1, self._total, f"frame {frame}")

    def part(self, share, text):
        """Reports the ``share`` of the work at this frame that is done."""
        self._report(self._done - 1 + share, self._total, text)


# The plan


def _plan(arguments, scene):
    """(phases in order, frames to be drawn). Raises Refused."""
    phases, frames = arguments["phases"], arguments["frames"]
    bounds = scene.frame_start, scene.frame_end
    for frame in [*frames, *(phase[key] for phase in phases for key in ("start", "end"))]:
        if not bounds[0] <= frame <= bounds[1]:
            raise Refused(
                f"Frame {frame} is outside the scene's range, {bounds[0]} to {bounds[1]} (Scene.frame_start and "
                "frame_end)."
            )
    if not phases:
        first, last = (min(frames), max(frames)) if frames else bounds
        phases = [{"name": "", "start": first, "end": last}]
    phases = sorted(phases, key=lambda phase: phase["start"])
    return phases, sorted(set(frames)) or _sampled(phases)


def _sampled(phases):
    """Frames that show the phases: their starts and ends, and some evenly between."""
    if len(phases) == 1:
        return _evenly(phases[0]["start"], phases[0]["end"], _USUAL)
    frames = set()
    for phase in phases:
        frames.update(_evenly(phase["start"], phase["end"], 3 if 2 * len(phases) + 1 >= _FEWEST else 4))
    # If a phase starts in the frame after the end of the one before, one picture shows both.
    frames -= {
        phase["start"] for phase in phases if phase["start"] - 1 in frames and phase["start"] != phase["end"]
    }
    if len(frames) > _MOST:
        frames = {phases[0]["start"], *(phase["end"] for phase in phases)}
    if len(frames) > _MOST:
        ordered = sorted(frames)
        frames = {ordered[at] for at in _evenly(0, len(ordered) - 1, _MOST)}
    return sorted(frames)


def _evenly(first, last, count):
    count = min(count, last - first + 1)
    return sorted({round(first + (last - first) * at / max(count - 1, 1)) for at in range(count)})


# Pictures


class _PictureStrips:
    """The pictures of all actors: the whole path of each and, if the actor is small in it, close views."""

    def __init__(self, tracks, sampled, arguments):
        self._tracks, self._sampled, self._folder = tracks, sampled, arguments["folder"]
        os.makedirs(self._folder, exist_ok=True)
        self.columns = len(sampled) if len(sampled) <= _IN_A_ROW else -(-len(sampled) // 2)
        tile = (arguments["width"] - arguments["gap"] * (self.columns - 1)) // self.columns - 2
        self._tile = min(tile, _WIDEST)
        self.views = [[] for _ in tracks]
        self._cut = [{} for _ in tracks]  # names of what pictures show cut away, with their frames
        self.any = False
        self._jobs = {frame: [] for frame in sampled}

    def plan(self):
        """Chooses the views, once the tracks are complete."""
        for number, track in enumerate(self._tracks):
            view = path_view([track], self._tile)
            if view is None:
                continue
            self._add(number, "path", dict.fromkeys(self._sampled, view))
            if wants_close_views(track, view):
                self._add(number, "close", {frame: close_view(track, view, frame) for frame in self._sampled})

    def _add(self, number, kind, views):
        pictures = [{"frame": frame, "view": view and view.as_dict()} for frame, view in views.items()]
        self.views[number].append({"kind": kind, "pictures": pictures})
        for frame, view in views.items():
            if view is not None:
                path = os.path.join(self._folder, f"{number}-{kind}-{frame}.png")
                self._jobs[frame].append((number, view, path))
                self.any = True

    def draw(self, frame, graph, pictures, progress):
        """Renders the pictures of the current frame."""
        states = [track.actor.state_at(graph) for track in self._tracks]
        for track, state in zip(self._tracks, states, strict=True):
            track.check(frame, state)
        jobs, drawn = [], []
        for number, view, path in self._jobs[frame]:
            names = {obj.name for obj in self._tracks[number].actor.objects}
            state = states[number]
            points = state.sample(_RAYS) if state is not None else []
            jobs.append(PictureJob(names, points, view, path, dots_of(self._tracks[number].actor, state)))
            drawn.append(number)
        for done, _ in enumerate(pictures.render(jobs), 1):
            progress.part(done / len(jobs), f"drawing frame {frame}")
        for number, job in zip(drawn, jobs, strict=True):
            for name in job.cut:
                self._cut[number].setdefault(name, []).append(frame)

    def notes(self, number):
        """What is cut away in the pictures of an actor, and in which of them."""
        cut = self._cut[number]
        if not cut:
            return []
        frames = sorted({frame for at in cut.values() for frame in at})
        return [
            f"Cut away in its pictures, since it would hide it: {quoted(sorted(cut), _NAMED)} "
            f"(frame{'s' * (len(frames) > 1)} {', '.join(map(str, frames))})."
        ]


# Entries


def _actor_entry(track, span):
    actor = track.actor
    names = [obj.name for obj in actor.objects]
    keyed = keyed_frames(actor.objects)
    return {
        "name": actor.name,
        "kind": actor.kind,
        "objects": names[:20],
        "object_count": len(names),
        "measured": actor.measured,
        "deforms": track.deforms,
        "speed_of": track.speed_name,
        "keyframes": [frame for frame in keyed if span[0] <= frame <= span[1]],
        "keyed": [max(-_FARTHEST, min(_FARTHEST, end)) for end in (keyed[0], keyed[-1])] if keyed else None,
        "frames": track.frames,
        "centres": [centre and [round(part, 5) for part in centre] for centre in track.centres],
        "displacements": track.displacements(),
        "speeds": track.main_speeds,
    }


def _phase_entry(track, number, phase, contacts):
    entry = {"phase": phase["name"], "start": phase["start"], "end": phase["end"]}
    entry.update(track.summary(phase["start"], phase["end"]))
    entry["contacts"] = contacts.summary(number, track, phase["start"], phase["end"])
    return entry


def _caches(actor, scene):
    """(cache, its state as data) of all caches that the actor takes part in."""
    entries = []
    for cache in of_objects(scene, [obj.name for obj in actor.objects]):
        state = "unbaked" if not cache.baked else "baked, outdated" if cache.outdated else "baked"
        start, end = cache.range
        entry = {"label": cache.label, "state": state, "start": start, "end": end, "on": cache.simulated}
        entries.append((cache, entry))
    return entries
