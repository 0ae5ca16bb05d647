# SPDX-License-Identifier: GPL-3.0-or-later
"""Visits the frames of a batch of measurements, each once, for the followers: measurements over many frames.

A follower is made from a request. ``look(frame, graph, tracker)`` is called at every frame from its ``start`` to its
``end``, in order, then ``result()``; each may raise Unmeasurable.
"""

import contextlib
import itertools

import bpy

from ..geometry.solids import Unmeasurable
from ..motion.mesh_tracker import MeshTracker
from ..motion.timeline import FrameStepper
from ..physics.finite_check import Diverged
from .collisions import PassageFollower, TouchFollower
from .movement import PathFollower, TogetherFollower

MOST_FRAMES = 5000
MOST_LOOKS = 100_000  # calls of ``look`` for all followers

# Kind of request → its follower.
FOLLOWED = {
    "path": PathFollower,
    "together": TogetherFollower,
    "touches": TouchFollower,
    "passage": PassageFollower,
}


@contextlib.contextmanager
def unmeasured_as_answer(answers, place):
    """Makes the reason the answer if something cannot be measured."""
    try:
        yield
    except Unmeasurable as reason:
        answers[place] = {"unmeasured": str(reason)}
    except Exception as error:
        answers[place] = {"unmeasured": f"{type(error).__name__}: {error}"}


class Followers:
    """The followers of a batch, by the ``places`` of their requests among the ``answers``."""

    def __init__(self, requests, answers):
        self._answers = answers
        self._followers = {}
        for place, request in enumerate(requests):
            if request["kind"] in FOLLOWED:
                with unmeasured_as_answer(answers, place):
                    self._followers[place] = FOLLOWED[request["kind"]](request)

    def through(self, frames, report):
        """Takes the scene to each of ``frames`` and of the followers' frames, yields each, and goes back at the end.

        If a simulation is not baked, every frame from its start is visited. Raises Unmeasurable for too many, and
        Diverged; what is followed then has no result.
        """
        spans = [range(follower.start, follower.end + 1) for follower in self._followers.values()]
        frames = sorted({*frames, *itertools.chain(*spans)})
        if not frames:
            return
        stepper = FrameStepper(bpy.context.scene, frames[0])
        count = stepper.count(frames)
        if count > MOST_FRAMES or sum(map(len, spans)) > MOST_LOOKS:
            self._followers.clear()
            raise Unmeasurable(
                f"{count} frames would have to be visited{'; bake first' * bool(stepper.stepped_for)}"
            )
        done, tracker = itertools.count(), MeshTracker()
        with stepper:
            for frame, graph in self._visited(
                stepper, frames, lambda at: report(next(done), count, f"frame {at}")
            ):
                yield frame
                tracker.enter(frame, graph)
                for place, follower in list(self._followers.items()):
                    if follower.start <= frame <= follower.end:
                        self._followers.pop(place)
                        with unmeasured_as_answer(self._answers, place):
                            follower.look(frame, graph, tracker)
                            self._followers[place] = follower

    def _visited(self, stepper, frames, visiting):
        try:
            yield from stepper.through(frames, visiting)
        except Diverged:
            self._followers.clear()
            raise

    def finish(self):
        """Stores the results as answers."""
        for place, follower in self._followers.items():
            with unmeasured_as_answer(self._answers, place):
                self._answers[place] = {"value": follower.result()}
