# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds what some instances do not let be assigned, although RNA says of the property that it can be.

Each instance is asked (``bpy_struct.is_property_readonly``) when it is new and in its modes, and whether a switch of
its own that is turned over makes the difference.
"""

from .rna import ancestry, declaring_class

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
        self._properties = {}

    def properties(self, struct):
        """(name, path) of each property that RNA lets be assigned, of the instance's class."""
        rna = struct.bl_rna
        known = self._properties.get(rna.identifier)
        if known is None:
            known = self._properties[rna.identifier] = [
                (prop.identifier, f"bpy.types.{declaring_class(rna, prop.identifier)}.{prop.identifier}")
                for prop in rna.properties
                if not (prop.is_readonly or prop.is_registered or prop.type == "COLLECTION")
            ]
        return known

    def look(self, label, struct, root):
        """Asks an instance; ``root`` is what it belongs to, made as ``label`` says, and not another of its kind."""
        if struct != root and ancestry(struct.bl_rna)[-1] == ancestry(root.bl_rna)[-1]:
            return
        for name, path in self.properties(struct):
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

    def look_in_mode(self, struct, mode):
        """Asks an instance that has been put into a mode for what it lets be assigned when it is new."""
        for name, path in self.properties(struct):
            if struct.is_property_readonly(name) and not self.found.get(path, {}).get(True):
                self.modes.setdefault(path, {})[mode] = None

    def write(self, write):
        """A ``locked`` record for each property that was locked somewhere.

        ``on`` and ``free_on``: the labels of what has it locked, and free; ``freed_by`` the setting that frees it;
        ``modes`` those that lock it where it is free before.
        """
        for path in sorted(self.modes.keys() | {path for path, found in self.found.items() if found[True]}):
            found = self.found.get(path, {True: {}, False: {}})
            write(
                "locked",
                path=path,
                on=list(found[True]),
                free_on=[label for label in found[False] if label not in found[True]],
                freed_by=self.freed_by.get(path, ""),
                modes=list(self.modes.get(path, {})),
            )
