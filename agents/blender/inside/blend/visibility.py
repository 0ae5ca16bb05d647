# SPDX-License-Identifier: GPL-3.0-or-later
"""Which objects a render shows, and has Blender evaluate them where keys hide them in the viewport alone."""

import contextlib

from .fcurves import played_curves, varies


def rendered_objects(layer):
    """Yields the objects of a layer collection that renders show: no collection that hides them, not hidden."""
    if layer.exclude or layer.collection.hide_render:
        return
    for obj in layer.collection.objects:
        if not obj.hide_render:
            yield obj
    for child in layer.children:
        yield from rendered_objects(child)


@contextlib.contextmanager
def as_rendered(scene):
    """Has Blender evaluate, in frames that are set meanwhile, also the objects that keys hide in the viewport.

    It does not move what is hidden there, while renders show it where it is. Yields whether there are such objects.
    """
    hidden = [(obj, curves, obj.hide_viewport) for obj in scene.objects if (curves := _hiding(obj))]
    try:
        for obj, curves, _ in hidden:
            _mute(curves, True)
            obj.hide_viewport = False
        yield bool(hidden)
    finally:
        for obj, curves, hide in hidden:
            _mute(curves, False)
            obj.hide_viewport = hide


def comes_and_goes(obj):
    """Whether keys show an object in renders at some frames, and not at others."""
    return any(curve.data_path == "hide_render" and varies(curve) for curve in played_curves(obj))


def _hiding(obj):
    """The f-curves and drivers that hide an object in the viewport."""
    if obj.animation_data is None or obj.library is not None:
        return []
    curves = [*played_curves(obj), *obj.animation_data.drivers]
    return [curve for curve in curves if curve.data_path == "hide_viewport" and not curve.mute]


def _mute(curves, mute):
    for curve in curves:
        curve.mute = mute
