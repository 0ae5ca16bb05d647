# SPDX-License-Identifier: GPL-3.0-or-later
"""Tries a simulation over a few frames: numbers and small pictures, and what the whole bake would take."""

import contextlib
import os
import time

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ..blend.named_objects import objects_named
from ..geometry.solids import Solids
from ..physics import caches, stepped_frames
from ..physics.finite_check import Diverged
from ..state.likely_mistakes import bodies_off_their_meshes
from .actors import resolve, round_to
from .followed import Followed
from .solid_facts import solid_facts
from .timeline import FrameStepper
from .trial_pictures import TrialPictures

_FOLLOWED = 100  # actors of which some are told of in full; others by their places alone
_SAMPLES = 6  # frames that are drawn, and at which volumes and depths are measured
_STREAMED = 3  # actors in a line of progress
_MOST_POINTS = 240_000  # that are followed, of all actors
_MOST_OF_ONE = 20_000
_HEIGHTS = 30  # frames of which heights are told, of a few actors
_FEW = 3
_LATE = 4  # the last quarter of the frames tells what later ones will take


def trial(arguments, report):
    """Steps ``frames`` frames of the simulations of ``objects`` (None: all), for at most ``seconds``.

    Of many objects, those that are ``first`` or in such a collection are told of, then those that move most.
    ``folder`` gets the pictures (None: none are made), ``width`` pixels wide each. Caches that are baked are played.
    No bake is left behind, and the scene stays at its frame. Returns, in metres, m/s and seconds: the ``first`` and
    ``last`` frame, ``simulated`` (False: nothing had to be), ``seconds_per_frame`` (of all frames, and of the last
    ones), ``whole`` (frames of the whole bake, and the seconds it would take), ``stopped`` (why it ended early),
    ``actors`` with their ``samples``, ``others`` and ``fallen`` (see Followed), ``pictures`` (see TrialPictures) and
    ``notes``.
    """
    scene = bpy.context.scene
    chosen = caches.find_caches(scene) if arguments["objects"] is None else []
    names = arguments["objects"] or _simulated_names(scene, chosen)
    first = _members(scene, arguments["first"])
    names = sorted(names, key=lambda name: name not in first)
    names, rest = names[:_FOLLOWED], [scene.objects[name] for name in names[_FOLLOWED:]]
    actors = resolve(names, scene, min(_MOST_OF_ONE, _MOST_POINTS // len(names)))
    bodies = [obj for obj in rest if obj.rigid_body is not None]
    parts = {obj.name for actor in actors for obj in actor.objects}
    own = caches.of_objects(scene, parts)
    if not own:
        raise Refused("There is nothing to try: none of these objects is simulated.")
    if stale := [caches.describe_stale(cache) for cache in own if cache.baked and cache.outdated]:
        raise Refused(
            "Free the old bake first (blender_bake, free=true): it would be played here, and show nothing of what was "
            f"changed since: {', '.join(stale)}."
        )
    notes = [f"Baked, so played as it is: {cache.label}." for cache in own if cache.baked]
    if any(cache.kind == caches.RIGID_BODY for cache in own):
        notes += bodies_off_their_meshes([obj for obj in scene.objects if obj.rigid_body is not None])
    with _stepping_fluids(own, arguments["folder"]):
        run = _Trial(scene, Followed(scene, actors, bodies, first, own), arguments, report)
        run.step()
        run.draw(notes)
    return {**run.result(own), "notes": notes}


def _simulated_names(scene, found):
    """The objects that caches move, in the scene's order."""
    names = dict.fromkeys(cache.object for cache in found if cache.object is not None)
    world = scene.rigidbody_world
    if world is not None and world.collection is not None:
        bodies = (obj for obj in world.collection.objects if obj.rigid_body is not None)
        names.update(dict.fromkeys(obj.name for obj in bodies if obj.rigid_body.type == "ACTIVE"))
    there = {obj.name for obj in bpy.context.view_layer.objects}
    names = [name for name in names if name in there]
    if not names:
        raise Refused("There is nothing to try: the scene has no simulation.")
    return names


def _members(scene, names):
    """The names of the objects that some names stand for; what the scene lacks is left out."""
    members = set()
    for name in names:
        with contextlib.suppress(Refused):
            members.update(obj.name for obj in objects_named(scene, [name])[name])
    return members


@contextlib.contextmanager
def _stepping_fluids(own, folder):
    """Lets unbaked domains of the chosen ones be simulated by stepping, and removes what that left behind."""
    waiting = [cache.domain for cache in own if cache.domain is not None and not cache.baked]
    before = [(domain, domain.cache_type, domain.cache_directory) for domain in waiting]
    before = [entry for entry in before if entry[1] != "REPLAY"]
    try:
        # A change of the type removes the files of the folder, which must be the trial's own then.
        for number, (domain, _, _) in enumerate(before):
            domain.cache_directory = os.path.join(folder, f"fluid-{number}")
            domain.cache_type = "REPLAY"
        yield
    finally:
        for domain, kind, place in before:
            domain.cache_type = kind
            domain.cache_directory = place
        if before:
            stepped_frames.forget()


class _Trial:
    """The frames that are stepped, and what is measured at them."""

    def __init__(self, scene, followed, arguments, report):
        self._scene, self._followed, self._report = scene, followed, report
        self._seconds, self._width = arguments["seconds"], arguments["width"]
        self._folder = arguments["folder"]
        self._stepper = FrameStepper(scene, scene.frame_start)
        first = self._stepper.stepped_from
        self._first = scene.frame_start if first is None else first
        self._wanted = range(self._first, self._first + arguments["frames"])
        held = stepped_frames.last_held(scene)
        self._simulates = first is not None and (held is None or held < self._wanted[-1])
        self._took = []
        self._stopped = ""
        self._solid_facts = {}  # frame → {track: its facts}
        self._pictures = []

    def step(self):
        """Visits the frames until the time is up or a simulation is not finite."""
        began = time.monotonic()
        samples = set(_evenly(self._wanted, _SAMPLES))
        with self._stepper:
            started = [began]
            steps = self._stepper.through(self._wanted, lambda _frame: started.append(time.monotonic()))
            try:
                for frame, graph in steps:
                    self._took.append(time.monotonic() - started[-1])
                    self._followed.add(frame, graph)
                    if frame in samples or frame == self._wanted[-1]:
                        self._measure_solids(frame)
                    self._report(len(self._took), len(self._wanted), self._line(frame))
                    if time.monotonic() - began > self._seconds and frame != self._wanted[-1]:
                        self._stopped = f"the {self._seconds:g} s for this trial were over"
                        self._measure_solids(frame)
                        break
            except Diverged as error:
                self._stopped = str(error)
            finally:
                steps.close()

    def _line(self, frame):
        """What is streamed of a frame."""
        told = [
            f"{track.actor.name}: {_where(track)}"
            for track in self._followed.tracks[:_STREAMED]
            if track.centres[-1] is not None
        ]
        return f"frame {frame} in {self._took[-1]:.2f} s; {'; '.join(told)}"

    def _measure_solids(self, frame):
        if frame in self._solid_facts:
            return
        solids = Solids()
        self._solid_facts[frame] = {
            track: solid_facts(track.actor, solids, self._scene) for track in self._followed.shown()
        }

    def draw(self, notes):
        """Draws the measured frames, if they can be visited again without simulating them again."""
        if self._width is None or not self._took:
            return
        frames = sorted(self._solid_facts)
        pictures = TrialPictures(self._scene, self._followed.shown(), self._width, self._folder)
        stepper = FrameStepper(self._scene, self._first)
        if not pictures.any or stepper.count(frames) > len(frames):
            notes.append("No pictures: the frames would have to be simulated again.")
            return
        with stepper:
            for frame, graph in stepper.through(frames, lambda _frame: None):
                pictures.draw(frame, graph)
        self._pictures = pictures.as_data()
        notes += pictures.notes

    def result(self, own):
        """The result as data."""
        last = self._first + len(self._took) - 1
        late = self._took[-max(1, len(self._took) // _LATE) :]
        pace = sum(late) / len(late) if late else 0.0
        left = max(0, self._scene.frame_end - last)
        told = self._followed.told()
        return {
            "first": self._first,
            "last": last,
            "simulated": self._simulates,
            "seconds_per_frame": [_mean(self._took), pace],
            "whole": [self._scene.frame_end - self._first + 1, sum(self._took) + left * pace],
            "stopped": self._stopped,
            "caches": [cache.label for cache in own],
            "actors": [self._actor_entry(track, len(told)) for track in told],
            "others": self._followed.others(),
            "fallen": self._followed.fallen(),
            "pictures": self._pictures,
        }

    def _actor_entry(self, track, count):
        lowest = min((low.z, frame) for low, frame in _there(track.lows, track)) if any(track.lows) else None
        speeds = _there(track.main_speeds, track)
        peak = max(speeds, key=lambda pair: pair[0]) if speeds else None
        is_swarm = track.actor.measured == "particles"
        return {
            "name": track.actor.name,
            "lowest": lowest and [round_to(lowest[0]), lowest[1]],
            "peak_speed": peak and [round_to(peak[0]), peak[1]],
            "most_alive": max(track.counts, default=0) if is_swarm else None,
            "heights": [] if is_swarm else self._heights(track, count),
            "samples": [
                {"frame": frame, **_place(track, frame), **facts.get(track, {})}
                for frame, facts in sorted(self._solid_facts.items())
                if frame in track.frames
            ],
        }

    def _heights(self, track, count):
        """[frame, lowest, highest point, speed] at the samples, and at frames between, of few actors at more."""
        between = _evenly(track.frames, min(len(track.frames), _HEIGHTS // max(1, count // _FEW)))
        return [
            [frame, round_to(track.lows[at].z), round_to(track.highs[at].z), round_to(track.main_speeds[at])]
            for at, frame in enumerate(track.frames)
            if track.lows[at] is not None and (frame in between or frame in self._solid_facts)
        ]


def _evenly(frames, count):
    last = len(frames) - 1
    return [frames[round(last * at / max(1, count - 1))] for at in range(min(count, last + 1))]


def _mean(values):
    return sum(values) / len(values) if values else 0.0


def _there(values, track):
    """(value, frame) of those that are not None."""
    return [(value, frame) for value, frame in zip(values, track.frames, strict=True) if value is not None]


def _where(track):
    speed = track.main_speeds[-1]
    return f"lowest {track.lows[-1].z:.3f} m" + (f", {speed:.2f} m/s" if speed is not None else "")


def _place(track, frame):
    at = track.frames.index(frame)
    low, high, centre, velocity = (
        each[at] for each in (track.lows, track.highs, track.centres, track.velocities)
    )
    return {
        "alive": track.counts[at] if track.actor.measured == "particles" else None,
        "lowest": low and round_to(low.z),
        "highest": high and round_to(high.z),
        "middle": centre and [round_to(part) for part in centre],
        "speed": round_to(track.main_speeds[at]),
        "velocity": velocity and [round_to(part) for part in velocity],
    }
