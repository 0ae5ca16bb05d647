# SPDX-License-Identifier: GPL-3.0-or-later
"""The pictures of a trial: one strip of what is solid or liquid together, and one of each swarm of particles."""

import os

from ..preview.frame_pictures import FramePictures, PictureJob
from .actors import dots_of
from .viewpoints import path_view

_RAYS = 8
_MOST_SWARMS = 3
_NAMED = 6


class TrialPictures:
    """Strips of pictures of some ``tracks``, ``width`` pixels wide each, in ``folder``.

    A swarm has a strip of its own: beside a thing of another size, one of both could not be seen.
    """

    def __init__(self, scene, tracks, width, folder):
        swarms = [[track] for track in tracks if track.actor.measured == "particles"][:_MOST_SWARMS]
        others = [track for track in tracks if track.actor.measured != "particles"]
        groups = [group for group in (others, *swarms) if group]
        views = [(group, path_view(group, width)) for group in groups]
        self._strips = [_Strip(group, view) for group, view in views if view is not None]
        self._folder = folder
        self._pictures = FramePictures(scene)

    @property
    def any(self):
        """Whether there is anything to be drawn."""
        return bool(self._strips)

    @property
    def notes(self):
        """What a viewer must know about them."""
        return self._pictures.notes

    def draw(self, frame, graph):
        """Draws the current frame."""
        os.makedirs(self._folder, exist_ok=True)
        jobs = []
        for number, strip in enumerate(self._strips):
            name = f"{number}-{frame}.png"
            jobs.append(strip.job(graph, os.path.join(self._folder, name)))
            strip.files[str(frame)] = name
        for _ in self._pictures.render(jobs):
            pass

    def as_data(self):
        """[{"of": names, "metres_per_pixel", "files": {frame: file in the folder}}]."""
        return [
            {
                "of": [track.actor.name for track in strip.tracks[:_NAMED]],
                "metres_per_pixel": strip.view.as_dict()["metres_per_pixel"],
                "files": strip.files,
            }
            for strip in self._strips
        ]


class _Strip:
    """Pictures of some tracks from one view."""

    def __init__(self, tracks, view):
        self.tracks, self.view = tracks, view
        self.files = {}

    def job(self, graph, path):
        """The picture of the current frame."""
        names = {obj.name for track in self.tracks for obj in track.actor.objects}
        states = [(track.actor, track.actor.state_at(graph)) for track in self.tracks]
        points = [point for _, state in states if state is not None for point in state.sample(_RAYS)]
        dots = [dot for actor, state in states for dot in dots_of(actor, state)]
        return PictureJob(names, points, self.view, path, dots)
