# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds enumerations whose items depend on a struct beside their own: ``color_depth`` on the codec of the same scene.

What an owner points to is put into each mode that changes which items are taken, and meanwhile its neighbours, and the
owner, into each of theirs. Where a neighbour's setting decides, its other settings are tried with each of its values.
"""

import bpy

from ..classes.rna import declaring_class
from .assigning import put, refused_value_items
from .observer import UNVARIED


def can_be_varied(struct):
    """Whether it may be put into modes, and is Blender's own: what Python registers is known to Python alone."""
    return struct.bl_rna.identifier not in UNVARIED and not isinstance(struct, bpy.types.PropertyGroup)


def values_of(struct, names):
    """name → value of some settings."""
    return {name: getattr(struct, name) for name in names}


class Neighbours:
    """Tries what belongs to new things, which an observer has read before."""

    def __init__(self, observer):
        self.observer = observer
        self.pairs = set()
        # path → rows, and own setting → values with which neighbours were tried (see write)
        self.rows = {}
        self.states = {}

    def look(self, root):
        """Tries what belongs to an instance, once for each pair of classes."""
        for owner in list(self.observer.parts(root)):
            beside = self.observer.belonging(owner)
            for struct in beside:
                enums = self.observer.layout(struct).enums
                fields = [field for field in enums if self.observer.is_computed(field)]
                for other in (owner, *beside) if fields and can_be_varied(struct) else ():
                    pair = struct.bl_rna.identifier, other.bl_rna.identifier
                    if pair[0] != pair[1] and pair not in self.pairs and can_be_varied(other):
                        self.pairs.add(pair)
                        self.try_modes(struct, other, fields)

    def modes(self, struct):
        """The names of its settings that put it into modes."""
        return [field.name for field in self.observer.layout(struct).modes]

    def items(self, struct, fields):
        """The items that each of these enumerations takes now."""
        found = []
        for field in fields:
            found.append(tuple(refused_value_items(struct, field.name, field.is_flag)))
            self.observer.keep_texts(struct, field, found[-1])
        return tuple(found)

    def try_modes(self, struct, other, fields):
        """Puts a struct into each mode that these enumerations depend on, and the other one into all of its."""
        before, others = self.observer.read(struct), self.observer.read(other)
        names = self.modes(struct)
        usual = self.items(struct, fields)
        # The modes that change nothing are as the first one.
        states = {name: [value] for name, value in values_of(struct, names).items()}
        found = self.try_other(struct, other, fields)
        for name in names:
            for value in refused_value_items(struct, name):
                if value in states[name] or not put(struct, name, value):
                    continue
                if self.items(struct, fields) == usual:
                    states[name].append(value)
                else:
                    state = {each: [has] for each, has in values_of(struct, names).items()}
                    self.note(fields, state, self.try_other(struct, other, fields))
                self.observer.restored(struct, before)
        self.note(fields, states, found)
        self.observer.restored(other, others)

    def try_other(self, struct, other, fields):
        """Of each of the other's settings that decides: its name, its value, and (values, items) of all that was tried.

        More values than one are that of another of its settings, with its name before it.
        """
        found = []
        for name in self.modes(other):
            tried = self.tried(struct, other, fields, name)
            if len(set(tried.values())) < 2:
                continue
            start, rows = getattr(other, name), []
            for value, items in tried.items():
                more = []
                for second in self.modes(other) if put(other, name, value) else ():
                    with_second = self.tried(struct, other, fields, second) if second != name else {}
                    if len(set(with_second.values())) > 1:
                        more += [([value, second, each], taken) for each, taken in with_second.items()]
                rows += more or [([value], items)]
            put(other, name, start)
            found.append((f"{declaring_class(other.bl_rna, name)}.{name}", start, rows))
        return found

    def tried(self, struct, other, fields, name):
        """value → for each enumeration its items, of a setting that is then put back.

        None for an enumeration on which another of the struct's own settings, changed as well, may have its effect.
        """
        state, start, found = values_of(struct, self.modes(struct)), getattr(other, name), {}
        for value in refused_value_items(other, name):
            if put(other, name, value):
                changed = {each for each, has in values_of(struct, state).items() if has != state[each]}
                items = zip(fields, self.items(struct, fields), strict=True)
                found[value] = tuple(None if changed - {field.name} else taken for field, taken in items)
        put(other, name, start)
        return found

    def note(self, fields, states, found):
        """Keeps what was found for each of the enumerations that it makes a difference for."""
        for number, field in enumerate(fields):
            own = {name: values for name, values in states.items() if name != field.name}
            known = self.states.setdefault(field.path, {})
            for name, values in own.items():
                known.setdefault(name, set()).update(values)
            for setting, start, tried in found:
                items = [[values, list(row[number])] for values, row in tried if row[number] is not None]
                if any(row[1] != items[0][1] for row in items):
                    self.add(field.path, {"setting": setting, "start": start, "tried": items}, own)

    def add(self, path, outcome, states):
        """Adds what came out; it may have been the same in other states."""
        rows = self.rows.setdefault(path, [])
        for row in rows:
            if all(row[name] == value for name, value in outcome.items()):
                for name, values in states.items():
                    row["states"][name] = sorted({*row["states"][name], *values})
                return
        rows.append({**outcome, "states": states})

    def write(self, write):
        """One ``enum_neighbours`` record for each enumeration that depends on a neighbour.

        Its ``rows`` have the ``states`` of its own struct, the neighbour's ``setting``, the value that this had at the
        ``start``, and what was ``tried``: values (see try_other) and the items taken with them. ``states`` are all that
        neighbours were tried in.
        """
        for path, rows in sorted(self.rows.items()):
            states = {name: sorted(values) for name, values in self.states[path].items()}
            write("enum_neighbours", path=path, rows=rows, states=states)
