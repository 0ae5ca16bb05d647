# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects a render shows."""


def rendered_objects(layer):
    """Yields the objects of a layer collection that renders show: no collection that hides them, not hidden."""
    if layer.exclude or layer.collection.hide_render:
        return
    for obj in layer.collection.objects:
        if not obj.hide_render:
            yield obj
    for child in layer.children:
        yield from rendered_objects(child)
