# SPDX-License-Identifier: GPL-3.0-or-later
"""Reads instances: the values that a new one has, and the items that its enumerations take.

RNA's own defaults are those of zeroed memory for one setting in six, and its lists of enum items are a superset, or
empty, where the items depend on the instance. So whatever is made (see ``new_things``) is read here, with all structs
that belong to it, and read again in each of its modes.
"""

import bpy

from ..classes.rna import ancestry, declaring_class
from ..wire import plain
from .assigning import put, refused_items, refused_value_items, same
from .layouts import Layout, asked_pointers
from .locked import Locked
from .making import by_operator
from .observations import Contexts, Observations
from .own_names import OwnNames
from .pointers import Pointers, variable
from .written_through import WrittenThrough

DEPTH = 3
# How many instances of one class are put into every mode.
VARIED = 3
# Up to Blender 4.3 it claims to be a Paint, which it is not in memory: reading what it inherits crashes.
UNREADABLE = frozenset({"UvSculpt"})
# Its modes crash Blender 3.4.
UNVARIED = frozenset({"BrushGpencilSettings"})
# Pointers to what is around an instance.
AROUND = frozenset({"parent"})


class Observer(Observations):
    """Reads instances, and keeps what they have."""

    def __init__(self):
        super().__init__()
        self.pointers = Pointers()
        self.locked = Locked()
        self.names = OwnNames()
        self.through = WrittenThrough()
        self._layouts = {}
        self._pointers = {}
        self._varied = {}

    def layout(self, struct):
        """The layout of the instance's class."""
        return self.layout_of(struct.bl_rna)

    def layout_of(self, rna):
        """The layout of a class."""
        known = self._layouts.get(rna.identifier)
        if known is None:
            known = self._layouts[rna.identifier] = Layout(rna, self.pointers_of(rna))
            self.fields.update((field.path, field) for field in known.fields)
        return known

    def pointers_of(self, rna):
        """The pointers of a class that instances are asked for. They are all that many ask of a layout."""
        known = self._pointers.get(rna.identifier)
        if known is None:
            known = self._pointers[rna.identifier] = asked_pointers(rna)
        return known

    def leave_out(self, cls, name):
        """Has a property of a class never be read."""
        layout = self.layout_of(getattr(bpy.types, cls).bl_rna)
        layout.keep([field for field in layout.fields if field.name != name])

    def belonging(self, struct):
        """The structs behind an instance's pointers, without other data-blocks."""
        pointers = self.pointers_of(struct.bl_rna)
        values = [getattr(struct, name, None) for name in pointers if name not in AROUND]
        return [
            value
            for value in values
            if isinstance(value, bpy.types.bpy_struct)
            and not isinstance(value, bpy.types.ID)
            and value.bl_rna.identifier not in UNREADABLE
        ]

    def parts(self, root):
        """An instance, and the structs that belong to it, directly and through each other."""
        queue, seen = [(root, DEPTH)], set()
        while queue:
            struct, left = queue.pop(0)
            key = (struct.as_pointer(), struct.bl_rna.identifier)
            if key not in seen:
                seen.add(key)
                yield struct
                queue += [(part, left - 1) for part in self.belonging(struct)] if left else []

    def nearest(self, root):
        """An instance, and of each class the struct that belongs to it most directly."""
        seen = set()
        for struct in self.parts(root):
            name = struct.bl_rna.identifier
            if name not in seen:
                seen.add(name)
                yield struct

    def empty_pointers(self, struct):
        """The paths of the pointers of an instance that nothing can be assigned to, and whether each is None."""
        return {
            path: getattr(struct, name, None) is None for name, path in self.layout(struct).unassigned.items()
        }

    def look(self, label, root, vary=True, place="", is_new=True):
        """Reads an instance and what belongs to it; ``label`` says what it is.

        ``vary``: in all modes, too. ``place``: where it is, if that decides which items enumerations take. What a
        pointer of it leads to counts only if it is new: no script has worked on it.
        """
        self.names.add(root)
        seen = self.values if is_new else self.start_values
        # All are read before any is put into a mode, which may change another one's settings.
        parts = [
            (struct, self.read(struct)) for struct in (self.parts(root) if is_new else self.nearest(root))
        ]
        for struct, before in parts:
            if is_new:
                for name, path in self.layout(struct).pointers.items():
                    self.pointers.add(path, label, getattr(struct, name, None) is not None)
                if not by_operator(label):
                    self.count(struct)
                self.locked.look(label, struct, root, self.layout(struct).writable)
            for field, value in before.items():
                if not field.is_chosen or label == field.unasked:
                    self.add(seen.setdefault(field.path, []), plain(value), label)
            for field in self.unset(struct, before):
                self.add(seen.setdefault(field.path, []), "", label)
            # What a mode would let it take is not known without all modes.
            enums = self.layout(struct).enums
            if not vary:
                enums = [field for field in enums if field.is_listed_wrongly(before.get(field))]
            self.ask(struct, label + place, "", enums)
            self.ask_choices(struct, label + place)
        for struct, before in parts if vary else ():
            name = struct.bl_rna.identifier
            if name not in UNVARIED and self._varied.get(name, 0) < VARIED:
                self._varied[name] = self._varied.get(name, 0) + 1
                self.vary(struct, label, place, self.restored(struct, before), is_new)
                if self._varied[name] == 1:
                    self.through.look(self, struct, self.restored(struct, before))
                if self._varied[name] == 1:
                    self.vary_beside(struct, label, parts)

    def count(self, struct):
        """Notes which of a new instance's collections have elements."""
        for name, path in self.layout(struct).collections.items():
            try:
                has_elements = len(getattr(struct, name)) > 0
            except (AttributeError, TypeError, RuntimeError):
                continue
            self.collections[path] = self.collections.get(path, False) or has_elements

    def read(self, struct):
        """field → value of each comparable property, arrays and sets as lists."""
        values = {}
        for field in self.layout(struct).fields:
            if field.is_chosen and not field.is_mode:
                continue
            try:
                value = getattr(struct, field.name)
            except Exception:
                continue
            # An empty enum is a number that stands for no item here.
            if value != "" or not field.is_enum:
                values[field] = plain(value) if field.is_many else value
        return values

    def unset(self, struct, before):
        """The enumerations of an instance that have none of their items, though RNA says which one is the default."""
        for field in self.layout(struct).enums:
            is_plain = not (field.is_flag or field.is_chosen) and field.default in field.static
            if is_plain and field not in before and getattr(struct, field.name, None) == "":
                yield field

    def ask(self, struct, label, mode, enums=None):
        """Notes which items the instance's enumerations take now: all, or these."""
        enums = self.layout(struct).enums if enums is None else enums
        state = self.state(struct) if enums else {}
        for field in enums:
            items = refused_value_items(struct, field.name, field.is_flag)
            if items:
                found = self.items.setdefault(field.path, {}).setdefault(tuple(items), Contexts())
                found.add((label, mode), state)
                self.keep_texts(struct, field, items)

    def state(self, struct):
        """What may decide which items an instance takes: its modes, and the type of its object."""
        modes = {field.name: getattr(struct, field.name) for field in self.layout(struct).modes}
        owner = struct.id_data
        if isinstance(owner, bpy.types.Object):
            modes["type" if struct == owner else "obj.type"] = owner.type
        return modes

    def ask_choices(self, struct, label):
        """Notes which items an instance's functions take, of those that RNA does not list."""
        for path, function, argument, names in self.layout(struct).choices:
            try:
                getattr(struct, function)(**dict.fromkeys(names, "name"), **{argument: "\x01"})
            except TypeError as refusal:
                items = refused_items(refusal)
                if items:
                    found = self.choices.setdefault((path, argument), {}).setdefault(tuple(items), Contexts())
                    found.add((label, ""), {})
            except Exception:
                continue

    def keep_texts(self, struct, field, items):
        """Keeps name and description of the items that RNA does not list."""
        known = self.texts.setdefault(field.path, {})
        for item in items:
            if item not in known and item not in field.static:
                known[item] = self.text(struct, field.name, item)

    @staticmethod
    def text(struct, name, item):
        """(name, description) of an item that only the instance has."""
        layout = bpy.types.UILayout
        try:
            return layout.enum_item_name(struct, name, item), layout.enum_item_description(struct, name, item)
        except Exception:
            return "", ""

    def vary(self, struct, label, place, before, is_new):
        """Puts the instance into each mode and notes what else changed; then puts everything back."""
        known = {part.as_pointer() for part in self.belonging(struct)}
        empty = {path for path, is_empty in self.empty_pointers(struct).items() if is_empty}
        enums = self.layout(struct).enums
        is_first = self._varied[struct.bl_rna.identifier] == 1
        if not is_first:
            # It has shown which of them depend on the mode.
            enums = [field for field in enums if self.is_computed(field)]
        for field in self.layout(struct).modes:
            start = before.get(field)
            for item in refused_value_items(struct, field.name):
                mode = f"{field.name}={item!r}"
                if item == start:
                    self.began_in.setdefault(mode, []).append((label, before))
                    continue
                if not put(struct, field.name, item):
                    continue
                has_changed_others = self.compare(struct, label, mode, field, before)
                if empty:
                    now = self.empty_pointers(struct)
                    filled = {path for path in empty if not now[path]}
                    self.note_filled(struct, filled, f".{field.name} = {item!r}")
                    empty -= filled
                self.ask(struct, label + place, mode, enums)
                if is_first:
                    self.locked.look_in_mode(struct, mode, self.layout(struct).writable)
                for part in self.belonging(struct):
                    if part.as_pointer() not in known:
                        self.look(f"{label} with {mode}", part, is_new=is_new)
                if has_changed_others:
                    before = self.restored(struct, before)
            before = self.restored(struct, before)

    def vary_beside(self, struct, label, parts):
        """Puts the instance into each mode and notes what that changes in what belongs to the same owner.

        ``parts`` are (instance, its values) of all that was looked at.
        """
        same = {
            part.as_pointer()
            for owner, _ in parts
            if struct in (belonging := self.belonging(owner))
            for part in belonging
        }
        beside = [
            (part, self.restored(part, before))
            for part, before in parts
            if part != struct and part.as_pointer() in same
        ]
        start = self.read(struct) if beside else {}
        for field in self.layout(struct).modes if beside else ():
            mode = f"{declaring_class(struct.bl_rna, field.name)}.{field.name}"
            for item in refused_value_items(struct, field.name):
                if item == start.get(field) or not put(struct, field.name, item):
                    continue
                for part, before in beside:
                    if self.compare(part, label, f"{mode}={item!r}", None, before):
                        self.restored(part, before)
            self.restored(struct, start)

    def note_filled(self, struct, paths, call):
        """Notes that a call filled pointers which were None.

        ``call`` is what follows the name of ``struct``; all of it if ``struct`` is None.
        """
        for path in paths:
            if struct is not None and path.split(".")[2] in ancestry(struct.bl_rna):
                name = variable(path.split(".")[2])
            else:
                name = variable(struct.bl_rna.identifier) if struct is not None else ""
            self.pointers.add_filler(path, name + call)

    def compare(self, struct, label, mode, changed, before):
        """Notes the properties that the mode has changed. Returns whether there are any."""
        found = False
        self.put_into.setdefault(mode, []).append((label, ancestry(struct.bl_rna)))
        for field, value in self.read(struct).items():
            known = field in before and not field.is_chosen
            if field is not changed and known and value != before[field] and not same(value, before[field]):
                found = True
                rows = self.in_modes.setdefault(field.path, [])
                for row in rows:
                    if row[1] == mode and same(row[0], value):
                        row[2].append(label)
                        break
                else:
                    rows.append((plain(value), mode, [label]))
        return found

    def restored(self, struct, before):
        """Gives an instance its first values back. Returns those that it has: some cannot be given."""
        present = self.read(struct)
        # What one setting refuses it may take once another has its first value back.
        for _ in range(2):
            changed = [
                field
                for field, value in present.items()
                if value != before.get(field) and not same(value, before.get(field))
            ]
            if not changed:
                break
            for field in changed:
                try:
                    value = before[field]
                    setattr(struct, field.name, set(value) if field.is_flag else value)
                except Exception:
                    continue
            present = self.read(struct)
        return present

    def write(self, write):
        """The records of what was observed, the pointers, what is locked, what is written through others, and names."""
        super().write(write)
        self.pointers.write(write)
        self.locked.write(write)
        self.through.write(write)
        self.names.write(write)
