# SPDX-License-Identifier: GPL-3.0-or-later
"""The objects that a name of a tool's argument stands for, by one rule for all tools."""

from simworlds.sandbox.inside.refusal import Refused

from .names import nearest, quoted
from .protocol_tags import object_collections

_NEAR = 4


def objects_named(scene, names):
    """{name: its objects}. Raises Refused for a name that nothing in the scene has.

    A name is first that of an object of the protocol (the collection of its parts), then that of a Blender object, then
    that of any other collection.
    """
    tagged = {one.name: one for one in object_collections(scene)}
    collections = {one.name: one for one in scene.collection.children_recursive}
    found = {}
    for name in names:
        if name not in tagged and name in scene.objects:
            found[name] = [scene.objects[name]]
        elif name in collections:
            found[name] = list(collections[name].all_objects)
        else:
            known = list(dict.fromkeys([*tagged, *scene.objects.keys(), *collections]))
            near = nearest(name, known, _NEAR)
            raise Refused(
                f"There is no object or collection {name[:100]!r} in the scene {scene.name!r}."
                + (
                    f" Nearest: {quoted(near, _NEAR)}."
                    if near
                    else f" There are: {quoted(known, 12)}."
                    if known
                    else ""
                )
            )
    return found
