# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what some instances do not let be assigned, although RNA says of the property that it can be.

Each instance is asked (``bpy_struct.is_property_readonly``) when it is new and in its modes, and whether a switch of
its own that is turned over makes the difference.
"""

from ..classes.rna import ancestry
from .making import by_operator

SWITCHES = "use_"


class Locked:
    """Which properties were locked, on what, in which modes, and which setting frees them."""

    def __init__(self):
        # path → {whether it is locked: labels of what was made}
        self.found = {}
        # path → the modes that lock it
        self.modes = {}
        # path → the setting that frees it, empty where no switch does
        self.freed_by = {}

    def look(self, label, struct, root, writable):
        """Asks an instance; ``root`` is what it belongs to, made as ``label`` says, and not another of its kind.

        ``writable``: name → path of what RNA lets be assigned.
        """
        if struct != root and ancestry(struct.bl_rna)[-1] == ancestry(root.bl_rna)[-1]:
            return
        for name, path in writable.items():
            is_locked = struct.is_property_readonly(name)
            self.found.setdefault(path, {True: {}, False: {}})[is_locked][label] = None
            if is_locked and path not in self.freed_by:
                self.freed_by[path] = self.switch(struct, name)

    def switch(self, struct, locked):
        """The setting of an instance that frees a property; empty where there is none."""
        for prop in struct.bl_rna.properties:
            name = prop.identifier
            if prop.type != "BOOLEAN" or not name.startswith(SWITCHES) or struct.is_property_readonly(name):
                continue
            before = getattr(struct, name)
            setattr(struct, name, not before)
            is_free = not struct.is_property_readonly(locked)
            setattr(struct, name, before)
            if is_free:
                return f"{name} = {not before}"
        return ""

    def look_in_mode(self, struct, mode, writable):
        """Asks an instance that has been put into a mode for what it lets be assigned when it is new."""
        for name, path in writable.items():
            if struct.is_property_readonly(name) and not self.found.get(path, {}).get(True):
                self.modes.setdefault(path, {})[mode] = None

    def write(self, write):
        """A ``locked`` record for each property that was locked somewhere.

        ``is_always``: on all that was made. Else ``on`` are the labels of what has it locked, or ``free_on`` of what
        has it free if these are fewer. ``freed_by`` is the setting that frees it; ``modes`` those that lock it where
        it is free before.
        """
        for path in sorted(self.modes.keys() | {path for path, found in self.found.items() if found[True]}):
            found = self.found.get(path, {True: {}, False: {}})
            locked, free = list(found[True]), [label for label in found[False] if label not in found[True]]
            is_told_by_free = 0 < len(free) < len(locked)
            write(
                "locked",
                path=path,
                is_always=bool(locked) and not free,
                on=[] if is_told_by_free or not free else plainest(locked),
                free_on=plainest(free) if is_told_by_free else [],
                freed_by=self.freed_by.get(path, ""),
                modes=list(self.modes.get(path, {})),
            )


def plainest(labels):
    """The labels of what no operator made, or all if there are none."""
    return [label for label in labels if not by_operator(label)] or labels
