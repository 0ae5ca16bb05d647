# SPDX-License-Identifier: GPL-3.0-or-later
"""A call that takes long, done in slices between which the window lives; the user's hands are held meanwhile."""

import contextlib
import time

import bpy

from simworlds.sandbox.inside.refusal import Refused

from .code.undo_steps import digest
from .user import hold
from .user_state import in_window

_SLICE_SECONDS = 0.1


class LongWork:
    """``steps``, a generator, is the work of ``request``. ``value`` is its result, once it ``has_ended``."""

    def __init__(self, request, steps):
        """Raises Refused while an animation plays, which would go to other frames in between."""
        if any(window.screen.is_animation_playing for window in bpy.context.window_manager.windows):
            raise Refused("The user plays the animation. Call again when they have stopped it.")
        self.request, self.before = request, digest()
        self.value, self.has_ended = None, False
        self.started = time.perf_counter()
        self._steps = steps
        self._told = self._shown = ""
        hold.begin()

    def __str__(self):
        told = f": {self._told}" if self._told else ""
        return f"The {self.request.tool} runs in Blender for {self.request.client.name}{told}"

    def report(self, done, total, text=""):
        """Tells the client, and soon the user, how far it is."""
        self._told = str(text)
        self.request.client.send(
            {"ticket": self.request.ticket, "progress": [done, total, self._told[:1000]]}
        )

    def go_on(self):
        """Works for a moment. Raises Refused if it is to end early, and what the work raises."""
        if self._shown != self._told:
            self._shown = self._told
            hold.tell(f"SimWorlds: {self._told}   |   Esc: stop and undo it")
        if why := self._to_end():
            raise Refused(f"{why}; what it had done in the open Blender was undone.")
        until = time.perf_counter() + _SLICE_SECONDS
        with in_window():
            while time.perf_counter() < until and not self.has_ended:
                try:
                    next(self._steps)
                except StopIteration as end:
                    self.value, self.has_ended = end.value, True

    def _to_end(self):
        if self.request.withdrawn:
            return f"The {self.request.tool} was cancelled"
        if time.monotonic() > self.request.deadline:
            return f"The {self.request.tool} was not done in {self.request.seconds:g} s (timeout)"
        if hold.escaped():
            return f"The user has ended the {self.request.tool} with Esc"
        return ""

    def close(self):
        """Ends the work where it is, and lets the user work again."""
        hold.release()
        # Of another file that was opened meanwhile nothing has to be put back.
        with contextlib.suppress(ReferenceError), in_window():
            self._steps.close()
