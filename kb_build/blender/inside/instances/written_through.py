# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds sets of items that change other properties of their struct when they are assigned, or that do not take none."""

from .assigning import put, refused_value_items, same


def ignores_none(struct, name):
    """Whether a set that has items keeps them where it is given none, without a word."""
    try:
        setattr(struct, name, set())
        return bool(getattr(struct, name))
    except Exception:
        return False


class WrittenThrough:
    """What was seen to change with sets of items, by the path of the set."""

    def __init__(self):
        self.names = {}
        self.keeping = set()

    def look(self, observer, struct, before):
        """Assigns each item of each set of an instance alone; puts everything back. ``before``: its first values."""
        for field in observer.layout(struct).enums:
            for item in refused_value_items(struct, field.name, True) if field.is_flag else ():
                if not put(struct, field.name, {item}):
                    continue
                changed = [
                    other
                    for other, value in observer.read(struct).items()
                    if other is not field and other in before and not other.is_chosen
                    if value != before[other] and not same(value, before[other])
                ]
                if ignores_none(struct, field.name):
                    self.keeping.add(field.path)
                for other in changed:
                    self.names.setdefault(field.path, {})[other.name] = None
                    if other.is_flag and self.changes(struct, other, field, item):
                        self.names.setdefault(other.path, {})[field.name] = None
                before = observer.restored(struct, before)

    @staticmethod
    def changes(struct, other, field, item):
        """Whether assigning another set changes one that has this item."""
        for each in refused_value_items(struct, other.name, True):
            are_put = put(struct, field.name, {item}) and put(struct, other.name, {each})
            if are_put and getattr(struct, field.name) != {item}:
                return True
        return False

    def write(self, write):
        """One ``written_through`` record for each set: the ``names`` of what it changes, and whether it ``keeps`` what
        it has where it is given none.
        """
        for path in sorted(self.names.keys() | self.keeping):
            write(
                "written_through",
                path=path,
                names=list(self.names.get(path, ())),
                keeps=path in self.keeping,
            )
