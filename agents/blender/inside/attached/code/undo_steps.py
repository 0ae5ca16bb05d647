# SPDX-License-Identifier: GPL-3.0-or-later
"""Makes every call that changes something one step of Blender's undo, and takes such steps back."""

import hashlib

import bpy

from simworlds.sandbox.inside.refusal import Refused

from ...changes import KINDS
from ...digests.block_reader import key_of
from ...digests.fingerprint import digests_by_part
from ..user_state import in_window

PREFIX = "SimWorlds: "
MOST_BLOCKS = 300  # that are read while the window waits; of more, whether a state is the same is not known
_LONGEST = 60


class Step:
    """A step: its ``name``, and the digests of the scene ``before`` and ``after`` it; None if not known.

    ``operators``: what tells that the user has called none since.
    """

    def __init__(self, name, before, after):
        self.name, self.before, self.after = name, before, after
        self.operators = _operators()


class UndoSteps:
    """The steps of the file that is open, oldest first. ``busy`` while it undoes: Blender tells everybody of that."""

    def __init__(self):
        self.steps = []
        self.busy = False

    def forget(self):
        """Another file was opened, and with it Blender forgot all steps."""
        self.steps.clear()

    def keep(self, name, before):
        """Makes what was done since ``before`` (a digest) a step."""
        title = PREFIX + " ".join(name.split())[:_LONGEST]
        with in_window():
            bpy.ops.ed.undo_push(message=title)
        self.steps.append(Step(title, before, digest()))
        most = bpy.context.preferences.edit.undo_steps
        if most:
            del self.steps[:-most]

    def undo(self, count):
        """Takes back the newest ``count`` steps. Returns their names and whether the scene ``matches`` the one before
        them (None: not known). Raises Refused where the user's own work would be undone."""
        self._drop_undone()
        if not self.steps:
            raise Refused(
                "There is no step of SimWorlds to undo: none was made in this file, or the user has undone them."
            )
        if count > len(self.steps):
            raise Refused(f"Only {len(self.steps)} steps of SimWorlds can be undone, not {count}.")
        taken = self.steps[-count:]
        self.busy = True
        try:
            for _ in taken:
                if not _undo():
                    raise Refused(
                        "Blender has no more undo steps (Preferences > System > Undo Steps, and Global Undo)."
                    )
                self.steps.pop()
        finally:
            self.busy = False
        now, then = digest(), taken[0].before
        return {
            "undone": [step.name for step in reversed(taken)],
            "matches": None if now is None or then is None else now == then,
            "left": len(self.steps),
        }

    def _drop_undone(self):
        """Forgets steps that the user has undone. Raises Refused if the user has worked after the last one."""
        if not self.steps:
            return
        now, last = digest(), self.steps[-1]
        if now is None or last.after is None:
            if _operators() == last.operators:
                return
        elif last.after == now:
            return
        for number in range(len(self.steps) - 1, -1, -1):
            if now is not None and self.steps[number].before == now:
                del self.steps[number:]
                return
        raise Refused(
            "The user has changed the scene after SimWorlds' last step, so undoing would take back their work. "
            "Ask them to use Edit > Undo History, where the steps are named 'SimWorlds: …'."
        )


def _undo():
    """Has Blender undo a step; returns whether there was one."""
    try:
        with in_window():
            return "FINISHED" in bpy.ops.ed.undo()
    except RuntimeError:  # it has none
        return False


def _operators():
    """Which operators the user has called: Blender keeps the last ones, and none that was called by Python."""
    called = bpy.context.window_manager.operators
    return len(called), called[-1].as_pointer() if called else 0


def digest():
    """A digest of the file's data-blocks; None if there are too many to read in a moment."""
    if sum(len(getattr(bpy.data, kind)) for kind in KINDS) > MOST_BLOCKS:
        return None
    layer = getattr(bpy.context, "view_layer", None)
    if layer is not None:
        layer.update()
    blocks = [block for kind in KINDS for block in getattr(bpy.data, kind)]
    total = hashlib.blake2b(digest_size=12)
    read = digests_by_part(blocks)
    for line in sorted(repr((key_of(block), sorted(parts.items()))) for block, parts in read.items()):
        total.update(line.encode("utf-8", "replace"))
    return total.hexdigest()
