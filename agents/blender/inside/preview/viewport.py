# SPDX-License-Identifier: GPL-3.0-or-later
"""One picture of the whole scene, as the viewport of a Blender with a window would show it."""

import contextlib
import os

import bpy
import gpu

from ..render.engines import WORKBENCH
from .fixed_views import SCENE, PreviewRenderer, copy_of
from .framing import VIEWS
from .studio_scene import StudioScene, drawing_engine

_FILE = ".first.png"
_VIEW = VIEWS[-1]  # three-quarter, as a new viewport stands


def viewport(arguments, report):
    """Renders the scene, ``size`` pixels a side, into ``folder``. Returns the view; Refused if there is nothing."""
    scene, notes = bpy.context.scene, []
    engine = drawing_engine(notes)
    bpy.context.view_layer.update()
    with StudioScene(engine) as studio:
        subject = copy_of(studio, SCENE, scene.name, None, notes)
        renderer = PreviewRenderer(studio, subject, arguments["folder"], arguments["size"])
        renderer.set_up(True, False, notes)
        with renderer.cleaned_up():
            (view,) = renderer.fixed_views(report, 1, views=(_VIEW,))
        return view


def make_drawable(arguments, report):
    """Lets code draw with the module ``gpu`` from now on, where this machine can: Blender without a window sets it up
    with the first picture only, which is drawn into ``folder`` and removed."""
    del report
    try:
        gpu.types.GPUOffScreen(1, 1).free()
        return
    except (SystemError, RuntimeError):
        pass
    path = os.path.join(arguments["folder"], _FILE)
    if drawing_engine([]) == WORKBENCH:
        with StudioScene(WORKBENCH) as studio:
            studio.render(studio.camera(), (16, 16), path)
        with contextlib.suppress(OSError):
            os.remove(path)
