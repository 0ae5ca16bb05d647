# SPDX-License-Identifier: GPL-3.0-or-later
"""What was seen of instances, by property, and the records that are made of it (see ``observer``)."""

import bpy

from ..wire import plain
from .assigning import same

# Values more various than this describe the instances, not what is new in them.
MOST_VALUES = 24
# How the labels begin of what is there when Blender starts.
START_UP, FACTORY = AT_START = ("start-up ", "factory ")


class Contexts:
    """Where an enumeration had the same items: (label, mode) pairs, and the values of the struct's other enums."""

    def __init__(self):
        self.made = {}
        self.states = []

    def add(self, pair, state):
        """Adds an instance in a mode, and the values of its enums by name."""
        self.made[pair] = None
        self.states.append(state)

    def row(self, items, name):
        """The record of the enumeration ``name``."""
        seen = {}
        for state in self.states:
            for other, value in state.items():
                if other != name:
                    seen.setdefault(other, set()).add(value)
        states = {other: sorted(values) for other, values in seen.items()}
        return {"items": list(items), "made": [list(pair) for pair in self.made], "states": states}


def made_new(labels):
    """Of things those that a script has made, if there are some: who reads of these needs no others."""
    return [label for label in labels if not label.startswith(AT_START)] or labels


class Observations:
    """The values that instances have, and the items that their enumerations take."""

    def __init__(self):
        self.fields = {}
        # path → [(value, labels of what was made)]
        self.values = {}
        # path → the same of what is there when Blender starts
        self.start_values = {}
        # label → the call that made it, of those that one call makes
        self.calls = {}
        # path → [(value, mode, labels)]
        self.in_modes = {}
        # mode → [(label, ancestry)] of all that was put into it
        self.put_into = {}
        # mode → [(label, first values)] of all that began in it
        self.began_in = {}
        # path → {items: Contexts}
        self.items = {}
        # path → {identifier: (name, description)}
        self.texts = {}
        # (path of a function, argument) → {items: Contexts}
        self.choices = {}
        # path of a collection → whether one of the new instances has elements in it
        self.collections = {}

    @staticmethod
    def add(rows, value, label):
        """Adds a label to the row of its value."""
        for row in rows:
            if row[0] == value or same(row[0], value):
                row[1][label] = None
                return
        rows.append((value, {label: None}))

    def write(self, write):
        """A ``new_values`` record for each property that was read, ``enum_items`` for each asked, ``argument_items``
        for each choice of a function, and the collections that no new instance has filled.

        One that is ``chosen`` says nothing about what is new.
        """
        for path in sorted(self.values.keys() | self.start_values.keys()):
            write("new_values", path=path, values=self.usual(path), modes=self.modal(path))
        for path in sorted(self.fields.keys() - self.values.keys() - self.start_values.keys()):
            if self.fields[path].is_chosen:
                write("new_values", path=path, chosen=True)
        for path in sorted(self.items):
            self.write_items(write, path)
        for (path, argument), found in sorted(self.choices.items()):
            contexts = [row.row(items, argument) for items, row in found.items()]
            write("argument_items", path=path, argument=argument, contexts=contexts)
        for path in sorted(path for path, has_elements in self.collections.items() if not has_elements):
            write("empty_collection", path=path)

    def usual(self, path):
        """The values of new instances, the usual one first, which needs no labels; none if all have RNA's.

        Then those that no new one has, of what Blender starts with.
        """
        cls = path.split(".")[2]
        rna = getattr(getattr(bpy.types, cls, None), "bl_rna", None)
        rows = sorted(
            self.values.get(path, ()), key=lambda row: self.rank(row, rna.name.lower() if rna else "")
        )
        if len(rows) > MOST_VALUES:
            return []
        others = [
            (value, labels, any(same(value, new) for new, _ in rows[:1]))
            for value, labels in self.start_values.get(path, ())
        ]
        # Of several in one thing, those that have what a new one has are the ones that people mean.
        usual = {label for _, labels, is_usual in others if is_usual for label in labels}
        start = [
            {"value": value, "made": made}
            for value, labels, is_usual in others
            if not is_usual and (made := made_new([label for label in labels if label not in usual]))
        ]
        default = self.fields[path].default
        if not start and all(same(value, default) for value, _ in rows):
            return []
        if not rows:
            return [] if all(same(row["value"], default) for row in start) else start
        new = []
        for row, (value, labels) in enumerate(rows):
            known = {"value": value, "made": list(labels) if row or len(rows) == 1 == len(labels) else []}
            if call := self.maker(labels):
                if any(other is not labels and not labels.keys().isdisjoint(other) for _, other in rows):
                    # What the call makes has several of the class, with other values: it tells nothing of this one.
                    if row:
                        continue
                else:
                    known["by"] = call
            new.append(known)
        return new + start

    def rank(self, row, own):
        """That of the thing that is called as the class itself comes first, then those of data-blocks and of what they
        bring, then the most frequent ones.
        """
        _, labels = row
        return own not in labels, not any(self.calls.get(label) for label in labels), -len(labels)

    def maker(self, labels):
        """The call that made everything with these labels; empty where it was not one call."""
        calls = {self.calls.get(label, "") for label in labels}
        return calls.pop() if len(calls) == 1 else ""

    def modal(self, path):
        """The values that a mode gives; ``made`` where it gives them to some instances only that were put into it."""
        cls = path.split(".")[-2]
        rows = []
        for value, mode, labels in self.in_modes.get(path, ()):
            others = {label for label, names in self.put_into[mode] if cls in names}
            for label, before in self.began_in.get(mode, ()):
                first = [kept for field, kept in before.items() if field.path == path]
                others |= {label for kept in first if not same(plain(kept), value)}
            others -= set(labels)
            rows.append({"value": value, "when": mode, "made": list(dict.fromkeys(labels)) if others else []})
        return rows

    def is_computed(self, field):
        """Whether an enumeration had other items than RNA lists, somewhere."""
        return any(set(items) != set(field.static) for items in self.items.get(field.path, ()))

    def write_items(self, write, path):
        """The items in every context, unless they are always those that RNA lists."""
        field = self.fields[path]
        if not self.is_computed(field):
            return
        contexts = self.items[path]
        write(
            "enum_items",
            path=path,
            contexts=[found.row(items, field.name) for items, found in contexts.items()],
            texts={name: list(text) for name, text in self.texts.get(path, {}).items()},
        )
