# SPDX-License-Identifier: GPL-3.0-or-later
"""Goes through the frames of a batch of measurements, each once, and has what follows something look at them.

A follower is made from a request. ``look(frame, graph, cast)`` is called at every frame from its ``start`` to its
``end``, in order, and ``told()`` at last; all of it may raise Unmeasurable.
"""

import contextlib
import itertools

import bpy

from ..geometry.solids import Unmeasurable
from ..motion.mesh_tracker import Cast
from ..motion.trajectories import Playing
from ..physics.caches import renew
from .movement import Path, Together
from .touches import Passage, Touches

MOST_FRAMES = 5000
MOST_LOOKS = 100_000  # frames of all followers

# Kind of request → what follows something.
FOLLOWED = {
    "path": Path,
    "together": Together,
    "touches": Touches,
    "passage": Passage,
}


@contextlib.contextmanager
def telling(answers, place):
    """Has what cannot be measured told as the answer."""
    try:
        yield
    except Unmeasurable as reason:
        answers[place] = {"unmeasured": str(reason)}
    except Exception as error:
        answers[place] = {"unmeasured": f"{type(error).__name__}: {error}"}


class Following:
    """The followers of a batch: ``places`` of their requests among the ``answers``."""

    def __init__(self, requests, answers):
        self._answers = answers
        self._followers = {}
        for place, request in enumerate(requests):
            if request["kind"] in FOLLOWED:
                with telling(answers, place):
                    self._followers[place] = FOLLOWED[request["kind"]](request)

    def through(self, frames, report):
        """Takes the scene to each of the frames, and of those that are followed, and back. Yields each.

        Where a simulation is not baked, frames are stepped through from its start. Raises Unmeasurable for too many.
        """
        spans = [range(one.start, one.end + 1) for one in self._followers.values()]
        frames = sorted({*frames, *itertools.chain(*spans)})
        if not frames:
            return
        playing = Playing(bpy.context.scene, frames[0])
        count = playing.count(frames)
        if count > MOST_FRAMES or sum(map(len, spans)) > MOST_LOOKS:
            self._followers.clear()
            raise Unmeasurable(
                f"{count} frames would have to be visited{'; bake first' * bool(playing.stepped_for)}"
            )
        if playing.stepped_for:
            renew(bpy.context.scene)  # what a jump to some frame left behind would be taken for a result
        done, cast = itertools.count(), Cast()
        with playing:
            for frame, graph in playing.through(frames, lambda at: report(next(done), count, f"frame {at}")):
                yield frame
                cast.enter(frame, graph)
                for place, one in list(self._followers.items()):
                    if one.start <= frame <= one.end:
                        self._followers.pop(place)
                        with telling(self._answers, place):
                            one.look(frame, graph, cast)
                            self._followers[place] = one

    def tell(self):
        """Puts down what was found."""
        for place, one in self._followers.items():
            with telling(self._answers, place):
                self._answers[place] = {"value": one.told()}
