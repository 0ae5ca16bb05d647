# SPDX-License-Identifier: GPL-3.0-or-later
"""Finds defaults of operators' enumerations that are no values of them: RNA has a stand-in, and the values are put
together while Blender runs.

An operator names its values when it refuses another, before it does anything, where the context lets it run.
"""

from ..instances.assigning import refused_items
from .operators import REFUSED, names_in_file


def defaults(operator):
    """Argument → its default, of the enumerations of which RNA lists values."""
    return {
        prop.identifier: prop.default
        for prop in operator.get_rna_type().properties
        if prop.type == "ENUM" and not prop.is_enum_flag and prop.enum_items_static and prop.default
    }


def values_now(operator, argument):
    """The values that an argument takes here and now; None where Blender does not say."""
    try:
        operator(**{argument: REFUSED})
    except TypeError as refusal:
        return refused_items(refusal)
    except RuntimeError:
        pass
    return None


class Defaults:
    """Asks operators for their values wherever they can run, until one of these is the default."""

    def __init__(self, known):
        self.operators = dict(known)
        # path → {argument: default}, of those that have not been among the values.
        self.waiting = {}
        # (path, argument) → the most values that were named.
        self.named = {}

    def ask(self, paths):
        """Asks operators that can run here and now."""
        for path in paths:
            operator = self.operators[path]
            if path not in self.waiting:
                self.waiting[path] = defaults(operator)
            for argument, default in list(self.waiting[path].items()):
                values = values_now(operator, argument)
                if values is not None and default in values:
                    del self.waiting[path][argument]
                elif values is not None:
                    self.named[path, argument] = max(self.named.get((path, argument), ()), values, key=len)

    def write(self, write):
        """One ``refused_default`` record for each that was never taken. Names of things in the file are not told."""
        names = names_in_file()
        for (path, argument), values in sorted(self.named.items()):
            if argument in self.waiting[path]:
                told = list(values) if names.isdisjoint(values) else []
                write("refused_default", path=path, argument=argument, values=told)
