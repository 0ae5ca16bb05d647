# SPDX-License-Identifier: GPL-3.0-or-later
"""Shows the open scene in another guise: the same things and motion, otherwise organised. One function for each."""

from simworlds.sandbox.inside.refusal import Refused

from . import grouping, meshes, units

GUISES = {
    "ungrouped": grouping.ungroup,
    "grouped": grouping.group,
    "renamed": grouping.rename,
    "rescaled": units.rescale,
    "instanced": meshes.instance,
    "joined": meshes.join,
}


def dress(guise, cast):
    """Puts the open scene into a guise. Returns how much of it was changed.

    ``cast``: the actors, each with ``name``, ``other`` (another name for it), ``still`` (whether it is of a role that
    nothing simulates), ``units`` (names of objects, the first of which stands for the rest), and ``parts``, what
    belongs to it by contact alone.

    Raises Refused where there is nothing that could be changed so.
    """
    changed = GUISES[guise](cast)
    if not changed:
        raise Refused(f"nothing in it can be {guise}")
    return changed
