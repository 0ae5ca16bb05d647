# SPDX-License-Identifier: GPL-3.0-or-later
"""Which pointers of new instances are None, and what was seen to fill them."""

import re


def variable(cls):
    """A name that scripts give to an instance of a class: ``scene``, ``node_tree``."""
    name = re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", cls).lower()
    return "obj" if name == "object" else name


class Pointers:
    """Which pointers of new instances are None, and what was seen to fill them."""

    def __init__(self):
        # path → {label of what was made: whether it leads to something}
        self.filled = {}
        # paths of those that lead to something on some of what is called the same, and not on the rest of it
        self.partly = set()
        # path → calls, in the order in which they were tried
        self.fillers = {}

    def add(self, path, label, is_filled):
        """Adds what one instance has; a label stands for what leads to something if one of its instances does."""
        known = self.filled.setdefault(path, {})
        if known.setdefault(label, is_filled) != is_filled:
            self.partly.add(path)
            known[label] = True

    def add_filler(self, path, call):
        """Adds a call that was seen to fill a pointer."""
        self.fillers.setdefault(path, []).append(call)

    def filler(self, path):
        """Of the calls that fill a pointer the one that has most words of its name in it; the first of several."""
        words = path.rpartition(".")[2].split("_")
        calls = self.fillers.get(path, ())
        return max(calls, key=lambda call: sum(word in call.lower() for word in words), default="")

    def write(self, write):
        """One ``new_pointer`` record for each pointer of which a new instance was seen.

        ``empty`` are the labels of those that have None, [] if most do; ``filled`` then those that do not. ``partly``:
        of those that have the same label some do.
        """
        for path in sorted(self.filled):
            labels = {True: [], False: []}
            for label, is_filled in self.filled[path].items():
                labels[is_filled].append(label)
            are_usual = len(labels[False]) > len(labels[True])
            write(
                "new_pointer",
                path=path,
                is_empty=bool(labels[False]),
                empty=[] if are_usual else labels[False],
                filled=labels[True] if are_usual else [],
                filler=self.filler(path) if labels[False] else "",
                partly=path in self.partly and not labels[False],
            )
